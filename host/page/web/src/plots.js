// Plots against time of the last minute. They are drawn some times a second, and only while they are seen.

import uPlot from "uplot";

import { byId, element, setText } from "./element.js";
import { History, SPAN_S } from "./history.js";
import { number } from "./words.js";

const REDRAW_MS = 100;
const HEIGHT = 118;

const QUANTITIES = [
  { name: "force", title: "Total force, N", least: 1 },
  { name: "strength", title: "Total strength", least: 0.1 },
  { name: "count", title: "Contacts", least: 2, isCount: true },
  { name: "rate", title: "Frames a second", least: 10 },
  { name: "noise", title: "Signal to noise, dB", least: 20 },
  { name: "lost", title: "Frames lost a second", least: 1 },
];

export class Plots {
  constructor(session) {
    this.session = session;
    this.history = new History();
    this.now = 0;
    this.isSeen = false;
    this.drawn = 0;
    this.plots = QUANTITIES.map((quantity) => this.makePlot(quantity));
    session.listen((changes) => this.update(changes));
    new ResizeObserver(() => this.resize()).observe(byId("plots"));
  }

  makePlot({ title, least, isCount }) {
    const now = element("output");
    const box = element("figure", { className: "plot" }, element("h3", {}, title, now));
    byId("plots").append(box);
    const plot = new uPlot(
      {
        width: 300,
        height: HEIGHT,
        legend: { show: false },
        cursor: { y: false, drag: { x: false, y: false } },
        scales: { x: { time: false, range: () => [-SPAN_S, 0] }, y: { range: (_, low, high) => rangeOf(low, high, least) } },
        axes: [axis({ values: (_, ticks) => ticks.map((tick) => `${tick} s`), size: 26 }), axis({ size: 44, space: 28, ...wholeSteps(isCount) })],
        series: [{}, { stroke: () => colour("--accent"), width: 1.5, points: { show: false }, spanGaps: false }],
      },
      [[], []],
      box,
    );
    return { plot, box, now };
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
    if (changes.has("contacts") && this.session.shown.contacts) this.addContacts(this.session.shown.contacts);
    if (changes.has("status") && this.session.shown.status) this.history.addStatus(this.timeOf("status"), this.session.shown.status);
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
    this.history.clear();
    this.now = 0;
  }

  timeOf(topic) {
    const time = Number(this.session.times[topic]) / 1e9;
    this.now = Math.abs(time - this.now) > SPAN_S ? time : Math.max(this.now, time);
    return time;
  }

  addContacts({ contacts }) {
    const isCalibrated = this.session.shown.skin?.is_calibrated ?? contacts.some(({ force }) => Number.isFinite(force));
    this.plots[0].box.hidden = !isCalibrated;
    this.plots[1].box.hidden = isCalibrated;
    this.history.addContacts(this.timeOf("contacts"), contacts);
  }

  draw() {
    this.drawn = performance.now();
    const { player, recorded } = this.session;
    const now = player ? Number(player.position) / 1e9 : this.now;
    QUANTITIES.forEach(({ name, isCount }, i) => {
      const { times, values } = player ? recorded.history.before(name, now) : this.history.of(name);
      const { plot, box, now: latest } = this.plots[i];
      if (box.hidden) return;
      plot.setData([times.map((time) => time - now), values]);
      const value = values.at(-1) ?? NaN;
      setText(latest, isCount && Number.isFinite(value) ? String(value) : number(value));
    });
  }
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
