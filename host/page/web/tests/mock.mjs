// A server that speaks page and program's contract without a board: a synthetic skin with presses, services, and
// the page's files under the program's content security policy. To try the page by hand: node tests/mock.mjs [hemisphere]

import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { WebSocketServer } from "ws";

import { contactsOf, healthOf, imageOf, presses, quantised } from "./press.mjs";
import { schemaOf } from "./schemas.mjs";
import { disc, hemisphere } from "./skins.mjs";

const ASSETS = new URL("../../assets/", import.meta.url);
const FILES = {
  "/": ["index.html", "text/html; charset=utf-8"],
  "/app.js": ["app.js", "text/javascript; charset=utf-8"],
  "/app.css": ["app.css", "text/css; charset=utf-8"],
};
export const POLICY =
  "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self'; img-src 'self' data: blob:; worker-src 'self' blob:";

const CHANNELS = [
  ["/dermatome/skin", "Skin"],
  ["/dermatome/status", "Status"],
  ["/dermatome/image", "Image"],
  ["/dermatome/contacts", "ContactArray"],
  ["/dermatome/health", "Health"],
  ["/dermatome/measurements", "Measurements"],
  ["/dermatome/scope", "Scope"],
].map(([topic, name], i) => ({
  id: i + 1,
  topic,
  encoding: "cdr",
  schemaName: `dermatome_msgs/msg/${name}`,
  schema: schemaOf(name),
  schemaEncoding: "ros2msg",
}));

const SERVICES = ["tare", "drive", "patch", "threshold", "record", "scope", "check", "calibrate"];
const writers = new Map();

/** The channel of a topic, and the CDR of a message on it. */
export const channelOf = (topic) => CHANNELS.find((channel) => channel.topic === topic);
export function encode(topic, message) {
  if (!writers.has(topic)) writers.set(topic, new MessageWriter(parse(channelOf(topic).schema, { ros2: true })));
  return writers.get(topic).writeMessage(message);
}

export class Mock {
  constructor({ skin = disc(), rate = 400, still, isFaulty = false } = {}) {
    Object.assign(this, { skin, rate, still, isFaulty });
    this.status = usualStatus(skin, rate);
    this.sequence = 0;
    this.calls = [];
    this.answers = {};
    this.slot = null;
    this.clients = new Set();
    this.sessionId = `${Date.now()}-${Math.random()}`;
    this.began = Date.now();
  }

  /** Listens on a port of the machine itself, any where it is 0. */
  async listen(port = 0) {
    this.server = createServer((request, response) => this.serve(request, response));
    this.sockets = new WebSocketServer({ server: this.server, handleProtocols: () => "foxglove.sdk.v1" });
    this.sockets.on("connection", (socket, request) => this.welcome(socket, request));
    await new Promise((resolve) => this.server.listen(port, "127.0.0.1", resolve));
    this.port = this.server.address().port;
    this.url = `http://127.0.0.1:${this.port}/`;
    this.timers = [setInterval(() => this.sendDue(), 5), setInterval(() => this.sendStatus(), 500)];
    return this;
  }

  async close() {
    this.timers.forEach(clearInterval);
    for (const { socket } of this.clients) socket.terminate();
    await new Promise((resolve) => this.sockets.close(resolve));
    this.server.closeAllConnections();
    await new Promise((resolve) => this.server.close(resolve));
  }

  async serve({ url }, response) {
    const file = FILES[new URL(url, "http://mock").pathname];
    response.setHeader("Content-Security-Policy", POLICY);
    if (!file) return response.writeHead(404).end();
    response.setHeader("Content-Type", file[1]);
    response.end(await readFile(new URL(file[0], ASSETS)));
  }

