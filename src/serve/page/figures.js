// The figures of what is shown, side by side: how large, how good, and how the qualities are spread.
import { took } from "./catalogue.js";
import { byId, grouped, make, percent, seconds, short } from "./elements.js";
import { endingOf, filesOf, stemOf } from "./things.js";

const reports = new Map();

/** The statistics of a mesh: of its job's report, or of an inspection. */
export async function figuresOf(catalogue, thing) {
  if (thing.kind !== "mesh") return null;
  const report = thing.job && catalogue.made(thing.job, stemOf(thing.name) + ".report.json");
  const key = report ? report.id : thing.key;
  if (!reports.has(key)) reports.set(key, report ? readReport(catalogue, thing, report) : inspect(catalogue, thing));
  try {
    return await reports.get(key);
  } catch {
    reports.delete(key);
    return null;
  }
}

async function readReport(catalogue, thing, { name }) {
  const { statistics, fidelity } = await catalogue.readJson(thing.job, name);
  return { ...statistics, fidelity, seconds: took(thing.job) };
}

async function inspect(catalogue, thing) {
  const files = filesOf(catalogue, thing), report = stemOf(thing.name) + ".report.json";
  const metric = endingOf(thing.name).startsWith("mesh") && thing.job ? Object.keys(files).find((name) => name.endsWith(".solb")) : undefined;
  const words = [thing.name, ...(metric ? ["--metric", metric] : []), "--report", report];
  const job = await catalogue.have({ command: "inspect", words, files });
  return catalogue.readJson(job, report);
}

/** Rows of the table: what, and how it is read and written. */
const ROWS = [
  ["vertices", (of) => grouped(of.vertices)],
  ["tetrahedra", (of) => grouped(of.tets)],
  ["triangles on the boundary", (of) => grouped(of.triangles)],
  ["complexity", (of) => (of.metric ? grouped(of.metric.complexity) : "–")],
  ["unit edges (1/√2 to √2)", (of) => percent(of.metric?.unit_edges)],
  ["mean ratio, least", (of) => short(of.mean_ratios?.min)],
  ["mean ratio, mean", (of) => short(of.mean_ratios?.mean)],
  ["edge length, least", (of) => short(of.edge_lengths?.min)],
  ["edge length, greatest", (of) => short(of.edge_lengths?.max)],
  ["volume", (of) => short(of.volume)],
  ["farthest from the model", (of) => short(of.fidelity?.from_model?.distance)],
  ["worst normal deviation", (of) => (of.fidelity?.worst_normal ? short(of.fidelity.worst_normal.degrees) + "°" : "–")],
  ["seconds", (of) => seconds(of.seconds)],
];

/** Shows the figures of one or two: [{name, of}]. */
export function showFigures(all) {
  const known = all.filter((one) => one.of);
  byId("figures").hidden = known.length === 0;
  if (known.length === 0) return;
  const head = () => make("thead", {}, make("tr", {}, make("td", {}), ...known.map((one) => make("th", { scope: "col", textContent: one.name }))));
  const rows = ROWS.map(([name, text]) => [name, known.map(({ of }) => text(of))]).filter(([, texts]) => texts.some((text) => text !== "–"));
  const body = rows.map(([name, texts]) => make("tr", {}, make("th", { scope: "row", textContent: name }), ...texts.map((textContent) => make("td", { textContent }))));
  byId("sizes").replaceChildren(make("caption", { textContent: "Figures" }), head(), make("tbody", {}, ...body));
  const inWhat = known.every(({ of }) => of.metric) ? "in the metric" : known.some(({ of }) => of.metric) ? "in the metric, where there is one" : "in space";
  histogram(byId("ratios"), `Mean ratio of tetrahedra, ${inWhat}`, known.map((one) => one.of.mean_ratios), head);
  histogram(byId("lengths"), `Length of edges, ${inWhat}`, known.map((one) => one.of.edge_lengths), head);
}

const ends = ({ low, high }) => (low === null ? "≤ 0" : high === null ? `> ${short(low)}` : `${short(low)} – ${short(high)}`);

/** A histogram as a table: a class a row, a bar and a share for each mesh. */
function histogram(table, name, all, head) {
  const classes = all.find((one) => one?.classes?.length)?.classes || [];
  const share = (one, i) => (one?.count ? (one.classes?.[i]?.count || 0) / one.count : 0);
  const shown = classes.flatMap((one, i) => (all.some((of) => of?.classes?.[i]?.count) ? [i] : []));
  table.hidden = shown.length === 0;
  const most = Math.max(...shown.flatMap((i) => all.map((one) => share(one, i))), 1e-9);
  const cell = (one, i) => {
    const bar = make("i", { "aria-hidden": "true" });
    bar.style.width = `${(100 * share(one, i)) / most}%`;
    return make("td", { className: "bar" }, bar, make("span", { textContent: percent(share(one, i)), title: grouped(one?.classes?.[i]?.count || 0) }));
  };
  table.replaceChildren(make("caption", { textContent: name }), head(), make("tbody", {},
    ...shown.map((i) => make("tr", {}, make("th", { scope: "row", textContent: ends(classes[i]) }), ...all.map((one) => cell(one, i))))));
}
