// Chooses among the skins of a robot, or all of it, where the program tells of several, or a recording holds several.

import { byId, eachChild, element, setText } from "./element.js";
import { WHOLE } from "./spaces.js";

export function skinChoice(session) {
  const choice = byId("skin-choice");
  choice.addEventListener("change", () => {
    if (session.player) session.chooseRecorded(choice.value);
    else session.program.choose(choice.value);
  });
  session.listen((changes) => {
    if (changes.has("program") || changes.has("player")) show(session.source, choice);
  });
}

function show({ spaces, space, hasRobot }, choice) {
  const names = hasRobot ? [WHOLE, ...spaces] : spaces;
  choice.hidden = names.length < 2;
  eachChild(choice, names, () => element("option"), (option, name) => {
    option.value = name;
    setText(option, name === WHOLE ? "Whole robot" : name);
  });
  if (space !== undefined) choice.value = space;
}
