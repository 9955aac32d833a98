// The view: a turn (rows to the right, up, and towards the eye), the centre of the picture, and pixels a unit. Parallel lines stay
// parallel.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const scaled = (a, factor) => [factor * a[0], factor * a[1], factor * a[2]];
const lengthOf = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scaled(a, 1 / (lengthOf(a) || 1));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// Depths from -DEPTH to DEPTH are seen.
const DEPTH = 4;
// The share of the picture that is left free at each side.
const MARGIN = 0.06;

class Camera {
  constructor(box) {
    this.box = box;
    this.size = [1, 1];
    this.turn = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    this.centre = [0, 0, 0];
    this.scale = 1;
  }

  // Looks from a direction, and shows all.
  look(turn) {
    this.turn = turn.map(unit);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let k = 0; k < 8; k++) {
      const corner = [0, 1, 2].map((axis) => this.box[(k >> axis) & 1][axis]);
      this.turn.forEach((way, axis) => {
        low[axis] = Math.min(low[axis], dot(way, corner));
        high[axis] = Math.max(high[axis], dot(way, corner));
      });
    }
    const free = 1 - 2 * MARGIN;
    this.scale = Math.min(...[0, 1].map((axis) => free * this.size[axis] / Math.max(high[axis] - low[axis], 1e-6)));
    this.centre = [0, 0, 0];
    this.turn.forEach((way, axis) => { this.centre = add(this.centre, way, (low[axis] + high[axis]) / 2); });
  }

  // Looks as another camera did, whose positions had another frame.
  follow(other, from, to) {
    this.turn = other.turn;
    this.centre = to.position(from.model(other.centre));
    this.scale = other.scale * to.diagonal / from.diagonal;
  }

  // Turns by pixels to the right and down: the width of the picture is half a turn.
  rotate(x, y) {
    const turned = (a, b, angle) => {
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      return [add(scaled(a, cos), b, sin), add(scaled(b, cos), a, -sin)];
    };
    const angle = Math.PI / Math.max(Math.min(...this.size), 1);
    let [right, up, eye] = this.turn;
    [eye, right] = turned(eye, right, -x * angle);
    [eye, up] = turned(eye, up, y * angle);
    right = unit(cross(up, eye));
    eye = unit(eye);
    this.turn = [right, cross(eye, right), eye];
  }

  // Moves what is seen by pixels to the right and down.
  pan(x, y) {
    this.centre = add(add(this.centre, this.turn[0], -x / this.scale), this.turn[1], y / this.scale);
  }

  // Zooms; the point that is seen at these pixels stays there.
  zoom(factor, x = this.size[0] / 2, y = this.size[1] / 2) {
    const before = this.place(x, y);
    this.scale = Math.min(Math.max(this.scale * factor, 1), 1e8);
    this.centre = add(this.centre, add(before, this.place(x, y), -1));
  }

  // The point at pixels from the left and from the top, at the depth of the centre.
  place(x, y) {
    const right = (x - this.size[0] / 2) / this.scale, up = (this.size[1] / 2 - y) / this.scale;
    return add(add(this.centre, this.turn[0], right), this.turn[1], up);
  }

  // The pixels at which a point is seen.
  project(point) {
    const away = add(point, this.centre, -1);
    return [this.size[0] / 2 + this.scale * dot(this.turn[0], away), this.size[1] / 2 - this.scale * dot(this.turn[1], away)];
  }

  // The map to clip space, by columns.
  matrix() {
    const [right, up, eye] = this.turn;
    const [x, y, z] = [2 * this.scale / this.size[0], 2 * this.scale / this.size[1], -1 / DEPTH];
    const row = (way, factor) => [...scaled(way, factor), -factor * dot(way, this.centre)];
    const rows = [row(right, x), row(up, y), row(eye, z), [0, 0, 0, 1]];
    return Float32Array.from({ length: 16 }, (_, i) => rows[i % 4][i >> 2]);
  }
}
