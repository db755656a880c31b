// --- Lattices of nodes and the layers of cells in them that are shown: see scene.py

/** Lattices behind one another: where the nodes and cells of each begin, and steps along its directions. */
function laidOut(lattices) {
  let nodes = 0, cells = 0;
  return lattices.map((lattice) => {
    const { counts } = lattice;
    const laid = {
      ...lattice, node: nodes, cell: cells,
      nodeSteps: stepsOf(counts), cellSteps: stepsOf(counts.map((count) => count - 1)),
    };
    nodes += counts.reduce((product, count) => product * count, 1);
    cells += counts.reduce((product, count) => product * (count - 1), 1);
    return laid;
  });
}

function stepsOf(counts) {
  return counts.map((_, axis) => counts.slice(axis + 1).reduce((product, count) => product * count, 1));
}

/** A layer of cells of a lattice: what the painter draws, n x m cells. */
class Layer {
  constructor(lattice, sheet) {
    const along = lattice.counts.map((_, axis) => axis).filter((axis) => axis !== sheet.axis);
    const across = sheet.axis === null ? 0 : sheet.axis;
    const cellAcross = sheet.axis === null ? 0 : Math.min(sheet.node, lattice.counts[across] - 2);
    Object.assign(this, { lattice, along, axis: sheet.axis, node: sheet.node, cellAcross, sheet });
    this.first = sheet.ranges.map(([first]) => first);
    this.cells = sheet.ranges.map(([first, last]) => last - first);
    const at = (start, steps, index) => start + (sheet.axis === null ? 0 : index * steps[across]) +
      this.first.reduce((sum, first, k) => sum + first * steps[along[k]], 0);
    this.nodeBase = at(lattice.node, lattice.nodeSteps, sheet.node);
    this.cellBase = at(lattice.cell, lattice.cellSteps, cellAcross);
    this.nodeSteps = along.map((axis) => lattice.nodeSteps[axis]);
    this.cellSteps = along.map((axis) => lattice.cellSteps[axis]);
  }

  /** Number of the node (a, b) of the layer among all. */
  nodeAt(a, b) {
    return this.nodeBase + a * this.nodeSteps[0] + b * this.nodeSteps[1];
  }

  /** Number of the cell (a, b) of the layer among all. */
  cellAt(a, b) {
    return this.cellBase + a * this.cellSteps[0] + b * this.cellSteps[1];
  }

  /** Indices in its block of the cell (a, b): i, j or i, j, k. */
  indices(a, b) {
    const { lattice } = this;
    const own = new Array(lattice.counts.length).fill(0);
    this.along.forEach((axis, k) => (own[axis] = this.first[k] + [a, b][k]));
    if (this.axis !== null) own[this.axis] = this.cellAcross;
    if (lattice.fixed === undefined) return own;
    own.splice(lattice.fixed, 0, 0);
    return own.map((index, axis) => index + lattice.start[axis]);
  }

  /** Pairs of numbers of nodes: the four sides of the layer. */
  border() {
    const [n, m] = this.cells, pairs = [];
    for (const a of [0, n]) for (let b = 0; b < m; b++) pairs.push([this.nodeAt(a, b), this.nodeAt(a, b + 1)]);
    for (const b of [0, m]) for (let a = 0; a < n; a++) pairs.push([this.nodeAt(a, b), this.nodeAt(a + 1, b)]);
    return pairs;
  }
}

/** Return the cell of `layers` that is in front at x, y on the screen, or null. */
function picked(layers, points, camera, x, y) {
  const [right, up, towards] = camera.axes;
  const [px, py, pz] = points, [tx, ty, tz] = camera.target, { scale } = camera;
  const seen = (axis, n) =>
    scale * (axis[0] * (px[n] - tx) + axis[1] * (py[n] - ty) + axis[2] * (pz[n] - tz));
  let best = null;
  for (const layer of layers) {
    const [n, m] = layer.cells;
    let before = new Float64Array(2 * (m + 1)), row = new Float64Array(2 * (m + 1));
    for (let a = 0; a <= n; a++) {
      [before, row] = [row, before];
      for (let b = 0; b <= m; b++) {
        const node = layer.nodeAt(a, b);
        row[2 * b] = seen(right, node) - x;
        row[2 * b + 1] = seen(up, node) - y;
        if (a && b && inside(before[2 * b - 2], before[2 * b - 1], row[2 * b - 2], row[2 * b - 1],
          row[2 * b], row[2 * b + 1], before[2 * b], before[2 * b + 1])) {
          const depth = seen(towards, node);
          if (!best || depth > best.depth) best = { layer, a: a - 1, b: b - 1, depth };
        }
      }
    }
  }
  return best;
}

/** Say whether the origin is in the quadrilateral of four corners: an odd number of crossings of a ray. */
function inside(ax, ay, bx, by, cx, cy, dx, dy) {
  return crosses(ax, ay, bx, by) !== crosses(bx, by, cx, cy) !==
    (crosses(cx, cy, dx, dy) !== crosses(dx, dy, ax, ay));
}

function crosses(ax, ay, bx, by) {
  return ay > 0 !== by > 0 && ax - ay * (bx - ax) / (by - ay) > 0;
}

/** Return the numbers of the nodes of an edge of a block in the plane. */
function edgeNodes(lattice, { axis, end, start, stop }) {
  const [across, along] = axis === 0 ? [0, 1] : [1, 0];
  const fixed = lattice.node + (end ? (lattice.counts[across] - 1) * lattice.nodeSteps[across] : 0);
  return Array.from({ length: stop - start + 1 }, (_, k) => fixed + (start + k) * lattice.nodeSteps[along]);
}

/** Return the edges of a cell of 4 corners in the plane or 8 in space, the last index running fastest. */
function edgesOf(corners) {
  const pairs = [];
  for (let a = 0; a < corners.length; a++) {
    for (let bit = 1; bit < corners.length; bit *= 2) if (!(a & bit)) pairs.push([corners[a], corners[a | bit]]);
  }
  return pairs;
}

/** Return the edges of a net of points, rows of columns. */
function netOf(rows) {
  return rows.flatMap((row, a) => row.flatMap((point, b) => [
    ...(b ? [[row[b - 1], point]] : []), ...(a ? [[rows[a - 1][b], point]] : []),
  ]));
}
