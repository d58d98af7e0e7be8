// What the service has for us: files, jobs with their results; and jobs that are asked for and followed.
import { ask, jobPath, resultPath } from "./service.js";

/** The label of jobs that the workbench needs for itself: pages, figures, conversions. Those of another version of the program are made anew. */
const OWN = "workbench";
export const isOwn = (job) => job.label.split(" ")[0] === OWN;

/** How many jobs are followed by a stream each: a browser has six connections to a server. */
const STREAMS = 3;

/** Milliseconds between looks at jobs that no stream tells of. */
const LOOK = 2000;

/** Seconds that a job took. */
export const took = (job) => (job.started && job.ended ? (job.ended - job.started) / 1000 : NaN);

export const hasEnded = (job) => !["queued", "running"].includes(job.state);

/** Files and jobs; tells `change`, and `end` with a job. */
export class Catalogue extends EventTarget {
  constructor() {
    super();
    this.files = [];
    this.jobs = new Map();
    this.results = new Map();
    this.streams = new Map();
    /** Names files that were made here, by the contents that they are of. */
    this.names = new Map();
    this.timer = 0;
    this.ownLabel = OWN;
  }

  changed() {
    this.dispatchEvent(new Event("change"));
  }

  /** Looks at all anew; the program has this version. */
  async load(version) {
    this.ownLabel = `${OWN} ${version}`;
    const [files, jobs] = await Promise.all([ask("GET", "/v1/files"), ask("GET", "/v1/jobs?limit=200")]);
    this.files = files;
    const seen = new Set(jobs.map((job) => job.id));
    for (const id of this.jobs.keys()) if (!seen.has(id)) this.jobs.delete(id);
    jobs.forEach((job) => this.note(job));
    await this.loadResults();
    this.changed();
    this.watch();
  }

  /** The jobs, the newest first. */
  list() {
    return [...this.jobs.values()].sort((a, b) => (a.id < b.id ? 1 : -1));
  }

  /** What jobs have made that have ended, a few at a time. */
  async loadResults() {
    const wanted = this.list().filter((job) => hasEnded(job) && !this.results.has(job.id)).map((job) => job.id);
    const next = async () => {
      for (let id = wanted.shift(); id; id = wanted.shift()) await this.loadResult(id);
    };
    await Promise.all([next(), next(), next()]);
  }

  async loadResult(id) {
    const made = await ask("GET", jobPath(id, "results")).catch((error) => (error.status === 404 ? [] : null));
    if (made) this.results.set(id, made);
  }

  /** Takes over what the service says of a job. */
  note(job) {
    const before = this.jobs.get(job.id);
    // A stream and a look may tell out of order.
    if (before && hasEnded(before) && !hasEnded(job)) return;
    this.jobs.set(job.id, job);
  }

  /** Follows the jobs that have not ended. */
  watch() {
    const open = this.list().filter((job) => !hasEnded(job)).reverse();
    for (const job of open) if (this.streams.size < STREAMS && !this.streams.has(job.id)) this.stream(job.id);
    clearTimeout(this.timer);
    if (open.some((job) => !this.streams.has(job.id))) this.timer = setTimeout(() => this.look(), LOOK);
  }

  stream(id) {
    const source = new EventSource(jobPath(id, "events"));
    this.streams.set(id, source);
    const close = () => {
      source.close();
      if (this.streams.get(id) === source) this.streams.delete(id);
    };
    source.addEventListener("progress", (event) => {
      this.note(JSON.parse(event.data));
      this.changed();
    });
    source.addEventListener("end", (event) => {
      close();
      this.ended(JSON.parse(event.data));
    });
    source.onerror = () => {
      close();
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.look(), LOOK);
    };
  }

  /** Looks at jobs without a stream. */
  async look() {
    try {
      for (const job of await ask("GET", "/v1/jobs?limit=200")) {
        const before = this.jobs.get(job.id);
        if (before && !hasEnded(before) && hasEnded(job)) await this.ended(job);
        else this.note(job);
      }
    } catch { /* the next look may succeed */ }
    this.changed();
    this.watch();
  }

  async ended(job) {
    if (this.results.has(job.id) && hasEnded(this.jobs.get(job.id) || {})) return;
    await this.loadResult(job.id);
    if (!this.results.has(job.id)) this.results.set(job.id, []);
    this.note(job);
    this.changed();
    this.dispatchEvent(new CustomEvent("end", { detail: job }));
    this.watch();
  }

  /** Asks for a job: {command, words, files}. */
  async start({ command, words, files }, label = "") {
    const job = await ask("POST", "/v1/jobs", { command, arguments: words, files, label });
    this.note(job);
    this.changed();
    this.watch();
    return job;
  }

  /** The job when it has ended; `told(job)` hears of it before. */
  whenEnded(id, told = () => {}) {
    return new Promise((resolve) => {
      const look = () => {
        const job = this.jobs.get(id);
        if (job && !(hasEnded(job) && this.results.has(id))) return told(job);
        this.removeEventListener("change", look);
        return resolve(job || null);
      };
      this.addEventListener("change", look);
      look();
    });
  }

  /** A job of the workbench's own: one that is there already, or a new one; when it has ended. */
  async have(request, told) {
    const keyOf = (command, words, files) => JSON.stringify([command, words, Object.entries(files).sort()]);
    const wanted = keyOf(request.command, request.words, request.files);
    const is = (job) => job.label === this.ownLabel && ["queued", "running", "done"].includes(job.state) && keyOf(job.command, job.request.arguments, job.request.files) === wanted;
    const job = this.list().find(is) || await this.start(request, this.ownLabel);
    const end = await this.whenEnded(job.id, told);
    if (!end) throw new Error("The job was removed.");
    if (!this.results.get(end.id)?.length) throw new Error(end.reason || "The job has made nothing.");
    return end;
  }

  /** What a job has made by this name. */
  made(job, name) {
    return (this.results.get(job.id) || []).find((result) => result.name === name) || null;
  }

  async readJson(job, name) {
    return ask("GET", resultPath(job.id, name));
  }

  async cancel(id) {
    this.note(await ask("POST", jobPath(id, "cancel")));
    this.changed();
    this.watch();
  }

  /** Forgets a job, and what was made of its results for the workbench alone. */
  async removeJob(id) {
    const ids = new Set((this.results.get(id) || []).map((result) => result.id));
    await ask("DELETE", jobPath(id));
    this.jobs.delete(id);
    this.results.delete(id);
    await this.removeOwn(ids);
    this.changed();
  }

  async removeFile(id) {
    await ask("DELETE", "/v1/files/" + id);
    this.files = this.files.filter((file) => file.id !== id);
    await this.removeOwn(new Set([id]));
    this.changed();
  }

  /** Forgets the workbench's own jobs on contents that are gone. */
  async removeOwn(ids) {
    const own = this.list().filter((job) => isOwn(job) && hasEnded(job) && Object.values(job.request.files).some((file) => ids.has(file)));
    for (const job of own) await this.removeJob(job.id).catch(() => {});
  }

  addFile(file) {
    this.files = [file, ...this.files.filter((one) => one.id !== file.id)];
    this.changed();
  }
}
