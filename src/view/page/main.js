// From the data to the picture, and back from the panel.

/** Usual views (azimuth, elevation); others of the first see cuts that it does not. */
const VIEWS = { Home: [-55, 25], "+x": [0, 0], "−x": [180, 0], "+y": [90, 0], "−y": [-90, 0], "+z": [-90, 90], "−z": [-90, -90] };
const SEEING = [[-55, 25], [35, 25], [125, 25], [-145, 25], [-55, 50], [-55, -35]];

async function start() {
  const canvas = byId("canvas"), message = byId("message");
  const head = JSON.parse(byId("head").textContent);
  listFigures(head.figures);
  const painter = new Painter(canvas);
  const arrays = await readArrays(head.arrays, byId("data").textContent);
  byId("data").remove();
  const model = new Model(head, arrays);
  const camera = new Camera();
  const first = head.start;
  byId("counts").textContent = head.counts || `${grouped(model.vertexCount)} vertices · ${grouped(model.tetCount)} tetrahedra · ${grouped(model.triangleCount)} triangles`;
  const hidden = new Set(head.surfaces.flatMap((one, place) => (first.hidden.includes(one.reference) ? [place] : [])));
  const look = {
    camera, radius: model.radius, nothing: head.maps.nothing, background: [1, 1, 1], ridge: [0.09, 0.11, 0.16],
    wire: first.wire && model.triangleCount < 400000, ridges: true, model: true, streamlines: true, range: [0, 1], logarithmic: false, colours: "references",
  };
  let kind = "reference";
  const status = { state: "loading", frames: 0, camera, look, model, inflate, part: null };
  window.geoAdapt = status;
  const frame = new Frame({
    name: ({ reference, name }) => rename(reference, name),
    look: (asked) => lookSo(asked),
    fit: () => fit(isShown),
  });

  painter.loadColours("references", [...head.surfaces, ...head.regions].map((one) => rgbOf(one.colour)), false);
  painter.loadColours("quality", head.maps.quality, true);
  painter.loadColours("field", head.maps.field, true);
  painter.load(painter.surface, model.surfaceSoup());
  painter.loadLines(painter.streamlines, model.streamlines);

  // Labels of a large mesh come when the picture stands still.
  let labelling = 0;
  const placeLabels = () => {
    clearTimeout(labelling);
    byId("labels").replaceChildren();
    if (!byId("numbers").checked) return;
    const place = () => {
      const { clientWidth, clientHeight } = byId("stage");
      drawLabels(spotsOf(model, cutPositions, camera, clientWidth, clientHeight, 3), (one) => [head.surfaces[one].reference, head.surfaces[one].name].filter(Boolean).join(" "));
      document.body.dataset.labels = byId("labels").childElementCount;
    };
    if (model.shown.length + model.faces.length < 20000) place();
    else labelling = setTimeout(place, 100);
  };
  let cutPositions = [];

  // Drawing waits for the next frame; `stale` says what has to be made anew before.
  let waiting = false;
  const stale = { part: true, values: true };
  const redraw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      draw();
    });
  };
  const draw = () => {
    if (stale.part) {
      status.part = partOf();
      model.show(status.part);
      showLimit();
      painter.choose(model.shown);
      const soup = model.pieces ? model.pieceSoup(kind in head.fields) : model.cutSoup();
      cutPositions = soup.positions;
      painter.load(painter.cut, soup);
      painter.loadValues(painter.cut, model.cutValues(kind));
      painter.loadLines(painter.lines, model.lineEnds());
      painter.loadLines(painter.model, model.modelEnds());
    }
    if (stale.values) {
      painter.loadValues(painter.surface, model.surfaceValues(kind));
      if (!stale.part) {
        if (model.pieces) painter.load(painter.cut, model.pieceSoup(kind in head.fields));
        painter.loadValues(painter.cut, model.cutValues(kind));
      }
    }
    if (stale.part || stale.values || stale.isolines) {
      const field = head.fields[kind] && byId("isolines").checked ? model.fields[kind] : null;
      const shownRange = look.logarithmic ? look.range.map(Math.exp) : look.range;
      const ends = isolinesOf(model, field, field ? ticks(shownRange, look.logarithmic, first.isolines || 20) : []);
      painter.loadLines(painter.isolines, ends);
      document.body.dataset.isolines = ends.length / 6;
      stale.isolines = false;
    }
    stale.part = stale.values = false;
    const error = painter.draw(look);
    drawAxes(camera);
    drawRuler(camera);
    status.frames++;
    status.state = error ? "error" : "drawn";
    const plane = status.part.plane;
    if (plane && !error) message.textContent = model.behind.every((one) => !one) ? "The cut takes all away: nothing is behind the plane." : model.behind.every((one) => one) ? "The cut meets nothing: all is behind the plane." : "";
    else if (!error) message.textContent = "";
    placeLabels();
    Object.assign(document.body.dataset, {
      state: status.state, webgl: painter.version, frames: status.frames, triangles: model.shown.length, faces: model.faces.length, pieces: model.pieces ? model.pieces.count : 0,
      azimuth: camera.azimuth.toFixed(2), elevation: camera.elevation.toFixed(2),
    });
    if (error) message.textContent = "WebGL: error " + error;
    frame.drawn(lookNow());
  };

  // The plane: an axis or a normal of one's own, and where along it, between the ends of the box.
  const cut = { axis: "x", flipped: false, normal: [1, 1, 0], share: 0.5 };
  const normalOf = () => {
    const raw = cut.axis === "free" ? cut.normal : [0, 1, 2].map((i) => ("xyz"[i] === cut.axis ? 1 : 0));
    const length = Math.hypot(...raw) || 1;
    return raw.map((x) => x / length);
  };
  const ends = () => {
    const n = normalOf();
    const reach = n.reduce((sum, x, i) => sum + Math.abs(x) * model.bounds[1][i], 0);
    return [-reach, reach];
  };
  const offsetOf = () => ends()[0] + cut.share * (ends()[1] - ends()[0]);
  const absolute = () => {
    const offset = offsetOf() + dot(normalOf(), model.centre);
    return Math.abs(offset) < 1e-7 * model.radius ? 0 : offset;
  };
  const partOf = () => {
    const sign = cut.flipped ? -1 : 1;
    const plane = byId("cutting").checked ? { normal: normalOf().map((x) => sign * x), offset: sign * offsetOf() } : null;
    return { plane, hidden, below: byId("filtering").checked ? byId("below").value / 1000 : null, along: byId("along").checked };
  };
  const showPlane = () => {
    byId("offset").value = 1000 * cut.share;
    if (document.activeElement !== byId("where")) byId("where").value = short(absolute());
    byId("normal").hidden = cut.axis !== "free";
  };
  const movePlane = (share) => {
    cut.share = Math.max(0, Math.min(1, share));
    byId("cutting").checked = true;
    showPlane();
    stale.part = true;
    redraw();
  };
  const setOffset = (offset) => {
    const [low, high] = ends();
    movePlane((offset - dot(normalOf(), model.centre) - low) / (high - low || 1));
  };
  /** Turns the plane so that its cut is seen. */
  const faceViewer = () => {
    cut.flipped = dot(normalOf(), camera.frame().toward) < 0;
    byId("flip").checked = cut.flipped;
  };

  // How the page looks, in the model's coordinates: another page of the same model can look so too.
  const lookNow = () => ({
    azimuth: camera.azimuth, elevation: camera.elevation, scale: camera.scale, at: camera.target.map((x, i) => x + model.centre[i]),
    cut: { on: byId("cutting").checked, axis: cut.axis, flipped: cut.flipped, normal: cut.normal, offset: absolute() },
  });
  const lookSo = ({ azimuth, elevation, scale, at = [NaN], cut: { on, axis, flipped, normal = [NaN], offset } = {} }) => {
    if (![azimuth, elevation, scale, offset, ...at, ...normal].every(Number.isFinite) || !["x", "y", "z", "free"].includes(axis)) return;
    Object.assign(camera, { azimuth, elevation, scale, target: at.map((x, i) => x - model.centre[i]) });
    Object.assign(cut, { axis, normal, flipped: Boolean(flipped) });
    document.querySelector(`[name=axis][value=${axis}]`).checked = true;
    byId("flip").checked = cut.flipped;
    normalInputs.forEach((input, i) => { input.value = normal[i]; });
    setOffset(offset);
    if (on && model.tetCount && kind === "reference") setColour("quality");
    byId("cutting").checked = Boolean(on);
    frame.followed(lookNow());
  };

  const setColour = (chosen) => {
    kind = chosen;
    const field = head.fields[kind];
    look.colours = field ? "field" : kind === "quality" ? "quality" : "references";
    byId("colour").value = String(kind);
    byId("range").hidden = !field;
    look.logarithmic = Boolean(field?.logarithmic);
    setRange(field ? field.range : [0, 1]);
    stale.values = true;
  };
  const setRange = ([low, high]) => {
    const safe = (x) => (look.logarithmic ? Math.log(Math.max(x, 1e-37)) : x);
    look.range = [safe(low), safe(high)];
    stale.isolines = true;
    [byId("low").value, byId("high").value, byId("logarithmic").checked] = [short(low), short(high), look.logarithmic];
    byId("legend").hidden = look.colours === "references";
    if (look.colours === "quality") drawLegend({ name: head.quality, stops: head.maps.quality, range: [0, 1], logarithmic: false, histogram: head.histogram });
    else if (look.colours === "field") drawLegend({ name: head.fields[kind].name, stops: head.maps.field, range: [low, high], logarithmic: look.logarithmic, histogram: null });
    redraw();
  };
  const fit = (wanted) => {
    const { clientWidth, clientHeight } = byId("stage");
    camera.fit(model.boxOf(wanted), Math.max(100, clientWidth - 120), Math.max(100, clientHeight - 150));
    redraw();
  };
  const isShown = (place) => !hidden.has(place);
  const lookFrom = ([azimuth, elevation]) => {
    [camera.azimuth, camera.elevation] = [azimuth, elevation];
    fit(isShown);
  };

  byId("views").append(...Object.keys(VIEWS).map((name) => make("button", { type: "button", textContent: name, onclick: () => lookFrom(VIEWS[name]) })),
    make("button", { type: "button", textContent: "Save picture", onclick: savePicture }));
  byId("colour").append(make("option", { value: "reference", textContent: "references" }), make("option", { value: "quality", textContent: "quality" }),
    ...head.fields.map((field, i) => make("option", { value: String(i), textContent: field.name })));
  byId("colour").onchange = (event) => setColour(event.target.value in head.fields ? Number(event.target.value) : event.target.value);
  const typedRange = () => {
    look.logarithmic = byId("logarithmic").checked;
    const [low, high] = ["low", "high"].map((id) => parseFloat(byId(id).value));
    setRange(low < high ? [low, high] : head.fields[kind].range);
  };
  for (const id of ["low", "high", "logarithmic"]) byId(id).onchange = typedRange;
  for (const id of ["wire", "ridges", "model", "streamlines"]) {
    byId(id).checked = look[id];
    byId(id).onchange = (event) => {
      look[id] = event.target.checked;
      redraw();
    };
  }
  byId("numbers").checked = first.numbers;
  byId("numbers").onchange = placeLabels;
  if (head.counts) byId("surfaces-title").textContent = "Faces";
  byId("with-model").hidden = model.chords.length === 0;
  byId("with-streamlines").hidden = model.streamlines.length === 0;
  byId("axis").append(...["x", "y", "z", "free"].map((axis) => make("label", {}, make("input", {
    type: "radio", name: "axis", value: axis, checked: axis === cut.axis, onchange: () => {
      cut.axis = axis;
      faceViewer();
      movePlane(0.5);
    },
  }), axis)), make("label", {}, make("input", {
    type: "checkbox", id: "flip", onchange: (event) => {
      cut.flipped = event.target.checked;
      movePlane(cut.share);
    },
  }), "other side"));
  const normalInputs = [...byId("normal").querySelectorAll("input")];
  for (const input of normalInputs) input.onchange = () => {
    const typed = normalInputs.map((one) => parseFloat(one.value));
    if (typed.every(Number.isFinite) && Math.hypot(...typed) > 0) cut.normal = typed;
    faceViewer();
    movePlane(cut.share);
  };
  byId("offset").oninput = (event) => movePlane(event.target.value / 1000);
  byId("where").onchange = (event) => {
    const typed = parseFloat(event.target.value);
    event.target.blur();
    if (Number.isFinite(typed)) setOffset(typed);
  };
  byId("along").checked = first.along;
  byId("along").onchange = () => {
    stale.part = true;
    redraw();
  };
  byId("isolines").checked = first.isolines > 0 || !first.plane;
  byId("isolines").onchange = () => {
    stale.isolines = true;
    redraw();
  };
  byId("cutting").onchange = (event) => {
    if (event.target.checked) faceViewer();
    if (event.target.checked && kind === "reference") setColour("quality");
    stale.part = true;
    redraw();
  };
  const showLimit = () => {
    const count = status.part?.below !== null && status.part ? ": " + grouped(model.faces.length / 4) : "";
    byId("limit").textContent = "below " + short(byId("below").value / 1000) + count;
  };
  byId("below").oninput = () => {
    byId("filtering").checked = true;
    stale.part = true;
    redraw();
  };
  byId("filtering").onchange = (event) => {
    if (event.target.checked) setColour("quality");
    stale.part = true;
    redraw();
  };
  byId("cut").hidden = byId("worst").hidden = byId("bodies").hidden = model.tetCount === 0;
  const boxes = () => [...byId("surfaces").querySelectorAll("[type=checkbox]")];
  const hide = (place, on) => {
    if (on) hidden.delete(place);
    else hidden.add(place);
    stale.part = true;
    redraw();
  };
  listReferences(byId("surfaces"), head.surfaces, hide, (place) => fit((other) => other === place));
  listReferences(byId("regions"), head.regions);
  const rename = listenToNames(head, head.surfaces, (place, content) => {
    placeLabels();
    frame.tell("names", { reference: head.surfaces[place].reference, name: head.surfaces[place].name || "", content });
  });
  boxes().forEach((box, place) => { box.checked = isShown(place); });
  for (const [id, on] of [["all", true], ["none", false]]) {
    byId(id).onclick = () => boxes().forEach((box, place) => {
      box.checked = on;
      hide(place, on);
    });
  }
  listen(canvas, camera, redraw, (x, y) => {
    const found = model.pick(camera, x / camera.scale, -y / camera.scale);
    const surface = found?.kind === "triangle" ? head.surfaces[model.surfaces[found.element]] : null;
    markPicked(surface ? model.surfaces[found.element] : -1);
    frame.tell("picked", { reference: surface?.reference, name: surface?.name, about: surface?.about });
    describe(found, {
      head, regions: model.regions, surfaces: model.surfaces, quality: model.quality, fields: model.fields,
      qualityOfTriangle: (t) => model.qualityOfTriangle(t),
    });
  }, (key) => {
    if (key === "r" || key === "R" || key === "Home") lookFrom(VIEWS.Home);
    else if (key === "," || key === ".") movePlane(cut.share + (key === "." ? 0.002 : -0.002));
    else if (key === "c" || key === "C") byId("cutting").click();
    else if (key === "w" || key === "W") byId("wire").click();
    else return false;
    return true;
  });

  function savePicture() {
    draw();
    canvas.toBlob((blob) => offer(blob, head.title.replace(/[^\w.-]+/g, "-") + ".png"));
  }

  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const paper = () => {
    look.background = rgbOf(dark.matches ? "#15181d" : "#fdfdfe");
    look.ridge = dark.matches ? [0.03, 0.04, 0.06] : [0.09, 0.11, 0.16];
    redraw();
  };
  dark.addEventListener("change", paper);
  new ResizeObserver(redraw).observe(canvas);
  canvas.addEventListener("webglcontextlost", () => { message.textContent = "The graphics card was taken away: load the page again."; });

  // As the command asked for.
  if (first.plane) {
    const [normal, offset] = first.plane;
    const axis = normal.findIndex((x) => Math.abs(x) === 1);
    cut.axis = axis < 0 ? "free" : "xyz"[axis];
    cut.flipped = axis >= 0 && normal[axis] < 0;
    if (axis < 0) {
      cut.normal = normal;
      normalInputs.forEach((input, i) => { input.value = short(normal[i]); });
    }
    byId("flip").checked = cut.flipped;
    for (const radio of byId("axis").querySelectorAll("[type=radio]")) radio.checked = radio.value === cut.axis;
    setOffset(cut.flipped ? -offset : offset);
  }
  if (first.below !== null) {
    byId("filtering").checked = true;
    byId("below").value = 1000 * first.below;
  }
  showPlane();
  showLimit();
  setColour(first.colour.startsWith("field ") ? Number(first.colour.slice(6)) : first.colour);
  if (first.range && kind in head.fields) setRange(first.range);
  const plane = partOf().plane;
  lookFrom(first.view || SEEING.find((view) => {
    [camera.azimuth, camera.elevation] = view;
    return !plane || dot(plane.normal, camera.frame().toward) > 0.4;
  }) || VIEWS.Home);
  camera.scale *= first.zoom;
  if (first.at) camera.target = first.at.map((x, i) => x - model.centre[i]);
  message.textContent = "";
  paper();
}

start().catch((error) => {
  byId("message").textContent = error.message;
  document.body.dataset.state = "error";
});
