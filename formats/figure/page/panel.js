// --- Controls beside the picture

const $ = (selector) => document.querySelector(selector);

/** Return a new element with attributes and children. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  Object.assign(made, attributes);
  made.append(...children);
  return made;
}

/** Return a number in four digits. */
function figure(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(2).replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}

/** Return names of parts in the order in which they appear, with how many cells each has. */
function counted(layers, nameOf) {
  const cells = new Map();
  for (const layer of layers) {
    const name = nameOf(layer);
    cells.set(name, (cells.get(name) || 0) + layer.cells[0] * layer.cells[1]);
  }
  return [...cells];
}

/** Fill a section with a checkbox for each of `entries` (name, label, count); `change` hears of all that are on. */
function checkboxes(list, entries, on, change) {
  const boxes = entries.map(([name, label, count]) => {
    const box = element("input", { type: "checkbox", checked: on(name), value: name });
    const small = element("small", { textContent: count });
    list.append(element("li", {}, element("label", { className: "check" }, box, label), small));
    return box;
  });
  const hear = () => change(boxes.filter((box) => box.checked).map((box) => box.value));
  boxes.forEach((box) => box.addEventListener("change", hear));
  if (boxes.length < 3) return;
  const all = element("button", { textContent: "all", type: "button" });
  const none = element("button", { textContent: "none", type: "button" });
  for (const [button, checked] of [[all, true], [none, false]]) {
    button.addEventListener("click", () => {
      boxes.forEach((box) => (box.checked = checked));
      hear();
    });
  }
  list.before(element("div", { className: "both" }, all, none));
}

/** Show the distribution of a metric, its figures and the ends of its scale. */
function showMetric(metric, limits) {
  const [low, mean, high] = [metric.min, metric.mean, metric.max].map(figure);
  $("#about").textContent = metric.about + (metric.unit ? ` (${metric.unit})` : "");
  const most = Math.max(...metric.histogram);
  $("#histogram").replaceChildren(...metric.histogram.map((count, k) => {
    const bar = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    const width = 240 / metric.histogram.length, height = count ? 1 + 43 * Math.sqrt(count / most) : 0;
    const box = { x: k * width, y: 44 - height, width: width * 0.9, height };
    Object.entries(box).forEach(([name, value]) => bar.setAttribute(name, value));
    return bar;
  }));
  [$("#least").value, $("#most").value] = limits.map(figure);
  const cells = [["least", low], ["mean", mean], ["greatest", high]].map(([name, text]) =>
    element("td", {}, element("b", { textContent: name }), text));
  $("#figures tbody").replaceChildren(element("tr", {}, ...cells));
}

/** Paint the colour bar. */
function showBar(digits, reversed) {
  const context = $("#bar").getContext("2d");
  const image = context.createImageData(256, 1);
  for (let k = 0; k < 256; k++) {
    const from = 6 * (reversed ? 255 - k : k);
    for (let c = 0; c < 3; c++) image.data[4 * k + c] = parseInt(digits.slice(from + 2 * c, from + 2 * c + 2), 16);
    image.data[4 * k + 3] = 255;
  }
  context.putImageData(image, 0, 0);
}

/** Return a place in words: block 2, i 3, j 4. */
function placeWords(block, at, blocks) {
  const indices = at.map((index, k) => `${"ijk"[k]} ${index}`).join(", ");
  return blocks > 1 ? `block ${block}, ${indices}` : indices;
}

/** List the worst places of a metric; `choose` hears which of them is clicked. */
function showWorst(metric, blocks, choose) {
  $("#worst ol").replaceChildren(...metric.worst.map((cell) => {
    const value = element("b", { textContent: figure(cell.value) });
    const place = element("span", { textContent: placeWords(cell.block, cell.at, blocks) });
    const button = element("button", { type: "button" }, value, place);
    button.addEventListener("click", () => {
      document.querySelectorAll("#worst .on").forEach((other) => other.classList.remove("on"));
      button.classList.add("on");
      choose(cell);
    });
    return element("li", {}, button);
  }));
}

/** Draw a length that is a round number in the grid's unit. */
function showRuler(scale) {
  const round = 10 ** Math.floor(Math.log10(140 / scale));
  const length = [5, 2, 1].map((m) => m * round).find((l) => l * scale <= 140) || round;
  $("#ruler span").textContent = figure(length);
  $("#ruler i").style.width = `${length * scale}px`;
}

/** Draw where x, y and z point. */
function showTriad(axes) {
  const svg = (name, attributes) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    return made;
  };
  const [right, up] = axes;
  $("#triad").replaceChildren(...["x", "y", "z"].flatMap((name, k) => {
    const label = svg("text", { x: 34 * right[k], y: -34 * up[k] });
    label.textContent = name;
    return [svg("line", { x1: 0, y1: 0, x2: 25 * right[k], y2: -25 * up[k] }), label];
  }));
}

/** Return how many blocks, nodes and cells there are, in words. */
function countWords(facts) {
  const [first] = facts.blocks;
  const cells = `${facts.cells.toLocaleString("en")} cells`;
  if (facts.blocks.length > 1) return `${facts.blocks.length} blocks, ${cells}`;
  return `${first.join(" × ")} nodes, ${cells}`;
}
