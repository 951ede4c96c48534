// The samples of one slot of the scan against time. The board is asked for them only while the panel is open.

import uPlot from "uplot";

import { byId, element, setText } from "./element.js";
import { axis, colour } from "./plots.js";
import { number } from "./words.js";

const HEIGHT = 280;
const LARGEST_CODE = 4095;

export class ScopeView {
  constructor(session) {
    this.session = session;
    this.isSeen = false;
    this.slot = null;
    this.plot = this.makePlot();
    byId("slot").addEventListener("change", () => this.watch());
    session.listen((changes) => this.update(changes));
    new ResizeObserver(() => this.resize()).observe(byId("scope-plot"));
  }

  makePlot() {
    return new uPlot(
      {
        width: 300,
        height: HEIGHT,
        legend: { show: false },
        cursor: { drag: { x: true, y: false } },
        scales: { x: { time: false }, y: { range: [0, LARGEST_CODE + 1] } },
        axes: [axis({ label: "ms", labelSize: 18, size: 30 }), axis({ size: 48 })],
        series: [{}, { stroke: () => colour("--accent"), width: 1.25, points: { show: false } }],
        hooks: { drawClear: [(plot) => this.shadeSettling(plot)] },
      },
      [[], []],
      byId("scope-plot"),
    );
  }

  /** Asks for samples while the panel is seen. */
  setSeen(isSeen) {
    if (isSeen === this.isSeen) return;
    this.isSeen = isSeen;
    this.session.wantScope(isSeen);
    if (isSeen) this.resize();
    if (isSeen) this.draw();
    this.watch();
  }

  watch() {
    const slot = this.isSeen && byId("slot").value !== "" ? Number(byId("slot").value) : null;
    if (slot === this.slot || !this.session.offers("/dermatome/scope")) return;
    this.slot = slot;
    this.session.call("/dermatome/scope", { slot }).then(
      () => setText(byId("said-scope"), ""),
      (error) => {
        this.slot = null;
        setText(byId("said-scope"), error.message);
      },
    );
  }

  update(changes) {
    if (changes.has("new")) this.slot = null;
    if (changes.has("skin")) this.listSlots();
    if (changes.has("skin") || changes.has("program")) this.watch();
    if (changes.has("look")) this.plot.redraw(false, true);
    if (changes.has("scope") && this.isSeen) this.draw();
  }

  listSlots() {
    const { skin } = this.session.shown;
    if (!skin) return;
    const chosen = byId("slot").value || "0";
    const steps = Array.from({ length: skin.steps.length / 4 }, (_, slot) => stepText(skin.steps, slot));
    const tests = Array.from({ length: skin.electrodes.length / 3 }, (_, i) => `test of electrode ${i + 1}`);
    const options = [...steps, ...tests].map((text, slot) => element("option", { value: slot }, `${slot}: ${text}`));
    byId("slot").replaceChildren(...options);
    byId("slot").value = Number(chosen) < options.length ? chosen : "0";
  }

  resize() {
    const width = byId("scope-plot").clientWidth;
    if (width > 0) this.plot.setSize({ width, height: HEIGHT });
  }

  draw() {
    const { scope } = this.session.shown;
    if (!scope) return this.plot.setData([[], []]);
    const toMilliseconds = 1000 / scope.sample_rate;
    const times = Array.from(scope.samples, (_, i) => i * toMilliseconds);
    this.plot.setData([times, scope.samples]);
    setText(byId("scope-text"), describe(scope));
  }

  shadeSettling(plot) {
    const { scope } = this.session.shown;
    if (!scope?.settling) return;
    const end = plot.valToPos((scope.settling * 1000) / scope.sample_rate, "x", true);
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.fillStyle = colour("--shade");
    ctx.fillRect(bbox.left, bbox.top, Math.max(0, end - bbox.left), bbox.height);
    ctx.restore();
  }
}

function stepText(steps, slot) {
  const [drivePlus, driveMinus, sensePlus, senseMinus] = steps.subarray(4 * slot, 4 * slot + 4).map((index) => index + 1);
  return `current ${drivePlus} to ${driveMinus}, voltage ${sensePlus} to ${senseMinus}`;
}

function describe({ slot, gain, settling, period, sample_rate: rate, samples }) {
  const [low, high] = [Math.min(...samples), Math.max(...samples)];
  const clipped = low === 0 || high === LARGEST_CODE ? " It reaches the converter's limit: lower the gain or the amplitude." : "";
  return `Slot ${slot}, gain ${gain}: codes ${low} to ${high} of 0 to ${LARGEST_CODE}. ${number(rate / period / 1000)} kHz carrier, ${number(rate / 1e6)} MS/s, ${period} samples a period. The first ${settling} samples (shaded) are left out while the voltage settles.${clipped}`;
}
