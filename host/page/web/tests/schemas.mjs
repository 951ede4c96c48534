// The schemas that the program advertises: each message definition with those that it needs, as ROS 2 puts them together.

import { readFileSync } from "node:fs";

const FOLDER = new URL("../../../messages/dermatome_msgs/msg/", import.meta.url);
const SEPARATOR = "=".repeat(80);

const COMMON = {
  "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
  "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
  "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
  "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
};

/** The text of `dermatome_msgs/NAME` with all that it needs. */
export function schemaOf(name) {
  const texts = new Map();
  collect(`dermatome_msgs/${name}`, texts);
  const [root, ...others] = [...texts];
  return [root[1], ...others.map(([other, text]) => `${SEPARATOR}\nMSG: ${other}\n${text}`)].join("\n");
}

function collect(name, texts) {
  if (texts.has(name)) return;
  const text = COMMON[name] ?? readFileSync(new URL(`${name.split("/")[1]}.msg`, FOLDER), "utf8");
  texts.set(name, text);
  for (const [, used] of text.matchAll(/^(\w+\/\w+)(?:\[\d*\])? /gm)) collect(used, texts);
}
