// WebGL: triangles with lines between them, and lines of a width. Version 2, else 1 with 32-bit indices.

/** The same shader in the languages of both versions. */
const DIALECTS = {
  2: {
    vertex: "#version 300 es\n#define attribute in\n#define varying out\n",
    fragment: "#version 300 es\nprecision highp float;\n#define varying in\n#define texture2D texture\nout vec4 result;\n",
  },
  1: {
    vertex: "",
    fragment: "#extension GL_OES_standard_derivatives : enable\nprecision highp float;\n#define result gl_FragColor\n",
  },
};

const TRIANGLE = {
  vertex: `
attribute vec3 position;
attribute vec3 normal;
attribute vec3 corner;
attribute float value;
uniform vec3 target, right, up, toward, light, size;
varying vec3 at;
varying float shade, number;
void main() {
  vec3 p = position - target;
  gl_Position = vec4(vec3(dot(p, right), dot(p, up), -dot(p, toward)) / size, 1.0);
  vec3 n = dot(normal, toward) < 0.0 ? -normal : normal;
  shade = min(1.0, 0.58 + 0.44 * max(0.0, dot(n, light)));
  at = corner;
  number = value;
}`,
  fragment: `
uniform sampler2D colours;
uniform vec3 nothing;
uniform vec2 range;
uniform float listed, logarithmic, wire, pixel;
varying vec3 at;
varying float shade, number;
void main() {
  vec3 colour;
  if (listed > 0.0) {
    float index = floor(number + 0.5);
    vec2 place = vec2(mod(index, 256.0) + 0.5, floor(index / 256.0) + 0.5);
    colour = texture2D(colours, place / vec2(256.0, listed)).rgb;
  } else if (number < -1e25) {
    colour = nothing;
  } else {
    float x = logarithmic > 0.0 ? log(max(number, 1e-37)) : number;
    float t = range.y > range.x ? (x - range.x) / (range.y - range.x) : 0.5;
    colour = texture2D(colours, vec2((255.0 * clamp(t, 0.0, 1.0) + 0.5) / 256.0, 0.5)).rgb;
  }
  vec3 slope = sqrt(dFdx(at) * dFdx(at) + dFdy(at) * dFdy(at)) * pixel;
  vec3 far = at / max(slope, vec3(1e-20));
  float lowest = 1.0 / max(max(slope.x, slope.y), max(slope.z, 1e-20));
  float line = clamp((0.3 - min(min(far.x, far.y), far.z)) * pixel + 0.5, 0.0, 1.0);
  float dark = wire * line * smoothstep(2.0, 7.0, lowest);
  result = vec4(colour * shade * (1.0 - dark), 1.0);
}`,
};

const LINE = {
  vertex: `
attribute vec3 first;
attribute vec3 second;
attribute vec2 place;
uniform vec3 target, right, up, toward, size;
uniform vec3 width;
void main() {
  vec3 a = first - target, b = second - target;
  vec2 along = vec2(dot(b - a, right), dot(b - a, up)) / width.xy;
  vec2 across = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(0.0);
  vec3 p = mix(a, b, place.x);
  vec3 at = vec3(dot(p, right), dot(p, up), -dot(p, toward) - width.z);
  at.xy += (across * place.y + normalize(along + vec2(1e-20, 0.0)) * (place.x - 0.5)) * width.xy;
  gl_Position = vec4(at / size - vec3(0.0, 0.0, 4e-7), 1.0);
}`,
  fragment: `
uniform vec3 colour;
void main() {
  result = vec4(colour, 1.0);
}`,
};

