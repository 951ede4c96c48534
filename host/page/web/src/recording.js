// A recording, an MCAP file of the topics: which chunks it has, and what each topic last said at any moment. Chunks are
// read when they are needed. Of a file that was cut, the index is made anew up to the last whole chunk.

import { McapIndexedReader, McapRecordBuilder, McapStreamReader } from "@mcap/core";

import { decompressFrame } from "./lz4.js";
import { TOPIC } from "./messages.js";

// Topics of one of several skins are named after its space; the page knows those of a single skin.
const SINGLE = "/dermatome/";
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
  const recording = new Recording(blob, name, index);
  recording.check();
  return recording;
}

class Recording {
  // Chunks: `[{ offset, length, start, end, channelIds }]` by time, times in ns. All is of the skin in `space`.
  constructor(blob, name, index, space = spacesOf(index)[0]) {
    const { chunks, schemas, channels, isCut } = index;
    Object.assign(this, { blob, name, index, space, chunks, schemas, isCut });
    this.chunks.sort((a, b) => Number(a.start - b.start));
    this.channels = new Map([...channels].flatMap(([id, channel]) => ofSpace(channel, space).map((named) => [id, named])));
    this.held = new Map();
  }

  /** Spaces of the skins that are in the file. */
  get spaces() {
    return spacesOf(this.index);
  }

  /** The same file, of another of its skins. */
  of(space) {
    return new Recording(this.blob, this.name, this.index, space);
  }

  get start() {
    return this.chunks[0].start;
  }

  get end() {
    return this.chunks.reduce((end, chunk) => (chunk.end > end ? chunk.end : end), this.start);
  }

  /** Length in seconds. */
  get duration() {
    return Number(this.end - this.start) / 1e9;
  }

  check() {
    if (this.chunks.length === 0) {
      throw new Error("The recording is empty: it was cut before its first chunk was written, or nothing was recorded.");
    }
    if (this.space === undefined) {
      throw new Error("The file holds no images or contacts of a skin (no topic /dermatome/image): another program wrote it.");
    }
  }

  /** The last message of each of `topics` at `time`, as `{ topic, schema, bytes, logTime }`. */
  async at(time, topics) {
    const found = await Promise.all(topics.map((topic) => this.lastOf(topic, time)));
    return found.filter((message) => message !== undefined);
  }

  // A skin that is described only later is still the one on which earlier images lie.
  async lastOf(topic, time) {
    const chunks = this.chunksOf(topic);
    for (const chunk of chunks.filter(({ start }) => start <= time).reverse()) {
      const messages = (await this.messagesOf(chunk)).get(topic) ?? [];
      const message = messages.findLast(({ logTime }) => logTime <= time);
      if (message) return message;
    }
    if (topic !== TOPIC.skin || chunks.length === 0) return undefined;
    return (await this.messagesOf(chunks[0])).get(topic)?.[0];
  }

  /** The time of the frame after `time`, or before it; `undefined` at the end. */
  async neighbour(time, isForward) {
    const topic = this.chunksOf(TOPIC.image).length > 0 ? TOPIC.image : TOPIC.contacts;
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

  /** All messages of `topics`, chunk by chunk; chunks that are read for it are not held. */
  async *walk(topics) {
    for (const chunk of this.chunks) {
      const messages = await (this.held.get(chunk) ?? this.readMessages(chunk));
      yield topics.flatMap((topic) => messages.get(topic) ?? []);
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

// A channel of the skin in `space`, named as that of a single skin; none where it is of another skin, or of all.
function ofSpace(channel, space) {
  const start = `/${space}/`;
  return channel.topic.startsWith(start) ? [{ ...channel, topic: SINGLE + channel.topic.slice(start.length) }] : [];
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
