// Which value has the last colour of the map. Automatic: the greatest of the image, at once upwards and slowly
// downwards, and never so little that noise fills the scale. Fixed: what a person set.

const FALL_S = 2;
// A contact at the threshold reaches half of the scale.
const LEAST_THRESHOLDS = 2;
const LEAST = 1e-3;

export class Scale {
  constructor() {
    this.isAutomatic = true;
    this.fixed = 0.2;
    this.held = 0;
    this.threshold = NaN;
    this.time = undefined;
  }

  get maximum() {
    return this.isAutomatic ? Math.max(this.held, this.least) : this.fixed;
  }

  get least() {
    return this.threshold > 0 ? this.threshold * LEAST_THRESHOLDS : LEAST;
  }

  /** Follows an image, `values` at `time` (s). */
  follow(values, time) {
    const passed = this.time === undefined ? Infinity : Math.abs(time - this.time);
    this.held *= Math.exp(-passed / FALL_S);
    this.time = time;
    for (const value of values) if (Math.abs(value) > this.held) this.held = Math.abs(value);
  }

  setAutomatic(isAutomatic) {
    if (!isAutomatic) this.fixed = roundTo2(this.maximum);
    this.isAutomatic = isAutomatic;
  }

  setFixed(maximum) {
    this.isAutomatic = false;
    this.fixed = maximum;
  }

  /** To the next of 1, 2, 5, 10, ... upwards or downwards. */
  step(isUp) {
    this.setFixed(nextStep(this.maximum, isUp));
  }
}

function roundTo2(value) {
  return Number(value.toPrecision(2));
}

/** The next number of the series 1, 2, 5, 10, ... beside a positive `value`. */
export function nextStep(value, isUp) {
  const decade = 10 ** Math.floor(Math.log10(value));
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20].map((step) => Number((step * decade).toPrecision(2)));
  const near = value * 1e-6;
  return isUp ? steps.find((step) => step > value + near) : steps.findLast((step) => step < value - near);
}
