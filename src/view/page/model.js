// What of the mesh is seen, as triangles and lines for the graphics card.

/** The nodes of face i of a tetrahedron, opposite to node i. */
const FACES = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
const NONE = 0xffffffff;
/** Stands for no value: graphics cards do not agree on NaN. */
const NOTHING = -1e30;

/** Normals of triangles, for each corner. */
function normalsOf(positions, count) {
  const normals = new Int16Array(12 * count);
  for (let t = 0; t < count; t++) {
    const p = 9 * t;
    const ux = positions[p + 3] - positions[p], uy = positions[p + 4] - positions[p + 1], uz = positions[p + 5] - positions[p + 2];
    const vx = positions[p + 6] - positions[p], vy = positions[p + 7] - positions[p + 1], vz = positions[p + 8] - positions[p + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const scale = 32767 / (Math.sqrt(x * x + y * y + z * z) || 1);
    for (let i = 0; i < 3; i++) {
      normals[12 * t + 4 * i] = x * scale;
      normals[12 * t + 4 * i + 1] = y * scale;
      normals[12 * t + 4 * i + 2] = z * scale;
    }
  }
  return normals;
}

class Model {
  constructor(head, arrays) {
    this.head = head;
    const values = (name) => arrays[name].values;
    this.points = values("points");
    this.tets = values("tets");
    this.regions = values("regions");
    this.masks = values("masks");
    this.quality = values("quality");
    this.triangles = values("triangles");
    this.surfaces = values("surfaces");
    this.sides = values("sides");
    this.edges = values("edges");
    this.chords = values("model edges");
    this.streamlines = values("streamlines");
    this.fields = head.fields.map((_, i) => values("field " + i));
    [this.vertexCount, this.tetCount] = [arrays.points.rows, arrays.tets.rows];
    [this.triangleCount, this.edgeCount] = [arrays.triangles.rows, arrays.edges.rows];
    this.behind = new Uint8Array(this.vertexCount);
    this.centre = head.centre;
    this.bounds = head.bounds.map((corner) => corner.map((x, i) => x - head.centre[i]));
    this.radius = Math.hypot(...this.bounds[1]) || 1;
    this.show({ plane: null, hidden: new Set(), below: null, along: false });
  }

  /** Chooses what is seen: a plane {normal, offset} about the middle of the box or null, surfaces that are hidden (by their place in
   * the list), and a mean ratio below which tetrahedra stand alone, or null. The rules are those of src/view/cut.rs. */
  show({ plane, hidden, below, along }) {
    this.pieces = null;
    this.clipped = [];
    const { points, tets, behind, triangles, sides, masks, quality } = this;
    if (plane) {
      const [x, y, z] = plane.normal, { offset } = plane;
      for (let v = 0; v < this.vertexCount; v++) {
        behind[v] = x * points[3 * v] + y * points[3 * v + 1] + z * points[3 * v + 2] < offset ? 1 : 0;
      }
    } else behind.fill(1);
    const reaches = (tet) => behind[tets[4 * tet]] | behind[tets[4 * tet + 1]] | behind[tets[4 * tet + 2]] | behind[tets[4 * tet + 3]];
    const someHidden = hidden.size > 0;
    const onShown = new Uint8Array(this.vertexCount);
    this.shown = new Uint32Array(this.triangleCount);
    let count = 0;
    for (let t = 0; t < this.triangleCount; t++) {
      if (someHidden && hidden.has(this.surfaces[t])) continue;
      const a = triangles[3 * t], b = triangles[3 * t + 1], c = triangles[3 * t + 2];
      onShown[a] = onShown[b] = onShown[c] = 1;
      const first = sides[2 * t], second = sides[2 * t + 1];
      const seen = first === NONE ? behind[a] | behind[b] | behind[c] : reaches(first) | (second !== NONE && reaches(second));
      if (seen && below === null) this.shown[count++] = t;
    }
    this.shown = this.shown.subarray(0, count);
    const section = plane && along && below === null ? sectionOf(this, plane, hidden) : null;
    if (section) {
      this.shown = Uint32Array.from(section.whole);
      this.pieces = section.pieces;
    }
    const faces = [];
    if (below !== null) {
      const limit = 65535 * below;
      for (let tet = 0; tet < this.tetCount; tet++) {
        if (quality[tet] < limit && reaches(tet)) faces.push(4 * tet, 4 * tet + 1, 4 * tet + 2, 4 * tet + 3);
      }
    } else if (plane && !section) {
      const count = this.tetCount;
      for (let tet = 0; tet < count; tet++) {
        const a = behind[tets[4 * tet]], b = behind[tets[4 * tet + 1]], c = behind[tets[4 * tet + 2]], d = behind[tets[4 * tet + 3]];
        if (a + b + c + d !== 1) continue;
        const face = b + 2 * c + 3 * d;
        if (!(masks[tet] >> face & 1)) faces.push(4 * tet + face);
      }
    }
    this.faces = Uint32Array.from(faces);
    const lines = [];
    for (let e = 0; e < this.edgeCount; e++) {
      const a = this.edges[2 * e], b = this.edges[2 * e + 1];
      if (!((behind[a] | behind[b]) && onShown[a] && onShown[b])) continue;
      if (section && behind[a] !== behind[b]) this.clipped.push(behind[a] ? section.between(a, b) : section.between(b, a));
      else lines.push(e);
    }
    this.lines = lines;
    this.modelLines = [];
    // Edges of the model belong to no surface of the mesh: where some are hidden, those about the others are drawn.
    const [low, high] = someHidden && this.chords.length ? this.boxOf((place) => !hidden.has(place)) : this.bounds;
    const margin = 0.01 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    const within = (p) => (!plane || dot(plane.normal, p) < plane.offset) && (!someHidden || p.every((x, i) => x > low[i] - margin && x < high[i] + margin));
    for (let k = 0; k < this.chords.length / 6; k++) {
      if (within(this.chords.subarray(6 * k, 6 * k + 3)) && within(this.chords.subarray(6 * k + 3, 6 * k + 6))) this.modelLines.push(k);
    }
  }

  /** The nodes of triangle t of the surface, or of a face 4·tet + face. */
  nodesOfTriangle(t, nodes) {
    for (let i = 0; i < 3; i++) nodes[i] = this.triangles[3 * t + i];
  }

  nodesOfFace(side, nodes) {
    const face = FACES[side & 3], tet = side >>> 2;
    for (let i = 0; i < 3; i++) nodes[i] = this.tets[4 * tet + face[i]];
  }

  /** Corners and normals of triangles, each with corners of its own: it is flat, and knows its edges. */
  soup(count, nodesOf) {
    const positions = new Float32Array(9 * count);
    const nodes = [0, 0, 0], { points } = this;
    for (let t = 0; t < count; t++) {
      nodesOf(t, nodes);
      for (let i = 0; i < 3; i++) for (let k = 0; k < 3; k++) positions[9 * t + 3 * i + k] = points[3 * nodes[i] + k];
    }
    return { positions, normals: normalsOf(positions, count), count };
  }

  /** The same of pieces, with corners that leave out the diagonals of quadrilaterals, and on a smooth map all sides within the body. */
  pieceSoup(smooth = false) {
    const { pieces, points } = this, { count } = pieces;
    const positions = new Float32Array(9 * count), corners = new Uint8Array(12 * count);
    for (let corner = 0; corner < 3 * count; corner++) {
      for (let k = 0; k < 3; k++) positions[3 * corner + k] = pieces.at(corner, (v) => points[3 * v + k]);
    }
    for (let p = 0; p < count; p++) {
      const sides = smooth && pieces.owners[p] < 0 ? 0 : pieces.sides[p];
      for (let i = 0; i < 3; i++) for (let k = 0; k < 3; k++) corners[12 * p + 4 * i + k] = i === k || !(sides >> k & 1) ? 1 : 0;
    }
    return { positions, normals: normalsOf(positions, count), count, corners };
  }

  surfaceSoup() {
    return this.soup(this.triangleCount, (t, nodes) => this.nodesOfTriangle(t, nodes));
  }

  cutSoup() {
    if (this.pieces) return this.pieceSoup();
    return this.soup(this.faces.length, (i, nodes) => this.nodesOfFace(this.faces[i], nodes));
  }

  /** What the colour of an element stands on: kind is "reference", "quality" or a number of a field. */
  qualityOfTriangle(t) {
    const element = this.tetCount ? this.sides[2 * t] : t;
    return element < this.quality.length ? this.quality[element] / 65535 : NOTHING;
  }

  surfaceValues(kind) {
    return this.values(kind, this.triangleCount, (t, nodes) => this.nodesOfTriangle(t, nodes),
      (t) => this.surfaces[t], (t) => this.qualityOfTriangle(t));
  }

  cutValues(kind) {
    if (this.pieces) return this.pieceValues(kind);
    const surfaces = this.head.surfaces.length;
    return this.values(kind, this.faces.length, (i, nodes) => this.nodesOfFace(this.faces[i], nodes),
      (i) => surfaces + this.regions[this.faces[i] >>> 2], (i) => this.quality[this.faces[i] >>> 2] / 65535);
  }

  pieceValues(kind) {
    const { pieces } = this, values = new Float32Array(3 * pieces.count), field = this.fields[kind];
    const surfaces = this.head.surfaces.length;
    for (let p = 0; p < pieces.count; p++) {
      const owner = pieces.owners[p], tet = -1 - owner;
      for (let i = 0; i < 3; i++) {
        if (field) {
          const value = pieces.at(3 * p + i, (v) => field[v]);
          values[3 * p + i] = Number.isNaN(value) ? NOTHING : value;
        } else if (kind === "reference") values[3 * p + i] = owner >= 0 ? this.surfaces[owner] : surfaces + this.regions[tet];
        else values[3 * p + i] = owner >= 0 ? this.qualityOfTriangle(owner) : this.quality[tet] / 65535;
      }
    }
    return values;
  }

  values(kind, count, nodesOf, reference, quality) {
    const values = new Float32Array(3 * count), nodes = [0, 0, 0];
    if (kind === "reference" || kind === "quality") {
      const of = kind === "reference" ? reference : quality;
      for (let t = 0; t < count; t++) values[3 * t] = values[3 * t + 1] = values[3 * t + 2] = of(t);
      return values;
    }
    const field = this.fields[kind];
    for (let t = 0; t < count; t++) {
      nodesOf(t, nodes);
      for (let i = 0; i < 3; i++) {
        const value = field[nodes[i]];
        values[3 * t + i] = Number.isNaN(value) ? NOTHING : value;
      }
    }
    return values;
  }

  /** The ends of lines, six numbers each. */
  lineEnds() {
    const { points } = this, ends = new Float32Array(6 * (this.lines.length + this.clipped.length));
    this.lines.forEach((e, i) => {
      for (let k = 0; k < 6; k++) ends[6 * i + k] = points[3 * this.edges[2 * e + (k > 2 ? 1 : 0)] + k % 3];
    });
    this.clipped.forEach(([a, b, t], i) => {
      for (let k = 0; k < 3; k++) {
        const [from, to] = [points[3 * a + k], points[3 * b + k]], at = 6 * (this.lines.length + i) + k;
        ends[at] = from;
        ends[at + 3] = from + t * (to - from);
      }
    });
    return ends;
  }

  modelEnds() {
    const ends = new Float32Array(6 * this.modelLines.length);
    this.modelLines.forEach((chord, i) => ends.set(this.chords.subarray(6 * chord, 6 * chord + 6), 6 * i));
    return ends;
  }

  /** The box of what is seen of a surface (its place in the list), or of all that are not hidden. */
  boxOf(wanted) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let t = 0; t < this.triangleCount; t++) {
      if (!wanted(this.surfaces[t])) continue;
      for (let i = 0; i < 3; i++) {
        for (let k = 0; k < 3; k++) {
          const x = this.points[3 * this.triangles[3 * t + i] + k];
          if (x < low[k]) low[k] = x;
          if (x > high[k]) high[k] = x;
        }
      }
    }
    return low[0] <= high[0] ? [low, high] : this.bounds;
  }

  /** The pieces under a point of the picture: with shares of their corners, of vertices for fields. */
  pickPiece(camera, x, y, found) {
    const { right, up, toward } = camera.frame(), { pieces, points, centre } = this;
    for (let p = 0; p < pieces.count; p++) {
      const at = [0, 1, 2].map((i) => [0, 1, 2].map((k) => pieces.at(3 * p + i, (v) => points[3 * v + k])));
      const [a, b, c] = at.map((q) => [0, 1, 2].map((k) => q[k] - camera.target[k])).map((q) => [dot(q, right) - x, dot(q, up) - y, dot(q, toward)]);
      const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      if (area === 0) continue;
      const w = [(b[0] * c[1] - b[1] * c[0]) / area, (c[0] * a[1] - c[1] * a[0]) / area, (a[0] * b[1] - a[1] * b[0]) / area];
      if (w.some((share) => share < 0)) continue;
      const owner = pieces.owners[p], corner = (i) => [pieces.a[3 * p + i], pieces.b[3 * p + i], pieces.t[3 * p + i]];
      const nodes = [0, 1, 2].flatMap((i) => corner(i).slice(0, 2));
      const shares = [0, 1, 2].flatMap((i) => [w[i] * (1 - corner(i)[2]), w[i] * corner(i)[2]]);
      found({
        kind: owner >= 0 ? "triangle" : "tetrahedron", element: owner >= 0 ? owner : -1 - owner, near: w[0] * a[2] + w[1] * b[2] + w[2] * c[2],
        nodes, w: shares, at: [0, 1, 2].map((k) => centre[k] + at.reduce((sum, q, i) => sum + w[i] * q[k], 0)),
      });
    }
  }

  /** The nearest element under a point (relative to the middle of the box) of the picture. */
  pick(camera, x, y) {
    const { right, up, toward } = camera.frame();
    const nodes = [0, 0, 0];
    let best = null;
    const look = (kind, element) => {
      const at = nodes.map((v) => [0, 1, 2].map((k) => this.points[3 * v + k] - camera.target[k]));
      const [a, b, c] = at.map((p) => [dot(p, right) - x, dot(p, up) - y]);
      const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      if (area === 0) return;
      const w = [(b[0] * c[1] - b[1] * c[0]) / area, (c[0] * a[1] - c[1] * a[0]) / area, (a[0] * b[1] - a[1] * b[0]) / area];
      if (w.some((share) => share < 0)) return;
      const near = w.reduce((sum, share, i) => sum + share * dot(at[i], toward), 0);
      if (!best || near > best.near) best = { kind, element, near, nodes: nodes.slice(), w };
    };
    const overlaps = () => {
      let [left, r, below, above] = [true, true, true, true];
      for (const v of nodes) {
        const p = [this.points[3 * v] - camera.target[0], this.points[3 * v + 1] - camera.target[1], this.points[3 * v + 2] - camera.target[2]];
        const [px, py] = [dot(p, right), dot(p, up)];
        left = left && px < x; r = r && px > x; below = below && py < y; above = above && py > y;
      }
      return !(left || r || below || above);
    };
    for (const t of this.shown) {
      this.nodesOfTriangle(t, nodes);
      if (overlaps()) look("triangle", t);
    }
    for (const side of this.faces) {
      this.nodesOfFace(side, nodes);
      if (overlaps()) look("tetrahedron", side >>> 2);
    }
    if (this.pieces) this.pickPiece(camera, x, y, (found) => {
      if (!best || found.near > best.near) best = found;
    });
    if (best && !best.at) {
      best.at = [0, 1, 2].map((k) => this.centre[k] + best.w.reduce((sum, share, i) => sum + share * this.points[3 * best.nodes[i] + k], 0));
    }
    return best;
  }
}
