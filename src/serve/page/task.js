// The form for what is to be done next, the same for a shell and for Python, and its start.
import * as adapt from "./adapt.js";
import * as bootstrap from "./bootstrap.js";
import { attempt, byId, make, say } from "./elements.js";
import { modelOf, thingsOf } from "./things.js";
import { python, shell } from "./words.js";

/** Fills a select with things; the one that was chosen stays so, while it is there. */
function offer(select, things, none) {
  const before = select.value;
  const text = (one) => (one.job ? `${one.name} (made ${new Date(one.job.created).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" })})` : one.name);
  const lines = [...(none ? [["", none]] : []), ...things.map((one) => [one.key, text(one)])];
  const state = JSON.stringify(lines);
  if (select.dataset.state === state) return;
  select.dataset.state = state;
  select.replaceChildren(...lines.map(([value, textContent]) => make("option", { value, textContent })));
  if (lines.some(([value]) => value === before)) select.value = before;
}

const chosen = (select, things) => things.find((one) => one.key === select.value) || null;

export class Task {
  /** `started(job)` is called for each job that is started. */
  constructor(catalogue, started) {
    Object.assign(this, { catalogue, started, isBusy: false });
    this.forms = { bootstrap: byId("bootstrap"), adapt: byId("adapt") };
    for (const radio of document.querySelectorAll("[name=what]")) radio.onchange = () => this.show();
    for (const form of Object.values(this.forms)) {
      form.oninput = () => this.show();
      form.onsubmit = (event) => {
        event.preventDefault();
        attempt(() => this.start());
      };
    }
    this.forms.adapt.elements.mesh.addEventListener("change", () => this.chooseModel());
    for (const [id, of] of [["copy-shell", "shell"], ["copy-python", "python"]]) byId(id).onclick = () => attempt(() => copy(byId(of).textContent));
    catalogue.addEventListener("change", () => this.show());
  }

  get what() {
    return document.querySelector("[name=what]:checked").value;
  }

  things() {
    const of = (...kinds) => thingsOf(this.catalogue, kinds);
    const went = (kind) => of(kind).filter((one) => !one.job), made = of("model").filter((one) => one.job);
    const fields = [...went("field"), ...of("field").filter((one) => one.job)];
    return { sources: [...went("model"), ...went("surface"), ...went("mesh"), ...made], meshes: of("mesh"), models: of("model"), fields };
  }

  /** Goes on with a thing: a model is meshed, a mesh adapted. */
  use(one) {
    const isSource = one.kind !== "mesh";
    document.querySelector(`[name=what][value=${isSource ? "bootstrap" : "adapt"}]`).checked = true;
    this.show();
    const { bootstrap: first, adapt: second } = this.forms;
    if (isSource) first.elements.model.value = one.key;
    else {
      second.elements.mesh.value = one.key;
      this.chooseModel();
    }
    this.show();
  }

  /** The model of the chosen mesh, where it is known. */
  chooseModel() {
    const { mesh, model } = this.forms.adapt.elements;
    const one = chosen(mesh, this.things().meshes);
    if (one?.job) model.value = modelOf(this.catalogue, one.job)?.key || "";
    this.show();
  }

  asked() {
    const { sources, meshes, models, fields } = this.things();
    const form = this.forms[this.what], of = form.elements;
    if (this.what === "bootstrap") return bootstrap.steps(form, this.catalogue, chosen(of.model, sources));
    return adapt.steps(form, this.catalogue, chosen(of.mesh, meshes), { model: chosen(of.model, models), field: chosen(of.file, fields) });
  }

  show() {
    const { sources, meshes, models, fields } = this.things();
    const { bootstrap: first, adapt: second } = this.forms;
    first.hidden = this.what !== "bootstrap";
    second.hidden = !first.hidden;
    offer(first.elements.model, sources);
    const mesh = second.elements.mesh.value;
    offer(second.elements.mesh, meshes);
    offer(second.elements.model, models, "none: the mesh's own surface");
    offer(second.elements.file, fields);
    bootstrap.arrange(first, chosen(first.elements.model, sources));
    adapt.arrange(second);
    if (second.elements.mesh.value !== mesh && second.elements.mesh.value) return this.chooseModel();
    const { steps, missing } = this.asked();
    for (const form of Object.values(this.forms)) form.elements.start.disabled = this.isBusy || steps.length === 0;
    byId("missing").textContent = missing;
    byId("elsewhere").hidden = steps.length === 0;
    byId("shell").textContent = shell(steps);
    byId("python").textContent = python(steps, location.origin);
    return undefined;
  }

  /** Starts what the form asks for, a step after the other. */
  async start() {
    const { steps, missing } = this.asked();
    if (missing) throw new Error(missing);
    const form = this.forms[this.what];
    const made = {};
    this.isBusy = true;
    this.show();
    // Names are made anew for the next one.
    form.elements.output.value = "";
    try {
      for (const step of steps) {
        const wanted = Object.fromEntries((step.wants || []).map((name) => [name, made[name]]));
        const job = await this.catalogue.start({ ...step, files: { ...step.files, ...wanted } }, step.output);
        say(`${step.command} has started: ${step.output}`);
        this.started(job);
        if (step === steps.at(-1)) break;
        const end = await this.catalogue.whenEnded(job.id);
        if (end?.state !== "done") return;
        for (const result of this.catalogue.results.get(job.id)) made[result.name] = result.id;
      }
    } finally {
      this.isBusy = false;
      this.show();
    }
  }
}

async function copy(text) {
  if (navigator.clipboard) await navigator.clipboard.writeText(text);
  else {
    // Without https there is no clipboard but this.
    const area = make("textarea", { value: text, className: "unseen" });
    document.body.append(area);
    area.select();
    const isDone = document.execCommand("copy");
    area.remove();
    if (!isDone) throw new Error("The browser does not let this page copy: select the text, and copy it by hand.");
  }
  say("Copied.");
}
