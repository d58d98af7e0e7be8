// What a job made, as files; its mesh in the format of another program.
import { attempt, bytes, make, say } from "./elements.js";
import { resultPath } from "./service.js";
import { endingOf, filesOf, stemOf } from "./things.js";

/** Endings that `convert` writes as files, and who reads them. */
const FORMATS = [
  ["meshb", "Medit, libMeshb"], ["mesh", "Medit, text"], ["vtu", "ParaView"], ["vtk", "VTK, legacy"], ["xdmf", "FEniCSx"], ["xmf", "XDMF, meshio"], ["msh", "gmsh 4.1"], ["msh2", "gmsh 2.2"],
  ["su2", "SU2"], ["cgns", "CGNS"], ["b8.ugrid", "FUN3D"], ["inp", "Abaqus, CalculiX"], ["bdf", "Nastran"], ["stl", "its surface, STL"], ["obj", "its surface, OBJ"], ["ply", "its surface, PLY"],
];

/** Has the browser save a result. */
function save(job, name) {
  const link = make("a", { href: resultPath(job.id, name), download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

export function downloads(catalogue, job, mesh, title) {
  const made = catalogue.results.get(job.id);
  const links = make("ul", { className: "links" }, ...made.map((result) => make("li", {},
    make("a", { href: resultPath(job.id, result.name), download: result.name, textContent: result.name, "data-part": "get " + result.name }), make("small", { textContent: bytes(result.bytes) }))));
  const details = make("details", { "data-part": "downloads" }, make("summary", { textContent: "Download", "aria-label": "Download " + title, "data-part": "download" }));
  if (mesh) details.append(converter(catalogue, job, mesh));
  details.append(links);
  return details;
}

function converter(catalogue, job, mesh) {
  const select = make("select", { name: "format", "data-part": "format" }, ...FORMATS.map(([value, about]) => make("option", { value, textContent: `.${value} – ${about}` })));
  const go = make("button", { type: "submit", textContent: "Download", "data-part": "convert" });
  const act = async () => {
    const ending = select.value, output = `${stemOf(mesh.name)}.${ending}`;
    if (ending === endingOf(mesh.name)) return save(job, mesh.name);
    go.disabled = true;
    say(`${output} is being written …`);
    try {
      const end = await catalogue.have({ command: "convert", words: [mesh.name, output], files: filesOf(catalogue, mesh) });
      const all = catalogue.results.get(end.id).filter((result) => !["printed.txt", "log.txt"].includes(result.name));
      if (end.state !== "done" || all.length === 0) throw new Error(end.reason || `${output} could not be written.`);
      all.forEach((result) => save(end, result.name));
      return say(`Downloaded: ${all.map((result) => result.name).join(", ")}`);
    } finally {
      go.disabled = false;
    }
  };
  return make("form", { className: "row", onsubmit: (event) => {
    event.preventDefault();
    attempt(act);
  } }, make("label", {}, make("span", { textContent: "Format" }), select), go);
}
