// The panel of settings: drive, least strength, patch; and how the picture looks. What is in effect comes from Status;
// a field that a person is editing is left alone until it is applied.

import { MAPS } from "./colour.js";
import { driveText } from "./contacts_panel.js";
import { byId, element, setText } from "./element.js";
import { number } from "./words.js";

const FREQUENCIES_KHZ = [12.5, 20, 50, 100, 200];
const GAINS = [0, 1, 2, 4, 8, 16, 32, 64];

export function settingsPanel(session, picture) {
  fillSelect(byId("frequency"), FREQUENCIES_KHZ.map((khz) => [khz * 1000, `${khz} kHz`]));
  fillSelect(byId("gain"), GAINS.map((gain) => [gain, gain === 0 ? "automatic" : String(gain)]));
  fillSelect(byId("map"), Object.entries(MAPS).map(([name, { title }]) => [name, title]));
  const drive = driveForm(session);
  const patch = patchForm(session);
  thresholdForm(session);
  const look = lookForms(session, picture);
  session.listen((changes) => {
    if (["status", "program", "player", "new"].some((name) => changes.has(name))) {
      enable(session);
      if (session.shown.status) [drive, patch].forEach((show) => show(session.shown.status));
    }
    if (changes.has("look") || changes.has("image")) look();
  });
  look();
}

function enable(session) {
  const forms = { "drive-form": "drive", "threshold-form": "threshold", "patch-form": "patch" };
  for (const [form, service] of Object.entries(forms)) {
    const isOffered = session.offers(`/dermatome/${service}`);
    for (const control of byId(form).elements) if (control.tagName !== "OUTPUT") control.disabled = !isOffered;
  }
}

// Fields follow the status until they are edited, and again once they are applied.
function driveForm(session) {
  const form = byId("drive-form");
  let isEdited = false;
  form.addEventListener("input", () => (isEdited = true));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const amplitude = readPositive(byId("amplitude"), session.shown.status?.largest_amplitude * 1e3);
    if (amplitude.error) return setText(byId("said-drive"), amplitude.error);
    const request = { frequency_hz: Number(byId("frequency").value), amplitude_ma: amplitude.value, gain: Number(byId("gain").value) };
    apply(session, "drive", request).then((isApplied) => isApplied && (isEdited = false));
  });
  return (status) => {
    setText(byId("drive-now"), `In effect: ${driveText(status)}.`);
    byId("amplitude").max = String(round(status.largest_amplitude * 1e3));
    if (isEdited || form.contains(document.activeElement)) return;
    select(byId("frequency"), Math.round(status.frequency), `${number(status.frequency / 1e3)} kHz`);
    byId("amplitude").value = round(status.amplitude * 1e3);
    select(byId("gain"), status.gain, String(status.gain));
  };
}

/** The field's value, or what is wrong with it. */
function readPositive(field, largest) {
  const value = field.value.trim() === "" ? NaN : Number(field.value);
  if (!(value > 0)) return { error: "The amplitude is a number above 0, in mA." };
  if (largest > 0 && value > largest * 1.0001) return { error: `The board drives ${round(largest)} mA at most.` };
  return { value };
}

function thresholdForm(session) {
  byId("threshold-form").addEventListener("submit", (event) => {
    event.preventDefault();
    const value = byId("threshold").value.trim() === "" ? NaN : Number(byId("threshold").value);
    if (!(value >= 0)) return setText(byId("said-threshold"), "The strength is a number from 0, such as 0.05.");
    apply(session, "threshold", { value });
  });
  byId("threshold-default").addEventListener("click", () => {
    byId("threshold").value = "";
    apply(session, "threshold", { value: 0 });
  });
  session.listen((changes) => {
    const threshold = session.shown.skin?.contact_threshold;
    if (changes.has("skin") && threshold > 0) byId("threshold").placeholder = String(round(threshold));
  });
}

function patchForm(session) {
  const choice = byId("patch");
  byId("patch-form").addEventListener("submit", (event) => event.preventDefault());
  choice.addEventListener("change", () => apply(session, "patch", { index: Number(choice.value) }));
  let listed = "";
  return (status) => {
    const names = JSON.stringify(status.patches);
    if (names !== listed) fillSelect(choice, status.patches.map((name, index) => [index, name]));
    listed = names;
    if (document.activeElement !== choice) choice.value = String(status.patch);
  };
}

// True where the program has done it; what it says otherwise stands beside the control.
async function apply(session, service, request) {
  const said = byId(`said-${service}`);
  try {
    await session.call(`/dermatome/${service}`, request);
    setText(said, "");
    return true;
  } catch (error) {
    setText(said, error.message);
    return false;
  }
}

function lookForms(session, picture) {
  const { scale } = picture;
  const changed = () => session.changed("look");
  byId("colour-form").addEventListener("submit", (event) => event.preventDefault());
  byId("map").addEventListener("change", () => picture.setMap(byId("map").value));
  byId("scale-automatic").addEventListener("change", (event) => {
    scale.setAutomatic(event.target.checked);
    changed();
  });
  byId("scale-maximum").addEventListener("change", (event) => {
    const value = Number(event.target.value);
    if (value > 0) scale.setFixed(value);
    changed();
  });
  for (const part of ["contacts", "electrodes", "link"]) {
    byId(`show-${part}`).addEventListener("change", (event) => picture.setShown({ [part]: event.target.checked }));
  }
  return () => showLook(picture);
}

function showLook({ map, scale, shows }) {
  byId("map").value = map;
  byId("scale-automatic").checked = scale.isAutomatic;
  if (document.activeElement !== byId("scale-maximum")) byId("scale-maximum").value = Number(scale.maximum.toPrecision(2));
  for (const [part, isShown] of Object.entries(shows)) byId(`show-${part}`).checked = isShown;
}

function fillSelect(select, options) {
  select.replaceChildren(...options.map(([value, text]) => element("option", { value }, text)));
}

// A value that is none of the usual ones becomes an option, so that the field says what is in effect.
function select(field, value, text) {
  const isListed = [...field.options].some((option) => option.value === String(value));
  if (!isListed) field.append(element("option", { value }, text));
  field.value = String(value);
}

function round(value) {
  return Number(Number(value).toPrecision(4));
}
