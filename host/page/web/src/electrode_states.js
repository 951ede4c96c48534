// What Health says about each electrode.

import { css, colourAt } from "./colour.js";
import { number, ohm } from "./words.js";

const MAP = "cividis";
const LEAST_DECADES = 1;
// Colours change in steps, so that noise does not make the dots anew with each frame.
const STEPS = 24;

/** How each state is drawn and called: worst first. */
export const STATES = {
  open: { word: "no contact", shape: "square", sign: "×" },
  shorted: { word: "connected to a neighbour", shape: "diamond", sign: "=" },
  worse: { word: "touches worse than in the tare", shape: "triangle", sign: "!" },
  sound: { word: "sound", shape: "circle", sign: "" },
  unknown: { word: "not tested", shape: "circle", sign: "" },
};

/** `[{ number, impedance, state, colour }]` of `count` electrodes; numbers count from 1. */
export function electrodeStates(count, health) {
  const range = impedanceRange(health?.contact_impedance ?? []);
  return Array.from({ length: count }, (_, index) => {
    const impedance = health?.contact_impedance[index] ?? NaN;
    return { number: index + 1, impedance, state: stateOf(index, health), colour: colourOf(impedance, range) };
  });
}

function stateOf(index, health) {
  const bit = (bits) => (bits >> index) & 1;
  if (!health) return "unknown";
  if (bit(health.open)) return "open";
  if (bit(health.shorted)) return "shorted";
  if (bit(health.worse)) return "worse";
  return health.contact_impedance.length > 0 ? "sound" : "unknown";
}

/** The decades that the colours span, as logarithms; at least one decade, so that like electrodes look alike. */
export function impedanceRange(impedances) {
  const logs = [...impedances].filter((ohms) => Number.isFinite(ohms) && ohms > 0).map(Math.log10);
  if (logs.length === 0) return undefined;
  const [low, high] = [Math.min(...logs), Math.max(...logs)];
  const missing = Math.max(0, LEAST_DECADES - (high - low)) / 2;
  return [low - missing, high + missing];
}

function colourOf(impedance, range) {
  if (!range || !(impedance > 0)) return undefined;
  if (!Number.isFinite(impedance)) return css(colourAt(MAP, 1));
  const share = (Math.log10(impedance) - range[0]) / (range[1] - range[0]);
  return css(colourAt(MAP, Math.round(share * STEPS) / STEPS));
}

/** What the colours mean, in words. */
export function legendOf(health) {
  const range = impedanceRange(health?.contact_impedance ?? []);
  if (!range) return "Contact impedances are not measured.";
  return `Dots on the skin: dark ${ohm(10 ** range[0])}, light ${ohm(10 ** range[1])}. Square ×: no contact. Diamond =: connected to a neighbour. Triangle !: worse than in the tare.`;
}

/** What a health report says about the board, as pairs of name and value. */
export function boardFacts(health) {
  return [
    ["Temperature", Number.isFinite(health.temperature) ? `${number(health.temperature)} °C` : "not measured"],
    ["CPU load", `${Math.round(health.load * 100)} %`],
    ["Free stack", `${health.free_stack} bytes`],
    ["Drift taken out", `${number(health.drift * 100, 2)} %`],
    ["Reciprocity error", Number.isFinite(health.reciprocity_error) ? `${number(health.reciprocity_error * 100, 2)} %` : "not measured"],
    ["Samples missed", `${health.missed} times`],
  ];
}
