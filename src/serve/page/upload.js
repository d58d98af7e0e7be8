// Files on their way to the service: small ones in one go, large ones in pieces (tus 1.0.0), each of which may be tried again.
import { ask, transmit } from "./service.js";

/** Bytes of a piece, and above which there are pieces. */
const PIECE = 32 << 20;

/** Most bytes of a name. */
const LONGEST = 90;

/** How often a piece is tried. */
const TRIES = 5;

/** A name that the service takes: letters, digits and a few signs. */
export function plainName(name) {
  const plain = name.replace(/[^\p{L}\p{N}._\-+ ()=,]/gu, "_").replace(/^[.\- ]+/, "").replace(/[ .]+$/, "");
  // What is made of it has longer names.
  let cut = plain;
  while (new TextEncoder().encode(cut).length > LONGEST) cut = cut.slice(1);
  return cut || "file";
}

/** Uploads a file; `went(share)` tells how far it is. Returns the file as the service knows it. */
export async function upload(blob, name, went = () => {}) {
  const query = "?name=" + encodeURIComponent(plainName(name));
  // Asks for a token first, where one is wanted.
  await ask("GET", "/v1/me");
  if (blob.size <= PIECE) {
    const answer = await transmit("POST", "/v1/files" + query, blob, { "Content-Type": "application/octet-stream" }, (sent) => went(sent / (blob.size || 1)));
    return JSON.parse(answer.text);
  }
  return inPieces(blob, query, went);
}

async function inPieces(blob, query, went) {
  const tus = { "Tus-Resumable": "1.0.0" };
  const begun = await transmit("POST", "/v1/uploads" + query, null, { ...tus, "Upload-Length": String(blob.size) }, () => {});
  const path = begun.header("Location");
  let at = 0, tries = 0;
  for (;;) {
    try {
      const piece = blob.slice(at, at + PIECE);
      const headers = { ...tus, "Upload-Offset": String(at), "Content-Type": "application/offset+octet-stream" };
      const answer = await transmit("PATCH", path, piece, headers, (sent) => went((at + sent) / blob.size));
      if (answer.status === 200) return JSON.parse(answer.text);
      [at, tries] = [Number(answer.header("Upload-Offset")), 0];
    } catch (error) {
      if (++tries === TRIES || ![0, 408, 409, 429].includes(error.status)) throw error;
      await new Promise((resolve) => setTimeout(resolve, 1000 * tries));
      const offset = await transmit("HEAD", path, null, tus, () => {}).catch(() => null);
      if (offset) at = Number(offset.header("Upload-Offset"));
    }
  }
}
