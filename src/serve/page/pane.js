// A view: a page of `view` in a frame of its own without rights, and what it tells of clicks, names and the camera.
import { complain, make, say } from "./elements.js";
import { resultPath } from "./service.js";
import { filesOf, namesFileOf, stemOf, takesNames } from "./things.js";
import { upload } from "./upload.js";

/** Longest name that is taken from a frame or a user. */
const LONGEST = 100;

export class Pane {
  /** In an element of the page; `told(pane, message)` gets what concerns others. */
  constructor(catalogue, element, told) {
    Object.assign(this, { catalogue, element, told, thing: null, job: null, frame: null, picked: null, saving: Promise.resolve() });
    const part = (name) => element.querySelector(`[data-of=${name}]`);
    Object.assign(this, { title: part("title"), stage: part("stage"), face: part("face"), number: part("number"), name: part("name") });
    part("close").onclick = () => {
      this.clear();
      told(this, { kind: "closed" });
    };
    this.face.onsubmit = (event) => {
      event.preventDefault();
      this.send({ kind: "name", reference: this.picked, name: this.name.value.trim() });
      say(`Face ${this.picked} is called ${this.name.value.trim() || "nothing"}.`);
    };
    this.name.maxLength = LONGEST;
    window.addEventListener("message", (event) => {
      // Whoever else sends something is not heard.
      if (this.frame && event.source === this.frame.contentWindow) this.hear(event.data);
    });
  }

  clear() {
    // A view that waits for its turn is not wanted any more.
    if (this.job?.state === "queued") this.catalogue.cancel(this.job.id).catch(() => {});
    this.frame?.remove();
    Object.assign(this, { thing: null, job: null, frame: null, picked: null });
    this.element.hidden = true;
    this.face.hidden = true;
  }

  /** Shows a model or a mesh. What comes later than another wish is not shown. */
  async show(thing) {
    this.clear();
    this.thing = thing;
    this.element.hidden = false;
    this.title.textContent = thing.name;
    this.stage.replaceChildren(make("p", { className: "wait", textContent: "The view is being made …" }));
    this.stage.setAttribute("aria-busy", "true");
    try {
      const page = stemOf(thing.name) + ".html";
      const job = await this.catalogue.have({ command: "view", words: [thing.name, "-o", page], files: filesOf(this.catalogue, thing) }, (known) => {
        if (this.thing !== thing) return;
        this.job = known;
        this.stage.firstChild.textContent = known.state === "queued" ? "The view waits for its turn …" : "The view is being made …";
      });
      if (this.thing !== thing) return;
      if (!this.catalogue.made(job, page)) throw new Error(job.reason || "It cannot be shown.");
      this.job = job;
      this.frame = make("iframe", { title: "View of " + thing.name, src: resultPath(job.id, page) });
      this.frame.setAttribute("sandbox", "allow-scripts allow-downloads");
      this.stage.replaceChildren(this.frame);
    } catch (error) {
      if (this.thing !== thing) return;
      this.stage.replaceChildren(make("p", { className: "wait", textContent: error.message }));
      complain(`${thing.name}: ${error.message}`);
    } finally {
      if (this.thing === thing) this.stage.removeAttribute("aria-busy");
    }
  }

  /** To the frame, which has no origin that could be named. */
  send(message) {
    this.frame?.contentWindow?.postMessage({ geoAdapt: message }, "*");
  }

  hear(data) {
    const told = data?.geoAdapt;
    if (typeof told !== "object" || told === null) return;
    if (told.kind === "picked") this.pick(told);
    else if (told.kind === "names" && told.content && typeof told.content === "object") this.keep(told);
    else if (["look", "ready", "dragging"].includes(told.kind)) this.told(this, told);
  }

  pick({ reference, name }) {
    this.picked = Number.isInteger(reference) ? reference : null;
    this.face.hidden = this.picked === null || !takesNames(this.thing);
    if (this.picked === null) return;
    this.number.textContent = String(this.picked);
    this.name.value = typeof name === "string" ? name.slice(0, LONGEST) : "";
  }

  /** Names go up as the file beside the model or the mesh. */
  keep({ content, reference, name }) {
    if (reference === this.picked && typeof name === "string") this.name.value = name.slice(0, LONGEST);
    const { thing, catalogue } = this, file = namesFileOf(thing);
    if (!takesNames(thing)) return complain(`${thing.name} has its names inside: change them there.`);
    const blob = new Blob([JSON.stringify(content, null, 2) + "\n"], { type: "application/json" });
    this.saving = this.saving.then(async () => {
      const old = catalogue.names.get(thing.id);
      const known = await upload(blob, file);
      catalogue.names.set(thing.id, { name: file, id: known.id });
      catalogue.addFile({ ...known, name: file });
      if (old && old.id !== known.id && catalogue.files.some((one) => one.id === old.id)) await catalogue.removeFile(old.id).catch(() => {});
      say(`Names are kept: ${file}`);
    }).catch((error) => complain(`The names were not kept: ${error.message}`));
    return undefined;
  }
}
