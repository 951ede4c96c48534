// Plays a recording: a position that moves with the clock while it plays, and the messages at that position, which go the
// same way as those of a live skin. A seek during a seek replaces it; none pile up.

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const TICK_MS = 16;

export class Player {
  /**
   * `on.message(topic, schema, bytes, logTime)`, with the topic alone where the position is before its first message;
   * `on.change()` of position, speed or play, `on.error(error)`.
   */
  constructor(recording, on) {
    this.recording = recording;
    this.on = on;
    this.position = recording.start;
    this.speed = 1;
    this.isPlaying = false;
    this.shown = new Map();
    this.wanted = undefined;
    this.isSeeking = false;
    this.showFirst();
  }

  // A skin of a robot may come later than others: what is there first is what is looked for.
  async showFirst() {
    await this.seek(this.recording.start);
    const isUntouched = this.position === this.recording.start && !this.isPlaying && !this.isClosed;
    const first = isUntouched && (await this.recording.neighbour(this.recording.start - 1n, true).catch(() => undefined));
    if (first && this.position === this.recording.start) await this.seek(first);
  }

  /** Seconds since the start. */
  get seconds() {
    return Number(this.position - this.recording.start) / 1e9;
  }

  get isAtEnd() {
    return this.position >= this.recording.end;
  }

  setSpeed(speed) {
    this.speed = speed;
    this.on.change();
  }

  play() {
    if (this.isPlaying) return;
    if (this.isAtEnd) this.seek(this.recording.start);
    this.isPlaying = true;
    this.ticked = performance.now();
    this.timer = setInterval(() => this.tick(), TICK_MS);
    this.on.change();
  }

  pause() {
    clearInterval(this.timer);
    this.isPlaying = false;
    this.on.change();
  }

  toggle() {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  close() {
    clearInterval(this.timer);
    this.isPlaying = false;
    this.isClosed = true;
  }

  seekSeconds(seconds) {
    return this.seek(this.recording.start + BigInt(Math.round(seconds * 1e9)));
  }

  /** To the next or the previous frame. */
  async step(isForward) {
    this.pause();
    const time = await this.recording.neighbour(this.position, isForward);
    if (time !== undefined) await this.seek(time);
  }

  tick() {
    const now = performance.now();
    const passed = BigInt(Math.round((now - this.ticked) * 1e6 * this.speed));
    this.ticked = now;
    // Where the file is read more slowly than it is played, the position waits for it.
    if (this.isSeeking) return;
    this.seek(this.position + passed).catch(() => this.pause());
    if (this.isAtEnd) this.pause();
  }

  async seek(time) {
    const { start, end } = this.recording;
    this.position = time < start ? start : time > end ? end : time;
    this.wanted = this.position;
    this.on.change();
    if (this.isSeeking) return;
    this.isSeeking = true;
    try {
      while (this.wanted !== undefined && !this.isClosed) await this.showWanted();
    } catch (error) {
      this.pause();
      this.on.error(error);
    } finally {
      this.isSeeking = false;
    }
  }

  async showWanted() {
    const time = this.wanted;
    this.wanted = undefined;
    const messages = await this.recording.at(time);
    if (this.isClosed) return;
    this.forgetOthers(new Set(messages.map(({ topic }) => topic)));
    for (const message of messages) {
      if (this.shown.get(message.topic) === message) continue;
      this.shown.set(message.topic, message);
      this.on.message(message.topic, message.schema, message.bytes, message.logTime);
    }
  }

  // What comes only after the position is not shown there.
  forgetOthers(topics) {
    for (const topic of [...this.shown.keys()].filter((topic) => !topics.has(topic))) {
      this.shown.delete(topic);
      this.on.message(topic);
    }
  }
}
