// Where one looks from: without perspective, z up, as in the pictures that geo-adapt draws.

const DEGREE = Math.PI / 180;
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Points are relative to the middle of the box; scale is in CSS pixels a model unit. */
class Camera {
  constructor() {
    this.azimuth = -55;
    this.elevation = 25;
    this.target = [0, 0, 0];
    this.scale = 1;
    this.least = 0;
  }

  /** Unit vectors: right, up, toward who looks. */
  frame() {
    const a = this.azimuth * DEGREE, e = this.elevation * DEGREE;
    const toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    return { right, up: cross(toward, right), toward };
  }

  turn(degreesRight, degreesUp) {
    this.azimuth = ((this.azimuth - degreesRight + 540) % 360 + 360) % 360 - 180;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + degreesUp));
  }

  /** Moves what is shown by so many pixels to the right and down. */
  move(x, y) {
    const { right, up } = this.frame();
    for (let i = 0; i < 3; i++) this.target[i] += (-x * right[i] + y * up[i]) / this.scale;
  }

  /** Enlarges about a point, so many pixels right of and below the middle. */
  zoom(factor, x, y) {
    const scale = Math.max(this.least * 0.05, Math.min(this.least * 1e8, this.scale * factor));
    const { right, up } = this.frame();
    const step = 1 / this.scale - 1 / scale;
    for (let i = 0; i < 3; i++) this.target[i] += (x * right[i] - y * up[i]) * step;
    this.scale = scale;
  }

  /** Puts a box into a rectangle of so many pixels. */
  fit([low, high], width, height) {
    const { right, up, toward } = this.frame();
    const least = [Infinity, Infinity, Infinity], greatest = [-Infinity, -Infinity, -Infinity];
    for (let corner = 0; corner < 8; corner++) {
      const p = [0, 1, 2].map((i) => (corner >> i & 1 ? high : low)[i]);
      [right, up, toward].forEach((axis, i) => {
        least[i] = Math.min(least[i], dot(p, axis));
        greatest[i] = Math.max(greatest[i], dot(p, axis));
      });
    }
    this.target = [0, 1, 2].map((i) => (low[i] + high[i]) / 2);
    const fits = Math.min(width / (greatest[0] - least[0]), height / (greatest[1] - least[1]));
    this.scale = Number.isFinite(fits) ? 0.92 * fits : 1;
    if (!this.least) this.least = this.scale;
  }
}
