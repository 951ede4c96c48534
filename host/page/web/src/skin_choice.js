// Chooses among the skins of a robot, or all of it, where the program tells of several.

import { WHOLE } from "./connection.js";
import { byId, eachChild, element, setText } from "./element.js";

export function skinChoice(session) {
  const choice = byId("skin-choice");
  choice.addEventListener("change", () => session.program.choose(choice.value));
  session.listen((changes) => {
    if (changes.has("program") || changes.has("player")) show(session, choice);
  });
}

function show({ program, player }, choice) {
  const { spaces, hasRobot, space } = program;
  const names = hasRobot ? [WHOLE, ...spaces] : spaces;
  choice.hidden = names.length < 2 || Boolean(player);
  eachChild(choice, names, () => element("option"), (option, name) => {
    option.value = name;
    setText(option, name === WHOLE ? "Whole robot" : name);
  });
  if (space !== undefined) choice.value = space;
}
