// Tare and record: what is pressed, what is said where it fails, and what is under way.

import { byId, setText } from "./element.js";
import { bytes } from "./words.js";

/** Returns `{ tare, record }`, for keys and other buttons. */
export function actions(session) {
  const said = byId("said-actions");
  const run = (button, service, request) => {
    button.setAttribute("aria-busy", "true");
    return session.call(service, request).then(
      () => setText(said, ""),
      (error) => {
        said.dataset.kind = "error";
        setText(said, error.message);
      },
    ).finally(() => button.removeAttribute("aria-busy"));
  };
  const tare = () => run(byId("tare"), "/dermatome/tare", {});
  const record = () => run(byId("record"), "/dermatome/record", { start: !session.liveStatus?.recording });
  byId("tare").addEventListener("click", tare);
  byId("record").addEventListener("click", record);
  session.listen((changes) => {
    if (["status", "liveStatus", "program", "player", "new"].some((name) => changes.has(name))) show(session);
  });
  return { tare, record };
}

function show(session) {
  const status = session.liveStatus;
  const isRecording = Boolean(status?.recording) && session.program.isOpen;
  byId("tare").disabled = !session.offers("/dermatome/tare");
  byId("record").disabled = !session.offers("/dermatome/record");
  byId("record").setAttribute("aria-pressed", String(isRecording));
  setText(byId("record-word"), isRecording ? "Stop" : "Record");
  const line = byId("recording-line");
  line.hidden = !isRecording;
  if (isRecording) {
    setText(line, `Recording to ${status.recording}: ${bytes(status.recorded_bytes)}, ${status.recorded_frames} frames`);
  }
}
