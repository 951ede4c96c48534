// Chooses among the skins of a robot, where the program tells of several.

import { byId, eachChild, element, setText } from "./element.js";

export function skinChoice(session) {
  const choice = byId("skin-choice");
  choice.addEventListener("change", () => session.program.choose(choice.value));
  session.listen((changes) => {
    if (changes.has("program") || changes.has("player")) show(session, choice);
  });
}

function show({ program, player }, choice) {
  const { spaces, space } = program;
  choice.hidden = spaces.length < 2 || Boolean(player);
  eachChild(choice, spaces, () => element("option"), (option, name) => {
    option.value = name;
    setText(option, name);
  });
  if (space !== undefined) choice.value = space;
}
