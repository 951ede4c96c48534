// Numbers and states as people read them.

const DASH = "–";

/** `value` with three digits, or a dash where it is not known. */
export function number(value, digits = 3) {
  if (!Number.isFinite(value)) return DASH;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 10 ** digits) return Math.round(value).toString();
  if (size < 1e-4) return value.toExponential(1);
  return value.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size))));
}

/** `12.3 kPa` */
export function withUnit(value, unit, digits = 3) {
  return Number.isFinite(value) ? `${number(value, digits)} ${unit}` : DASH;
}

/** Ohm with its prefix; infinite where the test was clipped. */
export function ohm(value) {
  if (value === Infinity) return "above range";
  if (!Number.isFinite(value)) return DASH;
  if (value >= 1e6) return `${number(value / 1e6)} MΩ`;
  return value >= 1e3 ? `${number(value / 1e3)} kΩ` : `${number(value)} Ω`;
}

export function bytes(count) {
  const value = Number(count);
  if (value < 1e3) return `${value} B`;
  const [size, unit] = value < 1e6 ? [1e3, "kB"] : value < 1e9 ? [1e6, "MB"] : [1e9, "GB"];
  return `${(value / size).toFixed(1)} ${unit}`;
}

/** Seconds as `m:ss.mmm`, with hours where there are any. */
export function clock(seconds) {
  const milliseconds = Math.max(0, Math.round(seconds * 1000));
  const pad = (value, length) => String(value).padStart(length, "0");
  const hours = Math.floor(milliseconds / 3600000);
  const minutes = Math.floor(milliseconds / 60000) % 60;
  const rest = `${pad(Math.floor(milliseconds / 1000) % 60, 2)}.${pad(milliseconds % 1000, 3)}`;
  return hours > 0 ? `${hours}:${pad(minutes, 2)}:${rest}` : `${minutes}:${rest}`;
}

/** `#4 12.3 kPa 0.42 N`, or the strength where the skin is not calibrated. */
export function contactLabel(contact) {
  const name = contactName(contact);
  if (Number.isFinite(contact.force)) return `${name} ${withUnit(contact.pressure / 1e3, "kPa")} ${forceText(contact.force)}`;
  return `${name} strength ${strengthText(contact.strength)}`;
}

/** `0.42 N`, or the strength: where there is room for no more. */
export function shortLabel({ force, strength }) {
  return Number.isFinite(force) ? forceText(force) : strengthText(strength);
}

/** A strength, a relative change, always with the same decimals. */
export function strengthText(strength) {
  return Number.isFinite(strength) ? strength.toFixed(3) : DASH;
}

export function contactName(contact) {
  return contact.is_tracked ? `#${contact.id}` : "new";
}

export function forceText(force) {
  return Number.isFinite(force) ? `${force.toFixed(force < 10 ? 2 : 1)} N` : DASH;
}

/** Names of Status.state, and how it is marked. */
export const STATES = {
  no_board: { word: "No board", level: "bad" },
  no_patch: { word: "No patch", level: "bad" },
  not_tared: { word: "Not tared", level: "warn" },
  taring: { word: "Taring", level: "warn" },
  live: { word: "Live", level: "good" },
  lost: { word: "Lost", level: "bad" },
  ended: { word: "Ended", level: "warn" },
};
