// What the time plots show: for each quantity, its values of the last minute. In each bin of time only the extreme value
// is kept, so that a short press is seen although there may be 400 frames a second.

export const SPAN_S = 60;
const BIN_S = 0.05;

export class History {
  constructor() {
    this.series = new Map();
  }

  /** Adds `value` at `time` (s). Going back in time, as in a recording, begins anew. */
  add(name, time, value) {
    const points = this.of(name);
    const last = points.times.length - 1;
    if (last >= 0 && time < points.times[last] - BIN_S) this.clear(name);
    else if (last >= 0 && time - points.starts < BIN_S) return this.merge(points, last, value);
    points.starts = time;
    points.times.push(time);
    points.values.push(Number.isFinite(value) ? value : null);
    this.forgetBefore(points, time - SPAN_S);
  }

  /** `{ times, values }`, values null where they are not known. */
  of(name) {
    if (!this.series.has(name)) this.series.set(name, { times: [], values: [], starts: 0 });
    return this.series.get(name);
  }

  clear(name) {
    const names = name === undefined ? [...this.series.keys()] : [name];
    for (const each of names) Object.assign(this.of(each), { starts: 0 }).times.length = this.of(each).values.length = 0;
  }

  merge(points, last, value) {
    const held = points.values[last];
    if (Number.isFinite(value) && (held === null || Math.abs(value) > Math.abs(held))) points.values[last] = value;
  }

  forgetBefore({ times, values }, time) {
    let count = 0;
    while (times[count] < time) count++;
    if (count === 0) return;
    times.splice(0, count);
    values.splice(0, count);
  }
}
