// Programs for the three kinds of layers: faces, lines and dots. What is before the plane of the slice is left out.

const COMMON = `#version 300 es
precision highp float;
uniform mat4 u_matrix;
uniform mat3 u_turn;
uniform vec4 u_slice;
uniform float u_lift;
uniform vec2 u_size;
`;
const VERTEX = `${COMMON}
out vec3 v_place;
vec4 seen(vec3 place) {
  v_place = place;
  vec4 at = u_matrix * vec4(place, 1.0);
  at.z -= u_lift;
  return at;
}
`;
const FRAGMENT = `${COMMON}
in vec3 v_place;
out vec4 o_colour;
void slice() {
  if (dot(u_slice.xyz, v_place) > u_slice.w) discard;
}
`;

// Faces have their sides drawn in the same pass, so that lines are hidden exactly where faces are. A lamp is above the left shoulder.
const SHADERS = {
  faces: [`${VERTEX}
in vec3 a_position;
in vec3 a_normal;
in vec3 a_side;
in vec3 a_colour;
out vec3 v_normal;
out vec3 v_side;
out vec3 v_colour;
void main() {
  v_normal = a_normal;
  v_side = a_side;
  v_colour = a_colour;
  gl_Position = seen(a_position);
}`, `${FRAGMENT}
uniform vec3 u_back;
uniform vec3 u_ink;
uniform float u_contrast;
uniform float u_edge;
uniform float u_strength;
uniform bool u_filled;
in vec3 v_normal;
in vec3 v_side;
in vec3 v_colour;
void main() {
  vec3 flat_normal = cross(dFdx(v_place), dFdy(v_place));
  vec3 wide = fwidth(v_side);
  slice();
  vec3 near = v_side / max(wide, vec3(1e-9));
  float line = u_edge > 0.0 ? 1.0 - smoothstep(u_edge - 0.5, u_edge + 0.5, min(near.x, min(near.y, near.z))) : 0.0;
  if (!u_filled && line < 0.02) discard;
  bool smooth_normal = dot(v_normal, v_normal) > 0.0;
  vec3 normal = u_turn * normalize(smooth_normal ? v_normal : flat_normal);
  if (normal.z < 0.0) normal = -normal;
  float light = 0.4 + 0.6 * max(dot(normal, normalize(vec3(-0.35, 0.5, 1.0))), 0.0) + 0.1 * (0.5 + 0.5 * normal.y);
  light = 1.0 - u_contrast * (1.0 - min(light, 1.0));
  vec3 colour = gl_FrontFacing ? v_colour * light : u_back * 0.9 * light;
  o_colour = u_filled ? vec4(mix(colour, u_ink, u_strength * line), 1.0) : vec4(u_ink, line);
}`],
  lines: [`${VERTEX}
uniform float u_width;
in vec3 a_start;
in vec3 a_end;
void main() {
  vec4 start = seen(a_start), end = seen(a_end);
  vec2 way = (end.xy - start.xy) * u_size;
  vec2 along = length(way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
  float side = (gl_VertexID & 1) == 0 ? -0.5 : 0.5;
  bool first = gl_VertexID < 2;
  v_place = first ? a_start : a_end;
  // A little over the ends, so that no gap is seen where lines meet.
  vec2 offset = vec2(-along.y, along.x) * side + along * (first ? -0.25 : 0.25);
  gl_Position = first ? start : end;
  gl_Position.xy += 2.0 * u_width * offset / u_size;
}`, `${FRAGMENT}
uniform vec3 u_colour;
void main() {
  slice();
  o_colour = vec4(u_colour, 1.0);
}`],
  dots: [`${VERTEX}
uniform float u_width;
in vec3 a_position;
void main() {
  gl_Position = seen(a_position);
  gl_PointSize = u_width;
}`, `${FRAGMENT}
uniform vec3 u_colour;
uniform float u_width;
uniform bool u_ring;
void main() {
  slice();
  float away = length(gl_PointCoord - 0.5) * u_width;
  float outside = u_width / 2.0, inside = u_ring ? outside - u_width / 5.0 : -1.0;
  if (away > outside || away < inside) discard;
  o_colour = vec4(u_colour, 1.0);
}`],
};

class Program {
  constructor(gl, [vertex, fragment]) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) {
      const shaders = gl.getAttachedShaders(this.program).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error([gl.getProgramInfoLog(this.program), ...shaders].join("\n"));
    }
    this.places = new Map();
  }

  uniform(name) {
    if (!this.places.has(name)) this.places.set(name, this.gl.getUniformLocation(this.program, name));
    return this.places.get(name);
  }

  attribute(name) {
    return this.gl.getAttribLocation(this.program, name);
  }
}
