// Strokes and sizes: what is drawn on the surface, undone, and saved.

// A stroke has a point after this many pixels, or this share of an edge.
const STEP_PIXELS = 6;
const STEP_EDGES = 0.4;
// A stroke ends where the surface is farther away than this many times what the mouse moved: there another sheet begins.
const JUMP = 6;

class Drawing {
  // Vertices and the mean edge length in positions; `frame` maps positions to model units.
  constructor(vertices, edge, frame) {
    Object.assign(this, { vertices, edge, frame, strokes: [], open: null, history: [] });
    this.factors = new Float32Array(vertices.length / 3).fill(1);
  }

  // Goes on to draw on another mesh: strokes stay, as they are on the surface, and each vertex has the size of the nearest one before.
  moveTo({ vertices, edge, frame }) {
    const from = this.frame;
    this.strokes.forEach((stroke) => { stroke.points = stroke.points.map((place) => frame.position(from.model(place))); });
    const steps = this.history.filter((step) => step.factors), count = vertices.length / 3;
    let before = () => -1;
    if (steps.length > 0) {
      const grid = new Grid(this.vertices, this.edge);
      const nearest = Int32Array.from({ length: count }, (_, v) => grid.nearest(from.position(frame.model(vertices.subarray(3 * v, 3 * v + 3)))));
      before = (v) => nearest[v];
    }
    const carried = (factors) => Float32Array.from({ length: count }, (_, v) => factors[before(v)] ?? 1);
    steps.forEach((step) => { step.factors = carried(step.factors); });
    Object.assign(this, { vertices, edge, frame, open: null, factors: carried(this.factors) });
  }

  get lineCount() {
    return this.strokes.length;
  }

  get paintedCount() {
    return this.factors.reduce((count, factor) => count + (factor !== 1), 0);
  }

  // Begins a stroke; the radius is in mean edges, and without a weight it is followed exactly.
  beginStroke(place, radius, weight) {
    this.open = { points: [place], radius, weight };
  }

  // Leads the stroke on to a place; `pixel` is the length of a pixel. False: it ended, as the place is on another sheet.
  extendStroke(place, moved, pixel) {
    const { points } = this.open, last = points[points.length - 1], distance = lengthOf(add(place, last, -1));
    if (distance > JUMP * Math.max(moved, pixel) + 2 * pixel) {
      this.endStroke();
      return false;
    }
    if (distance >= Math.max(STEP_PIXELS * pixel, STEP_EDGES * this.edge)) points.push(place);
    return true;
  }

  endStroke() {
    if (this.open && this.open.points.length > 1) {
      this.strokes.push(this.open);
      this.history.push({ stroke: this.open });
    }
    this.open = null;
  }

  // Begins a stroke of the brush, which is undone as a whole.
  beginPaint() {
    this.history.push({ factors: this.factors.slice() });
  }

  // Sets the wanted edge length, over the mean, round a place.
  paint(place, radius, factor) {
    const { vertices, factors } = this, reach = (radius * this.edge) ** 2;
    for (let v = 0; v < factors.length; v++) {
      const [x, y, z] = [0, 1, 2].map((k) => vertices[3 * v + k] - place[k]);
      if (x * x + y * y + z * z <= reach) factors[v] = factor;
    }
  }

  undo() {
    const step = this.history.pop();
    if (step?.stroke) this.strokes = this.strokes.filter((stroke) => stroke !== step.stroke);
    if (step?.factors) this.factors = step.factors;
  }

  clear() {
    Object.assign(this, { strokes: [], open: null, history: [] });
    this.factors = new Float32Array(this.factors.length).fill(1);
  }

  // The ends of all lines of strokes.
  lines() {
    const strokes = this.open ? [...this.strokes, this.open] : this.strokes;
    return Float32Array.from(strokes.flatMap(({ points }) => points.slice(1).flatMap((place, k) => [...points[k], ...place])));
  }

  // The file of guides, as JSON in model units.
  guides() {
    const { frame, edge } = this;
    const strokes = this.strokes.map(({ points, radius, weight }) => ({
      points: points.map((place) => frame.model(place).map(rounded)),
      ...(radius > 0 ? { radius: rounded(radius * edge * frame.diagonal) } : {}),
      ...(weight ? { weight } : {}),
    }));
    const lines = strokes.map((stroke) => `    ${JSON.stringify(stroke)}`);
    return `{\n  "strokes": [\n${lines.join(",\n")}\n  ]\n}\n`;
  }

  // The file of sizes, as CSV in model units: a line for each vertex of the mesh.
  sizes() {
    const { frame, edge, vertices } = this, lines = ["x,y,z,size"];
    this.factors.forEach((factor, v) => {
      const place = frame.model(vertices.subarray(3 * v, 3 * v + 3));
      if (place.every(Number.isFinite)) lines.push([...place, factor * edge * frame.diagonal].map(rounded).join(","));
    });
    return `${lines.join("\n")}\n`;
  }
}

// Positions have some seven digits.
const rounded = (number) => Number(number.toPrecision(9));
