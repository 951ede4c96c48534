// A recording, an MCAP file of the topics: which chunks it has, and what each topic last said at any moment. Chunks are
// read when they are needed. Of a file that was cut, the index is made anew up to the last whole chunk.

import { McapIndexedReader, McapRecordBuilder, McapStreamReader } from "@mcap/core";

import { decompressFrame } from "./lz4.js";
import { TOPIC } from "./messages.js";
import { WHOLE, nameHere, tellOfRobot } from "./spaces.js";

// What holds for good: a skin's shape, where skins and links lie, and what links look like.
const LASTING = /(\/skin|\/links|\/tf_static)$/;
const SHOWN = { "dermatome_msgs/msg/Image": "/image", "dermatome_msgs/msg/ContactArray": "/contacts" };

const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
const RECORD_HEADER = 9;
const CHUNK = 6;
// Of a chunk: its times, its uncompressed size, its CRC, and the length of its compression's name.
const CHUNK_HEADER = 8 + 8 + 8 + 4 + 4;
const CHUNKS_HELD = 6;

const decompressHandlers = {
  lz4: (bytes, size) => decompressFrame(bytes, Number(size)),
};

/**
 * Opens `blob`. Throws an error in words where it is no recording of a skin. `onProgress(share)` is called while the
 * index of a file that was cut is made, for which all of it is read.
 */
export async function openRecording(blob, name, onProgress = () => {}) {
  await checkMagic(blob);
  const index = (await readIndex(blob)) ?? (await makeIndex(blob, onProgress));
  const whole = new Recording(blob, name, index, WHOLE);
  whole.check();
  index.start = await whole.firstFrame();
  return whole.hasRobot ? whole : whole.of(whole.spaces[0]);
}

class Recording {
  // Chunks: `[{ offset, length, start, end, channelIds }]` by time, times in ns. All is of the skin in `space`, or of all.
  constructor(blob, name, index, space) {
    const { chunks, schemas, channels, isCut } = index;
    Object.assign(this, { blob, name, index, space, chunks, schemas, isCut });
    this.chunks.sort((a, b) => Number(a.start - b.start));
    const named = [...channels].map(([id, channel]) => [id, { ...channel, topic: nameHere(channel, space, this.spaces) }]);
    this.channels = new Map(named.filter(([, { topic }]) => topic !== undefined));
    this.held = new Map();
    this.heldLasting = new Map();
  }

  /** Spaces of the skins that are in the file. */
  get spaces() {
    return spacesOf(this.index);
  }

  /** Whether the file tells of a whole robot. */
  get hasRobot() {
    return tellOfRobot([...this.index.channels.values()]);
  }

  /** Whether all skins of a robot are looked at. */
  get isWhole() {
    return this.space === WHOLE;
  }

  /** What is looked at. */
  get topics() {
    return this.isWhole ? [...this.channels.values()].map(({ topic }) => topic) : Object.values(TOPIC);
  }

  /** The same file, of another of its skins, or of all. */
  of(space) {
    return new Recording(this.blob, this.name, this.index, space);
  }

  /** The time of the first frame of any skin: before it links are told, and references are made. */
  get start() {
    return this.index.start;
  }

  get end() {
    return this.chunks.reduce((end, chunk) => (chunk.end > end ? chunk.end : end), this.start);
  }

  // A chunk that is damaged is told of where it is looked at.
  async firstFrame() {
    const { start } = this.chunks[0];
    return (await this.neighbour(start - 1n, true).catch(() => undefined)) ?? start;
  }

  /** Length in seconds. */
  get duration() {
    return Number(this.end - this.start) / 1e9;
  }

  check() {
    if (this.chunks.length === 0) {
      throw new Error("The recording is empty: it was cut before its first chunk was written, or nothing was recorded.");
    }
    if (this.spaces.length === 0) {
      throw new Error("The file holds no images or contacts of a skin (no topic /dermatome/image): another program wrote it.");
    }
  }

  /** The last message of each of `topics` at `time`, as `{ topic, schema, bytes, logTime }`. */
  async at(time, topics = this.topics) {
    const found = await Promise.all(topics.map((topic) => this.lastOf(topic, time)));
    return found.filter((message) => message !== undefined);
  }

