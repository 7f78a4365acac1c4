// SPDX-License-Identifier: MIT
// EXR's DWAA and DWAB: colour as cosines of 8 x 8 pixels, quantised by what the eye sees; the rest run-length coded or deflated.

const [AS_COSINES, AS_RUNS] = [1, 2];  // how a channel is packed; else deflated

async function unpackDwa(packed, header, rows) {
  const view = viewOf(packed);
  const [version, , otherPacked, acPacked, dcPacked, runsPacked, , runsSize, acCount, , acWay] =
    Array.from({ length: 11 }, (_, i) => Number(view.getBigUint64(8 * i, true)));
  if (version < 2) throw new Error("This DWA file is of an old version.");
  let at = 88 + view.getUint16(88, true);
  const channels = classify(header.channels, readRules(packed, 90, at));
  const part = (size) => packed.subarray(at, (at += size));
  const others = part(otherPacked);
  const [ac, dc, runLengths] = [part(acPacked), part(dcPacked), part(runsPacked)];
  const source = {
    ac: !acPacked ? [] : acWay ? wordsOf(await inflate(ac)) : unpackHuffman(ac, acCount), acAt: 0,
    dc: dcPacked ? wordsOf(unweave(await inflate(dc))) : [], dcAt: 0,
    runs: runsPacked ? runs(await inflate(runLengths), runsSize) : null, runsAt: 0,
    others: otherPacked ? await inflate(others) : null, othersAt: 0,
  };
  const area = { width: header.width, rows };
  for (const colour of coloursOf(channels)) decodeCosines(colour, source, area);
  for (const channel of channels) if (!channel.bytes) decodeAlone(channel, source, area);
  return asLines(channels, area);
}

const wordsOf = (bytes) => new Uint16Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + (bytes.length & ~1)));

/** Which channels are packed how: by the last part of the name, and the type. */
function readRules(packed, begin, end) {
  const rules = [];
  for (let at = begin; at < end;) {
    let name = "";
    while (packed[at]) name += String.fromCharCode(packed[at++]);
    const [bits, type] = [packed[at + 1], packed[at + 2]];
    rules.push({ name, type, part: (bits >> 4) - 1, way: (bits >> 2) & 3, anyCase: bits & 1 });
    at += 3;
  }
  return rules;
}

function classify(channels, rules) {
  return channels.map((channel) => {
    const dot = channel.name.lastIndexOf(".");
    const [prefix, name] = [channel.name.slice(0, dot + 1), channel.name.slice(dot + 1)];
    const rule = rules.find((each) => each.type === channel.type &&
      (each.anyCase ? each.name.toLowerCase() === name.toLowerCase() : each.name === name));
    return { ...channel, prefix, part: rule?.part ?? -1, way: rule?.way ?? 0, size: channel.type === 1 ? 2 : 4, bytes: null };
  });
}

/** Red, green and blue of one prefix, which were turned into luminance and two differences together. */
function coloursOf(channels) {
  const prefixes = [...new Set(channels.map(({ prefix }) => prefix))];
  return prefixes.map((prefix) => [0, 1, 2].map((part) => channels.find((each) => each.prefix === prefix && each.part === part)))
    .filter((three) => three.every(Boolean));
}

function decodeAlone(channel, source, { width, rows }) {
  const count = width * rows;
  if (channel.way === AS_COSINES) return decodeCosines([channel], source, { width, rows });
  const size = count * channel.size;
  const [from, begin] = channel.way === AS_RUNS ? [source.runs, source.runsAt] : [source.others, source.othersAt];
  if (!from || begin + size > from.length) throw damaged();
  if (channel.way === AS_RUNS) {  // all first bytes, then all second ones
    channel.bytes = new Uint8Array(size);
    for (let i = 0; i < size; i += 1) channel.bytes[(i % count) * channel.size + Math.floor(i / count)] = from[begin + i];
    source.runsAt += size;
  } else {
    channel.bytes = from.subarray(begin, begin + size);
    source.othersAt += size;
  }
}

