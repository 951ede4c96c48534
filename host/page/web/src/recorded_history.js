// The history of a whole recording, of each skin that is looked at, read in the background, in steps between which the
// page draws.

import { History } from "./history.js";
import { decode } from "./messages.js";
import { SINGLE } from "./spaces.js";

const STEP_MS = 12;

export class RecordedHistory {
  /** `onMore` is called when more of it has been read. */
  constructor(recording, onMore) {
    this.recording = recording;
    this.onMore = onMore;
    /** By what their topics begin with. */
    this.histories = new Map();
    this.isClosed = false;
    this.read();
  }

  /** Of the one skin that is looked at; empty where all of a robot is. */
  get history() {
    return this.of(SINGLE);
  }

  /** How strongly each skin was pressed: `{ times, values }`. */
  get strengths() {
    return [...this.histories.values()].map((history) => history.of("strength"));
  }

  of(start) {
    if (!this.histories.has(start)) this.histories.set(start, new History(Infinity));
    return this.histories.get(start);
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
    const message = decode(schema, bytes);
    const history = this.of(topic.slice(0, topic.lastIndexOf("/") + 1));
    if (topic.endsWith("/contacts")) history.addContacts(time, message.contacts);
    else history.addStatus(time, message);
  }
}