  async lastOf(topic, time) {
    if (LASTING.test(topic)) return this.lastingOf(topic, time);
    for (const chunk of this.chunksOf(topic).filter(({ start }) => start <= time).reverse()) {
      const messages = (await this.messagesOf(chunk)).get(topic) ?? [];
      const message = messages.findLast(({ logTime }) => logTime <= time);
      if (message) return message;
    }
    return undefined;
  }

  // What lasts is said once or twice, far from what is looked at, so it is held by itself. A skin that is described only
  // later is still the one on which earlier images lie.
  async lastingOf(topic, time) {
    if (!this.heldLasting.has(topic)) this.heldLasting.set(topic, this.allOf(topic));
    const messages = await this.heldLasting.get(topic);
    return messages.findLast(({ logTime }) => logTime <= time) ?? messages[0];
  }

  async allOf(topic) {
    const all = [];
    for (const chunk of this.chunksOf(topic)) all.push(...((await this.messagesOf(chunk)).get(topic) ?? []));
    return all;
  }

  /** The time of the frame of any skin after `time`, or before it; `undefined` at the end. */
  async neighbour(time, isForward) {
    const times = await Promise.all(this.frameTopics.map((topic) => this.neighbourOf(topic, time, isForward)));
    const found = times.filter((time) => time !== undefined).sort((a, b) => Number(a - b));
    return found.at(isForward ? 0 : -1);
  }

  // Where no images were recorded, frames are their contacts.
  get frameTopics() {
    const recorded = (end) => this.topics.filter((topic) => topic.endsWith(end) && this.chunksOf(topic).length > 0);
    const images = recorded("/image");
    return images.length > 0 ? images : recorded("/contacts");
  }

  async neighbourOf(topic, time, isForward) {
    const chunks = this.chunksOf(topic).filter(({ start, end }) => (isForward ? end > time : start < time));
    for (const chunk of isForward ? chunks : chunks.reverse()) {
      const messages = (await this.messagesOf(chunk)).get(topic) ?? [];
      const next = isForward
        ? messages.find(({ logTime }) => logTime > time)
        : messages.findLast(({ logTime }) => logTime < time);
      if (next) return next.logTime;
    }
    return undefined;
  }

  /** All messages of `topics` in the order of time, chunk by chunk; chunks that are read for it are not held. */
  async *walk(topics) {
    for (const chunk of this.chunks) {
      const messages = await (this.held.get(chunk) ?? this.readMessages(chunk));
      yield topics.flatMap((topic) => messages.get(topic) ?? []).sort((a, b) => Number(a.logTime - b.logTime));
    }
  }

  channelsOf(topics) {
    return [...this.channels.values()].filter((channel) => topics.includes(channel.topic));
  }

  chunksOf(topic) {
    const ids = this.channelsOf([topic]).map((channel) => channel.id);
    return this.chunks.filter((chunk) => ids.some((id) => chunk.channelIds.has(id)));
  }

  // Messages of a chunk by topic, in the order of time. The newest few chunks are held.
  messagesOf(chunk) {
    const held = this.held.get(chunk);
    const messages = held ?? this.readMessages(chunk);
    this.held.delete(chunk);
    this.held.set(chunk, messages);
    if (this.held.size > CHUNKS_HELD) this.held.delete(this.held.keys().next().value);
    return messages;
  }

  async readMessages(chunk) {
    const byTopic = new Map();
    for (const record of await this.recordsOf(chunk)) {
      if (record.type !== "Message") continue;
      const channel = this.channels.get(record.channelId);
      if (!channel) continue;
      const { topic, schemaId } = channel;
      const message = { topic, schema: this.schemaText(schemaId), bytes: record.data, logTime: record.logTime };
      if (!byTopic.has(topic)) byTopic.set(topic, []);
      byTopic.get(topic).push(message);
    }
    for (const messages of byTopic.values()) messages.sort((a, b) => Number(a.logTime - b.logTime));
    return byTopic;
  }

  // A chunk may hold messages of channels that an earlier one describes: they are told to the reader first.
  async recordsOf({ offset, length }) {
    const records = new McapRecordBuilder();
    for (const schema of this.schemas.values()) records.writeSchema(schema);
    for (const channel of this.index.channels.values()) records.writeChannel(channel);
    return recordsIn([records.buffer, await bytesOf(this.blob, offset, length)]);
  }

