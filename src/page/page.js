// The page: what it shows, and what the mouse and the keys do.

const canvas = byId("canvas");
const gl = canvas.getContext("webgl2", { antialias: true });

// The layers of some data, and their state.
class Scene {
  constructor(data) {
    this.data = data;
    this.palette = Object.fromEntries(Object.entries(data.palette).map(([name, colour]) =>
      [name, Array.isArray(colour) ? colour.map(rgb) : rgb(colour)]));
    this.frame = {
      centre: data.centre,
      diagonal: data.diagonal,
      model: (place) => [0, 1, 2].map((k) => place[k] * data.diagonal + data.centre[k]),
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
    return (this.surface ?? this.mesh);
  }

  isSeen(place) {
    return dot(this.slice, place) <= this.slice[3];
  }

  // The place on the surface that is seen at some pixels; null where there is none.
  pick(x, y) {
    this.tree ??= new Tree(this.ground.faces.points, this.ground.triangles.vertices);
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

let scene, drawing, strokes;
let mode = "turn";
let programs;
let isStale = false;

// Shows some data; what was drawn before stays.
function show(data) {
  const before = scene;
  scene = new Scene(data);
  const target = { vertices: scene.mesh.faces.points, edge: scene.edge, frame: scene.frame };
  if (drawing) drawing.moveTo(target); else drawing = new Drawing(target.vertices, target.edge, target.frame);
  strokes = new LineLayer(gl, programs, { name: "strokes", colour: "#d0208c", width: 4, shown: true, ends: drawing.lines() });
  before?.free();
  resize();
  scene.camera.look(data.views[0][1]);
  showFigures(data);
  showViews(data);
  showSwitches();
  showColours();
  setSlice();
  recolour();
  drawn();
}

function showViews(data) {
  byId("views").replaceChildren(...data.views.map(([name, turn]) => {
    const button = element("button", { type: "button", textContent: name });
    button.addEventListener("click", () => {
      scene.camera.look(turn);
      setSlice();
    });
    return button;
  }));
}

function showSwitches() {
  const { mesh, surface, tiles, lines, dots, palette } = scene, css = (colour) => `rgb(${colour.join()})`;
  const layer = (layer, id, label, key, colour, count) =>
    switchFor({ id, label, key, colour: css(colour), count, checked: layer.shown }, (shown) => {
      layer.shown = shown;
      refresh();
    });
  const count = (layer) => layer.faces.ends.length;
  byId("switches").replaceChildren(
    layer(mesh, "faces", "faces of the mesh", "", palette.quad, count(mesh)),
    switchFor({ id: "edges", label: "edges of the mesh", key: "line", colour: "currentColor", checked: scene.edges }, (shown) => {
      scene.edges = shown;
      refresh();
    }),
    ...(surface ? [layer(surface, "surface", "input surface", "", palette.surface, count(surface))] : []),
    ...(tiles ? [layer(tiles, "tiles", "tiles", "", palette.tiles[0], count(tiles))] : []),
    ...lines.map((line) => layer(line, line.name, line.name, "line", isInk(line) ? [] : line.rgb, undefined)),
    ...dots.map((dot) => layer(dot, dot.name, dot.name, dot.ring ? "ring" : "dot", dot.rgb, dot.count)),
  );
}

const isInk = (line) => line.rgb.every((part, k) => part === scene.palette.ink[k]);

// The choices of what colours faces.
function showColours() {
  const choices = [["sides", "number of sides"], ...scene.scales.map((scale, k) => [`scale-${k}`, scale.title])];
  if (scene.regions) choices.push(["regions", "regions"]);
  choices.push(["sizes", "painted sizes"]);
  const options = choices.map(([value, textContent]) => element("option", { value, textContent }));
  byId("colour").replaceChildren(...options);
}

// Colours the faces as chosen.
function recolour() {
  const { mesh, palette, scales, regions, sizes } = scene, chosen = byId("colour").value;
  const ramp = (scale, share) =>
    Number.isNaN(share) ? palette.back : scale.colours[Math.round(Math.min(Math.max(share, 0), 1) * (scale.colours.length - 1))];
  const scale = chosen === "sizes" ? sizes : scales[Number(chosen.split("-")[1])];
  const { ends } = mesh.faces, areTriangles = ends.length * 3 === mesh.faces.corners.length;
  const bySides = (face) => {
    const sides = ends[face] - (face > 0 ? ends[face - 1] : 0);
    if (areTriangles) return palette.surface;
    return sides === 3 ? palette.triangle : sides === 4 ? palette.quad : palette.polygon;
  };
  mesh.paint({
    sides: bySides,
    regions: (face) => regions.colours[regions.of[face]],
    sizes: (_, v) => ramp(sizes, 0.5 + Math.log2(drawing.factors[v]) / 4),
  }[chosen] ?? ((face) => ramp(scale, scale.shares[face])));
  scene.isMeasured = chosen !== "sides";
  showLegend(scale);
  const names = chosen === "regions" ? regions.names : [];
  byId("regions").replaceChildren(...names.map((name, k) => {
    const key = element("span", { className: "key" });
    key.style.background = scene.data.regions.colours[k];
    return element("li", {}, key, name || "without a name");
  }));
  refresh();
}

// The plane of the slice, by its controls.
function setSlice() {
  const axis = byId("slice-axis").value, share = Number(byId("slice").value), { box } = scene;
  byId("slice").disabled = axis === "none";
  if (axis === "none") {
    scene.slice = [0, 0, 0, 1];
  } else {
    let normal = axis === "eye" ? scene.camera.turn[2] : [0, 1, 2].map((k) => (k === Number(axis) ? 1 : 0));
    const corners = Array.from({ length: 8 }, (_, k) => [0, 1, 2].map((i) => box[(k >> i) & 1][i]));
    const heights = corners.map((corner) => dot(normal, corner));
    const [low, high] = [Math.min(...heights), Math.max(...heights)], sign = byId("slice-other").checked ? -1 : 1;
    scene.slice = [...scaled(normal, sign), sign * (low + (high - low) * share) + 1e-6];
  }
  refresh();
}

// Draws before the next picture of the browser.
function refresh() {
  if (!isStale) requestAnimationFrame(render);
  isStale = true;
}

function render() {
  isStale = false;
  const { mesh, surface, tiles, lines, dots, edge, camera } = scene;
  const probe = getComputedStyle(document.body);
  const [paper, text] = [probe.backgroundColor, probe.color].map((colour) => colour.match(/[\d.]+/g).slice(0, 3).map(Number));
  // On faces lines are dark; before the page they have the colour of its text.
  scene.ink = [mesh, surface, tiles].some((layer) => layer?.shown) ? scene.palette.ink : text;
  scene.density = canvas.width / camera.size[0];
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.clearColor(...paper.map((part) => part / 255), 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  const pixel = 1 / camera.scale;
  if (surface?.shown) surface.draw(scene);
  // Tiles are flat, and the surface bulges between their corners.
  if (tiles?.shown) tiles.draw(scene, { lift: 0.25 * edge });
  const lift = tiles?.shown ? 0.3 * edge : 0.1 * edge;
  // Where edges are smaller than some pixels, lines would hide the faces.
  const width = Math.min(0.7, 0.12 * edge * camera.scale);
  if (mesh.shown || scene.edges) {
    mesh.draw(scene, {
      lift, isFilled: mesh.shown, edge: scene.edges ? (mesh.shown ? width : Math.max(width, 0.5)) : 0, contrast: scene.isMeasured ? 0.5 : 1,
    });
  }
  lines.filter((layer) => layer.shown).forEach((layer) => layer.draw(scene, lift + 0.15 * edge + 2 * pixel));
  dots.filter((layer) => layer.shown).forEach((layer) => layer.draw(scene, lift + 0.2 * edge + 3 * pixel));
  strokes.draw(scene, lift + 0.25 * edge + 4 * pixel);
}

function resize() {
  const { clientWidth, clientHeight } = canvas, density = window.devicePixelRatio || 1;
  scene.camera.size = [Math.max(clientWidth, 1), Math.max(clientHeight, 1)];
  canvas.width = Math.round(scene.camera.size[0] * density);
  canvas.height = Math.round(scene.camera.size[1] * density);
  refresh();
}

// What changed by drawing: lines, counts and buttons.
function drawn() {
  strokes.set(drawing.lines());
  const { lineCount, paintedCount } = drawing;
  byId("stroke-count").textContent = lineCount === 0 ? "no stroke" : lineCount === 1 ? "1 stroke" : `${lineCount} strokes`;
  byId("size-count").textContent = paintedCount === 0 ? "nothing painted" : `${paintedCount.toLocaleString("en")} vertices painted`;
  byId("save-guides").disabled = lineCount === 0;
  byId("save-sizes").disabled = paintedCount === 0;
  byId("undo").disabled = drawing.history.length === 0;
  byId("clear").disabled = lineCount + paintedCount === 0;
  if (byId("colour").value === "sizes") recolour();
  refresh();
}

const HINTS = {
  turn: "",
  stroke: "Drag on the surface to draw a stroke. Control and drag turns.",
  size: "Drag on the surface to paint sizes. Control and drag turns.",
};

function setMode(wanted) {
  mode = wanted;
  byId("hint").textContent = HINTS[mode];
  canvas.classList.toggle("drawing", mode !== "turn");
  document.querySelectorAll("#modes button").forEach((button) =>
    button.setAttribute("aria-pressed", String(button.dataset.mode === mode)));
  if (mode === "size") {
    byId("colour").value = "sizes";
    recolour();
  }
}

// What a drag does, by the button, the keys and the mode.
function actionOf(event) {
  if (event.button === 1 || event.button === 2 || event.shiftKey) return "pan";
  return event.ctrlKey || mode === "turn" ? "turn" : mode;
}

const pixelsOf = (event) => {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};
const numberOf = (id, least) => Math.max(Number(byId(id).value) || 0, least);

let drag = null;

function paintAt(place) {
  if (place) drawing.paint(place, numberOf("size-radius", 0.1), Number(byId("size-factor").value));
  drawn();
}

function beginStroke(place) {
  drawing.beginStroke(place, numberOf("stroke-radius", 0), Number(byId("stroke-weight").value) || undefined);
}

const DRAGS = {
  turn: (event, [x, y]) => {
    scene.camera.rotate(x - drag.at[0], y - drag.at[1]);
    if (byId("slice-axis").value === "eye") setSlice();
  },
  pan: (event, [x, y]) => scene.camera.pan(x - drag.at[0], y - drag.at[1]),
  stroke: (event, at) => {
    const place = scene.pick(...at), pixel = 1 / scene.camera.scale;
    const moved = Math.hypot(at[0] - drag.drawn[0], at[1] - drag.drawn[1]) * pixel;
    const goesOn = place && drawing.open && drawing.extendStroke(place, moved, pixel);
    if (!place) drawing.endStroke();
    if (place && !goesOn) beginStroke(place);
    drag.drawn = at;
    drawn();
  },
  size: (event, at) => paintAt(scene.pick(...at)),
};

function begin(event) {
  const at = pixelsOf(event);
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  drag = { action: actionOf(event), at, drawn: at };
  if (drag.action === "stroke") {
    const place = scene.pick(...at);
    if (place) beginStroke(place);
  }
  if (drag.action === "size") {
    drawing.beginPaint();
    paintAt(scene.pick(...at));
  }
  event.preventDefault();
}

function move(event) {
  if (!drag) return;
  // All places since the last event, so that a quick stroke is smooth too.
  const events = event.getCoalescedEvents?.() ?? [];
  for (const one of events.length > 0 ? events : [event]) {
    const at = pixelsOf(one);
    DRAGS[drag.action](one, at);
    drag.at = at;
  }
  refresh();
}

function end() {
  drawing.endStroke();
  drag = null;
  drawn();
}

// Keys turn by so many pixels, and zoom by such a factor.
const KEY_PIXELS = 40;
const KEY_ZOOM = 1.2;

function press(event) {
  const { camera } = scene, ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const way = ways[event.key]?.map((part) => part * KEY_PIXELS);
  if (way && event.shiftKey) camera.pan(...way);
  else if (way) camera.rotate(...way);
  else if (["+", "="].includes(event.key)) camera.zoom(KEY_ZOOM);
  else if (event.key === "-") camera.zoom(1 / KEY_ZOOM);
  else if (event.key === "0") camera.look(camera.turn);
  else if (event.key === "z" && (event.ctrlKey || event.metaKey)) undo();
  else return;
  event.preventDefault();
  setSlice();
}

function undo() {
  drawing.undo();
  drawn();
}

function listen() {
  canvas.addEventListener("pointerdown", begin);
  canvas.addEventListener("pointermove", move);
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("keydown", press);
  canvas.addEventListener("wheel", (event) => {
    scene.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), ...pixelsOf(event));
    event.preventDefault();
    refresh();
  }, { passive: false });
  new ResizeObserver(resize).observe(canvas);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);
  document.querySelectorAll("#modes button").forEach((button) =>
    button.addEventListener("click", () => setMode(button.dataset.mode)));
  byId("undo").addEventListener("click", undo);
  byId("clear").addEventListener("click", () => {
    drawing.clear();
    drawn();
  });
  byId("save-guides").addEventListener("click", () => save("guides.json", drawing.guides()));
  byId("save-sizes").addEventListener("click", () => save("sizes.csv", drawing.sizes()));
  byId("colour").addEventListener("change", recolour);
  ["slice", "slice-axis", "slice-other"].forEach((id) => byId(id).addEventListener("input", setSlice));
}

if (gl) {
  programs = Object.fromEntries(Object.entries(SHADERS).map(([name, texts]) => [name, new Program(gl, texts)]));
  show(JSON.parse(byId("data").textContent));
  listen();
} else {
  byId("hint").textContent = "This browser has no WebGL 2, which the picture needs. The figures are shown all the same.";
  showFigures(JSON.parse(byId("data").textContent));
}

// For scripts: what was drawn as the texts of its files, where the surface is seen, other data to show, and the time of a frame.
window.quadmosaic = {
  guides: () => drawing.guides(),
  sizes: () => drawing.sizes(),
  show,
  // The place, in model units, that is seen at pixels of the window.
  pick: (clientX, clientY) => {
    const place = scene.pick(...pixelsOf({ clientX, clientY }));
    return place && scene.frame.model(place);
  },
  // The pixels of the window at which a place in model units is seen.
  project: (place) => {
    const { centre, diagonal } = scene.frame, box = canvas.getBoundingClientRect();
    const [x, y] = scene.camera.project(scaled(add(place, centre, -1), 1 / diagonal));
    return [x + box.left, y + box.top];
  },
  // The mean time of a frame in milliseconds, over so many in which the mesh turns.
  frameTime: (frames) => {
    const pixel = new Uint8Array(4), start = performance.now();
    for (let frame = 0; frame < frames; frame++) {
      scene.camera.rotate(7, 3);
      render();
      // Waits until it is drawn.
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    return (performance.now() - start) / frames;
  },
};
