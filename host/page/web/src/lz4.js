// Decompresses the LZ4 frame format, as in https://github.com/lz4/lz4/blob/dev/doc/lz4_Frame_format.md and
// lz4_Block_format.md. Checksums are skipped: the chunks of an MCAP file have a CRC of their own.

const MAGIC = 0x184d2204;
const IS_STORED = 0x80000000;
const LEAST_MATCH = 4;

/** The `size` bytes in the frame `source`. Throws where the frame is damaged or of another length. */
export function decompressFrame(source, size) {
  const view = new DataView(source.buffer, source.byteOffset, source.byteLength);
  const target = new Uint8Array(size);
  const flags = readHeader(view);
  let at = headerLength(flags);
  let end = 0;
  for (;;) {
    const word = view.getUint32(at, true);
    at += 4;
    if (word === 0) break;
    const length = word & ~IS_STORED;
    const block = source.subarray(at, at + length);
    if (block.length !== length) throw new Error("LZ4: the last block is cut");
    end = word & IS_STORED ? store(block, target, end) : decompressBlock(block, target, end);
    at += length + (flags.hasBlockSum ? 4 : 0);
  }
  if (end !== size) throw new Error(`LZ4: ${end} bytes where ${size} are expected`);
  return target;
}

function readHeader(view) {
  if (view.getUint32(0, true) !== MAGIC) throw new Error("LZ4: not a frame");
  const flags = view.getUint8(4);
  if (flags >> 6 !== 1) throw new Error("LZ4: a version that is not known");
  if (flags & 1) throw new Error("LZ4: a dictionary is needed");
  return { hasBlockSum: (flags & 0x10) !== 0, hasSize: (flags & 0x08) !== 0 };
}

// Magic, flags, block size, content size where there is one, and the header's checksum.
function headerLength({ hasSize }) {
  return 4 + 2 + (hasSize ? 8 : 0) + 1;
}

function store(block, target, end) {
  if (end + block.length > target.length) throw new Error("LZ4: more bytes than expected");
  target.set(block, end);
  return end + block.length;
}

// Sequences of literals and a match that repeats earlier output; the last one has no match.
function decompressBlock(block, target, end) {
  let at = 0;
  const readLength = (length) => {
    if (length !== 15) return length;
    let byte;
    do {
      if (at >= block.length) throw new Error("LZ4: a length is cut");
      length += byte = block[at++];
    } while (byte === 255);
    return length;
  };
  while (at < block.length) {
    const token = block[at++];
    const literals = readLength(token >> 4);
    if (at + literals > block.length) throw new Error("LZ4: literals are cut");
    end = store(block.subarray(at, at + literals), target, end);
    at += literals;
    if (at === block.length) break;
    if (at + 2 > block.length) throw new Error("LZ4: an offset is cut");
    const offset = block[at] | (block[at + 1] << 8);
    at += 2;
    end = repeat(target, end, offset, readLength(token & 15) + LEAST_MATCH);
  }
  return end;
}

// A match may overlap its own output, which repeats it.
function repeat(target, end, offset, length) {
  if (offset === 0 || offset > end) throw new Error("LZ4: a match before the start");
  if (end + length > target.length) throw new Error("LZ4: more bytes than expected");
  if (offset >= length) {
    target.copyWithin(end, end - offset, end - offset + length);
  } else {
    for (let i = 0; i < length; i++) target[end + i] = target[end + i - offset];
  }
  return end + length;
}
