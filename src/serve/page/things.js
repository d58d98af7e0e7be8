// Models, meshes and fields, whether they went up or were made by a job; and what belongs beside each.
import { isOwn } from "./catalogue.js";

const MODELS = ["step", "stp", "iges", "igs", "brep", "egads"];
const SURFACES = ["stl", "obj", "ply"];
const MESHES = ["meshb", "mesh", "su2", "vtu", "vtk", "msh", "msh2", "cgns", "xdmf", "xmf", "ugrid", "inp", "nas", "bdf"];
const FIELDS = ["solb", "sol", "csv", "dat"];

export const endingOf = (name) => name.slice(name.lastIndexOf(".") + 1).toLowerCase();
export const stemOf = (name) => name.slice(0, name.lastIndexOf(".") < 0 ? undefined : name.lastIndexOf(".")).replace(/\.(b8|lb8)$/, "");

export function kindOf(name) {
  const ending = endingOf(name);
  if (MODELS.includes(ending)) return "model";
  if (SURFACES.includes(ending)) return "surface";
  if (MESHES.includes(ending)) return "mesh";
  return FIELDS.includes(ending) ? "field" : "other";
}

/** A thing: {key, id, name, kind, job}; job is null for what went up. */
const thing = (id, name, job) => ({ key: (job ? job.id + "/" : "") + name + "/" + id.slice(0, 12), id, name, kind: kindOf(name), job });

/** What a job has made: its mesh first. */
export function madeBy(catalogue, job) {
  return (catalogue.results.get(job.id) || []).map((result) => thing(result.id, result.name, job));
}

export const meshOf = (catalogue, job) => madeBy(catalogue, job).find((one) => one.kind === "mesh") || null;
export const ofFile = (file) => thing(file.id, file.name, null);

/** All things of these kinds: results first, the newest first, then what went up. */
export function thingsOf(catalogue, kinds) {
  const made = catalogue.list().filter((job) => !isOwn(job)).flatMap((job) => madeBy(catalogue, job));
  return [...made, ...catalogue.files.map(ofFile)].filter((one) => kinds.includes(one.kind));
}

/** Whether names can lie beside a thing; other formats have them inside. */
export const takesNames = (one) => one.kind === "model" || ["mesh", "meshb"].includes(endingOf(one.name));

/** The names file that a thing has or would get: of a model its whole name with more, of a mesh as the viewer says. */
export const namesFileOf = (one) => (one.kind === "model" ? one.name : stemOf(one.name)) + ".names.json";

/** Names and contents of the files that a command shall find: the thing, its names, its metric. */
export function filesOf(catalogue, one) {
  const stem = stemOf(one.name), there = one.job ? catalogue.results.get(one.job.id) || [] : catalogue.files;
  const endings = one.kind === "mesh" ? ["solb", "sol", "h5", "mapbc"] : [];
  const names = takesNames(one) ? [`${stem}.names.json`, `${one.name}.names.json`] : [];
  const wanted = [...endings.map((ending) => `${stem}.${ending}`), ...names];
  const files = {};
  // The newest comes first in a list, so it is the one that stays.
  for (const file of [...there].reverse()) if (wanted.includes(file.name)) files[file.name] = file.id;
  const own = catalogue.names.get(one.id);
  if (own) files[own.name] = own.id;
  return { ...files, [one.name]: one.id };
}

/** The model that a job's mesh lies on: one that it made (a far field, a healed one), or that it read. */
export function modelOf(catalogue, job) {
  const made = madeBy(catalogue, job).find((one) => one.kind === "model");
  if (made) return made;
  const read = Object.entries(job.request.files || {}).find(([name]) => kindOf(name) === "model");
  return read ? thingsOf(catalogue, ["model"]).find((one) => one.id === read[1]) || null : null;
}

/** A name that nothing has yet: wing, wing-2, wing-3, … */
export function freeName(catalogue, stem, ending) {
  const taken = new Set(thingsOf(catalogue, ["mesh"]).map((one) => stemOf(one.name)));
  catalogue.list().filter((job) => job.label).forEach((job) => taken.add(stemOf(job.label)));
  const base = stem.replace(/-\d+$/, "");
  for (let number = 1; ; number++) {
    const name = number === 1 ? base : `${base}-${number}`;
    if (!taken.has(name)) return `${name}.${ending}`;
  }
}
