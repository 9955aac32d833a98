// What is drawn: each layer is one call.

// Triangles that turn by less than this are one smooth surface: the cosine of 40 degrees.
const SMOOTH = 0.766;

// A normal for each corner of triangles: the sum over those at its vertex that turn little from its own.
function cornerNormals(points, vertices) {
  const count = vertices.length / 3, normals = [], around = new Map();
  for (let t = 0; t < count; t++) {
    const [a, b, c] = [0, 1, 2].map((k) => points.subarray(3 * vertices[3 * t + k], 3 * vertices[3 * t + k] + 3));
    normals.push(cross(add(b, a, -1), add(c, a, -1)));
    for (let k = 0; k < 3; k++) {
      const v = vertices[3 * t + k];
      if (around.has(v)) around.get(v).push(t); else around.set(v, [t]);
    }
  }
  const units = normals.map(unit), result = new Float32Array(9 * count);
  for (let corner = 0; corner < 3 * count; corner++) {
    const own = units[Math.floor(corner / 3)];
    let sum = [0, 0, 0];
    for (const t of around.get(vertices[corner])) if (dot(units[t], own) > SMOOTH) sum = add(sum, normals[t]);
    result.set(unit(sum), 3 * corner);
  }
  return result;
}

function bufferOf(gl, numbers, usage = gl.STATIC_DRAW) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, usage);
  return buffer;
}

// A layer: its program, its vertices, and whether it is shown.
class Layer {
  constructor(gl, program) {
    Object.assign(this, { gl, program, shown: true, vertices: gl.createVertexArray() });
  }

  // Numbers of an attribute; `each`: they change with each so many instances.
  attribute(name, buffer, components, { type = this.gl.FLOAT, normalised = false, stride = 0, offset = 0, each = 0 } = {}) {
    const { gl } = this, place = this.program.attribute(name);
    gl.bindVertexArray(this.vertices);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, components, type, normalised, stride, offset);
    gl.vertexAttribDivisor(place, each);
  }

  // Prepares a call; `lift` units towards the eye, so that it lies before what it lies on.
  begin(scene, lift) {
    const { gl, program } = this, { camera } = scene;
    gl.useProgram(program.program);
    gl.bindVertexArray(this.vertices);
    gl.uniformMatrix4fv(program.uniform("u_matrix"), false, camera.matrix());
    gl.uniformMatrix3fv(program.uniform("u_turn"), true, camera.turn.flat());
    gl.uniform4fv(program.uniform("u_slice"), scene.slice);
    gl.uniform1f(program.uniform("u_lift"), lift / DEPTH);
    gl.uniform2fv(program.uniform("u_size"), camera.size.map((side) => side * scene.density));
  }

  colour(name, colour) {
    this.gl.uniform3fv(this.program.uniform(name), colour.map((part) => part / 255));
  }

  free() {
    this.gl.deleteVertexArray(this.vertices);
    (this.buffers ?? []).forEach((buffer) => this.gl.deleteBuffer(buffer));
  }
}

class FaceLayer extends Layer {
  constructor(gl, programs, faces, isSmooth) {
    super(gl, programs.faces);
    const triangles = trianglesOf(faces), { vertices, sides } = triangles;
    const places = new Float32Array(3 * vertices.length), side = new Uint8Array(3 * vertices.length);
    for (let corner = 0; corner < vertices.length; corner++) {
      const v = 3 * vertices[corner];
      for (let k = 0; k < 3; k++) {
        places[3 * corner + k] = faces.points[v + k];
        // A side that is none of the face is far away everywhere.
        const real = (sides[Math.floor(corner / 3)] >> k) & 1;
        side[3 * corner + k] = !real || corner % 3 === k ? 255 : 0;
      }
    }
    Object.assign(this, { faces, triangles, colours: new Uint8Array(3 * vertices.length) });
    this.buffers = [bufferOf(gl, places), bufferOf(gl, side), bufferOf(gl, this.colours, gl.DYNAMIC_DRAW)];
    this.attribute("a_position", this.buffers[0], 3);
    this.attribute("a_side", this.buffers[1], 3, { type: gl.UNSIGNED_BYTE, normalised: true });
    this.attribute("a_colour", this.buffers[2], 3, { type: gl.UNSIGNED_BYTE, normalised: true });
    if (isSmooth) {
      this.buffers.push(bufferOf(gl, cornerNormals(faces.points, vertices)));
      this.attribute("a_normal", this.buffers[3], 3);
    }
  }

  // Colours by a function of the face and the vertex; each colour is red, green and blue to 255.
  paint(colour) {
    const { gl, triangles: { vertices, faces }, colours } = this;
    for (let corner = 0; corner < vertices.length; corner++) {
      colours.set(colour(faces[Math.floor(corner / 3)], vertices[corner]), 3 * corner);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[2]);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, colours);
  }

  // `edge`: half the width of sides in pixels, 0 for none; `strength`: how much of them is ink.
  draw(scene, { lift = 0, isFilled = true, edge = 0, strength = 1, contrast = 1 } = {}) {
    const { gl, program } = this;
    this.begin(scene, lift);
    this.colour("u_back", scene.palette.back);
    this.colour("u_ink", isFilled ? scene.palette.ink : scene.ink);
    gl.uniform1f(program.uniform("u_contrast"), contrast);
    gl.uniform1f(program.uniform("u_edge"), edge * scene.density);
    gl.uniform1f(program.uniform("u_strength"), strength);
    gl.uniform1i(program.uniform("u_filled"), isFilled);
    // Lines alone are smooth by how much of a pixel they cover.
    if (!isFilled) gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    gl.drawArrays(gl.TRIANGLES, 0, this.triangles.vertices.length);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  }
}

class LineLayer extends Layer {
  constructor(gl, programs, { name, colour, width, shown, ends }) {
    super(gl, programs.lines);
    Object.assign(this, { name, rgb: rgb(colour), width, shown });
    this.buffers = [gl.createBuffer()];
    this.attribute("a_start", this.buffers[0], 3, { stride: 24, each: 1 });
    this.attribute("a_end", this.buffers[0], 3, { stride: 24, offset: 12, each: 1 });
    this.set(ends);
  }

  // Six numbers a line.
  set(ends) {
    const { gl } = this;
    this.count = ends.length / 6;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[0]);
    gl.bufferData(gl.ARRAY_BUFFER, ends, gl.DYNAMIC_DRAW);
  }

  draw(scene, lift) {
    const { gl, program } = this;
    if (this.count === 0) return;
    this.begin(scene, lift);
    this.colour("u_colour", scene.isInk(this) ? scene.ink : this.rgb);
    gl.uniform1f(program.uniform("u_width"), this.width * scene.density);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.count);
  }
}

class DotLayer extends Layer {
  constructor(gl, programs, { name, colour, width, ring, shown, points }) {
    super(gl, programs.dots);
    Object.assign(this, { name, rgb: rgb(colour), width, ring, shown, count: points.length / 3 });
    this.buffers = [bufferOf(gl, points)];
    this.attribute("a_position", this.buffers[0], 3);
  }

  draw(scene, lift) {
    const { gl, program } = this;
    if (this.count === 0) return;
    this.begin(scene, lift);
    this.colour("u_colour", this.rgb);
    gl.uniform1f(program.uniform("u_width"), this.width * scene.density);
    gl.uniform1i(program.uniform("u_ring"), this.ring);
    gl.drawArrays(gl.POINTS, 0, this.count);
  }
}
