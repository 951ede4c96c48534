// The history of a whole recording, of each skin that is looked at, read in the background, in steps between which the
// page draws.

import { Histories } from "./history.js";
import { decode } from "./messages.js";
import { spaceOf } from "./spaces.js";

const STEP_MS = 12;

export class RecordedHistory {
  /** `onMore` is called when more of it has been read. */
  constructor(recording, onMore) {
    this.recording = recording;
    this.onMore = onMore;
    this.histories = new Histories(Infinity);
    this.isClosed = false;
    this.read();
  }

  /** How strongly each skin was pressed: `{ times, values }`. */
  get strengths() {
    return this.histories.all.map((history) => history.of("strength"));
  }

  close() {
    this.isClosed = true;
  }

  // A recording that is damaged further on is shown up to there; the player says why.
  async read() {
    try {
      const topics = this.recording.topics.filter((topic) => /\/(contacts|status)$/.test(topic));
      for await (const messages of this.recording.walk(topics)) await this.addAll(messages);
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
    const kind = topic.slice(topic.lastIndexOf("/") + 1);
    this.histories.take(spaceOf(topic), kind, time, decode(schema, bytes));
  }
}
