// The history of a whole recording, read in the background, in steps between which the page draws.

import { History } from "./history.js";
import { TOPIC, decode } from "./messages.js";

const STEP_MS = 12;

export class RecordedHistory {
  /** `onMore` is called when more of it has been read. */
  constructor(recording, onMore) {
    this.recording = recording;
    this.onMore = onMore;
    this.history = new History(Infinity);
    this.isClosed = false;
    this.read();
  }

  close() {
    this.isClosed = true;
  }

  // A recording that is damaged further on is shown up to there; the player says why.
  async read() {
    try {
      for await (const messages of this.recording.walk([TOPIC.contacts, TOPIC.status])) await this.addAll(messages);
    } catch (error) {
      console.warn("the history of the recording is not complete:", error.message);
    }
    if (!this.isClosed) this.onMore();
  }

  async addAll(messages) {
    let began = performance.now();
    for (const message of messages) {
      if (this.isClosed) return;
      this.add(message);
      if (performance.now() - began < STEP_MS) continue;
      this.onMore();
      await new Promise((resolve) => setTimeout(resolve));
      began = performance.now();
    }
  }

  add({ topic, schema, bytes, logTime }) {
    const time = Number(logTime) / 1e9;
    const message = decode(schema, bytes);
    if (topic === TOPIC.contacts) this.history.addContacts(time, message.contacts);
    else this.history.addStatus(time, message);
  }
}
