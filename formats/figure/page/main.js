// --- The page: what is shown, and what the mouse and the keys do

const facts = JSON.parse($("#facts").textContent);
const flat = facts.form === "plane";
const volume = facts.form === "volume";
const INK = [0.106, 0.153, 0.2, 1], FAINT = [0.106, 0.153, 0.2, 0.75], ACCENT = [0.82, 0.2, 0.26, 1];

async function begin() {
  const points = await coordinates(facts);
  const levels = new Map();
  const painter = new Painter($("#canvas"), points);
  painter.setColours(facts.colours);
  painter.setLevels([0]);
  const lattices = laidOut(facts.lattices);
  const sheets = facts.sheets.map((sheet) => new Layer(lattices[sheet.lattice], sheet));
  const layers = sheets.filter(({ sheet }) => sheet.kind !== "slice");
  const stored = sheets.filter(({ sheet }) => sheet.kind === "slice"); // all that a large volume has inside
  const camera = new Camera(flat, facts.box, facts.start.seen_from, facts.start.up);
  const pointAt = (node) => points.map((axis) => axis[node]);
  const stroke = (pairs, width, ink, more = {}) => ({ segments: painter.segmentsOf(pairs), width, ink, ...more });
  const state = {
    metric: null, limits: [0, 1], lines: true, every: facts.start.every, mark: [],
    parts: new Set(), blocks: new Set(facts.blocks.map((_, k) => k)), slice: [], cut: null,
  };

  // --- what is shown
  const shown = () => [
    ...layers.filter((layer) => state.blocks.has(layer.lattice.block) && (!volume || state.parts.has(layer.sheet.part))),
    ...state.slice.filter((layer) => state.blocks.has(layer.lattice.block)),
  ];
  for (const layer of layers) {
    layer.stroke = stroke(layer.border().map((pair) => pair.map(pointAt)), flat ? 1 : 1.2, flat ? FAINT : INK);
  }
  const edges = (facts.edges || []).map((edge) => {
    const nodes = edgeNodes(lattices[edge.block], edge);
    const pairs = nodes.slice(1).map((node, k) => [pointAt(nodes[k]), pointAt(node)]);
    return { ...edge, ...stroke(pairs, edge.kind === "wall" ? 2.2 : 1.6, INK) };
  });
  const dots = (facts.vertices || []).flatMap(({ x, y, cells }) => {
    const spot = [[[x, y, 0], [x, y, 0]]];
    return [stroke(spot, 9, INK), stroke(spot, 6.5, cells < 4 ? [0.95, 0.72, 0.02, 1] : [0.89, 0.34, 0.18, 1])];
  });

  let waiting = false;
  const draw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      const visible = shown();
      const strokes = [
        ...visible.map((layer) => layer.stroke).filter(Boolean),
        ...edges.filter((edge) => state.blocks.has(edge.block)), ...dots, ...state.mark,
      ];
      const look = {
        limits: state.limits, lines: state.lines, every: state.every,
        coloured: Boolean(state.metric), reversed: Boolean(state.metric && state.metric.low),
      };
      painter.draw(camera, visible, state.cut, strokes, look);
      showRuler(camera.scale);
      if (!flat) showTriad(camera.axes);
      document.body.dataset.frames = Number(document.body.dataset.frames || 0) + 1;
    });
  };

  // --- colours
  const level = (metric, value) => {
    const turn = metric.log ? Math.log : (x) => x;
    const [low, high] = [turn(metric.min), turn(metric.max)];
    return 65535 * (turn(metric.log ? Math.max(value, 1e-300) : value) - low) / (high - low || 1);
  };
  const valueOf = (metric, cell) => {
    const part = levels.get(metric.name)[cell] / 65535;
    if (metric.log) return metric.min * (metric.max / metric.min) ** part;
    return metric.min + part * (metric.max - metric.min);
  };
  const limit = (limits) => {
    const [low, high] = limits.map((value) => level(state.metric, value));
    state.limits = [low, high > low ? high : low + 1];
    draw();
  };
  const colour = async (name) => {
    const metric = facts.metrics.find((each) => each.name === name) || null;
    if (metric && !levels.has(name)) levels.set(name, await unpacked(name));
    state.metric = metric;
    mark([]);
    for (const id of ["#about", "#histogram", "#bar", "#ends", "#figures", "#worst"]) $(id).hidden = !metric;
    if (metric) {
      painter.setLevels(levels.get(name));
      showMetric(metric, metric.limits);
      showBar(facts.colours, metric.low);
      showWorst(metric, facts.blocks.length, visit);
      limit(metric.limits);
    }
    draw();
  };

  // --- going places
  const mark = (pairs, net = []) => {
    state.mark.forEach(({ segments }) => painter.release(segments));
    state.mark = [[net, 1, INK], [pairs, 3, ACCENT]].filter(([lines]) => lines.length)
      .map(([lines, width, ink]) => stroke(lines, width, ink, { through: true }));
  };
  /** Look at a cell of a volume from where its last index grows, away from the wall as a rule. */
  const faceAlong = (corners) => {
    const way = [0, 1, 2].map((x) => corners.reduce((sum, point, n) => sum + (n & 1 ? point[x] : -point[x]), 0));
    const length = Math.hypot(...way);
    if (!length) return;
    const [ahead, aside, high] = [1, 2, 0].map((k) => way[(camera.up + k) % 3]);
    camera.azimuth = Math.atan2(aside, ahead) / RADIANS + 20;
    camera.elevation = Math.max(-75, Math.min(75, Math.asin(high / length) / RADIANS + 15));
  };
  const visit = (cell) => {
    const corners = cell.corners.map((point) => (point.length === 3 ? point : [...point, 0]));
    const low = [0, 1, 2].map((k) => Math.min(...corners.map((point) => point[k])));
    const high = [0, 1, 2].map((k) => Math.max(...corners.map((point) => point[k])));
    const wide = low.map((value, k) => [value - 4 * (high[k] - value), high[k] + 4 * (high[k] - value)]);
    mark(edgesOf(corners), netOf(cell.around || []));
    if (volume) {
      if (facts.whole) setSlice("k", cell.at[2], cell.block);
      faceAlong(corners);
    }
    const { clientWidth, clientHeight } = $("#canvas");
    camera.fly(camera.fitting([wide.map((pair) => pair[0]), wide.map((pair) => pair[1])], clientWidth, clientHeight), draw);
  };
  const showAll = (box = camera.box, fly = true) => {
    const { clientWidth, clientHeight } = $("#canvas");
    const to = camera.fitting(box, clientWidth, clientHeight);
    if (fly) return camera.fly(to, draw, 0.4);
    Object.assign(camera, to);
    return draw();
  };
  const look = (azimuth, elevation) => {
    camera.stay();
    Object.assign(camera, { azimuth, elevation });
    draw();
  };
  const lookAlong = (axis) => look(...[[0, 0], [-90, 0], [-90, 90]][(axis - camera.up + 2) % 3]);

  // --- slices: the layer `at` of an index i, j or k, of one block or of all, or a cut by a plane of x, y or z
  const STEPS = 1000;
  const setSlice = (name, at, block = null) => {
    state.slice.forEach((layer) => painter.release(layer.stroke.segments));
    if (state.cut) painter.release(state.cut);
    Object.assign(state, { slice: [], cut: null });
    const axis = "ijk".indexOf(name), x = "xyz".indexOf(name), places = placesOf(name);
    if (places.length) at = places.reduce((best, place) => (Math.abs(place - at) < Math.abs(best - at) ? place : best));
    $("#across").value = name;
    $("#layer").disabled = !name;
    $("#at").textContent = name ? `${name} = ${figure(at)}` : "";
    if (places.length) {
      state.slice = stored.filter(({ sheet, lattice }) =>
        sheet.across === name && sheet.at === at && (block === null || lattice.block === block)).map(outlined);
      Object.assign($("#layer"), { max: places.length - 1, value: places.indexOf(at) });
    } else if (name && axis >= 0) {
      state.slice = lattices.filter((lattice) => (block === null || lattice.block === block) && at < lattice.counts[axis])
        .map((lattice) => sliceOf(lattice, axis, at));
      Object.assign($("#layer"), { max: Math.max(...lattices.map(({ counts }) => counts[axis])) - 1, value: at });
    } else if (name) {
      state.cut = painter.cutOf(cutBy(lattices.filter((lattice) => state.blocks.has(lattice.block)), points, x, at));
      const [low, high] = facts.box.map((corner) => corner[x]);
      Object.assign($("#layer"), { max: STEPS, value: Math.round(STEPS * (at - low) / (high - low)) });
    }
    state.sliced = [name, at, block];
    draw();
  };
  const sliceOf = (lattice, axis, node) => {
    const ranges = lattice.counts.filter((_, k) => k !== axis).map((count) => [0, count - 1]);
    return outlined(new Layer(lattice, { part: "", kind: "slice", axis, node, ranges }));
  };
  const outlined = (layer) => {
    layer.stroke = stroke(layer.border().map((pair) => pair.map(pointAt)), 1.2, INK);
    return layer;
  };
  /** Return the indices of the layers of constant i, j or k that are stored, ascending. */
  const placesOf = (name) =>
    [...new Set(stored.filter(({ sheet }) => sheet.across === name).map(({ sheet }) => sheet.at))];
  /** Return the index or coordinate that a place of the slider means. */
  const slid = (name, value) => {
    if ("ijk".includes(name)) return placesOf(name)[value] ?? value;
    const [low, high] = facts.box.map((corner) => corner["xyz".indexOf(name)]);
    return low + (high - low) * value / STEPS;
  };
  /** Return where a slice of a name is at first: the first layer, or the plane through the middle of what is seen. */
  const firstSlice = (name) => {
    const places = placesOf(name);
    if (!name || "ijk".includes(name)) return places[Math.floor(places.length / 2)] || 0;
    const middle = shown().length ? camera.target : camera.box[0].map((low, k) => (low + camera.box[1][k]) / 2);
    const [low, high] = facts.box.map((corner) => corner["xyz".indexOf(name)]);
    return Math.min(high - 1e-3 * (high - low), Math.max(low + 1e-3 * (high - low), middle["xyz".indexOf(name)]));
  };

  // --- controls
  $("#name").textContent = facts.name || "Grid";
  $("#counts").textContent = countWords(facts);
  $("#metric").append(
    ...facts.metrics.map(({ name }) => element("option", { value: name, textContent: name.replaceAll("_", " ") })),
    element("option", { value: "", textContent: "none" }));
  $("#metric").addEventListener("change", (event) => colour(event.target.value));
  $("#lines").addEventListener("change", (event) => {
    state.lines = event.target.checked;
    draw();
  });
  for (const id of ["#least", "#most"]) {
    $(id).addEventListener("change", () => {
      const limits = [$("#least"), $("#most")].map((input) => Number(input.value));
      if (limits.every(Number.isFinite) && limits[0] < limits[1]) limit(limits);
      else showMetric(state.metric, state.metric.limits);
    });
  }
  const list = $("#parts ul");
  if (volume) {
    const walls = new Set(layers.filter(({ sheet }) => sheet.kind === "wall").map(({ sheet }) => sheet.part));
    const names = counted(layers, (layer) => layer.sheet.part);
    state.parts = walls.size ? walls : new Set(names.map(([name]) => name));
    checkboxes(list, names.map(([name, count]) => [name, name, count]), (name) => state.parts.has(name), (on) => {
      state.parts = new Set(on);
      draw();
    });
  }
  const blockList = volume ? $("#blocks ul") : list;
  if (!volume) $("#parts h2").textContent = "Blocks";
  $("#parts").hidden = !volume && facts.blocks.length < 2;
  $("#blocks").hidden = !volume || facts.blocks.length < 2;
  checkboxes(
    blockList, facts.blocks.map((counts, k) => [String(k), `block ${k}`, counts.join(" × ")]), () => true,
    (on) => {
      state.blocks = new Set(on.map(Number));
      if (state.cut) setSlice(...state.sliced);
      draw();
    });
  if (volume) {
    $("#slice").hidden = false;
    $("#across").append(...["", ...(facts.whole ? "ijkxyz" : "ijk")].map((name) => element("option", { value: name, textContent: name || "none" })));
    $("#across").addEventListener("change", ({ target }) => setSlice(target.value, firstSlice(target.value)));
    $("#layer").addEventListener("input", ({ target }) => {
      const name = $("#across").value;
      setSlice(name, slid(name, Number(target.value)));
    });
    setSlice("", 0);
  }
  document.querySelectorAll(".space").forEach((each) => (each.hidden = flat));
  $("#triad").toggleAttribute("hidden", flat);
  const wallBox = small(facts.walls, camera.size()) ? boxOf(facts.walls) : null;
  document.querySelector("[data-view=near]").hidden = !wallBox;
  const views = {
    closer: () => (camera.stay(), camera.zoom(1.5), draw()), further: () => (camera.stay(), camera.zoom(1 / 1.5), draw()),
    all: () => showAll(), near: () => wallBox && showAll(wallBox),
    x: () => lookAlong(0), y: () => lookAlong(1), z: () => lookAlong(2),
  };
  document.querySelectorAll("[data-view]").forEach((button) =>
    button.addEventListener("click", () => views[button.dataset.view]()));
  const keys = { "+": "closer", "=": "closer", "-": "further", 0: "all", w: "near", ...(flat ? {} : { x: "x", y: "y", z: "z" }) };
  window.addEventListener("keydown", (event) => {
    if (event.target.tagName === "INPUT" || event.ctrlKey || event.metaKey || !(event.key in keys)) return;
    views[keys[event.key]]();
  });
  listen($("#canvas"), camera, draw, {
    pick(x, y) {
      const cell = picked(shown(), points, camera, x, y);
      if (!cell) return null;
      const { layer, a, b } = cell;
      const number = layer.cellAt(a, b);
      const place = placeWords(layer.lattice.block, layer.indices(a, b), facts.blocks.length);
      const name = volume && layer.sheet.part ? `${layer.sheet.part}: ` : "";
      const ring = [[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]].map((at) => pointAt(layer.nodeAt(...at)));
      mark(ring.map((point, k) => [point, ring[(k + 1) % 4]]));
      draw();
      return [name + place, state.metric ? `${state.metric.name} ${figure(valueOf(state.metric, number))}` : ""];
    },
    at: (x, y) => (flat ? camera.under(x, y).slice(0, 2) : null),
  });
  new ResizeObserver(draw).observe($("#canvas"));

  const { zoom } = facts.start;
  const zoomBox = zoom && [0, 1].map((end) => [0, 1, 2].map((k) => zoom[2 * k + end] ?? camera.box[end][k]));
  showAll(zoomBox || wallBox || camera.box, false);
  const { slice } = facts.start;
  if (slice && volume && (facts.whole || "ijk".includes(slice.name))) setSlice(slice.name, slice.at);
  $("#metric").value = facts.start.metric || "";
  await colour(facts.start.metric || "");
  window.meshonet = { camera, state, shown, facts };
  document.body.dataset.ready = "yes";
}

begin().catch((error) => {
  $("#trouble").textContent = error.message;
  $("#trouble").hidden = false;
  document.body.dataset.ready = "failed";
});
