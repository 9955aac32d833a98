// Where a straight line meets triangles, by a tree of boxes.

// A box of no more triangles is not divided.
const LEAF = 6;

class Tree {
  constructor(points, vertices) {
    const count = vertices.length / 3;
    Object.assign(this, { points, vertices, order: Uint32Array.from({ length: count }, (_, t) => t), nodes: [] });
    this.middles = new Float32Array(3 * count);
    for (let t = 0; t < count; t++) {
      for (let axis = 0; axis < 3; axis++) {
        const [a, b, c] = [0, 1, 2].map((k) => points[3 * vertices[3 * t + k] + axis]);
        this.middles[3 * t + axis] = (a + b + c) / 3;
      }
    }
    if (count > 0) this.divide(0, count);
  }

  corner(t, k) {
    const v = 3 * this.vertices[3 * t + k];
    return [this.points[v], this.points[v + 1], this.points[v + 2]];
  }

  // Makes the node of a run of triangles; its number.
  divide(start, end) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const least = [...low], most = [...high];
    for (let i = start; i < end; i++) {
      const t = this.order[i];
      for (let axis = 0; axis < 3; axis++) {
        for (let k = 0; k < 3; k++) {
          const x = this.points[3 * this.vertices[3 * t + k] + axis];
          low[axis] = Math.min(low[axis], x);
          high[axis] = Math.max(high[axis], x);
        }
        least[axis] = Math.min(least[axis], this.middles[3 * t + axis]);
        most[axis] = Math.max(most[axis], this.middles[3 * t + axis]);
      }
    }
    const number = this.nodes.length, node = { low, high, start, end, children: null };
    this.nodes.push(node);
    if (end - start > LEAF) {
      const extent = most.map((x, axis) => x - least[axis]), axis = extent.indexOf(Math.max(...extent));
      const limit = (least[axis] + most[axis]) / 2;
      let middle = start;
      for (let i = start; i < end; i++) {
        const t = this.order[i];
        if (this.middles[3 * t + axis] < limit) {
          this.order[i] = this.order[middle];
          this.order[middle++] = t;
        }
      }
      if (middle === start || middle === end) middle = (start + end) >> 1;
      node.children = [this.divide(start, middle), this.divide(middle, end)];
    }
    return number;
  }

  // The first point from an origin on along a way that is not cut away; null where there is none.
  first(origin, way, isSeen) {
    let best = Infinity, found = null;
    const open = this.nodes.length > 0 ? [0] : [];
    while (open.length > 0) {
      const node = this.nodes[open.pop()];
      let [enter, leave] = [-Infinity, best];
      for (let axis = 0; axis < 3; axis++) {
        const [a, b] = [(node.low[axis] - origin[axis]) / way[axis], (node.high[axis] - origin[axis]) / way[axis]];
        // A way along the box gives no number where it is in the box's side.
        if (a === a && b === b) [enter, leave] = [Math.max(enter, Math.min(a, b)), Math.min(leave, Math.max(a, b))];
      }
      if (enter > leave) continue;
      if (node.children) {
        open.push(...node.children);
        continue;
      }
      for (let i = node.start; i < node.end; i++) {
        const share = this.meets(this.order[i], origin, way), place = add(origin, way, share);
        if (share < best && isSeen(place)) [best, found] = [share, place];
      }
    }
    return found;
  }

  // Moeller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
  meets(t, origin, way) {
    const a = this.corner(t, 0), ab = add(this.corner(t, 1), a, -1), ac = add(this.corner(t, 2), a, -1);
    const p = cross(way, ac), volume = dot(ab, p);
    if (volume === 0) return Infinity;
    const from = add(origin, a, -1), u = dot(from, p) / volume, q = cross(from, ab), v = dot(way, q) / volume;
    return u >= 0 && v >= 0 && u + v <= 1 ? dot(ac, q) / volume : Infinity;
  }
}
