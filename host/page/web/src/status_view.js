// Shows the situation: the badge and the line at the top, banners, and the card over the picture.

import { byId, eachChild, element, setText } from "./element.js";
import { situationOf, warningsOf } from "./situation.js";

// A warning that comes and goes with the frames stays this long, so that the picture under it does not jump.
const STAYS_MS = 4000;
const ACTIONS = { tare: "Tare", retry: "Try now" };

/** `act(name)` is called where the button of the card is pressed. */
export function statusView(session, act) {
  const button = byId("situation-action");
  const warnedAt = new Map();
  button.addEventListener("click", () => act(button.dataset.action));
  session.listen((changes) => {
    if (changes.has("new")) warnedAt.clear();
    if (["status", "program", "player", "skin", "new", "held", "robot"].some((name) => changes.has(name))) show(session, button, warnedAt);
  });
}

function show(session, button, warnedAt) {
  const situation = situationOf(session);
  const badge = byId("state");
  setText(badge, situation.word);
  badge.dataset.level = situation.level;
  setText(byId("status-text"), situation.text);
  byId("status-text").title = situation.advice;
  document.title = `${session.isWhole ? session.source.spaces[0].split("/")[0] : (session.shown.skin?.name ?? situation.word)} – Dermatome`;
  byId("situation").hidden = !situation.covers;
  byId("view").classList.toggle("is-dimmed", situation.covers);
  byId("panel-contacts").classList.toggle("is-dimmed", situation.covers && situation.action === "retry");
  setText(byId("situation-text"), situation.text);
  setText(byId("situation-advice"), situation.advice);
  button.hidden = !(situation.action in ACTIONS);
  button.dataset.action = situation.action ?? "";
  setText(button, ACTIONS[situation.action] ?? "");
  byId("held").hidden = !session.isHeld || situation.covers;
  showBanners(session, situation, warnedAt);
}

function showBanners(session, { covers, advice }, warnedAt) {
  const now = performance.now();
  for (const text of warningsOf(session)) warnedAt.set(text, now);
  for (const [text, at] of warnedAt) if (now - at > STAYS_MS) warnedAt.delete(text);
  const banners = [...warnedAt.keys()].map((text) => ({ text, kind: "warning" }));
  if (!covers && advice) banners.push({ text: advice, kind: "hint" });
  eachChild(byId("banners"), banners, () => element("li"), (item, { text, kind }) => {
    item.dataset.kind = kind;
    setText(item, text);
  });
}
