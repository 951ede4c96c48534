// Chooses among the skins of a robot, or all of it, where the program tells of several, or a recording holds several.

import { WHOLE } from "./connection.js";
import { byId, eachChild, element, setText } from "./element.js";

export function skinChoice(session) {
  const choice = byId("skin-choice");
  choice.addEventListener("change", () => {
    if (session.player) session.chooseRecorded(choice.value);
    else session.program.choose(choice.value);
  });
  session.listen((changes) => {
    if (changes.has("program") || changes.has("player")) show(session, choice);
  });
}

function show({ program, player }, choice) {
  const { spaces, space } = player?.recording ?? program;
  const names = !player && program.hasRobot ? [WHOLE, ...spaces] : spaces;
  choice.hidden = names.length < 2;
  eachChild(choice, names, () => element("option"), (option, name) => {
    option.value = name;
    setText(option, name === WHOLE ? "Whole robot" : name);
  });
  if (space !== undefined) choice.value = space;
}