  welcome(socket, request) {
    const client = { socket, subscriptions: new Map(), url: request.url, origin: request.headers.origin };
    this.clients.add(client);
    socket.on("close", () => this.clients.delete(client));
    socket.on("message", (data, isBinary) => (isBinary ? this.called(client, data) : this.told(client, JSON.parse(data))));
    const services = SERVICES.map((name, i) => ({
      id: i + 1,
      name: `/dermatome/${name}`,
      type: `dermatome/${name}`,
      request: { encoding: "json", schemaName: "", schemaEncoding: "", schema: "" },
      response: { encoding: "json", schemaName: "", schemaEncoding: "", schema: "" },
    }));
    const info = { name: "dermatome", capabilities: ["services", "time"], supportedEncodings: ["json"], metadata: {} };
    for (const message of [
      { op: "serverInfo", ...info, sessionId: this.sessionId },
      { op: "advertise", channels: CHANNELS },
      { op: "advertiseServices", services },
    ]) {
      socket.send(JSON.stringify(message));
    }
  }

  told(client, message) {
    if (message.op === "unsubscribe") for (const id of message.subscriptionIds) client.subscriptions.delete(id);
    if (message.op !== "subscribe") return;
    for (const { id, channelId } of message.subscriptions) {
      const { topic } = CHANNELS.find((channel) => channel.id === channelId);
      client.subscriptions.set(id, topic);
      if (topic === "/dermatome/skin" && this.skin) this.sendTo(client, id, encode(topic, this.message(this.skin)));
      if (topic === "/dermatome/status") this.sendTo(client, id, encode(topic, this.statusMessage()));
    }
  }

  called(client, data) {
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const [serviceId, callId, length] = [1, 5, 9].map((at) => view.getUint32(at, true));
    const request = JSON.parse(data.subarray(13 + length));
    const name = SERVICES[serviceId - 1];
    this.calls.push({ name, request });
    const answer = this.answers[name]?.(request) ?? this.usualAnswer(name, request);
    Promise.resolve(answer).then((value) => client.socket.send(response(serviceId, callId, value)));
  }

  usualAnswer(name, request) {
    const does = {
      tare: () => this.tare(),
      record: () => this.record(request.start),
      drive: () => this.drive(request),
      patch: () => this.set({ patch: request.index }),
      threshold: () => ({ ok: true }),
      scope: () => ((this.slot = request.slot), { ok: true }),
      check: () => new Promise((resolve) => setTimeout(resolve, 400, usualCheck())),
      calibrate: () => this.calibrate(request),
    };
    return does[name]();
  }

  set(status) {
    Object.assign(this.status, status);
    this.sendStatus();
    return { ok: true };
  }

  tare() {
    this.set({ state: "taring", text: "Taking the reference", advice: "Do not touch the skin." });
    setTimeout(() => this.set({ state: "live", text: "The skin is live", advice: "" }), 300);
    return { ok: true };
  }

  record(isStart) {
    const file = isStart ? "dermatome-2026-01-31-12-00-00.mcap" : "";
    this.set({ recording: file, recorded_bytes: isStart ? 1n : 0n, recorded_frames: 0n });
    return { ok: true, file };
  }

  drive({ frequency_hz: frequency, amplitude_ma: amplitude, gain }) {
    return this.set({ frequency, amplitude: amplitude / 1000, gain });
  }

  calibrate({ readings }) {
    this.setSkin({ ...this.skin, is_calibrated: true });
    return { ok: true, text: `Fitted ${readings.length} readings; the largest error is 0.3 kPa.`, file: "mock-calibrated.dermatome" };
  }

  setSkin(skin) {
    this.skin = skin;
    this.send("/dermatome/skin", this.message(skin));
  }

  message(body) {
    const now = this.now();
    return { header: { stamp: { sec: Number(now / 1000000000n), nanosec: Number(now % 1000000000n) }, frame_id: "skin" }, ...body };
  }

  now() {
    return BigInt(Math.round((performance.timeOrigin + performance.now()) * 1e6));
  }

  statusMessage() {
    const isRecording = this.status.recording !== "";
    return this.message({
      ...this.status,
      frames: BigInt(this.sequence),
      recorded_bytes: isRecording ? BigInt(this.sequence) * 1700n : 0n,
      recorded_frames: isRecording ? BigInt(this.sequence) : 0n,
    });
  }

  sendStatus() {
    this.send("/dermatome/status", this.statusMessage());
  }

  // As many frames as the clock asks for; after a pause of the machine those are left out.
  sendDue() {
    const due = Math.floor(((Date.now() - this.began) / 1000) * this.rate);
    this.sequence = Math.max(this.sequence, due - 8);
    while (this.sequence < due) this.sendFrame();
  }

