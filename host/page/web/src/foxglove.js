// The frames of the Foxglove WebSocket protocol: bytes and JSON to objects, and back.

export const SUBPROTOCOL = "foxglove.sdk.v1";

const MESSAGE = 1;
const TIME = 2;
const SERVICE_RESPONSE = 3;
const SERVICE_REQUEST = 2;

/** A binary frame of the server as `{ op, ... }`, `undefined` where its kind is not known. Throws where it is cut. */
export function readBinary(buffer) {
  const view = new DataView(buffer);
  switch (view.getUint8(0)) {
    case MESSAGE:
      return {
        op: "message",
        subscriptionId: view.getUint32(1, true),
        logTime: view.getBigUint64(5, true),
        bytes: new Uint8Array(buffer, 13),
      };
    case TIME:
      return { op: "time", time: view.getBigUint64(1, true) };
    case SERVICE_RESPONSE:
      return readResponse(view, buffer);
    default:
      return undefined;
  }
}

function readResponse(view, buffer) {
  const encodingLength = view.getUint32(9, true);
  return {
    op: "serviceResponse",
    serviceId: view.getUint32(1, true),
    callId: view.getUint32(5, true),
    payload: JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 13 + encodingLength))),
  };
}

/** The binary frame that calls a service with `request`, as JSON. */
export function serviceRequest(serviceId, callId, request) {
  const encoding = new TextEncoder().encode("json");
  const payload = new TextEncoder().encode(JSON.stringify(request));
  const frame = new Uint8Array(13 + encoding.length + payload.length);
  const view = new DataView(frame.buffer);
  view.setUint8(0, SERVICE_REQUEST);
  view.setUint32(1, serviceId, true);
  view.setUint32(5, callId, true);
  view.setUint32(9, encoding.length, true);
  frame.set(encoding, 13);
  frame.set(payload, 13 + encoding.length);
  return frame;
}