class Painter {
  constructor(canvas) {
    const wanted = { antialias: true, alpha: false, preserveDrawingBuffer: true };
    let gl = canvas.getContext("webgl2", wanted), version = 2;
    if (!gl) {
      gl = canvas.getContext("webgl", wanted);
      version = 1;
      if (gl && !(gl.getExtension("OES_element_index_uint") && gl.getExtension("OES_standard_derivatives"))) gl = null;
    }
    if (!gl) throw new Error("This page draws with WebGL, and this browser has none (or it is switched off).\nTry another browser, or have a picture made: geo-adapt view MESH --png picture.png");
    Object.assign(this, { canvas, gl, version });
    this.triangle = this.program(TRIANGLE);
    this.line = this.program(LINE);
    this.corners = gl.createBuffer();
    this.cornerCount = 0;
    this.surface = { index: gl.createBuffer(), shown: 0 };
    this.cut = {};
    this.lines = { count: 0 };
    this.model = { count: 0 };
    this.isolines = { count: 0 };
    this.streamlines = { count: 0 };
    this.textures = {};
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  program(source) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const kind of ["vertex", "fragment"]) {
      const shader = gl.createShader(kind === "vertex" ? gl.VERTEX_SHADER : gl.FRAGMENT_SHADER);
      gl.shaderSource(shader, DIALECTS[this.version][kind] + source[kind]);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error("WebGL: " + gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    const names = [...(source.vertex + source.fragment).matchAll(/uniform \w+ ([^;]+);/g)].flatMap((found) => found[1].split(/, */));
    const inputs = [...source.vertex.matchAll(/attribute \w+ (\w+);/g)].map((found) => found[1]);
    const uniforms = Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)]));
    const attributes = Object.fromEntries(inputs.map((name) => [name, gl.getAttribLocation(program, name)]));
    return { program, uniforms, attributes };
  }

  fill(buffer, data, target = this.gl.ARRAY_BUFFER) {
    const { gl } = this;
    const filled = buffer || gl.createBuffer();
    gl.bindBuffer(target, filled);
    gl.bufferData(target, data, gl.DYNAMIC_DRAW);
    return filled;
  }

  /** Triangles as Model.soup makes them, into this.surface or this.cut. */
  load(part, { positions, normals, count, corners = null }) {
    part.positions = this.fill(part.positions, positions);
    part.normals = this.fill(part.normals, normals);
    part.count = count;
    part.ownCorners = corners ? this.fill(part.ownCorners, corners) : null;
    if (count > this.cornerCount) {
      const corners = new Uint8Array(12 * count);
      for (let t = 0; t < count; t++) corners[12 * t] = corners[12 * t + 5] = corners[12 * t + 10] = 1;
      this.fill(this.corners, corners);
      this.cornerCount = count;
    }
  }

  /** Which triangles of the surface are drawn. */
  choose(shown) {
    const index = new Uint32Array(3 * shown.length);
    shown.forEach((t, i) => { for (let k = 0; k < 3; k++) index[3 * i + k] = 3 * t + k; });
    this.fill(this.surface.index, index, this.gl.ELEMENT_ARRAY_BUFFER);
    this.surface.shown = shown.length;
  }

  loadValues(part, values) {
    part.values = this.fill(part.values, values);
  }

  /** Lines by their ends: four corners each, as two triangles. */
  loadLines(part, ends) {
    const count = ends.length / 6, data = new Float32Array(6 * 8 * count);
    const places = [[0, -1], [1, -1], [1, 1], [0, -1], [1, 1], [0, 1]];
    for (let i = 0; i < count; i++) {
      for (let corner = 0; corner < 6; corner++) {
        const at = 8 * (6 * i + corner);
        data.set(ends.subarray(6 * i, 6 * i + 6), at);
        data.set(places[corner], at + 6);
      }
    }
    part.buffer = this.fill(part.buffer, data);
    part.count = 6 * count;
  }

  /** A row of colours for values, or a list for references. */
  loadColours(name, colours, smooth) {
    const { gl } = this;
    const rows = smooth ? 1 : Math.max(1, Math.ceil(colours.length / 256));
    const bytes = new Uint8Array(4 * 256 * rows).fill(255);
    for (let i = 0; i < (smooth ? 256 : colours.length); i++) {
      const colour = smooth ? between(colours, i / 255) : colours[i];
      for (let k = 0; k < 3; k++) bytes[4 * i + k] = Math.round(255 * colour[k]);
    }
    const texture = this.textures[name]?.texture || gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, rows, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, smooth ? gl.LINEAR : gl.NEAREST);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    this.textures[name] = { texture, rows };
  }

  attribute({ attributes }, name, buffer, size, type, normalised, stride = 0, offset = 0) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(attributes[name]);
    gl.vertexAttribPointer(attributes[name], size, type, normalised, stride, offset);
  }

  /** Draws all. `look` says how: camera, radius, background, colours (name), range, logarithmic, nothing, wire, ridges, model. */
  draw(look) {
    const { gl, canvas } = this;
    const pixel = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * pixel)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(...look.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { camera } = look;
    const { right, up, toward } = camera.frame();
    const depth = 1.02 * look.radius + Math.abs(dot(camera.target, toward));
    const size = [canvas.clientWidth / (2 * camera.scale), canvas.clientHeight / (2 * camera.scale), depth];
    const light = [0, 1, 2].map((i) => 0.28 * right[i] + 0.42 * up[i] + toward[i]);
    const length = Math.hypot(...light);
    const common = ({ uniforms }) => {
      gl.uniform3fv(uniforms.target, camera.target);
      gl.uniform3fv(uniforms.right, right);
      gl.uniform3fv(uniforms.up, up);
      gl.uniform3fv(uniforms.toward, toward);
      gl.uniform3fv(uniforms.size, size);
    };
    const { uniforms } = this.triangle;
    gl.useProgram(this.triangle.program);
    common(this.triangle);
    const colours = this.textures[look.colours];
    gl.bindTexture(gl.TEXTURE_2D, colours.texture);
    gl.uniform3fv(uniforms.light, light.map((x) => x / length));
    gl.uniform3fv(uniforms.nothing, look.nothing);
    gl.uniform2fv(uniforms.range, look.range);
    gl.uniform1f(uniforms.listed, look.colours === "references" ? colours.rows : 0);
    gl.uniform1f(uniforms.logarithmic, look.logarithmic ? 1 : 0);
    gl.uniform1f(uniforms.wire, look.wire ? 0.62 : 0);
    gl.uniform1f(uniforms.pixel, pixel);
    for (const part of [this.surface, this.cut]) {
      const count = part === this.surface ? part.shown : part.count;
      if (!count) continue;
      this.attribute(this.triangle, "position", part.positions, 3, gl.FLOAT, false);
      this.attribute(this.triangle, "normal", part.normals, 3, gl.SHORT, true, 8);
      this.attribute(this.triangle, "corner", part.ownCorners || this.corners, 3, gl.UNSIGNED_BYTE, false, 4);
      this.attribute(this.triangle, "value", part.values, 1, gl.FLOAT, false);
      if (part === this.surface) {
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, part.index);
        gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 0);
      } else gl.drawArrays(gl.TRIANGLES, 0, 3 * count);
    }
    gl.useProgram(this.line.program);
    common(this.line);
    for (const [part, half, lift, colour, wanted] of [[this.isolines, 0.5, 1, [0.1, 0.1, 0.14], true], [this.streamlines, 0.8, 2, [0.06, 0.07, 0.1], look.streamlines], [this.lines, 0.75, 1.2, look.ridge, look.ridges], [this.model, 0.6, 2, [0.85, 0.1, 0.45], look.model]]) {
      if (!part.count || !wanted) continue;
      gl.uniform3fv(this.line.uniforms.width, [half / camera.scale, half / camera.scale, lift / camera.scale]);
      gl.uniform3fv(this.line.uniforms.colour, colour);
      this.attribute(this.line, "first", part.buffer, 3, gl.FLOAT, false, 32, 0);
      this.attribute(this.line, "second", part.buffer, 3, gl.FLOAT, false, 32, 12);
      this.attribute(this.line, "place", part.buffer, 2, gl.FLOAT, false, 32, 24);
      gl.drawArrays(gl.TRIANGLES, 0, part.count);
    }
    return gl.getError();
  }
}

/** The colour of t in [0, 1] between evenly spaced stops. */
function between(stops, t) {
  const place = Math.max(0, Math.min(1, t)) * (stops.length - 1);
  const low = Math.min(Math.floor(place), stops.length - 2);
  return stops[low].map((x, i) => x + (place - low) * (stops[low + 1][i] - x));
}
