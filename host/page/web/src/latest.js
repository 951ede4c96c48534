// The newest message of each topic, undecoded. There is no queue: a message that comes before the last one of its topic
// was taken replaces it, so that nothing can pile up however slowly the page draws.

export class Latest {
  constructor() {
    this.waiting = new Map();
  }

  get isEmpty() {
    return this.waiting.size === 0;
  }

  put(topic, schema, bytes, logTime) {
    this.waiting.set(topic, { topic, schema, bytes, logTime });
  }

  /** Takes what has come since the last time, of the topics for which `isTaken` says so; others keep waiting. */
  take(isTaken = () => true) {
    const taken = [...this.waiting.values()].filter(({ topic }) => isTaken(topic));
    for (const { topic } of taken) this.waiting.delete(topic);
    return taken;
  }

  clear() {
    this.waiting.clear();
  }
}
