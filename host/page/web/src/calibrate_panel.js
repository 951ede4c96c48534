// The guided calibration: readings of a known pressure against the strength of the strongest contact, and the fit.

import { byId, eachChild, element, setText } from "./element.js";
import { number, strengthText, withUnit } from "./words.js";

const READING_MS = 500;
const LEAST_FRAMES = 3;
const LEAST_READINGS = 3;
const LARGEST_KPA = 10000;

export function calibratePanel(session) {
  const readings = [];
  const show = () => showReadings(session, readings, remove);
  const remove = (index) => {
    readings.splice(index, 1);
    show();
  };
  byId("reading-form").addEventListener("submit", (event) => {
    event.preventDefault();
    takeReading(session).then(
      (reading) => {
        readings.push(reading);
        setText(byId("said-reading"), "");
        show();
      },
      (error) => setText(byId("said-reading"), error.message),
    );
  });
  byId("calibrate").addEventListener("click", () => calibrate(session, readings));
  session.listen((changes) => {
    if (changes.has("contacts") || changes.has("new")) showStrongest(session.shown.contacts);
    if (changes.has("skin") || changes.has("new")) showCalibrated(session.shown.skin);
    if (changes.has("program") || changes.has("player")) show();
  });
  show();
}

async function takeReading(session) {
  const pressure = byId("pressure").value.trim() === "" ? NaN : Number(byId("pressure").value);
  if (!(pressure > 0 && pressure <= LARGEST_KPA)) {
    throw new Error(`Type the pressure first: a number above 0, up to ${LARGEST_KPA} kPa.`);
  }
  if (session.player) throw new Error("A recording is shown. Close it to take readings of the skin.");
  const button = byId("take-reading");
  button.disabled = true;
  setText(byId("said-reading"), "Reading. Keep the pressure steady.");
  const strengths = await strengthsFor(session, READING_MS).finally(() => (button.disabled = false));
  return { pressure, ...meanAndSpread(strengths) };
}

// The strongest contact's strength in each frame that is shown in the time.
function strengthsFor(session, duration) {
  const strengths = [];
  const end = session.listen((changes) => {
    const strongest = session.shown.contacts?.contacts[0];
    if (changes.has("contacts") && strongest) strengths.push(strongest.strength);
  });
  return new Promise((resolve) => setTimeout(resolve, duration, strengths)).finally(end);
}

/** Mean and standard deviation of at least a few strengths. */
export function meanAndSpread(strengths) {
  const known = strengths.filter(Number.isFinite);
  if (known.length < LEAST_FRAMES) {
    throw new Error("No contact was seen in that half second. Press on the skin, hold it, and take the reading again.");
  }
  const mean = known.reduce((sum, strength) => sum + strength, 0) / known.length;
  const variance = known.reduce((sum, strength) => sum + (strength - mean) ** 2, 0) / (known.length - 1);
  return { strength: mean, spread: Math.sqrt(variance) };
}

async function calibrate(session, readings) {
  const said = byId("said-calibrate");
  const button = byId("calibrate");
  button.disabled = true;
  setText(said, "Fitting.");
  said.dataset.kind = "progress";
  try {
    const request = { readings: readings.map(({ pressure, strength }) => ({ pressure_kpa: pressure, strength })) };
    const { text = "Calibrated.", file } = await session.call("/dermatome/calibrate", request);
    said.dataset.kind = "good";
    setText(said, file ? `${text} Written to ${file}.` : text);
  } catch (error) {
    said.dataset.kind = "error";
    setText(said, error.message);
  }
  button.disabled = !mayCalibrate(session, readings);
}

function mayCalibrate(session, readings) {
  return pressuresOf(readings) >= LEAST_READINGS && session.offers("/dermatome/calibrate");
}

function pressuresOf(readings) {
  return new Set(readings.map(({ pressure }) => pressure)).size;
}

function showReadings(session, readings, remove) {
  eachChild(byId("readings"), readings, makeRow, (row, { pressure, strength, spread }, index) => {
    const texts = [withUnit(pressure, "kPa", 4), strengthText(strength), `± ${number(spread, 2)}`];
    texts.forEach((text, i) => setText(row.children[i], text));
    const button = row.lastChild.firstChild;
    button.setAttribute("aria-label", `Remove the reading at ${pressure} kPa`);
    button.onclick = () => remove(index);
  });
  byId("calibrate").disabled = !mayCalibrate(session, readings);
  setText(byId("calibrate-hint"), hintOf(session, readings));
}

function makeRow() {
  const button = element("button", { type: "button", className: "small" }, "Remove");
  return element("tr", {}, element("td"), element("td"), element("td"), element("td", {}, button));
}

function hintOf(session, readings) {
  const missing = LEAST_READINGS - pressuresOf(readings);
  if (missing > 0) return `${missing} more, each at another pressure.`;
  return session.offers("/dermatome/calibrate") ? "" : "The program does not offer to calibrate now.";
}

function showStrongest(contacts) {
  const strongest = contacts?.contacts[0];
  setText(byId("strongest"), strongest ? `Strongest contact now: ${strengthText(strongest.strength)}` : "No contact now.");
}

function showCalibrated(skin) {
  const text = skin?.is_calibrated ? "The patch in use is calibrated: contacts have kPa and N." : "The patch in use is not calibrated: contacts have a strength, but no kPa.";
  setText(byId("calibrated"), skin ? text : "No skin is known yet.");
}
