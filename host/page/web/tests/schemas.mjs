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

/** Those of a whole robot's topics by name, of markers only what the page reads. */
export const ROBOT_SCHEMAS = {
  "tf2_msgs/msg/TFMessage": joined("geometry_msgs/TransformStamped[] transforms\n", {
    "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    ...COMMON,
  }),
  "visualization_msgs/msg/MarkerArray": joined("visualization_msgs/Marker[] markers\n", {
    "visualization_msgs/Marker": "std_msgs/Header header\ngeometry_msgs/Point[] points\n",
    ...COMMON,
  }),
};

/** The text of `dermatome_msgs/NAME` with all that it needs. */
export function schemaOf(name) {
  const texts = new Map();
  collect(`dermatome_msgs/${name}`, texts);
  const [root, ...others] = [...texts];
  return joined(root[1], Object.fromEntries(others));
}

function joined(root, others) {
  return [root, ...Object.entries(others).map(([other, text]) => `${SEPARATOR}\nMSG: ${other}\n${text}`)].join("\n");
}

function collect(name, texts) {
  if (texts.has(name)) return;
  const text = COMMON[name] ?? readFileSync(new URL(`${name.split("/")[1]}.msg`, FOLDER), "utf8");
  texts.set(name, text);
  for (const [, used] of text.matchAll(/^(\w+\/\w+)(?:\[\d*\])? /gm)) collect(used, texts);
}
