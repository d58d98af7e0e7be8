// The files that went up: dropped or chosen, listed, shown, removed.
import { attempt, button, byId, bytes, carefulButton, complain, make, say, update } from "./elements.js";
import { kindOf, ofFile } from "./things.js";
import { upload } from "./upload.js";

const KINDS = { model: "CAD model", surface: "surface", mesh: "mesh", field: "field or metric", other: "beside others" };

/** `open(thing)` shows one, and goes on with it. */
export function beginShelf(catalogue, open) {
  const input = byId("file");
  const take = (files) => attempt(() => takeIn(catalogue, [...files], open));
  input.onchange = async () => {
    const files = [...input.files];
    await take(files);
    input.value = "";
  };
  // Files may be dropped anywhere: else the browser would leave the page for them.
  const drag = (isOn) => document.body.classList.toggle("dragging", isOn);
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    drag(true);
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) drag(false);
  });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    drag(false);
    if (event.dataTransfer.files.length) take(event.dataTransfer.files);
  });
  catalogue.addEventListener("change", () => list(catalogue, open));
}

async function takeIn(catalogue, files, open) {
  const bar = byId("sent"), taken = [];
  bar.hidden = false;
  try {
    for (const file of files) {
      say(`Uploading ${file.name}, ${bytes(file.size)} …`);
      bar.setAttribute("aria-label", "Upload of " + file.name);
      const known = await upload(file, file.name, (share) => { bar.value = share; });
      catalogue.addFile(known);
      taken.push(ofFile(known));
      say(`${known.name} is there.`);
    }
  } catch (error) {
    complain(`${files[taken.length]?.name}: ${error.message}`);
  } finally {
    bar.hidden = true;
  }
  const first = ["model", "surface", "mesh"].map((kind) => taken.find((one) => one.kind === kind)).find(Boolean);
  if (first) await open(first);
}

function list(catalogue, open) {
  const lines = catalogue.files.map((file) => {
    const one = ofFile(file), isSeen = ["model", "surface", "mesh"].includes(one.kind);
    const build = () => make("li", {},
      make("span", { className: "name", textContent: file.name }),
      make("small", { textContent: `${KINDS[kindOf(file.name)]}, ${bytes(file.bytes)}` }),
      make("span", { className: "buttons" },
        isSeen && button("Open", () => open(one), { "data-part": "open", "aria-label": "Open " + file.name }),
        make("a", { href: `/v1/files/${file.id}/content`, download: file.name, textContent: "Download", "aria-label": "Download " + file.name, "data-part": "get" }),
        carefulButton("Remove", file.name, () => catalogue.removeFile(file.id), { "data-part": "remove" })));
    return [file.id, file.name, build];
  });
  update(byId("files"), lines);
  byId("no-files").hidden = lines.length > 0;
}