/** One channel, or three: squares of 8 x 8 in rows; the outermost ones reach beyond the picture. */
function decodeCosines(group, source, { width, rows }) {
  const [across, down] = [Math.ceil(width / 8), Math.ceil(rows / 8)];
  const planes = group.map(({ type }) => (type === 1 ? new Uint16Array(width * rows) : new Float32Array(width * rows)));
  for (let square = 0; square < across * down; square += 1) {
    const pixels = group.map((_, i) => decodeSquare(source, source.dcAt + i * across * down + square));
    if (group.length === 3) toRedGreenBlue(pixels);
    const [left, top] = [8 * (square % across), 8 * Math.floor(square / across)];
    group.forEach((channel, i) => {
      for (let y = top; y < Math.min(top + 8, rows); y += 1) {
        for (let x = left; x < Math.min(left + 8, width); x += 1) {
          const bits = toHalf(pixels[i][8 * (y - top) + x - left]);
          const light = channel.linear && group.length === 1 ? bits : linearHalves()[bits];
          planes[i][y * width + x] = channel.type === 1 ? light : halves()[light];
        }
      }
    });
  }
  source.dcAt += group.length * across * down;
  group.forEach((channel, i) => { channel.bytes = new Uint8Array(planes[i].buffer); });
}

// Place k of a square's coefficients, from slow to fast along its diagonals.
const ZIGZAG = Array.from({ length: 64 }, (_, i) => i).sort((a, b) => {
  const [first, second] = [a, b].map((i) => (i >> 3) + (i & 7));
  return first - second || (first & 1 ? a - b : b - a);
});
const COSINES = Array.from({ length: 64 }, (_, i) => {  // [8 frequency + place]
  const [frequency, place] = [i >> 3, i & 7];
  return (frequency ? 0.5 : Math.SQRT1_2 / 2) * Math.cos(((2 * place + 1) * frequency * Math.PI) / 16);
});

function decodeSquare(source, dc) {
  const waves = new Float32Array(64);
  waves[0] = halves()[source.dc[dc]];
  let flat = true;
  for (let k = 1; k < 64;) {
    const word = source.ac[source.acAt++];
    if (word === undefined) throw damaged();
    if (word === 0xff00) break;  // zeros to the end
    if (word >> 8 === 0xff) k += word & 255;
    else { waves[ZIGZAG[k++]] = halves()[word]; flat = false; }
  }
  return flat ? waves.fill(waves[0] / 8) : along(along(waves));
}

/** Sums the waves of each row, and turns rows into columns. */
function along(waves) {
  const out = new Float32Array(64);
  for (let row = 0; row < 8; row += 1) {
    for (let place = 0; place < 8; place += 1) {
      let sum = 0;
      for (let frequency = 0; frequency < 8; frequency += 1) sum += waves[8 * row + frequency] * COSINES[8 * frequency + place];
      out[8 * place + row] = sum;
    }
  }
  return out;
}

function toRedGreenBlue([one, two, three]) {
  for (let i = 0; i < 64; i += 1) {
    const [luma, blue, red] = [one[i], two[i], three[i]];
    one[i] = luma + 1.5747 * red;
    two[i] = luma - 0.1873 * blue - 0.4682 * red;
    three[i] = luma + 1.8556 * blue;
  }
}

let linearTable = null;

/** From the curve by which values were quantised to light, for each half: a power to 1, exponential beyond. */
function linearHalves() {
  linearTable ??= Uint16Array.from(halves(), (value) => {
    if (!Number.isFinite(value)) return 0;
    const size = Math.abs(value);
    return toHalf(Math.sign(value) * (size <= 1 ? size ** 2.2 : Math.E ** (2.2 * (size - 1))));
  });
  return linearTable;
}

const floatBits = new DataView(new ArrayBuffer(4));

/** The nearest half's bits; of two, the even one. */
function toHalf(value) {
  floatBits.setFloat32(0, value);
  const bits = floatBits.getUint32(0);
  const sign = (bits >>> 16) & 0x8000;
  const exponent = ((bits >>> 23) & 255) - 112;
  if (exponent >= 31) return sign | (exponent === 143 && bits & 0x7fffff ? 0x7e00 : 0x7c00);
  const drop = exponent > 0 ? 13 : 14 - exponent;  // bits of the fraction that a half has not
  if (drop > 24) return sign;
  const whole = exponent > 0 ? (exponent << 23) | (bits & 0x7fffff) : (bits & 0x7fffff) | 0x800000;
  const [kept, rest, middle] = [whole >>> drop, whole & ((1 << drop) - 1), 1 << (drop - 1)];
  return sign | (kept + (rest > middle || (rest === middle && kept & 1) ? 1 : 0));
}

function asLines(channels, { width, rows }) {
  const out = new Uint8Array(width * rows * channels.reduce((sum, { size }) => sum + size, 0));
  for (let row = 0, to = 0; row < rows; row += 1) {
    for (const { bytes, size } of channels) {
      out.set(bytes.subarray(row * width * size, (row + 1) * width * size), to);
      to += width * size;
    }
  }
  return out;
}
