// The start, and what scripts may call.

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
    const box = canvas.getBoundingClientRect(), [x, y] = scene.camera.project(scene.frame.position(place));
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
