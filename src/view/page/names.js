// Names of surfaces: typed in the list, saved as the names file beside the mesh or the model.

/** `typed(place, content)` is called when a name has changed, with what the file would have. Returns a function (reference, name) that changes one. */
function listenToNames(head, surfaces, typed) {
  const { file, names, fields } = head.names;
  const save = byId("save-names");
  const inputs = [...byId("surfaces").querySelectorAll("input.name")];
  const content = () => (fields.length ? { ...names, fields } : names);
  const rename = (place, name) => {
    surfaces[place].name = name || null;
    const label = { ...names.triangles[surfaces[place].reference] };
    if (name) label.name = name;
    else delete label.name;
    names.triangles[surfaces[place].reference] = label;
    save.hidden = false;
    typed(place, content());
  };
  inputs.forEach((input, place) => { input.onchange = () => rename(place, input.value.trim()); });
  save.title = "Put it beside the " + (head.counts ? "model" : "mesh") + " as " + file;
  save.onclick = () => {
    offer(new Blob([JSON.stringify(content(), null, 2) + "\n"], { type: "application/json" }), file);
  };
  return (reference, name) => {
    const place = surfaces.findIndex((one) => one.reference === reference);
    if (place < 0 || typeof name !== "string") return;
    inputs[place].value = name.trim();
    rename(place, name.trim());
  };
}

/** Has the browser save a file. */
function offer(blob, name) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
