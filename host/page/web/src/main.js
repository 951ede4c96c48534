// Puts the page together: the session, the picture and the panels, and which key or button does what.

import { actions } from "./actions.js";
import { calibratePanel } from "./calibrate_panel.js";
import { MAPS } from "./colour.js";
import { contactsPanel } from "./contacts_panel.js";
import { electrodesPanel } from "./electrodes_panel.js";
import { byId, setText } from "./element.js";
import { setUpKeyboard } from "./keyboard.js";
import { Picture } from "./picture.js";
import { PlaybackBar } from "./playback_bar.js";
import { Plots } from "./plots.js";
import { ScopeView } from "./scope.js";
import { Session } from "./session.js";
import { settingsPanel } from "./settings_panel.js";
import { skinChoice } from "./skin_choice.js";
import { statusView } from "./status_view.js";
import { Tabs } from "./tabs.js";
import { setUpTestHook } from "./test_hook.js";
import { setUpTheme } from "./theme.js";

const session = new Session(location);
const picture = new Picture(session, { keepsPixels: new URLSearchParams(location.search).has("test") });
const { tare, record } = actions(session);

statusView(session, (action) => (action === "tare" ? tare() : session.program.retryNow()));
settingsPanel(session, picture);
skinChoice(session);
calibratePanel(session);
new PlaybackBar(session);

const panels = {
  contacts: contactsPanel(session),
  plots: new Plots(session),
  electrodes: electrodesPanel(session),
  scope: new ScopeView(session),
};
const tabs = new Tabs((selected) => {
  for (const [name, panel] of Object.entries(panels)) panel.setSeen(name === selected);
});

function hold() {
  if (session.player) session.player.toggle();
  else session.hold(!session.isHeld);
}

function nextMap() {
  const names = Object.keys(MAPS);
  picture.setMap(names[(names.indexOf(picture.map) + 1) % names.length]);
}

function changeScale(change) {
  change(picture.scale);
  session.changed("look");
}

setUpKeyboard(session, {
  tare,
  record,
  hold,
  step: (isForward) => session.player?.step(isForward),
  open: () => byId("open").click(),
  dismiss: () => setText(byId("said-actions"), ""),
  map: nextMap,
  automatic: () => changeScale((scale) => scale.setAutomatic(!scale.isAutomatic)),
  scale: (isUp) => changeScale((scale) => scale.step(isUp)),
  electrodes: () => picture.setShown({ electrodes: !picture.shows.electrodes }),
  reset: () => picture.scene?.resetView(),
  turn: (sideways, upwards) => picture.scene?.turn(sideways, upwards),
  zoom: (factor) => picture.scene?.zoom(factor),
  panel: (name) => tabs.select(name),
});

byId("pause").addEventListener("click", hold);
byId("next-map").addEventListener("click", nextMap);
byId("reset-view").addEventListener("click", () => picture.scene?.resetView());
session.listen((changes) => {
  if (!changes.has("held") && !changes.has("player") && !changes.has("new")) return;
  byId("pause").setAttribute("aria-pressed", String(session.isHeld));
  byId("pause").disabled = Boolean(session.player);
});

setUpTheme([...document.querySelectorAll("input[name=theme]")], () => session.changed("look"));
setUpTestHook(session, picture, tabs);
tabs.select("contacts");
session.changed("program");
