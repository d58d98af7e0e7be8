// The workbench: what its parts have to do with each other.
import { Catalogue, isOwn } from "./catalogue.js";
import { attempt, byId, bytes, complain, grouped, say } from "./elements.js";
import { figuresOf, showFigures } from "./figures.js";
import { Pane } from "./pane.js";
import { beginQueue } from "./queue.js";
import { ask } from "./service.js";
import { beginSession } from "./session.js";
import { beginShelf } from "./shelf.js";
import { Task } from "./task.js";
import { meshOf } from "./things.js";

const catalogue = new Catalogue();

/** Jobs that were started here, with what was seen then: their mesh is shown, unless the user has opened something else since. */
const started = new Map();

/** What a view tells: how it looks goes to the other one, so that the same is seen of both. */
function told(pane, message) {
  if (message.kind === "closed") return arrange();
  if (message.kind === "dragging") document.body.classList.add("dragging");
  const other = panes.find((one) => one !== pane);
  if (message.kind === "look" && other.thing && byId("together").checked) other.send(message);
  if (message.kind !== "ready") return undefined;
  pane.element.dataset.state = "ready";
  // A view beside the other is as large: it fits, and tells how it looks then.
  if (other.thing) panes[0].send({ kind: "fit" });
  return undefined;
}

const panes = ["first", "second"].map((id) => new Pane(catalogue, byId(id), told));

/** How many views there are, and their figures. */
async function arrange() {
  const shown = panes.filter((pane) => pane.thing);
  byId("views").dataset.count = shown.length;
  byId("empty").hidden = shown.length > 0;
  byId("joint").hidden = shown.length < 2;
  const wanted = shown.map((pane) => pane.thing);
  const all = await Promise.all(wanted.map(async (thing) => ({ name: thing.name, of: await figuresOf(catalogue, thing) })));
  const isStill = panes.filter((pane) => pane.thing).every((pane, i) => pane.thing === wanted[i]);
  if (isStill) showFigures(all);
}

async function show(pane, thing) {
  pane.element.dataset.state = "";
  const shown = pane.show(thing);
  await Promise.all([arrange(), shown]);
}

/** Shows in the first view; the views come into sight where the page is narrow. */
function showFirst(thing) {
  if (matchMedia("(max-width: 900px)").matches) byId("views").scrollIntoView();
  return show(panes[0], thing);
}

const compare = (thing) => show(panes[panes[0].thing ? 1 : 0], thing);

async function showUsage() {
  const me = await ask("GET", "/v1/me");
  byId("about").textContent = `${me.version} · ${me.owner === "local" ? "this machine" : me.owner} · ${bytes(me.bytes)} of ${bytes(me.most_bytes)}`;
  byId("about").title = `A job may make ${grouped(me.most_vertices)} vertices`;
  return me;
}

beginSession();
const task = new Task(catalogue, (job) => started.set(job.id, panes[0].thing));
const use = (thing) => {
  task.use(thing);
  say(`${thing.name} is chosen for the next step.`);
};
beginShelf(catalogue, (thing) => {
  task.use(thing);
  return showFirst(thing);
});
beginQueue(catalogue, { show: showFirst, compare, use });

catalogue.addEventListener("end", ({ detail: job }) => {
  showUsage().catch(() => {});
  if (isOwn(job)) return;
  if (job.state === "failed") complain(`${job.label || job.command}: ${job.reason || "failed"}`);
  else say(`${job.label || job.command} is ${job.state}.`);
  const mesh = meshOf(catalogue, job), isExpected = started.has(job.id) && started.get(job.id) === panes[0].thing;
  started.delete(job.id);
  if (!mesh || !isExpected) return;
  task.use(mesh);
  if (!panes[1].thing) attempt(() => show(panes[0], mesh));
});

byId("wrong-close").onclick = () => { byId("wrong").hidden = true; };
byId("skip").onclick = () => byId("views").focus();

task.show();
attempt(async () => {
  const { version } = await showUsage();
  await catalogue.load(version);
  document.body.dataset.state = "ready";
});
