// Plots against time of the last minute, a line for each skin. They are drawn some times a second, and only while they are
// seen.

import uPlot from "uplot";

import { byId, eachChild, element, setText } from "./element.js";
import { Histories, SPAN_S, onGrid } from "./history.js";
import { SINGLE_SPACE, nameOf } from "./spaces.js";
import { number } from "./words.js";

const REDRAW_MS = 100;
const HEIGHT = 118;

// What is written of several skins: the sum of all, or the least.
const sum = (values) => values.reduce((a, b) => a + b, 0);
const least = (values) => Math.min(...values);
const QUANTITIES = [
  { name: "force", title: "Total force, N", least: 1, ofAll: sum },
  { name: "strength", title: "Total strength", least: 0.1, ofAll: sum },
  { name: "count", title: "Contacts", least: 2, isCount: true, ofAll: sum },
  { name: "rate", title: "Frames a second", least: 10, ofAll: least },
  { name: "noise", title: "Signal to noise, dB", least: 20, ofAll: least },
  { name: "lost", title: "Frames lost a second", least: 1, ofAll: sum },
];
// Colours of lines; beyond, the same dashed.
const COLOURS = 6;
const DASHES = [[], [6, 3], [2, 3]];

export class Plots {
  constructor(session) {
    this.session = session;
    this.isSeen = false;
    this.drawn = 0;
    this.restart();
    /** Spaces of the skins, each of which has a line. */
    this.spaces = [];
    this.plots = QUANTITIES.map((quantity) => makePlot(quantity));
    session.listen((changes) => this.update(changes));
    new ResizeObserver(() => this.resize()).observe(byId("plots"));
  }

  setSeen(isSeen) {
    this.isSeen = isSeen;
    if (isSeen) this.resize();
  }

  resize() {
    const width = byId("plots").clientWidth;
    if (!this.isSeen || width === 0) return;
    for (const { plot } of this.plots) plot.setSize({ width, height: HEIGHT });
    this.draw();
  }

  update(changes) {
    if (changes.has("new")) this.restart();
    this.take();
    if (changes.has("look")) this.plots.forEach(({ plot }) => plot.redraw(false, true));
    if (this.isSeen && performance.now() - this.drawn > REDRAW_MS) this.draw();
    else if (this.isSeen && this.session.player) this.drawLater();
  }

  // While a recording stands still nothing else comes that would draw its last position.
  drawLater() {
    clearTimeout(this.later);
    this.later = setTimeout(() => this.session.player && this.draw(), REDRAW_MS);
  }

  restart() {
    this.histories = new Histories();
    this.taken = new Set();
    this.now = 0;
  }

  /** Takes what is new of each skin. */
  take() {
    if (this.session.player) return;
    const before = this.taken;
    this.taken = new Set();
    for (const { space, shown, times } of this.session.skins) {
      for (const kind of ["contacts", "status"].filter((kind) => shown[kind])) {
        this.taken.add(shown[kind]);
        if (!before.has(shown[kind])) this.histories.take(space, kind, this.timeOf(times[kind]), shown[kind]);
      }
    }
  }

  timeOf(logTime) {
    const time = Number(logTime) / 1e9;
    this.now = Math.abs(time - this.now) > SPAN_S ? time : Math.max(this.now, time);
    return time;
  }

  draw() {
    this.drawn = performance.now();
    const { player, recorded } = this.session;
    const now = player ? Number(player.position) / 1e9 : this.now;
    const histories = player ? recorded.histories : this.histories;
    this.showLines(histories.spaces);
    this.showUseful();
    QUANTITIES.forEach(({ name, isCount, ofAll }, i) => {
      const { plot, box, output } = this.plots[i];
      if (box.hidden) return;
      const series = histories.all.map((history) => (player ? history.before(name, now) : history.of(name)));
      plot.setData(onGrid(series, now));
      const latest = series.map(({ values }) => values.at(-1)).filter(Number.isFinite);
      const value = latest.length > 0 ? ofAll(latest) : NaN;
      setText(output, isCount && Number.isFinite(value) ? String(value) : number(value));
    });
  }

  // Force tells how strongly skins are pressed where they are calibrated, strength where not. Of all skins of a robot at once
  // nobody measures the noise.
  showUseful() {
    const calibrated = this.session.skins.map(({ shown: { skin, contacts } }) => {
      return skin?.is_calibrated ?? contacts?.contacts.some(({ force }) => Number.isFinite(force)) ?? false;
    });
    const useless = {
      force: !calibrated.some(Boolean),
      strength: calibrated.length > 0 && calibrated.every(Boolean),
      noise: this.session.isWhole,
    };
    QUANTITIES.forEach(({ name }, i) => (this.plots[i].box.hidden = useless[name] ?? false));
  }

  showLines(spaces) {
    if (spaces.join("\n") === this.spaces.join("\n")) return;
    for (const { plot } of this.plots) {
      this.spaces.forEach(() => plot.delSeries(1));
      spaces.forEach((_, line) => plot.addSeries(lineOf(line), line + 1));
      // Also of one that is hidden, which has no others yet.
      plot.setData([[], ...spaces.map(() => [])]);
    }
    this.spaces = spaces;
    const isOne = spaces.every((space) => space === SINGLE_SPACE);
    eachChild(byId("plot-skins"), isOne ? [] : spaces, makeEntry, updateEntry);
  }
}

function makePlot({ title, least, isCount }) {
  const output = element("output");
  const box = element("figure", { className: "plot" }, element("h3", {}, title, output));
  byId("plots").append(box);
  const plot = new uPlot(
    {
      width: 300,
      height: HEIGHT,
      legend: { show: false },
      cursor: { y: false, drag: { x: false, y: false } },
      scales: { x: { time: false, range: () => [-SPAN_S, 0] }, y: { range: (_, low, high) => rangeOf(low, high, least) } },
      axes: [axis({ values: (_, ticks) => ticks.map((tick) => `${tick} s`), size: 26 }), axis({ size: 44, space: 28, ...wholeSteps(isCount) })],
      series: [{}],
    },
    [[]],
    box,
  );
  return { plot, box, output };
}

const dashOf = (line) => DASHES[Math.floor(line / COLOURS) % DASHES.length];
const nameOfColour = (line) => `--line-${line % COLOURS}`;

function lineOf(line) {
  return { stroke: () => colour(nameOfColour(line)), dash: dashOf(line), width: 1.5, points: { show: false }, spanGaps: false };
}

function makeEntry() {
  return element("li");
}

function updateEntry(entry, space, line) {
  setText(entry, nameOf(space));
  entry.style.borderColor = `var(${nameOfColour(line)})`;
  entry.style.borderLeftStyle = ["solid", "dashed", "dotted"][DASHES.indexOf(dashOf(line))];
}

// From zero where all is above it, and never so narrow that noise fills the plot.
function rangeOf(low, high, least) {
  if (low === null || high === null) return [0, least];
  return [Math.min(0, low), Math.max(least, high * 1.1)];
}

function wholeSteps(isCount) {
  return isCount ? { incrs: [1, 2, 5, 10, 20, 50] } : {};
}

/** An axis in the page's colours. */
export function axis(options) {
  const grid = { stroke: () => colour("--line"), width: 1 };
  return { stroke: () => colour("--muted"), grid, ticks: { ...grid, size: 4 }, font: "11px system-ui, sans-serif", ...options };
}

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
