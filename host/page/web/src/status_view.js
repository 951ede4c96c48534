// Shows the situation: the badge and the line at the top, banners, and the card over the picture.

import { byId, eachChild, element, setText } from "./element.js";
import { situationOf, warningsOf } from "./situation.js";

const ACTIONS = { tare: "Tare", retry: "Try now" };

/** `act(name)` is called where the button of the card is pressed. */
export function statusView(session, act) {
  const button = byId("situation-action");
  button.addEventListener("click", () => act(button.dataset.action));
  session.listen((changes) => {
    if (["status", "program", "player", "skin", "new", "held"].some((name) => changes.has(name))) show(session, button);
  });
}

function show(session, button) {
  const situation = situationOf(session);
  const badge = byId("state");
  setText(badge, situation.word);
  badge.dataset.level = situation.level;
  setText(byId("status-text"), situation.text);
  byId("status-text").title = situation.advice;
  document.title = `${session.shown.skin?.name ?? situation.word} – Dermatome`;
  byId("situation").hidden = !situation.covers;
  byId("view").classList.toggle("is-dimmed", situation.covers);
  byId("panel-contacts").classList.toggle("is-dimmed", situation.covers && situation.action === "retry");
  setText(byId("situation-text"), situation.text);
  setText(byId("situation-advice"), situation.advice);
  button.hidden = !(situation.action in ACTIONS);
  button.dataset.action = situation.action ?? "";
  setText(button, ACTIONS[situation.action] ?? "");
  byId("held").hidden = !session.isHeld || situation.covers;
  showBanners(session, situation);
}

function showBanners(session, { covers, advice }) {
  const banners = warningsOf(session).map((text) => ({ text, kind: "warning" }));
  if (!covers && advice) banners.push({ text: advice, kind: "hint" });
  eachChild(byId("banners"), banners, () => element("li"), (item, { text, kind }) => {
    item.dataset.kind = kind;
    setText(item, text);
  });
}
