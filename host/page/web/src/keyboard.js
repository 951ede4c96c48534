// Keys. None does anything while text is typed or a dialog is open; those of the picture need the picture's focus.

import { byId, element } from "./element.js";
import { PANELS } from "./tabs.js";

const TURN = Math.PI / 36;
const ZOOM = 1.1;

/** `commands` by name: tare, record, hold, step, map, automatic, scale, reset, electrodes, open, dismiss, turn, zoom, panel. */
export function setUpKeyboard(session, commands) {
  const help = byId("help");
  const keys = keysOf(session, commands);
  fillHelp(keys);
  byId("help-button").addEventListener("click", () => help.showModal());
  help.addEventListener("click", (event) => event.target === help && help.close());
  addEventListener("keydown", (event) => {
    if (event.key === "?" && !isTyping(event.target)) {
      event.preventDefault();
      return help.open ? help.close() : help.showModal();
    }
    if (help.open || isTyping(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = keys.find(({ matches }) => matches(event));
    if (!key) return;
    event.preventDefault();
    key.act(event);
  });
}

function keysOf(session, commands) {
  const isPlain = (name) => (event) => event.key.toLowerCase() === name && !event.shiftKey;
  const isSpace = (event) => event.key === " " && !(event.target instanceof HTMLButtonElement);
  const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const onPicture = (event) => event.target === byId("canvas");
  const isStep = (event) => session.player && !event.shiftKey && ["ArrowLeft", "ArrowRight"].includes(event.key);
  return [
    { name: "t", does: "Tare", matches: isPlain("t"), act: commands.tare },
    { name: "r", does: "Start or stop recording", matches: isPlain("r"), act: commands.record },
    { name: "Space", does: "Pause the picture; play or pause a recording", matches: isSpace, act: commands.hold },
    { name: "← →", does: "Previous or next frame of a recording", matches: isStep, act: (event) => commands.step(event.key === "ArrowRight") },
    { name: "o", does: "Open a recording", matches: isPlain("o"), act: commands.open },
    { name: "c", does: "Next colour map", matches: isPlain("c"), act: commands.map },
    { name: "a", does: "Colour scale: automatic or fixed", matches: isPlain("a"), act: commands.automatic },
    { name: "[ ]", does: "Colour scale: smaller or larger", matches: ({ key }) => key === "[" || key === "]", act: ({ key }) => commands.scale(key === "]") },
    { name: "e", does: "Show or hide electrodes", matches: isPlain("e"), act: commands.electrodes },
    { name: "v", does: "Show all of the skin", matches: isPlain("v"), act: commands.reset },
    { name: "Arrows", does: "On the picture: turn it (with Shift while a recording is shown)", matches: (event) => onPicture(event) && event.key in arrow, act: ({ key }) => commands.turn(arrow[key][0] * TURN, arrow[key][1] * TURN) },
    { name: "+ −", does: "On the picture: nearer or farther", matches: (event) => onPicture(event) && ["+", "=", "-"].includes(event.key), act: ({ key }) => commands.zoom(key === "-" ? ZOOM : 1 / ZOOM) },
    { name: `1 – ${PANELS.length}`, does: "Panels, from left to right", matches: ({ key }) => key >= "1" && key <= String(PANELS.length), act: ({ key }) => commands.panel(PANELS[key - 1].name) },
    { name: "?", does: "This help", matches: () => false },
    { name: "Esc", does: "Close this help or a message", matches: isPlain("escape"), act: commands.dismiss },
  ];
}

function fillHelp(keys) {
  const rows = keys.map(({ name, does }) => element("div", {}, element("dt", {}, element("kbd", {}, name)), element("dd", {}, does)));
  byId("keys").replaceChildren(...rows);
}

function isTyping(target) {
  if (target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement) return true;
  return target instanceof HTMLInputElement && !["checkbox", "radio", "range", "file"].includes(target.type);
}
