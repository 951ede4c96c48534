// What the time plots show: for each quantity, its values of the last minute, or of a whole recording. In each bin of
// time only the extreme value is kept, so that a short press is seen although there may be 400 frames a second.

export const SPAN_S = 60;
const BIN_S = 0.05;
const OF_CONTACTS = ["force", "strength", "count"];

/** The history of each skin of which something has come, by its space. */
export class Histories {
  constructor(span) {
    this.span = span;
    this.bySpace = new Map();
  }

  /** In the order of their names, whichever was heard first. */
  get spaces() {
    return [...this.bySpace.keys()].sort();
  }

  get all() {
    return this.spaces.map((space) => this.bySpace.get(space));
  }

  /** Takes a message of a skin, as `History` does. */
  take(space, kind, time, message) {
    if (!this.bySpace.has(space)) this.bySpace.set(space, new History(this.span));
    this.bySpace.get(space).take(kind, time, message);
  }
}

export class History {
  constructor(span = SPAN_S) {
    this.span = span;
    this.clear();
  }

  clear() {
    this.series = new Map();
    this.lostBefore = undefined;
  }

  /** `{ times, values }`: times in s, values null where they are not known. */
  of(name) {
    if (!this.series.has(name)) this.series.set(name, { times: [], values: [] });
    return this.series.get(name);
  }

  /** Takes a message of `kind` contacts or status that came at `time`, s. */
  take(kind, time, message) {
    if (kind === "contacts") this.addContacts(time, message.contacts);
    else this.addStatus(time, message);
  }

  addContacts(time, contacts) {
    this.add("force", time, totalForce(contacts));
    this.add("strength", time, totalStrength(contacts));
    this.add("count", time, contacts.length);
  }

  addStatus(time, status) {
    const lost = Number(status.frames_lost);
    this.add("rate", time, status.frames_per_second);
    this.add("noise", time, status.signal_to_noise);
    this.add("lost", time, this.lostRate(time, lost));
    this.lostBefore = { time, lost };
    // Until contacts come again.
    if (status.state !== "live") for (const name of OF_CONTACTS) this.end(name, time);
  }

  /** No value is known from `time` on, until another comes. */
  end(name, time) {
    const points = this.of(name);
    const last = points.times.length - 1;
    if (last >= 0 && points.values[last] !== null) this.begin(points, Math.max(time, points.times[last] + BIN_S), NaN);
  }

  lostRate(time, lost) {
    const before = this.lostBefore;
    if (!before || time <= before.time || lost < before.lost) return 0;
    return (lost - before.lost) / (time - before.time);
  }

  /** Adds `value` at `time` (s). Going back in time begins anew. */
  add(name, time, value) {
    const points = this.of(name);
    const last = points.times.length - 1;
    if (last >= 0 && time < points.times[last] - BIN_S) points.times.length = points.values.length = 0;
    else if (last >= 0 && time - points.times[last] < BIN_S) return merge(points, last, value);
    this.begin(points, time, value);
  }

  /** A new bin from `time` on. */
  begin(points, time, value) {
    points.times.push(time);
    points.values.push(Number.isFinite(value) ? value : null);
    forgetBefore(points, time - this.span);
  }

  /** The part of a series within the span that ends at `time`. */
  before(name, time) {
    const { times, values } = this.of(name);
    const [first, end] = [firstAfter(times, time - SPAN_S), firstAfter(times, time)];
    return { times: times.slice(first, end), values: values.slice(first, end) };
  }
}

/** Series as one table of the span before `now`, s, for uPlot: times, and the values of each where it has one. */
export function onGrid(series, now) {
  const [first, last] = [Math.floor((now - SPAN_S) / BIN_S), Math.floor(now / BIN_S)];
  const times = Array.from({ length: last - first + 1 }, (_, i) => (first + i) * BIN_S - now);
  const columns = series.map(({ times: of, values }) => {
    const column = Array(times.length);
    // Bins begin at least their length apart, so that no two have one place.
    of.forEach((time, i) => {
      const place = Math.floor(time / BIN_S) - first;
      if (place >= 0 && place < column.length) column[place] = values[i];
    });
    return column;
  });
  return [times, ...columns];
}

export function totalForce(contacts) {
  return contacts.reduce((sum, { force }) => sum + force, 0);
}

export function totalStrength(contacts) {
  return contacts.reduce((sum, { strength }) => sum + strength, 0);
}

function merge({ values }, last, value) {
  const held = values[last];
  if (Number.isFinite(value) && (held === null || Math.abs(value) > Math.abs(held))) values[last] = value;
}

function forgetBefore({ times, values }, time) {
  const count = times.findIndex((other) => other >= time);
  if (count <= 0) return;
  times.splice(0, count);
  values.splice(0, count);
}

function firstAfter(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] > time) high = middle;
    else low = middle + 1;
  }
  return low;
}
