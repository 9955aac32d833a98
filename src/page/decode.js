// Arrays of the page's data: little-endian bytes in base64.

function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

const floats = (text) => new Float32Array(bytesOf(text).buffer);
const indices = (text) => new Uint32Array(bytesOf(text).buffer);

// Faces: positions, the vertices of all faces, and the end of each face in these.
function facesOf(faces) {
  const points = floats(faces.points);
  const corners = faces.corners ? indices(faces.corners) : Uint32Array.from({ length: points.length / 3 }, (_, i) => i);
  const ends = faces.ends ? indices(faces.ends) : Uint32Array.from({ length: corners.length / 3 }, (_, i) => 3 * i + 3);
  return { points, corners, ends };
}

// The triangles of faces: for each its three vertices, its face, and which of its sides are sides of the face (bit k: the side
// opposite to corner k). A quad is cut along its shorter diagonal.
function trianglesOf({ points, corners, ends }) {
  let count = 0;
  for (let face = 0, start = 0; face < ends.length; start = ends[face++]) count += Math.max(ends[face] - start - 2, 0);
  const vertices = new Uint32Array(3 * count), faces = new Uint32Array(count), sides = new Uint8Array(count);
  let next = 0;
  const add = (face, a, b, c, real) => {
    vertices.set([a, b, c], 3 * next);
    faces[next] = face;
    sides[next++] = real;
  };
  const distance = (a, b) =>
    Math.hypot(points[3 * a] - points[3 * b], points[3 * a + 1] - points[3 * b + 1], points[3 * a + 2] - points[3 * b + 2]);
  for (let face = 0, start = 0; face < ends.length; start = ends[face++]) {
    const corner = corners.subarray(start, ends[face]), last = corner.length - 1;
    if (corner.length === 4 && distance(corner[1], corner[3]) < distance(corner[0], corner[2])) {
      add(face, corner[1], corner[2], corner[3], 0b101);
      add(face, corner[3], corner[0], corner[1], 0b101);
      continue;
    }
    for (let k = 1; k < last; k++) {
      add(face, corner[0], corner[k], corner[k + 1], 1 | (k === last - 1 ? 2 : 0) | (k === 1 ? 4 : 0));
    }
  }
  return { vertices, faces, sides };
}

// Red, green and blue of "#rrggbb".
const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
