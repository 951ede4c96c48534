// The panel of electrodes: the check, guided, and what each electrode and the board say.

import { showPairs } from "./contacts_panel.js";
import { byId, eachChild, element, setText } from "./element.js";
import { STATES, boardFacts, electrodeStates, legendOf } from "./electrode_states.js";
import { flagWords } from "./messages.js";
import { ohm } from "./words.js";

const REDRAW_MS = 250;

export function electrodesPanel(session) {
  let isSeen = false;
  let drawn = 0;
  const update = (changes) => {
    const isDue = performance.now() - drawn > REDRAW_MS && (changes.has("health") || changes.has("skin"));
    if (!isSeen || !(isDue || changes.has("new"))) return;
    drawn = performance.now();
    showElectrodes(session.shown);
  };
  session.listen(update);
  setUpCheck(session);
  const setSeen = (seen) => {
    isSeen = seen;
    update(new Set(["new"]));
  };
  return { setSeen };
}

function showElectrodes({ skin, health }) {
  const count = Math.max((skin?.electrodes.length ?? 0) / 3, health?.contact_impedance.length ?? 0);
  setText(byId("electrode-legend"), count > 0 ? legendOf(health) : "No skin is known yet.");
  eachChild(byId("electrode-rows"), electrodeStates(count, health), makeRow, updateRow);
  const flags = health ? flagWords(health.flags) : [];
  showPairs(byId("health"), health ? [...boardFacts(health), ["Latest frame", flags.join(", ") || "sound"]] : []);
}

function makeRow() {
  const swatch = element("span", { className: "swatch", "aria-hidden": "true" });
  return element("tr", {}, element("th", { scope: "row" }), element("td", {}, swatch, element("span")), element("td"));
}

function updateRow(row, { number, impedance, state, colour }) {
  const { word, sign } = STATES[state];
  row.dataset.state = state;
  setText(row.children[0], String(number));
  row.children[1].firstChild.style.background = colour ?? "transparent";
  setText(row.children[1].lastChild, ohm(impedance));
  setText(row.children[2], sign ? `${sign} ${word}` : word);
}

function setUpCheck(session) {
  const button = byId("check");
  const said = byId("said-check");
  let isRunning = false;
  const enable = () => (button.disabled = isRunning || !session.offers("/dermatome/check"));
  session.listen(enable);
  button.addEventListener("click", async () => {
    isRunning = true;
    enable();
    byId("check-result").replaceChildren();
    setText(said, "Checking. Do not touch the skin.");
    said.dataset.kind = "progress";
    try {
      showFindings(await session.call("/dermatome/check"));
      setText(said, "");
    } catch (error) {
      said.dataset.kind = "error";
      setText(said, error.message);
    }
    isRunning = false;
    enable();
    setText(button, "Check again");
  });
}

function showFindings({ summary = [], findings = [] }) {
  const lines = summary.map((text) => element("p", {}, text));
  const items = findings.map(({ level, found, advice }) =>
    element("li", { "data-level": level === "fault" ? "fault" : "note" },
      element("strong", {}, `${level === "fault" ? "Fault" : "Note"}: ${found}`),
      element("span", {}, advice ?? "")),
  );
  const list = items.length > 0 ? element("ul", { className: "findings" }, ...items) : element("p", { className: "good" }, "Nothing wrong was found.");
  byId("check-result").replaceChildren(...lines, list);
}
