// SPDX-License-Identifier: MIT
// EXR's PIZ: values by their rank among those that occur, differences by Haar wavelets, Huffman codes.

const damaged = () => new Error("The EXR file is damaged.");

function viewOf(bytes) { return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength); }

/** A block of `rows` lines: first a bitmap of the values that occur, then the ranks, channel after channel. */
function unpackPiz(packed, header, rows) {
  const view = viewOf(packed);
  const [first, last] = [view.getUint16(0, true), view.getUint16(2, true)];
  if (last > 8191) throw damaged();
  const values = new Uint16Array(65536);
  let known = 1;  // zero always is
  let at = 4;
  for (let byte = first; byte <= last; byte += 1, at += 1) {
    for (let bit = 0; bit < 8; bit += 1) if ((packed[at] >> bit) & 1 && byte + bit) values[known++] = 8 * byte + bit;
  }
  const words = header.channels.map(({ type }) => (type === 1 ? 1 : 2));
  const lines = words.map((size) => size * header.width);  // words of a line
  const ranks = unpackHuffman(packed.subarray(at + 4, at + 4 + view.getInt32(at, true)), rows * lines.reduce((a, b) => a + b, 0));
  const begins = lines.map((_, i) => rows * lines.slice(0, i).reduce((a, b) => a + b, 0));
  words.forEach((size, channel) => {
    for (let word = 0; word < size; word += 1) {
      unmixPlane(ranks, { begin: begins[channel] + word, across: size, down: lines[channel], width: header.width, height: rows }, known <= 1 << 14);
    }
  });
  const out = new Uint16Array(ranks.length);
  for (let row = 0, to = 0; row < rows; row += 1) {
    for (let channel = 0; channel < words.length; channel += 1) {
      const from = begins[channel] + row * lines[channel];
      for (let i = 0; i < lines[channel]; i += 1) out[to++] = values[ranks[from + i]];
    }
  }
  return new Uint8Array(out.buffer);
}

/** Undoes the wavelets of one plane, from the coarsest squares to neighbours. `small`: ranks stay below 2^14. */
function unmixPlane(data, { begin, across, down, width, height }, small) {
  const unmix = small ? unmixSmall : unmixWrapped;
  let far = 1;
  while (2 * far <= Math.min(width, height)) far *= 2;
  for (let near = far >> 1; near >= 1; far = near, near >>= 1) {
    let y = 0;
    for (; y + far <= height; y += far) {
      let at = begin + y * down;
      let x = 0;
      for (; x + far <= width; x += far, at += far * across) {
        const [right, below] = [at + near * across, at + near * down];
        unmix(data, at, below);
        unmix(data, right, right + near * down);
        unmix(data, at, right);
        unmix(data, below, below + near * across);
      }
      if (width & near) unmix(data, at, at + near * down);  // a column without a neighbour
    }
    if (height & near) {
      for (let x = 0, at = begin + y * down; x + far <= width; x += far, at += far * across) unmix(data, at, at + near * across);
    }
  }
}

/** From mean and difference, as signed numbers, to the two values. */
function unmixSmall(data, low, high) {
  const difference = (data[high] << 16) >> 16;
  const first = ((data[low] << 16) >> 16) + (difference & 1) + (difference >> 1);
  data[low] = first;
  data[high] = first - difference;
}

/** The same modulo 2^16. */
function unmixWrapped(data, low, high) {
  const difference = data[high];
  data[high] = data[low] - (difference >> 1);
  data[low] = difference + data[high] - 32768;
}

const QUICK = 12;  // codes up to so many bits are looked up at once

/** `total` 16-bit values from canonical Huffman codes of 65537 symbols, of which the last used one repeats the value before. */
function unpackHuffman(packed, total) {
  const view = viewOf(packed);
  const [least, most, bits] = [0, 4, 12].map((at) => view.getUint32(at, true));
  if (least > 65536 || most > 65536) throw damaged();
  let at = 8 * 20;  // of the bit that comes next
  const take = (count) => {  // up to 12 of them
    const byte = at >> 3;
    const word = (packed[byte] << 16) | (packed[byte + 1] << 8) | packed[byte + 2];
    at += count;
    return (word >> (24 - (at - count & 7) - count)) & ((1 << count) - 1);
  };
  const codes = readCodes(take, least, most);
  at = (at + 7) & ~7;
  const end = at + bits;
  const out = new Uint16Array(total);
  let to = 0;
  while (at < end && to < total) {
    const entry = codes.quick[take(QUICK)];
    at -= QUICK;
    const symbol = entry ? entry >> 6 : longCode(codes, take);
    if (entry) at += entry & 63;
    if (symbol === most) {
      const count = take(8);
      out.fill(out[to - 1], to, to + count);
      to += count;
    } else out[to++] = symbol;
  }
  if (to !== total) throw damaged();
  return out;
}

/** The lengths of all codes give the codes: the longest are the least, and equally long ones follow their symbols. */
function readCodes(take, least, most) {
  const symbols = Array.from({ length: 59 }, () => []);
  for (let symbol = least; symbol <= most; symbol += 1) {
    const length = take(6);
    if (length === 63) symbol += take(8) + 5;  // that many, and this one, do not occur
    else if (length >= 59) symbol += length - 58;
    else if (length) symbols[length].push(symbol);
  }
  const first = new Array(59).fill(0);
  const quick = new Int32Array(1 << QUICK);  // 64 symbol + length; 0: a longer code
  for (let length = 58, code = 0; length >= 1; length -= 1) {
    first[length] = code;
    symbols[length].forEach((symbol, i) => {
      const step = 2 ** (QUICK - length);
      if (step >= 1) quick.fill(64 * symbol + length, (code + i) * step, (code + i + 1) * step);
    });
    code = Math.floor((code + symbols[length].length) / 2);
  }
  return { symbols, first, quick };
}

/** Bit by bit; a code of more than 52 bits would want more values than memory holds. */
function longCode({ symbols, first }, take) {
  for (let length = 1, code = 0; length <= 52; length += 1) {
    code = 2 * code + take(1);
    const index = code - first[length];
    if (index >= 0 && index < symbols[length].length) return symbols[length][index];
  }
  throw damaged();
}
