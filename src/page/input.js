// What the mouse and the keys do.

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
  if (mode !== "turn") scene.prepare();
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