  sendFrame() {
    this.sequence++;
    if (this.status.state !== "live" || this.isQuiet || !this.skin) return;
    for (const [topic, body] of this.frame(this.sequence)) this.send(topic, this.message(body));
  }

  /** Messages of frame number `sequence`, by topic. */
  frame(sequence) {
    const time = sequence / this.rate;
    const stamp = { sequence, device_time_us: BigInt(Math.round(time * 1e6)), flags: 0 };
    const list = presses(this.skin, time, this);
    const frame = [
      ["/dermatome/image", { ...stamp, ...quantised(imageOf(this.skin, list)) }],
      ["/dermatome/contacts", { ...stamp, contacts: contactsOf(this.skin, list) }],
    ];
    if (sequence % 20 === 0) frame.push(["/dermatome/health", { ...stamp, ...healthOf(this.skin, this.isFaulty) }]);
    if (this.slot !== null && sequence % 40 === 0) frame.push(["/dermatome/scope", scopeOf(this.slot)]);
    return frame;
  }

  send(topic, message) {
    let bytes;
    for (const client of this.clients) {
      for (const [id, subscribed] of client.subscriptions) {
        if (subscribed !== topic) continue;
        bytes ??= encode(topic, message);
        this.sendTo(client, id, bytes);
      }
    }
  }

  // A slow client gets the newest, as from the program.
  sendTo({ socket }, id, bytes) {
    if (socket.bufferedAmount > 1e6) return;
    const frame = new Uint8Array(13 + bytes.length);
    const view = new DataView(frame.buffer);
    view.setUint8(0, 1);
    view.setUint32(1, id, true);
    view.setBigUint64(5, this.now(), true);
    frame.set(bytes, 13);
    socket.send(frame);
  }
}

function response(serviceId, callId, answer) {
  const payload = Buffer.from(JSON.stringify(answer));
  const head = Buffer.alloc(13);
  head.writeUInt8(3, 0);
  head.writeUInt32LE(serviceId, 1);
  head.writeUInt32LE(callId, 5);
  head.writeUInt32LE(4, 9);
  return Buffer.concat([head, Buffer.from("json"), payload]);
}

function usualStatus(skin, rate) {
  return {
    state: "live",
    text: "The skin is live",
    advice: "",
    warnings: [],
    port: "sim:mock",
    board: "simulated",
    firmware: "0.9.0",
    skin: skin?.name ?? "",
    patch_crc: 0x1234abcd,
    patch: 0,
    patches: ["laplace 0.03", "greit, noise figure 0.5"],
    frequency: 50000,
    amplitude: 0.001,
    largest_amplitude: 0.002,
    gain: 0,
    frame_rate: rate,
    frames: 0n,
    frames_per_second: rate,
    frames_lost: 0n,
    packets_damaged: 0n,
    signal_to_noise: 61.5,
    recording: "",
    recorded_bytes: 0n,
    recorded_frames: 0n,
  };
}

function usualCheck() {
  return {
    ok: true,
    summary: ["16 electrodes, 208 voltages, 61.5 dB signal to noise."],
    findings: [
      { level: "fault", found: "Electrode 4 has no contact.", advice: "Look at its wire and at its button." },
      { level: "note", found: "Electrode 13 touches worse than in the tare.", advice: "Clean it, or tare again." },
    ],
  };
}

function scopeOf(slot) {
  const [period, settling] = [32, 48];
  const samples = Uint16Array.from({ length: 320 }, (_, i) => {
    const settled = 1 - Math.exp(-i / 14);
    return Math.round(2048 + settled * (900 + 20 * slot) * Math.sin((2 * Math.PI * i) / period) + 4 * Math.sin(i * 78.233));
  });
  return { slot, gain: 8, settling, period, sample_rate: 1600000, samples };
}

if (import.meta.url === `file://${process.argv[1]}`) {
  const skin = process.argv[2] === "hemisphere" ? hemisphere() : disc();
  console.log((await new Mock({ skin, isFaulty: true }).listen(Number(process.env.PORT ?? 0))).url);
}
