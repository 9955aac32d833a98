// The page: its scene and its controls.

const canvas = byId("canvas");
const gl = canvas.getContext("webgl2", { alpha: false, antialias: true });

let scene, drawing, strokes;
let mode = "turn";
let programs;
// Whether a frame is asked for, and whether what was drawn is to be shown in it.
let isStale = false, isDrawn = false;

// Shows some data; what was drawn before stays, and so does the view.
function show(data) {
  const before = scene;
  scene = new Scene(gl, programs, data);
  const target = { vertices: scene.mesh.faces.points, edge: scene.edge, frame: scene.frame };
  if (drawing) drawing.moveTo(target); else drawing = new Drawing(target.vertices, target.edge, target.frame);
  strokes?.free();
  strokes = new LineLayer(gl, programs, { name: "strokes", colour: "#d0208c", width: 4, shown: true, ends: drawing.lines() });
  before?.free();
  resize();
  if (before) scene.camera.follow(before.camera, before.frame, scene.frame); else scene.camera.look(data.views[0][1]);
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
    switchFor({ id, label, key, colour: colour ? css(colour) : "currentColor", count, checked: layer.shown }, (shown) => {
      layer.shown = shown;
      hideOthers(layer);
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
    ...lines.map((line) => layer(line, line.name, line.name, "line", scene.isInk(line) ? null : line.rgb)),
    ...dots.map((dot) => layer(dot, dot.name, dot.name, dot.ring ? "ring" : "dot", dot.rgb, dot.count)),
  );
}

// The faces of the mesh and what lies below them hide each other: of these one kind is shown.
function hideOthers(layer) {
  const { mesh, surface, tiles } = scene, below = [surface, tiles].filter((other) => other);
  const others = !layer.shown ? [] : layer === mesh ? below : below.includes(layer) ? [mesh] : [];
  others.forEach((other) => { other.shown = false; });
  [["faces", mesh], ["surface", surface], ["tiles", tiles]].filter(([, kind]) => kind).forEach(([id, kind]) => {
    document.querySelector(`[data-layer="${id}"]`).checked = kind.shown;
  });
  // Below tiles the surface has the colour of grout.
  surface?.paint(() => (tiles?.shown ? scene.palette.grout : scene.palette.surface));
}

// The choices of what colours faces.
function showColours() {
  const choices = [["sides", "number of sides"], ...scene.scales.map((scale, k) => [`scale-${k}`, scale.title])];
  if (scene.regions) choices.push(["regions", "regions"]);
  choices.push(["sizes", "painted sizes"]);
  const options = choices.map(([value, textContent]) => element("option", { value, textContent }));
  const chosen = byId("colour").value;
  byId("colour").replaceChildren(...options);
  if (choices.some(([value]) => value === chosen)) byId("colour").value = chosen;
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
  if (isDrawn) showDrawn();
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
  // Where edges are short, lines of full width and strength would hide the faces.
  const length = edge * camera.scale, width = Math.min(0.7, 0.12 * length), strength = Math.min(0.75, 0.07 * length);
  if (mesh.shown || scene.edges) {
    mesh.draw(scene, {
      lift, isFilled: mesh.shown, edge: scene.edges ? (mesh.shown ? width : Math.max(width, 0.5)) : 0, strength, contrast: scene.isMeasured ? 0.5 : 1,
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

// Shows what changed by drawing: counts and buttons at once, lines and colours with the next frame.
function drawn() {
  const { lineCount, paintedCount } = drawing;
  byId("stroke-count").textContent = lineCount === 0 ? "no stroke" : lineCount === 1 ? "1 stroke" : `${lineCount} strokes`;
  byId("size-count").textContent = paintedCount === 0 ? "nothing painted" : `${paintedCount.toLocaleString("en")} vertices painted`;
  byId("save-guides").disabled = lineCount === 0;
  byId("save-sizes").disabled = paintedCount === 0;
  byId("undo").disabled = drawing.history.length === 0;
  byId("clear").disabled = lineCount + paintedCount === 0;
  isDrawn = true;
  refresh();
}

function showDrawn() {
  isDrawn = false;
  strokes.set(drawing.lines());
  if (byId("colour").value === "sizes") recolour();
}
