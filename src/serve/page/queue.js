// The jobs: how far each is, and what can be done with what it made.
import { hasEnded, isOwn } from "./catalogue.js";
import { downloads } from "./downloads.js";
import { button, byId, carefulButton, grouped, make, seconds, say, update } from "./elements.js";
import { jobPath, textOf } from "./service.js";
import { meshOf } from "./things.js";

const STATES = { queued: "waits", running: "at work", done: "done", failed: "failed", cancelled: "cancelled" };

/** What a job says of its progress, in words. */
function progressOf(job) {
  const told = job.progress;
  if (job.state === "queued") return "waits for its turn";
  if (!told) return "begins";
  if (told.kind === "stage") return told.what;
  if (told.kind === "forecast") return `about ${grouped(told.vertices)} vertices, ${seconds(told.seconds)}`;
  const parts = [];
  if (told.vertices !== undefined) parts.push(`${grouped(told.vertices)}${told.expected ? " of about " + grouped(told.expected) : ""} vertices`);
  if (told.pass !== undefined) parts.push(`pass ${told.pass}${told.operation ? ", " + told.operation : ""}`);
  if (told.left !== undefined && told.left !== null) parts.push(`${seconds(told.left)} left`);
  return parts.join(" · ") || told.kind || "at work";
}

function titleOf(job) {
  if (job.label) return job.label;
  const words = Array.isArray(job.request.arguments) ? job.request.arguments : [];
  const at = words.findIndex((word) => word === "-o" || word === "--output");
  return at >= 0 ? words[at + 1] : job.request.arguments?.output || job.command;
}

/** `acts`: show(thing), compare(thing), use(thing). */
export function beginQueue(catalogue, acts) {
  catalogue.addEventListener("change", () => list(catalogue, acts));
  byId("own-jobs").onchange = () => list(catalogue, acts);
}

function list(catalogue, acts) {
  const isSeen = (job) => byId("own-jobs").checked || !isOwn(job);
  const jobs = catalogue.list().filter(isSeen);
  const lines = jobs.map((job) => {
    const made = catalogue.results.get(job.id);
    return [job.id, `${job.state} ${made ? made.length : ""}`, () => line(catalogue, job, acts)];
  });
  update(byId("jobs"), lines);
  // What changes often changes in place, so that the focus stays.
  for (const job of jobs) if (!hasEnded(job)) tell(job);
  const count = jobs.filter((job) => !hasEnded(job)).length;
  document.title = (count ? `(${count}) ` : "") + "geo-adapt workbench";
  byId("no-jobs").hidden = jobs.length > 0;
}

function tell(job) {
  const line = [...byId("jobs").children].find((one) => one.dataset.key === job.id);
  const bar = line.querySelector("progress"), share = job.progress?.share;
  line.querySelector(".told").textContent = progressOf(job);
  if (typeof share === "number") bar.value = share;
  else bar.removeAttribute("value");
}

function line(catalogue, job, { show, compare, use }) {
  const title = titleOf(job), mesh = hasEnded(job) ? meshOf(catalogue, job) : null;
  const named = (text, act, part) => button(text, act, { "data-part": part, "aria-label": `${text}: ${title}` });
  const state = make("span", { className: "state " + job.state, textContent: STATES[job.state] });
  const head = make("p", { className: "head" }, make("strong", { textContent: title }), " ", make("small", { textContent: job.command }), state);
  if (!hasEnded(job)) {
    const bar = make("progress", { max: 1, "aria-label": "Progress of " + title });
    return make("li", {}, head, bar, make("p", { className: "told" }), make("span", { className: "buttons" }, named("Cancel", () => catalogue.cancel(job.id), "cancel")), logOf(job, title));
  }
  return make("li", {}, head,
    job.reason && make("p", { className: "reason", textContent: job.reason }),
    make("span", { className: "buttons" },
      mesh && named("Show", () => show(mesh), "show"),
      mesh && named("Compare", () => compare(mesh), "compare"),
      mesh && named("Adapt", () => use(mesh), "use"),
      carefulButton("Remove", title, async () => {
        await catalogue.removeJob(job.id);
        say(title + " was removed.");
      }, { "data-part": "remove" })),
    (catalogue.results.get(job.id) || []).length > 0 && downloads(catalogue, job, mesh, title),
    logOf(job, title));
}

/** What the job printed, read when it is opened. */
function logOf(job, title) {
  const text = make("pre", { tabIndex: 0, "aria-label": "What the program printed for " + title });
  const details = make("details", { "data-part": "log", ontoggle: async () => {
    if (!details.open) return;
    const printed = await textOf("GET", jobPath(job.id, "log")).catch((error) => error.message);
    const figures = hasEnded(job) ? await textOf("GET", jobPath(job.id, "results", "printed.txt")).catch(() => "") : "";
    text.textContent = [printed, figures].filter((one) => one.trim()).join("\n") || "nothing";
  } }, make("summary", { textContent: "What it printed" }), text);
  return details;
}
