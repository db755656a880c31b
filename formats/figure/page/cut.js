// --- Cuts of volumes by a plane of constant x, y or z: a polygon for every cell that the plane goes through

const HEX_EDGES = [];
for (let a = 0; a < 8; a++) for (const bit of [1, 2, 4]) if (!(a & bit)) HEX_EDGES.push([a, a | bit]);

/**
 * Return the triangles in which the plane cuts the cells of `lattices`: points, numbers of cells, and how far
 * each corner is from the polygon's rim, 1 in its middle. Each polygon is a fan around its middle.
 */
function cutBy(lattices, points, axis, coordinate) {
  const distance = points[axis];
  const corners = [], cells = [], rims = [];
  for (const lattice of lattices) {
    const [ni, nj, nk] = lattice.counts, [si, sj, sk] = lattice.nodeSteps;
    const offsets = [0, 1, 2, 3, 4, 5, 6, 7].map((c) => (c & 4 ? si : 0) + (c & 2 ? sj : 0) + (c & 1 ? sk : 0));
    let cell = lattice.cell;
    for (let i = 0; i < ni - 1; i++) for (let j = 0; j < nj - 1; j++) {
      let node = lattice.node + i * si + j * sj;
      for (let k = 0; k < nk - 1; k++, node += sk, cell++) {
        let above = 0;
        for (let c = 0; c < 8; c++) if (distance[node + offsets[c]] >= coordinate) above++;
        if (above === 0 || above === 8) continue;
        const polygon = polygonOf(node, offsets, points, axis, coordinate);
        const middle = [0, 1, 2].map((x) => polygon.reduce((sum, point) => sum + point[x], 0) / polygon.length);
        polygon.forEach((point, n) => {
          corners.push(middle, point, polygon[(n + 1) % polygon.length]);
          cells.push(cell, cell, cell);
          rims.push(1, 0, 0);
        });
      }
    }
  }
  return { corners, cells, rims };
}

/** Return the points in which edges of a cell meet the plane, in their order around the polygon. */
function polygonOf(node, offsets, points, axis, coordinate) {
  const corners = [];
  for (const [a, b] of HEX_EDGES) {
    const p = node + offsets[a], q = node + offsets[b];
    const from = points[axis][p] - coordinate, to = points[axis][q] - coordinate;
    if (from >= 0 === to >= 0) continue;
    const part = from / (from - to);
    corners.push([0, 1, 2].map((x) => (x === axis ? coordinate : points[x][p] + part * (points[x][q] - points[x][p]))));
  }
  const [u, v] = [0, 1, 2].filter((x) => x !== axis);
  const middle = [0, 1, 2].map((x) => corners.reduce((sum, point) => sum + point[x], 0) / corners.length);
  const angle = (point) => Math.atan2(point[v] - middle[v], point[u] - middle[u]);
  return corners.map((point) => [angle(point), point]).sort((one, two) => one[0] - two[0]).map(([, point]) => point);
}
