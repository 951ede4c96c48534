// The panel of contacts: the figures of the moment, a row for each contact, and what session this is.

import { byId, eachChild, element, setText } from "./element.js";
import { totalForce, totalStrength } from "./history.js";
import { nameOf } from "./spaces.js";
import { STATES, bytes, contactName, forceText, number, strengthText, withUnit } from "./words.js";

const REDRAW_MS = 100;

/** Returns `{ setSeen }`; it is brought up to date only while it is seen. */
export function contactsPanel(session) {
  let isSeen = false;
  let drawn = 0;
  const update = (changes) => {
    if (!isSeen) return;
    if (["status", "skin", "new"].some((name) => changes.has(name))) showSession(session);
    const isDue = performance.now() - drawn > REDRAW_MS;
    if (!changes.has("new") && !(isDue && ["contacts", "status", "robot"].some((name) => changes.has(name)))) return;
    drawn = performance.now();
    if (session.isWhole) showRobot(session.robot);
    else showContacts(session.shown);
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
  setText(byId("no-contacts"), contacts ? "Nothing touches the skin." : "No contacts are known.");
  eachChild(byId("contact-rows"), list, makeRow, updateRow);
}

// Places are in the frames of the links, as programs get them.
function showRobot({ contacts, skins }) {
  const list = contacts.sort((a, b) => a.space.localeCompare(b.space) || a.id - b.id);
  const rates = [...skins.values()].map(({ status }) => status?.frames_per_second).filter(Number.isFinite);
  const telling = [...skins.values()].filter(({ contacts: told }) => told).length;
  showPairs(byId("figures"), [
    ["Contacts", telling > 0 ? list.length : "–"],
    ["Skins", skins.size],
    ["Least frames/s", rates.length > 0 ? number(Math.min(...rates)) : "–"],
  ]);
  byId("no-contacts").hidden = list.length > 0;
  setText(byId("no-contacts"), nothingText(telling, skins.size));
  eachChild(byId("contact-rows"), list, makeRow, updateRow);
  showPairs(byId("session"), [...skins].map(([space, { status, contacts: of }]) => [nameOf(space), skinText(status, of)]));
}

// Of a skin whose board is lost it is not known whether anything touches it.
function nothingText(telling, all) {
  if (telling === 0) return "No contacts are known.";
  return telling < all ? "Nothing touches the skins that tell contacts." : "Nothing touches the robot.";
}

function skinText(status, contacts) {
  const count = contacts?.contacts.length;
  const touches = contacts && `${count} ${count === 1 ? "contact" : "contacts"}`;
  return [STATES[status?.state]?.word ?? "–", touches, status?.text].filter(Boolean).join(", ");
}

function makeRow() {
  return element("tr", {}, element("th", { scope: "row" }), ...Array.from({ length: 5 }, () => element("td")));
}

function updateRow(row, contact) {
  const { area, strength, pressure, force, space } = contact;
  const position = contact.onLink ?? contact.position;
  // The skin's name takes room.
  const decimals = space ? 0 : 1;
  const place = [position.x, position.y, position.z].map((metres) => (metres * 1000).toFixed(decimals)).join(", ");
  const texts = [
    space ? `${nameOf(space)} ${contactName(contact)}` : contactName(contact),
    strengthText(strength),
    number(pressure / 1e3),
    number(force),
    number(area * 1e4),
    place,
  ];
  texts.forEach((text, i) => setText(row.children[i], text));
}

function showSession({ isWhole, shown: { status, skin } }) {
  setText(byId("session-title"), isWhole ? "Skins" : "Session");
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
