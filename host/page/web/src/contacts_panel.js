// The panel of contacts: the figures of the moment, a row for each contact, and what session this is.

import { byId, eachChild, element, setText } from "./element.js";
import { totalForce, totalStrength } from "./history.js";
import { bytes, contactName, forceText, number, strengthText, withUnit } from "./words.js";

const REDRAW_MS = 100;

/** Returns `{ setSeen }`; it is brought up to date only while it is seen. */
export function contactsPanel(session) {
  let isSeen = false;
  let drawn = 0;
  const update = (changes) => {
    if (!isSeen) return;
    if (changes.has("status") || changes.has("skin") || changes.has("new")) showSession(session);
    const isDue = performance.now() - drawn > REDRAW_MS;
    if (!changes.has("new") && !(isDue && (changes.has("contacts") || changes.has("status")))) return;
    drawn = performance.now();
    showContacts(session.shown);
  };
  session.listen(update);
  const setSeen = (seen) => {
    isSeen = seen;
    update(new Set(["new"]));
  };
  return { setSeen };
}

function showContacts({ contacts, skin, status }) {
  // By number, so that rows stay where they are while one contact or the other is stronger.
  const list = (contacts?.contacts ?? []).slice().sort((a, b) => a.id - b.id);
  const isCalibrated = skin?.is_calibrated ?? false;
  showPairs(byId("figures"), [
    ["Contacts", contacts ? list.length : "–"],
    isCalibrated ? ["Force", forceText(totalForce(list))] : ["Strength", contacts ? strengthText(totalStrength(list)) : "–"],
    ["Frames/s", number(status?.frames_per_second ?? NaN)],
    ["Signal/noise", withUnit(status?.signal_to_noise ?? NaN, "dB", 2)],
  ]);
  byId("no-contacts").hidden = list.length > 0;
  setText(byId("no-contacts"), contacts ? "Nothing touches the skin." : "No contacts have come yet.");
  eachChild(byId("contact-rows"), list, makeRow, updateRow);
}

function makeRow() {
  return element("tr", {}, element("th", { scope: "row" }), ...Array.from({ length: 5 }, () => element("td")));
}

function updateRow(row, contact) {
  const { position, area, strength, pressure, force } = contact;
  const place = [position.x, position.y, position.z].map((metres) => (metres * 1000).toFixed(1)).join(", ");
  const texts = [
    contactName(contact),
    strengthText(strength),
    number(pressure / 1e3),
    number(force),
    number(area * 1e4),
    place,
  ];
  texts.forEach((text, i) => setText(row.children[i], text));
}

function showSession({ shown: { status, skin } }) {
  showPairs(byId("session"), status ? sessionFacts(status, skin) : []);
}

function sessionFacts(status, skin) {
  const crc = status.patch_crc ? status.patch_crc.toString(16).padStart(8, "0") : "–";
  return [
    ["Skin", status.skin || skin?.name || "–"],
    ["Board", [status.board, status.firmware && `firmware ${status.firmware}`].filter(Boolean).join(", ") || "–"],
    ["Port", status.port || "–"],
    ["Patch", `${status.patches[status.patch] ?? "–"} (${crc})`],
    ["Drive", driveText(status)],
    ["Frames", `${status.frames}, lost ${status.frames_lost}; damaged packets ${status.packets_damaged}`],
    ["Calibrated", skin ? (skin.is_calibrated ? "yes: kPa and N" : "no: strength only") : "–"],
    ...(status.recording ? [["Recording", `${status.recording}, ${bytes(status.recorded_bytes)}`]] : []),
  ];
}

/** The drive in effect, in words. */
export function driveText({ frequency, amplitude, gain, frame_rate: rate }) {
  const gainText = gain > 0 ? `gain ${gain}` : "gain automatic";
  return `${withUnit(frequency / 1e3, "kHz")}, ${withUnit(amplitude * 1e3, "mA")}, ${gainText}, ${withUnit(rate, "frames/s")}`;
}

/** A list of names and values. */
export function showPairs(list, pairs) {
  eachChild(list, pairs, () => element("div", {}, element("dt"), element("dd")), (pair, [name, value]) => {
    setText(pair.firstChild, name);
    setText(pair.lastChild, String(value));
  });
}
