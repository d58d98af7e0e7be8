// Names of surfaces: typed in the list, saved as the names file beside the mesh or the model.

/** `typed(place, name)` is called when a name has changed. */
function listenToNames(head, surfaces, typed) {
  const { file, names, fields } = head.names;
  const save = byId("save-names");
  const inputs = [...byId("surfaces").querySelectorAll("input.name")];
  inputs.forEach((input, place) => {
    input.onchange = () => {
      const name = input.value.trim();
      surfaces[place].name = name || null;
      const label = { ...names.triangles[surfaces[place].reference] };
      if (name) label.name = name;
      else delete label.name;
      names.triangles[surfaces[place].reference] = label;
      save.hidden = false;
      typed(place, name);
    };
  });
  save.title = "Put it beside the " + (head.counts ? "model" : "mesh") + " as " + file;
  save.onclick = () => {
    const content = fields.length ? { ...names, fields } : names;
    offer(new Blob([JSON.stringify(content, null, 2) + "\n"], { type: "application/json" }), file);
  };
}

/** Has the browser save a file. */
function offer(blob, name) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
