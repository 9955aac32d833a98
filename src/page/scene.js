// What is shown: the layers of some data, and the view.

class Scene {
  constructor(gl, programs, data) {
    this.data = data;
    this.palette = Object.fromEntries(Object.entries(data.palette).map(([name, colour]) =>
      [name, Array.isArray(colour) ? colour.map(rgb) : rgb(colour)]));
    this.frame = {
      centre: data.centre,
      diagonal: data.diagonal,
      model: (place) => [0, 1, 2].map((k) => place[k] * data.diagonal + data.centre[k]),
      position: (place) => scaled(add(place, data.centre, -1), 1 / data.diagonal),
    };
    this.edge = data.edge / data.diagonal;
    this.mesh = new FaceLayer(gl, programs, facesOf(data.mesh), false);
    this.surface = data.surface && new FaceLayer(gl, programs, facesOf(data.surface), true);
    this.tiles = data.tiles && new FaceLayer(gl, programs, facesOf(data.tiles), false);
    this.surface?.paint(() => this.palette.surface);
    this.tiles?.paint((tile) => this.palette.tiles[(tile * 7919) % this.palette.tiles.length]);
    for (const layer of [this.surface, this.tiles]) if (layer) layer.shown = false;
    this.lines = data.lines.map((lines) => new LineLayer(gl, programs, { ...lines, ends: floats(lines.ends) }));
    this.dots = data.dots.map((dots) => new DotLayer(gl, programs, { ...dots, points: floats(dots.points) }));
    this.scales = data.scales.map((scale) => ({ ...scale, colours: scale.ramp.map(rgb), shares: floats(scale.shares) }));
    this.sizes = { ...data.sizes, colours: data.sizes.ramp.map(rgb) };
    this.regions = data.regions && { ...data.regions, of: indices(data.regions.of_face), colours: data.regions.colours.map(rgb) };
    this.edges = true;
    this.box = boxOf(this.mesh.faces);
    this.camera = new Camera(this.box);
    this.slice = [0, 0, 0, 1];
  }

  free() {
    [this.mesh, this.surface, this.tiles, ...this.lines, ...this.dots].forEach((layer) => layer?.free());
  }

  // What strokes are drawn on.
  get ground() {
    return this.surface ?? this.mesh;
  }

  // Whether a layer has the colour of text.
  isInk(layer) {
    return layer.rgb.every((part, k) => part === this.palette.ink[k]);
  }

  isSeen(place) {
    return dot(this.slice, place) <= this.slice[3];
  }

  // Builds what places are found by, which takes some tenths of a second on a large surface.
  prepare() {
    this.tree ??= new Tree(this.ground.faces.points, this.ground.triangles.vertices);
  }

  // The place on the surface that is seen at some pixels; null where there is none.
  pick(x, y) {
    this.prepare();
    const eye = this.camera.turn[2], from = add(this.camera.place(x, y), eye, DEPTH);
    return this.tree.first(from, scaled(eye, -1), (place) => this.isSeen(place));
  }
}

// The corners of the box round the vertices that faces use.
function boxOf({ points, corners }) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const v of corners) {
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], points[3 * v + axis]);
      high[axis] = Math.max(high[axis], points[3 * v + axis]);
    }
  }
  return [low, high];
}
