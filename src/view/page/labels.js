// Numbers and names on surfaces, in the middle of what is seen of each. The rules are those of src/view/labels.rs.

/** Where each surface (by its place in the list) has its label: {owner, x, y, room} in CSS pixels, the roomiest first. */
function spotsOf(model, cutPositions, camera, width, height, cell) {
  const columns = Math.ceil(width / cell), rows = Math.ceil(height / cell);
  const near = new Float32Array(columns * rows).fill(-Infinity), owners = new Int32Array(columns * rows).fill(-1);
  const { right, up, toward } = camera.frame(), { target, scale } = camera;
  const place = (x, y, z) => {
    const p = [x - target[0], y - target[1], z - target[2]];
    return [(width / 2 + dot(p, right) * scale) / cell - 0.5, (height / 2 - dot(p, up) * scale) / cell - 0.5, dot(p, toward)];
  };
  const draw = ([a, b, c], owner) => {
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (!area) return;
    const span = (i, count) => [Math.max(0, Math.ceil(Math.min(a[i], b[i], c[i]))), Math.min(count - 1, Math.floor(Math.max(a[i], b[i], c[i])))];
    const [top, bottom] = span(1, rows), [left, last] = span(0, columns);
    for (let y = top; y <= bottom; y++) {
      for (let x = left; x <= last; x++) {
        const u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
        const v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area;
        const w = 1 - u - v;
        if (u < 0 || v < 0 || w < -1e-9) continue;
        const depth = u * a[2] + v * b[2] + w * c[2], at = y * columns + x;
        if (depth > near[at]) {
          near[at] = depth;
          owners[at] = owner;
        }
      }
    }
  };
  const { points, triangles } = model;
  const corner = (v) => place(points[3 * v], points[3 * v + 1], points[3 * v + 2]);
  for (const t of model.shown) draw([0, 1, 2].map((i) => corner(triangles[3 * t + i])), model.surfaces[t]);
  for (let p = 0; p < cutPositions.length; p += 9) {
    draw([0, 3, 6].map((i) => place(cutPositions[p + i], cutPositions[p + i + 1], cutPositions[p + i + 2])), -1);
  }
  return roomiest(owners, columns, rows).map(({ owner, at, room }) => ({
    owner, x: (at % columns + 0.5) * cell, y: (Math.floor(at / columns) + 0.5) * cell, room: room * cell,
  }));
}

/** The cell of each owner that is farthest from cells of others: a chamfer distance in two sweeps. */
function roomiest(owners, columns, rows) {
  const count = columns * rows, room = new Float32Array(count).fill(Infinity), best = new Map();
  const before = [[-1, 0, 1], [-1, -1, Math.SQRT2], [0, -1, 1], [1, -1, Math.SQRT2]];
  for (const sweep of [1, -1]) {
    for (let k = 0; k < count; k++) {
      const i = sweep === 1 ? k : count - 1 - k, x = i % columns, y = (i - x) / columns;
      for (const [dx, dy, step] of before) {
        const nx = x + sweep * dx, ny = y + sweep * dy;
        const inside = nx >= 0 && ny >= 0 && nx < columns && ny < rows, other = ny * columns + nx;
        room[i] = Math.min(room[i], step + (inside && owners[other] === owners[i] ? room[other] : 0));
      }
    }
  }
  for (let i = 0; i < count; i++) {
    if (owners[i] >= 0 && !(best.get(owners[i])?.room >= room[i])) best.set(owners[i], { owner: owners[i], at: i, room: room[i] });
  }
  return [...best.values()].sort((a, b) => b.room - a.room || a.owner - b.owner);
}

/** Writes the labels over the picture; what would lie on another one is left out. */
function drawLabels(spots, textOf) {
  const taken = [];
  const labels = spots.map(({ owner, x, y }) => {
    const text = textOf(owner), half = 3.6 * text.length + 3;
    const box = [x - half, y - 9, x + half, y + 9];
    if (taken.some((o) => !(box[2] < o[0] || o[2] < box[0] || box[3] < o[1] || o[3] < box[1]))) return null;
    taken.push(box);
    return makeSvg("text", { x, y }, text);
  });
  byId("labels").replaceChildren(...labels.filter((label) => label));
}
