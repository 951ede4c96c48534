// Reads a recording with npm's @mcap/core, from its start on or by its index, and prints what it holds as JSON:
//
//     node read.mjs stream|index FILE
//
// Numbers that JSON does not have are the words nan, inf and -inf. The libraries are those of the page.

import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(new URL("../../../page/web/package.json", import.meta.url));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const lz4 = require("lz4js");

const decompressHandlers = { lz4: (bytes, size) => lz4.decompress(bytes, Number(size)) };
const WORDS = new Map([[NaN, "nan"], [Infinity, "inf"], [-Infinity, "-inf"]]);

/** What a recording holds, record by record. */
class Content {
  schemas = new Map();
  channels = new Map();
  readers = new Map();
  types = {};
  messages = {};
  attachments = {};
  metadata = {};

  take(record) {
    if (record.type === "Schema") this.schemas.set(record.id, record);
    if (record.type === "Channel") this.takeChannel(record);
    if (record.type === "Message") this.takeMessage(record);
    if (record.type === "Attachment") this.takeAttachment(record);
    if (record.type === "Metadata") this.metadata[record.name] = Object.fromEntries(record.metadata);
  }

  takeChannel({ id, topic, schemaId, messageEncoding }) {
    const { name, encoding, data } = this.schemas.get(schemaId);
    this.channels.set(id, topic);
    this.types[topic] = [name, encoding, messageEncoding];
    this.messages[topic] ??= [];
    this.readers.set(id, new MessageReader(parse(new TextDecoder().decode(data), { ros2: true })));
  }

  takeMessage({ channelId, sequence, logTime, data }) {
    const message = this.readers.get(channelId).readMessage(data);
    this.messages[this.channels.get(channelId)].push([sequence, String(logTime), message]);
  }

  takeAttachment({ name, mediaType, data }) {
    this.attachments[name] = [mediaType, createHash("sha256").update(data).digest("hex")];
  }
}

/** Whether the file ends as it was meant to. */
function stream(bytes, content) {
  const reader = new McapStreamReader({ decompressHandlers });
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) content.take(record);
  return reader.done();
}

async function index(bytes, content) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  for (const records of [reader.schemasById, reader.channelsById]) records.forEach((record) => content.take(record));
  for await (const record of reader.readMessages({ validateCrcs: true })) content.take(record);
  for await (const record of reader.readAttachments()) content.take(record);
  for await (const record of reader.readMetadata()) content.take(record);
  return true;
}

function plain(key, value) {
  if (typeof value === "bigint") return Number.isSafeInteger(Number(value)) ? Number(value) : String(value);
  if (typeof value === "number") return WORDS.get(value) ?? value;
  return ArrayBuffer.isView(value) ? Array.from(value) : value;
}

const [way, file] = process.argv.slice(2);
const content = new Content();
const isWhole = await { stream, index }[way](readFileSync(file), content);
const { types, messages, attachments, metadata } = content;
process.stdout.write(JSON.stringify({ isWhole, types, messages, attachments, metadata }, plain));
