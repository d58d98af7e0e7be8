// What stands around the picture: lists, legend, ruler.

const byId = (id) => document.getElementById(id);

/** An element with properties and children. */
function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

function makeSvg(tag, attributes = {}, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

/** Four figures, without zeros at the end. */
function short(x) {
  if (!Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return x.toExponential(2).replace(/\.?0+e/, "e").replace("e+", "e");
  return String(Number(x.toPrecision(4)));
}

const grouped = (count) => count.toLocaleString("en").replaceAll(",", "\u202f");
const css = (colour) => "rgb(" + colour.map((x) => Math.round(255 * x)).join(" ") + ")";
const rgbOf = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
const named = (one) => one.reference + (one.name ? " · " + one.name : "");

/** Round numbers between the ends. */
function ticks([low, high], logarithmic, about = 8) {
  if (!(low < high)) return [low];
  if (logarithmic && low > 0 && high / low >= 100) {
    const [first, last] = [Math.ceil(Math.log10(low) - 1e-6), Math.floor(Math.log10(high) + 1e-6)];
    const step = Math.floor((last - first) / about) + 1, found = [];
    for (let power = first; power <= last; power += step) found.push(10 ** power);
    return found;
  }
  const rough = (high - low) / about, ten = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((x) => x * ten).find((x) => x >= rough), found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return found;
}

/** The legend of a map of colours; histogram may be null. */
function drawLegend({ name, stops, range, logarithmic, histogram }) {
  const legend = byId("legend"), high = Math.max(120, Math.min(300, byId("stage").clientHeight - 260));
  const svg = makeSvg("svg", { width: 160, height: high + 34, viewBox: `0 -10 160 ${high + 34}` });
  const gradient = makeSvg("linearGradient", { id: "gradient", x1: 0, y1: 1, x2: 0, y2: 0 });
  stops.forEach((stop, i) => gradient.append(makeSvg("stop", { offset: i / (stops.length - 1), "stop-color": css(stop) })));
  svg.append(gradient, makeSvg("rect", { x: 92, y: 0, width: 14, height: high, fill: "url(#gradient)", rx: 2 }));
  const place = (x) => {
    const [a, b, v] = logarithmic ? [...range, x].map((one) => Math.log(Math.max(one, 1e-37))) : [...range, x];
    return b > a ? high * (1 - (v - a) / (b - a)) : high / 2;
  };
  for (const value of ticks(range, logarithmic)) {
    const y = place(value);
    svg.append(makeSvg("line", { x1: 106, x2: 111, y1: y, y2: y, stroke: "currentColor" }), makeSvg("text", { x: 115, y }, short(value)));
  }
  if (histogram) {
    const most = Math.log(1 + Math.max(...histogram)) || 1, each = high / histogram.length;
    histogram.forEach((count, i) => {
      const bar = 78 * Math.log(1 + count) / most;
      if (count) svg.append(makeSvg("rect", { x: 86 - bar, y: high - (i + 0.93) * each, width: bar, height: 0.86 * each, fill: "var(--bar)" }));
    });
    svg.append(makeSvg("text", { x: 8, y: high + 16, style: "fill: var(--pale)" }, "number, log scale"));
  }
  legend.replaceChildren(...name.split(", ").map((line) => make("p", { textContent: line })), svg);
  legend.hidden = false;
}

function drawAxes(camera) {
  const { right, up, toward } = camera.frame();
  const axes = [0, 1, 2].map((i) => ({ i, x: 30 * right[i], y: -30 * up[i], near: toward[i] })).sort((a, b) => a.near - b.near);
  byId("axes").replaceChildren(...axes.flatMap(({ i, x, y }) => {
    const colour = ["#d0453c", "#2f9d4f", "#3b78d8"][i];
    return [makeSvg("line", { x1: 0, y1: 0, x2: x, y2: y, stroke: colour, "stroke-width": 2.5, "stroke-linecap": "round" }),
      makeSvg("text", { x: 1.36 * x, y: 1.36 * y, fill: colour }, "xyz"[i])];
  }));
}

function drawRuler(camera) {
  const widest = 170 / camera.scale, ten = 10 ** Math.floor(Math.log10(widest));
  const length = [5, 2, 1].map((x) => x * ten).find((x) => x <= widest) || ten;
  byId("ruler").style.width = length * camera.scale + "px";
  byId("ruler").firstElementChild.textContent = short(length);
}

/** The list of surfaces or regions; `toggle(place, on)` and `fit(place)` may be left out. */
function listReferences(list, references, toggle, fit) {
  list.replaceChildren(...references.map((one, place) => {
    const box = toggle ? [make("input", { type: "checkbox", checked: true, onchange: (event) => toggle(place, event.target.checked) })] : [];
    const swatch = make("i");
    swatch.style.background = one.colour;
    const text = make("span", { textContent: toggle ? String(one.reference) : named(one) });
    const label = make("label", { title: one.about || named(one) }, ...box, swatch, text);
    if (toggle) label.className = "number";
    const name = toggle ? [make("input", { type: "text", className: "name", value: one.name || "", placeholder: "name", title: "Its name" })] : [];
    const button = fit ? [make("button", { type: "button", textContent: "fit", title: "Fill the picture with it", onclick: () => fit(place) })] : [];
    return make("li", {}, label, ...name, ...button, make("small", { textContent: grouped(one.count) }));
  }));
}

function listFigures(figures) {
  byId("figures").replaceChildren(...figures.map(([name, value]) => make("tr", {}, make("td", { textContent: name }), make("td", { textContent: value, className: value.length < 16 ? "short" : "" }))));
}

/** Shows in the list which surface was clicked, if one was. */
function markPicked(place) {
  [...byId("surfaces").children].forEach((line, i) => {
    line.classList.toggle("picked", i === place);
    if (i === place) line.scrollIntoView({ block: "nearest" });
  });
}

/** Says what was clicked. */
function describe(found, { head, regions, surfaces, quality, fields, qualityOfTriangle }) {
  const box = byId("picked");
  box.hidden = !found;
  if (!found) return;
  const parts = [];
  if (found.kind === "triangle") {
    const one = head.surfaces[surfaces[found.element]];
    if (head.counts) parts.push("face " + named(one), ...(one.about ? [one.about] : []));
    else parts.push("triangle " + grouped(found.element + 1), "reference " + named(one));
  } else {
    parts.push("tetrahedron " + grouped(found.element + 1), "region " + named(head.regions[regions[found.element]]));
  }
  const ratio = found.kind === "triangle" ? qualityOfTriangle(found.element) : quality[found.element] / 65535;
  if (ratio >= 0 && !head.counts) parts.push("mean ratio " + short(ratio));
  fields.forEach((field, i) => {
    const value = found.w.reduce((sum, share, k) => sum + share * field[found.nodes[k]], 0);
    if (Number.isFinite(value)) parts.push(head.fields[i].name + " " + short(value));
  });
  parts.push("at (" + found.at.map((x) => String(Number(x.toPrecision(6)))).join(", ") + ")");
  box.textContent = parts.join("  ·  ");
}
