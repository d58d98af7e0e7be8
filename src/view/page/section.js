// A cut along the plane itself. The rules are those of src/view/section.rs.

/** Triangles of polygons: corners between two vertices each (a, b, and how far), what they belong to, and which sides are real. */
class Pieces {
  constructor() {
    Object.assign(this, { a: [], b: [], t: [], owners: [], sides: [] });
  }

  get count() {
    return this.owners.length;
  }

  /** A triangle, or a quadrilateral as two, of corners [a, b, t]. */
  push(owner, corners) {
    const add = (three, sides) => {
      for (const [a, b, t] of three) {
        this.a.push(a);
        this.b.push(b);
        this.t.push(t);
      }
      this.owners.push(owner);
      this.sides.push(sides);
    };
    const [a, b, c, d] = corners;
    if (!d) add([a, b, c], 7);
    else {
      add([a, b, c], 5);
      add([a, c, d], 3);
    }
  }

  /** The value at a corner of something that vertices have. */
  at(corner, of) {
    const { a, b, t } = this, first = of(a[corner]);
    return t[corner] === 0 ? first : first + t[corner] * (of(b[corner]) - first);
  }
}

/** What a plane makes of a model: whole triangles, pieces (of triangle t: its number; of a tetrahedron: −1 − its number), and ends of edges. */
function sectionOf(model, plane, hidden) {
  const { points, tets, triangles, surfaces } = model;
  const [x, y, z] = plane.normal;
  const heights = new Float64Array(model.vertexCount);
  for (let v = 0; v < heights.length; v++) heights[v] = x * points[3 * v] + y * points[3 * v + 1] + z * points[3 * v + 2] - plane.offset;
  const pieces = new Pieces(), whole = [];
  const vertex = (v) => [v, v, 0];
  const between = (behind, front) => [behind, front, heights[behind] / (heights[behind] - heights[front])];
  for (let t = 0; t < model.triangleCount; t++) {
    if (hidden.has(surfaces[t])) continue;
    const nodes = triangles.subarray(3 * t, 3 * t + 3);
    const back = [], front = [];
    for (const v of nodes) (heights[v] < 0 ? back : front).push(v);
    const [a, b] = back;
    if (back.length === 3) whole.push(t);
    else if (back.length === 1) pieces.push(t, [vertex(a), between(a, front[0]), between(a, front[1])]);
    else if (back.length === 2) pieces.push(t, [vertex(a), vertex(b), between(b, front[0]), between(a, front[0])]);
  }
  for (let tet = 0; tet < model.tetCount; tet++) {
    let count = 0;
    for (let i = 0; i < 4; i++) if (heights[tets[4 * tet + i]] < 0) count++;
    if (count === 0 || count === 4) continue;
    const back = [], front = [];
    for (let i = 0; i < 4; i++) (heights[tets[4 * tet + i]] < 0 ? back : front).push(tets[4 * tet + i]);
    const [a, b] = back, [c, d] = front;
    if (count === 1) pieces.push(-1 - tet, front.map((v) => between(a, v)));
    else if (count === 3) pieces.push(-1 - tet, back.map((v) => between(v, c)));
    else pieces.push(-1 - tet, [between(a, c), between(a, d), between(b, d), between(b, c)]);
  }
  return { whole, pieces, between, heights };
}

/** Ends of the lines on which a field has one of the values, six numbers each. */
function isolinesOf(model, field, levels) {
  const { pieces, points } = model, ends = [];
  if (!pieces || !field) return new Float32Array(0);
  for (let p = 0; p < pieces.count; p++) {
    if (pieces.owners[p] >= 0) continue;
    const values = [0, 1, 2].map((i) => pieces.at(3 * p + i, (v) => field[v]));
    if (!values.every(Number.isFinite)) continue;
    const [low, high] = [Math.min(...values), Math.max(...values)];
    for (const level of levels) {
      if (level < low || level > high) continue;
      const found = [];
      for (const [i, j] of [[0, 1], [1, 2], [2, 0]]) {
        if ((values[i] < level) === (values[j] < level)) continue;
        const t = (level - values[i]) / (values[j] - values[i]);
        found.push([0, 1, 2].map((k) => {
          const [from, to] = [i, j].map((one) => pieces.at(3 * p + one, (v) => points[3 * v + k]));
          return from + t * (to - from);
        }));
      }
      if (found.length === 2) ends.push(...found[0], ...found[1]);
    }
  }
  return Float32Array.from(ends);
}
