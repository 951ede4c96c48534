// Writes small recordings of the mock's skin, as the program does: MCAP, chunks of LZ4 frames.

import { McapWriter } from "@mcap/core";
import lz4 from "lz4js";

import { Mock, channelOf, encode } from "./mock.mjs";

const START_NS = 1_760_000_000_000_000_000n;

class Memory {
  parts = [];
  length = 0n;
  position() {
    return this.length;
  }
  async write(bytes) {
    this.parts.push(bytes.slice());
    this.length += BigInt(bytes.length);
  }
}

/** The bytes of a recording of `seconds` at `rate` frames a second; of several skins, `mocks` by their spaces. */
export async function record({ seconds = 2, rate = 100, mock = new Mock({ rate }), mocks = { dermatome: mock }, topics, chunkSize = 64 * 1024 } = {}) {
  const memory = new Memory();
  const compressChunk = (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) });
  const writer = new McapWriter({ writable: memory, chunkSize, compressChunk });
  await writer.start({ profile: "ros2", library: "mock" });
  const ids = new Map();
  const write = async ([space, mock], topic, body, time) => {
    if (topics && !topics.includes(topic)) return;
    const name = topic.replace("/dermatome/", `/${space}/`);
    if (!ids.has(name)) ids.set(name, await register(writer, topic, name));
    const logTime = START_NS + BigInt(Math.round(time * 1e9));
    const data = encode(topic, mock.message(body));
    await writer.addMessage({ channelId: ids.get(name), sequence: 0, logTime, publishTime: logTime, data });
  };
  const skins = Object.entries(mocks);
  for (const skin of skins) {
    await write(skin, "/dermatome/skin", skin[1].skin, 0);
    await write(skin, "/dermatome/status", skin[1].status, 0);
  }
  for (let sequence = 0; sequence < seconds * rate; sequence++) {
    for (const skin of skins) {
      for (const [topic, body] of skin[1].frame(sequence)) await write(skin, topic, body, sequence / rate);
    }
  }
  await writer.end();
  return Buffer.concat(memory.parts);
}

async function register(writer, topic, name) {
  const { schema, schemaName, schemaEncoding } = channelOf(topic);
  const schemaId = await writer.registerSchema({ name: schemaName, encoding: schemaEncoding, data: new TextEncoder().encode(schema) });
  return writer.registerChannel({ schemaId, topic: name, messageEncoding: "cdr", metadata: new Map() });
}
