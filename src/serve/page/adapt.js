// Which mesh is adapted to what: the words of `adapt`, and of `field evaluate` before it where the field is a function.
import { filesOf, freeName, stemOf } from "./things.js";
import { options, split } from "./words.js";

/** What each kind of metric asks for, by the names of the fields. */
const ASKS = {
  size: ["size"],
  analytic: ["analytic", "target", "unit"],
  function: ["function", "target", "unit", "norm"],
  field: ["file", "target", "unit", "norm"],
  metric: ["file", "target", "unit"],
};

/** Shows the fields that the chosen kind of metric has. */
export function arrange({ elements }) {
  const wanted = ASKS[elements.by.value];
  for (const name of ["size", "analytic", "function", "file", "target", "unit", "norm"]) elements[name].closest("label").hidden = !wanted.includes(name);
  elements.file.closest("label").querySelector("span").textContent = elements.by.value === "metric" ? "The metric" : "The field";
  elements.target.placeholder = elements.by.value === "metric" ? "as it is" : "5000";
}

/** The steps that the form asks for, and what is missing. */
export function steps(form, catalogue, mesh, { model, field }) {
  if (!mesh) return { steps: [], missing: "Make a first mesh, or upload a mesh." };
  const value = (name) => form.elements[name].value.trim();
  const by = value("by"), output = value("output") || freeName(catalogue, stemOf(mesh.name), "meshb");
  const asks = (name) => ASKS[by].includes(name);
  if (asks("file") && !field) return { steps: [], missing: "Upload the field or the metric: .sol, .solb, .csv or .dat with a value at each vertex of the mesh." };
  if (by === "size" && !value("size")) return { steps: [], missing: "Give a size." };
  const target = value("target") || (by === "metric" ? "" : form.elements.target.placeholder);
  const chosen = { cad: model?.name };
  const before = [];
  let files = { ...(model ? filesOf(catalogue, model) : {}), ...filesOf(catalogue, mesh) };
  const own = by === "function" ? `${stemOf(mesh.name)}-${value("function")}.solb` : "";
  if (by === "size") chosen.size = value("size");
  if (by === "analytic") chosen.analytic = value("analytic");
  if (by === "function") {
    before.push({ command: "field evaluate", words: [mesh.name, "--function", value("function"), "-o", own], files: filesOf(catalogue, mesh), output: own });
    chosen.field = own;
  }
  if (asks("file")) {
    chosen[by] = field.name;
    files = { ...files, ...filesOf(catalogue, field) };
  }
  if (asks("target")) chosen[value("unit")] = target;
  if (asks("norm")) chosen.norm = value("norm");
  for (const name of ["hmin", "hmax", "gradation"]) chosen[name] = value(name);
  const words = [mesh.name, "-o", output, ...options(chosen), ...split(value("more")), "--report", stemOf(output) + ".report.json"];
  return { steps: [...before, { command: "adapt", words, files, wants: own ? [own] : [], output }], missing: "" };
}
