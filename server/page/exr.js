// SPDX-License-Identifier: MIT
// Reads the EXR files that sheaf writes: one part, scanlines; half, float and uint channels; compressed by what browsers
// can undo (deflate) or hardly at all. PIZ and DWA would need decoders of their own: such frames are downloaded.

const SCANLINES = { 0: 1, 1: 1, 2: 1, 3: 16 };  // of a block, by compression
const COMPRESSIONS = ["none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"];

const damaged = () => new Error("The EXR file is damaged.");

/** Gives { width, height, channels: { name: Float32Array }, attributes: { name: text } }, rows from the top. */
async function readExr(buffer) {
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== 20000630) throw new Error("This is no EXR file.");
  if (view.getUint32(4, true) & 0x1200) throw new Error("Tiled and deep EXR files are not shown here.");
  const header = readHeader(view);
  if (!(header.compression in SCANLINES)) {
    const name = COMPRESSIONS[header.compression] ?? header.compression;
    throw new Error(`The layers of a frame compressed with ${name} are not shown in the browser: download it.`);
  }
  const { width, height } = header;
  const channels = Object.fromEntries(header.channels.map(({ name }) => [name, new Float32Array(width * height)]));
  const rows = SCANLINES[header.compression];
  const blocks = Array.from({ length: Math.ceil(height / rows) }, (_, i) => Number(view.getBigUint64(header.end + 8 * i, true)));
  await Promise.all(blocks.map(async (offset) => {
    const top = view.getInt32(offset, true) - header.top;
    const packed = new Uint8Array(buffer, offset + 8, view.getUint32(offset + 4, true));
    const count = Math.min(rows, height - top);
    const size = count * width * header.channels.reduce((sum, { type }) => sum + (type === 1 ? 2 : 4), 0);
    spread(await unpack(packed, size, header.compression), header, channels, top, count);
  }));
  return { width, height, channels, attributes: header.attributes };
}

function readHeader(view) {
  let at = 8;
  const text = () => {
    let read = "";
    while (view.getUint8(at)) read += String.fromCharCode(view.getUint8(at++));
    at += 1;
    return read;
  };
  const header = { attributes: {}, channels: [], compression: 0, width: 0, height: 0, top: 0, end: 0 };
  while (view.getUint8(at)) {
    const [name, type, size] = [text(), text(), view.getUint32(at, true)];
    at += 4;
    const begin = at;
    if (type === "chlist") {
      while (view.getUint8(at)) {
        header.channels.push({ name: text(), type: view.getUint32(at, true) });
        at += 16;
      }
    } else if (name === "compression") header.compression = view.getUint8(at);
    else if (name === "dataWindow") {
      const [left, top, right, bottom] = [0, 4, 8, 12].map((step) => view.getInt32(begin + step, true));
      Object.assign(header, { width: right - left + 1, height: bottom - top + 1, top });
    } else if (type === "string") header.attributes[name] = new TextDecoder().decode(new Uint8Array(view.buffer, begin, size));
    at = begin + size;
  }
  header.end = at + 1;
  if (!(header.width > 0 && header.height > 0 && header.width * header.height <= 2 ** 27)) throw new Error("The EXR file's size makes no sense.");
  return header;
}

async function unpack(packed, size, compression) {
  if (compression === 0 || packed.length === size) return packed;  // what would grow is stored as it is
  const whole = unweave(compression === 1 ? runs(packed, size) : await inflate(packed));
  if (whole.length !== size) throw damaged();
  return whole;
}

/** From differences of neighbours, all first halves of the pairs before all second ones. */
function unweave(raw) {
  for (let i = 1; i < raw.length; i += 1) raw[i] = raw[i - 1] + raw[i] - 128;
  const whole = new Uint8Array(raw.length);
  const half = (raw.length + 1) >> 1;
  for (let i = 0; i < raw.length; i += 1) whole[i] = raw[(i >> 1) + (i & 1 ? half : 0)];
  return whole;
}

async function inflate(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function runs(packed, size) {
  const raw = new Uint8Array(size);
  let to = 0;
  for (let at = 0; at < packed.length;) {
    const count = (packed[at] << 24) >> 24;
    at += 1;
    if (count < 0) {
      raw.set(packed.subarray(at, at - count), to);
      at -= count;
      to -= count;
    } else {
      raw.fill(packed[at], to, to + count + 1);
      at += 1;
      to += count + 1;
    }
  }
  return raw;
}

/** Puts a block's lines, channel after channel within each, where they belong. */
function spread(data, header, channels, top, count) {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  let at = 0;
  for (let row = top; row < top + count; row += 1) {
    for (const { name, type } of header.channels) {
      const into = channels[name];
      for (let i = row * header.width; i < (row + 1) * header.width; i += 1) {
        if (type === 1) into[i] = halves()[view.getUint16(at, true)];
        else into[i] = type === 2 ? view.getFloat32(at, true) : view.getUint32(at, true);
        at += type === 1 ? 2 : 4;
      }
    }
  }
}

let halfTable = null;

/** All 65536 halves as floats. */
function halves() {
  if (halfTable) return halfTable;
  halfTable = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits += 1) {
    const [exponent, fraction] = [(bits >> 10) & 31, bits & 1023];
    const size = exponent === 31 ? (fraction ? NaN : Infinity)
      : exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * (fraction / 1024);
    halfTable[bits] = bits & 32768 ? -size : size;
  }
  return halfTable;
}
