// Writes small recordings of the mock's skin, or of a robot's, as the program does: MCAP, chunks of LZ4 frames.

import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";
import lz4 from "lz4js";

import { Mock, channelOf, encode } from "./mock.mjs";
import { ROBOT_SCHEMAS } from "./schemas.mjs";

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

/**
 * The bytes of a recording of `seconds` at `rate` frames a second; of several skins, `mocks` by their spaces, each from
 * second `begins[space]` on. Of a robot its messages are `robot`, `[topic, body, time]`, its skins' frames named as their
 * spaces are.
 */
export async function record({ seconds = 2, rate = 100, mock = new Mock({ rate }), mocks = { dermatome: mock }, begins = {}, robot = [], topics, chunkSize = 64 * 1024 } = {}) {
  const memory = new Memory();
  const compressChunk = (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) });
  const writer = new McapWriter({ writable: memory, chunkSize, compressChunk });
  await writer.start({ profile: "ros2", library: "mock" });
  const ids = new Map();
  const write = async ([space, mock], topic, body, time) => {
    if (topics && !topics.includes(topic)) return;
    const name = topic.replace("/dermatome/", `/${space}/`);
    const message = mock.message(body);
    if (robot.length > 0) message.header.frame_id = space;
    await put(name, channelOf(topic), encode(topic, message), time);
  };
  const put = async (name, channel, data, time) => {
    if (!ids.has(name)) ids.set(name, await register(writer, channel, name));
    const logTime = START_NS + BigInt(Math.round(time * 1e9));
    await writer.addMessage({ channelId: ids.get(name), sequence: 0, logTime, publishTime: logTime, data });
  };
  const skins = Object.entries(mocks);
  const beginOf = ([space]) => begins[space] ?? 0;
  const ofRobot = robot.toSorted(([, , a], [, , b]) => a - b);
  const putRobot = async (time) => {
    while (ofRobot[0]?.[2] <= time) {
      const [topic, body, at] = ofRobot.shift();
      const channel = robotChannelOf(topic);
      await put(topic, channel, new MessageWriter(parse(channel.schema, { ros2: true })).writeMessage(body), at);
    }
  };
  await putRobot(0);
  for (let sequence = 0; sequence < seconds * rate; sequence++) {
    await putRobot(sequence / rate);
    for (const skin of skins.filter((skin) => sequence / rate >= beginOf(skin))) {
      if (sequence === Math.ceil(beginOf(skin) * rate)) {
        await write(skin, "/dermatome/skin", skin[1].skin, sequence / rate);
        await write(skin, "/dermatome/status", skin[1].status, sequence / rate);
      }
      for (const [topic, body] of skin[1].frame(sequence)) await write(skin, topic, body, sequence / rate);
    }
  }
  await writer.end();
  return Buffer.concat(memory.parts);
}

function robotChannelOf(topic) {
  const schemaName = topic === "/links" ? "visualization_msgs/msg/MarkerArray" : "tf2_msgs/msg/TFMessage";
  return { schemaName, schema: ROBOT_SCHEMAS[schemaName], schemaEncoding: "ros2msg" };
}

async function register(writer, { schema, schemaName, schemaEncoding }, name) {
  const schemaId = await writer.registerSchema({ name: schemaName, encoding: schemaEncoding, data: new TextEncoder().encode(schema) });
  return writer.registerChannel({ schemaId, topic: name, messageEncoding: "cdr", metadata: new Map() });
}