  schemaText(schemaId) {
    return new TextDecoder().decode(this.schemas.get(schemaId)?.data);
  }
}

// Spaces of the skins whose images or contacts are in a file, in its order.
function spacesOf({ channels, schemas }) {
  const shown = [...channels.values()].flatMap(({ topic, schemaId }) => {
    const end = SHOWN[schemas.get(schemaId)?.name];
    return end && topic.endsWith(end) ? [topic.slice(1, -end.length)] : [];
  });
  return [...new Set(shown)];
}

async function checkMagic(blob) {
  if (blob.size === 0) throw new Error("The file is empty.");
  const start = await bytesOf(blob, 0, Math.min(blob.size, MAGIC.length));
  if (MAGIC.some((byte, i) => start[i] !== byte)) {
    throw new Error("The file is not MCAP. Recordings of `dermatome view` end in .mcap.");
  }
}

// The index at the file's end; `undefined` where it has none, as when the file was cut.
async function readIndex(blob) {
  const readable = {
    size: async () => BigInt(blob.size),
    read: (offset, length) => bytesOf(blob, Number(offset), Number(length)),
  };
  try {
    const reader = await McapIndexedReader.Initialize({ readable });
    // A chunk without messages holds channels only, and no times.
    const withMessages = reader.chunkIndexes.filter((chunk) => chunk.messageIndexOffsets.size > 0);
    const chunks = withMessages.map((chunk) => ({
      offset: Number(chunk.chunkStartOffset),
      length: Number(chunk.chunkLength),
      start: chunk.messageStartTime,
      end: chunk.messageEndTime,
      channelIds: new Set(chunk.messageIndexOffsets.keys()),
    }));
    const isUsable = reader.channelsById.size > 0 && chunks.every(({ channelIds }) => channelIds.size > 0);
    return isUsable ? { chunks, schemas: reader.schemasById, channels: reader.channelsById, isCut: false } : undefined;
  } catch {
    return undefined;
  }
}

// Walks the file from record to record and reads each chunk once, up to the last one that is whole.
async function makeIndex(blob, onProgress) {
  const index = { chunks: [], schemas: new Map(), channels: new Map(), isCut: true };
  let offset = MAGIC.length;
  while (offset + RECORD_HEADER <= blob.size) {
    const header = viewOf(await bytesOf(blob, offset, RECORD_HEADER));
    const length = RECORD_HEADER + Number(header.getBigUint64(1, true));
    if (offset + length > blob.size) break;
    if (header.getUint8(0) === CHUNK && !(await addChunk(index, blob, offset, length))) break;
    offset += length;
    onProgress(offset / blob.size);
  }
  return index;
}

// False where the chunk is damaged: nothing behind it is trusted.
async function addChunk(index, blob, offset, length) {
  const bytes = await bytesOf(blob, offset, length);
  if (length < RECORD_HEADER + CHUNK_HEADER) return false;
  const times = viewOf(bytes.subarray(RECORD_HEADER, RECORD_HEADER + 16));
  const known = new McapRecordBuilder();
  for (const channel of index.channels.values()) known.writeChannel(channel);
  const channelIds = new Set();
  try {
    for (const record of recordsIn([known.buffer, bytes])) {
      if (record.type === "Schema") index.schemas.set(record.id, record);
      if (record.type === "Channel") index.channels.set(record.id, record);
      if (record.type === "Message") channelIds.add(record.channelId);
    }
  } catch {
    return false;
  }
  const [start, end] = [times.getBigUint64(0, true), times.getBigUint64(8, true)];
  if (channelIds.size > 0) index.chunks.push({ offset, length, start, end, channelIds });
  return true;
}

function recordsIn(parts) {
  const reader = new McapStreamReader({ noMagicPrefix: true, decompressHandlers });
  for (const part of parts) reader.append(part);
  const records = [];
  for (let record; (record = reader.nextRecord()); ) records.push(record);
  return records;
}

async function bytesOf(blob, offset, length) {
  return new Uint8Array(await blob.slice(offset, offset + length).arrayBuffer());
}

function viewOf(bytes) {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}
