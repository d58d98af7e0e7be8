// RFC 1950 and 1951, for browsers without DecompressionStream.

/** The lengths and distances of RFC 1951, 3.2.5: first value and extra bits of each code. */
function steps(first, groups, each) {
  const base = [], extra = [];
  let value = first;
  for (let bits = 0; bits < groups; bits++) {
    for (let i = 0; i < (bits === 0 ? 2 * each : each); i++) {
      base.push(value);
      extra.push(bits);
      value += 1 << bits;
    }
  }
  return { base, extra };
}

const LENGTHS = steps(3, 6, 4);
// The last length has a code of its own, without extra bits.
LENGTHS.base[28] = 258;
LENGTHS.extra[28] = 0;
const DISTANCES = steps(1, 14, 2);

/** A Huffman code from the lengths of its words: how many there are of each length, and the symbols in order. */
function huffman(lengths) {
  const counts = new Uint16Array(16), starts = new Uint16Array(16), symbols = new Uint16Array(lengths.length);
  for (const length of lengths) counts[length]++;
  counts[0] = 0;
  for (let i = 1; i < 15; i++) starts[i + 1] = starts[i] + counts[i];
  lengths.forEach((length, symbol) => { if (length) symbols[starts[length]++] = symbol; });
  return { counts, symbols };
}

const FIXED = [
  huffman(Array.from({ length: 288 }, (_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8))),
  huffman(new Array(30).fill(5)),
];

/** The bytes of a zlib stream, which are at most `size`. */
function inflate(bytes, size) {
  const out = new Uint8Array(size);
  let at = 2, end = 0, hold = 0, held = 0;
  const bits = (count) => {
    while (held < count) {
      hold |= bytes[at++] << held;
      held += 8;
    }
    const value = hold & ((1 << count) - 1);
    hold >>>= count;
    held -= count;
    return value;
  };
  const symbol = ({ counts, symbols }) => {
    let code = 0, first = 0, index = 0;
    for (let length = 1; length < 16; length++) {
      code |= bits(1);
      const count = counts[length];
      if (code - count < first) return symbols[index + code - first];
      index += count;
      first = (first + count) << 1;
      code <<= 1;
    }
    throw new Error("the data of the page are damaged");
  };
  const dynamic = () => {
    const [literals, distances, words] = [bits(5) + 257, bits(5) + 1, bits(4) + 4];
    const order = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
    const lengths = new Array(19).fill(0);
    for (let i = 0; i < words; i++) lengths[order[i]] = bits(3);
    const code = huffman(lengths), all = [];
    while (all.length < literals + distances) {
      const word = symbol(code);
      if (word < 16) all.push(word);
      else {
        const value = word === 16 ? all[all.length - 1] : 0;
        const times = word === 16 ? 3 + bits(2) : word === 17 ? 3 + bits(3) : 11 + bits(7);
        for (let i = 0; i < times; i++) all.push(value);
      }
    }
    return [huffman(all.slice(0, literals)), huffman(all.slice(literals))];
  };
  for (let last = 0; !last;) {
    last = bits(1);
    const kind = bits(2);
    if (kind === 0) {
      hold = held = 0;
      const count = bytes[at] | (bytes[at + 1] << 8);
      out.set(bytes.subarray(at + 4, at + 4 + count), end);
      at += 4 + count;
      end += count;
      continue;
    }
    const [literals, distances] = kind === 1 ? FIXED : dynamic();
    for (let word = symbol(literals); word !== 256; word = symbol(literals)) {
      if (word < 256) {
        out[end++] = word;
        continue;
      }
      const length = LENGTHS.base[word - 257] + bits(LENGTHS.extra[word - 257]);
      const far = symbol(distances);
      const from = end - DISTANCES.base[far] - bits(DISTANCES.extra[far]);
      for (let i = 0; i < length; i++) out[end + i] = out[from + i];
      end += length;
    }
  }
  return out.subarray(0, end);
}
