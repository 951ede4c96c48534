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

/** The bytes of a recording of `seconds` at `rate` frames a second. */
export async function record({ seconds = 2, rate = 100, mock = new Mock({ rate }), topics, chunkSize = 64 * 1024 } = {}) {
  const memory = new Memory();
  const compressChunk = (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) });
  const writer = new McapWriter({ writable: memory, chunkSize, compressChunk });
  await writer.start({ profile: "ros2", library: "mock" });
  const ids = new Map();
  const write = async (topic, body, time) => {
    if (topics && !topics.includes(topic)) return;
    if (!ids.has(topic)) ids.set(topic, await register(writer, topic));
    const logTime = START_NS + BigInt(Math.round(time * 1e9));
    const data = encode(topic, mock.message(body));
    await writer.addMessage({ channelId: ids.get(topic), sequence: 0, logTime, publishTime: logTime, data });
  };
  await write("/dermatome/skin", mock.skin, 0);
  await write("/dermatome/status", mock.status, 0);
  for (let sequence = 0; sequence < seconds * rate; sequence++) {
    for (const [topic, body] of mock.frame(sequence)) await write(topic, body, sequence / rate);
  }
  await writer.end();
  return Buffer.concat(memory.parts);
}

async function register(writer, topic) {
  const { schema, schemaName, schemaEncoding } = channelOf(topic);
  const schemaId = await writer.registerSchema({ name: schemaName, encoding: schemaEncoding, data: new TextEncoder().encode(schema) });
  return writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() });
}
