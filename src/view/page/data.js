// From the text of the page to typed arrays.

const WIDTHS = { u8: 1, u16: 2, u32: 4, f32: 4 };
const BLOCK = 1 << 20;

/** The bytes of a line of base64. */
function bytesOf(line) {
  const text = atob(line), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** The bytes of a zlib stream. */
async function expanded(bytes) {
  if (typeof DecompressionStream === "undefined") return inflate(bytes, BLOCK);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The arrays by their names, each {rows, columns, values}, values row by row. */
async function readArrays(entries, text) {
  const total = entries.reduce((sum, e) => sum + e.rows * e.columns * WIDTHS[e.kind], 0);
  const bytes = new Uint8Array(total);
  const lines = text.split("\n").filter((line) => line.length > 0);
  await Promise.all(lines.map(async (line, i) => bytes.set(await expanded(bytesOf(line)), i * BLOCK)));
  const arrays = {};
  let at = 0;
  for (const entry of entries) {
    const size = entry.rows * entry.columns * WIDTHS[entry.kind];
    arrays[entry.name] = { rows: entry.rows, columns: entry.columns, values: unpacked(entry, bytes.subarray(at, at + size)) };
    at += size;
  }
  return arrays;
}

/** The values of an array, whose columns are one after the other, each as its lowest bytes, the next ones, and so on. */
function unpacked({ kind, rows, columns, delta }, bytes) {
  if (kind === "u8") return bytes.slice();
  const words = kind === "u16" ? new Uint16Array(rows * columns) : new Uint32Array(rows * columns);
  const width = WIDTHS[kind];
  for (let column = 0; column < columns; column++) {
    const start = column * width * rows;
    let before = 0;
    for (let row = 0; row < rows; row++) {
      let word = bytes[start + row] | (bytes[start + rows + row] << 8);
      if (width === 4) word |= (bytes[start + 2 * rows + row] << 16) | (bytes[start + 3 * rows + row] << 24);
      if (delta) word = before = (before + ((word >>> 1) ^ -(word & 1))) | 0;
      words[row * columns + column] = word;
    }
  }
  return kind === "f32" ? new Float32Array(words.buffer) : words;
}
