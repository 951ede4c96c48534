// Bytes of a topic to messages, by the schema that came with the topic.

import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

export const TOPIC = {
  skin: "/dermatome/skin",
  status: "/dermatome/status",
  image: "/dermatome/image",
  contacts: "/dermatome/contacts",
  health: "/dermatome/health",
  scope: "/dermatome/scope",
};

/** Bits of `flags`, as in Health.msg, in words. */
export const FLAGS = [
  "saturated",
  "an electrode without contact",
  "electrodes connected to each other",
  "no current",
  "not reciprocal",
  "implausible",
  "samples missed",
  "electrodes masked",
  "board hot",
  "unlike a press",
  "skin lifted",
  "an electrode touches worse than in the tare",
];

const readers = new Map();

function readerOf(schema) {
  let reader = readers.get(schema);
  if (!reader) {
    reader = new MessageReader(parse(schema, { ros2: true }));
    readers.set(schema, reader);
  }
  return reader;
}

/** The message in `bytes`. Its arrays of numbers are views of a copy of them, so it outlives a reused buffer. */
export function decode(schema, bytes) {
  return readerOf(schema).readMessage(bytes.slice());
}

/** Throws where the parts of a Skin message do not fit together, as in a file that another program wrote. */
export function checkSkin({ vertices, triangles, vertex_pixels: pixels, electrodes, link_vertices: linkVertices, link_triangles: linkTriangles }) {
  const fits = (places, corners) => places.length % 3 === 0 && corners.length % 3 === 0 && corners.every((corner) => corner < places.length / 3);
  const isFinite = [vertices, electrodes, linkVertices].every((places) => places.every(Number.isFinite));
  if (!fits(vertices, triangles) || !fits(linkVertices, linkTriangles) || pixels.length * 3 !== vertices.length || !isFinite) {
    throw new Error("the skin's vertices, triangles and pixels do not fit together");
  }
}

/** Relative conductivity change of each pixel of an Image, into `values` if that is long enough. */
export function pixelValues(image, values) {
  const { mantissas, exponent } = image;
  if (values?.length !== mantissas.length) values = new Float32Array(mantissas.length);
  const factor = 2 ** -exponent;
  for (let pixel = 0; pixel < mantissas.length; pixel++) values[pixel] = mantissas[pixel] * factor;
  return values;
}

/** Words for the bits that are set. */
export function flagWords(flags) {
  return FLAGS.filter((_, bit) => flags & (1 << bit));
}
