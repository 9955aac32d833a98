// The nearest of some points, by a grid of cubes.

// Points farther away than so many cubes are not looked for.
const FARTHEST = 8;

// The cubes that are so many away from one.
function* cubesAround([i, j, k], ring) {
  for (let x = -ring; x <= ring; x++) {
    for (let y = -ring; y <= ring; y++) {
      const step = Math.max(Math.abs(x), Math.abs(y)) === ring ? 1 : 2 * ring;
      for (let z = -ring; z <= ring; z += step) yield [i + x, j + y, k + z];
    }
  }
}

class Grid {
  // `side`: that of a cube; best about as long as points are apart.
  constructor(points, side) {
    Object.assign(this, { points, side, cells: new Map() });
    for (let v = 0; v < points.length / 3; v++) {
      const key = this.cellOf(this.at(v)).join();
      if (this.cells.has(key)) this.cells.get(key).push(v); else this.cells.set(key, [v]);
    }
  }

  at(v) {
    return this.points.subarray(3 * v, 3 * v + 3);
  }

  cellOf(place) {
    return Array.from(place, (x) => Math.floor(x / this.side));
  }

  // The point nearest to a place; -1 where none is within `FARTHEST` cubes.
  nearest(place) {
    const middle = this.cellOf(place);
    let best = Infinity, found = -1;
    // Whatever is outside of the cubes seen so far is farther away than so many sides.
    for (let ring = 0; ring <= FARTHEST && best > (ring - 1) * this.side; ring++) {
      for (const cell of cubesAround(middle, ring)) {
        for (const v of this.cells.get(cell.join()) ?? []) {
          const distance = lengthOf(add(place, this.at(v), -1));
          if (distance < best) [best, found] = [distance, v];
        }
      }
    }
    return found;
  }
}
