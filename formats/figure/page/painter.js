// --- What is drawn on the canvas

const TEXTURE_WIDTH = 2048;
const LINE_GAP = 6; // pixels between grid lines, at least
const PLAIN = [0.88, 0.9, 0.92];

class Painter {
  constructor(canvas, points) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("This browser cannot draw: it has no WebGL 2.");
    this.canvas = canvas;
    this.gl = gl;
    this.cells = program(gl, CELLS_VERTEX, CELLS_FRAGMENT);
    this.cuts = program(gl, CUT_VERTEX, CUT_FRAGMENT);
    this.segments = program(gl, SEGMENTS_VERTEX, SEGMENTS_FRAGMENT);
    this.empty = gl.createVertexArray();
    const [high, low] = halves(points);
    this.textures = { high: table(gl, high, gl.RGBA32F, gl.RGBA, 4), low: table(gl, low, gl.RGBA32F, gl.RGBA, 4) };
  }

  /** Set the values of all cells, 0 to 65535. */
  setLevels(levels) {
    const { gl } = this;
    gl.deleteTexture(this.textures.levels);
    this.textures.levels = table(gl, Float32Array.from(levels), gl.R32F, gl.RED, 1);
  }

  /** Set the colours, 256 of three bytes in hexadecimal digits. */
  setColours(digits) {
    const { gl } = this;
    const bytes = Uint8Array.from(digits.match(/../g), (pair) => parseInt(pair, 16));
    const texture = this.textures.colours = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
    parameters(gl, gl.LINEAR);
  }

  /** Draw `layers` of cells, a `cut` if any, and `strokes`: segments with a width and a colour. */
  draw(camera, layers, cut, strokes, look) {
    const { gl, canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    this._drawCells(camera, layers, look, ratio);
    if (cut) this._drawCut(camera, cut, look, ratio);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    this._drawStrokes(camera, strokes, ratio);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  _drawCells(camera, layers, look, ratio) {
    const { gl, cells: { at } } = this;
    this._begin(this.cells, ["high", "low", "levels", "colours"], camera, look, ratio);
    gl.bindVertexArray(this.empty);
    gl.uniform1f(at("every"), look.every || 0);
    for (const layer of layers) {
      const [n, m] = layer.cells;
      gl.uniform4i(at("nodes"), layer.nodeBase, ...layer.nodeSteps, m);
      gl.uniform3i(at("cells"), layer.cellBase, ...layer.cellSteps);
      gl.uniform2f(at("first"), ...layer.first);
      gl.drawArrays(gl.TRIANGLES, 0, 6 * n * m);
    }
  }

  _drawCut(camera, cut, look, ratio) {
    const { gl } = this;
    this._begin(this.cuts, ["levels", "colours"], camera, look, ratio);
    gl.bindVertexArray(cut.array);
    gl.drawArrays(gl.TRIANGLES, 0, cut.count);
    gl.bindVertexArray(null);
  }

  /** Use a program for faces, with textures, and tell it how they look. */
  _begin({ id, at }, textures, camera, look, ratio) {
    const { gl } = this;
    gl.useProgram(id);
    this._place(at, camera, ratio);
    textures.forEach((name, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, this.textures[name]);
      gl.uniform1i(at(name), unit);
    });
    gl.uniform2f(at("limits"), ...look.limits);
    gl.uniform3f(at("plain"), ...PLAIN);
    gl.uniform1i(at("coloured"), look.coloured);
    gl.uniform1i(at("reversed"), look.reversed);
    gl.uniform1i(at("lit"), !camera.flat);
    gl.uniform1f(at("gap"), look.lines ? LINE_GAP * ratio : 0);
  }

  _drawStrokes(camera, strokes, ratio) {
    const { gl, segments: { id, at } } = this;
    gl.useProgram(id);
    this._place(at, camera, ratio);
    for (const stroke of strokes) {
      if (stroke.through) gl.disable(gl.DEPTH_TEST);
      gl.bindVertexArray(stroke.segments.array);
      gl.uniform1f(at("width"), stroke.width * ratio);
      gl.uniform1f(at("forward"), 2 * ratio);
      gl.uniform4f(at("ink"), ...stroke.ink);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, stroke.segments.count);
      gl.enable(gl.DEPTH_TEST);
    }
    gl.bindVertexArray(null);
  }

  _place(at, camera, ratio) {
    const { gl, canvas } = this;
    const high = camera.target.map(Math.fround);
    gl.uniform3f(at("targetHigh"), ...high);
    gl.uniform3f(at("targetLow"), ...camera.target.map((value, k) => value - high[k]));
    gl.uniformMatrix3fv(at("axes"), false, camera.axes.flat());
    gl.uniform1f(at("scale"), camera.scale * ratio);
    gl.uniform2f(at("middle"), canvas.width / 2, canvas.height / 2);
  }

  /** Return segments, of pairs of points [x, y, z], to be drawn as strokes. */
  segmentsOf(pairs) {
    const numbers = new Float32Array(12 * pairs.length);
    pairs.forEach((pair, n) => pair.forEach((point, end) => put(numbers, 12 * n + 6 * end, point)));
    const parts = [["startHigh", 3], ["startLow", 3], ["stopHigh", 3], ["stopLow", 3]];
    return { ...this._array(this.segments.id, numbers, parts, 1), count: pairs.length };
  }

  /** Return what `cutBy` has found, to be drawn. */
  cutOf({ corners, cells, rims }) {
    const numbers = new Float32Array(8 * corners.length);
    corners.forEach((point, n) => {
      put(numbers, 8 * n, point);
      numbers[8 * n + 6] = cells[n];
      numbers[8 * n + 7] = rims[n];
    });
    const parts = [["high", 3], ["low", 3], ["cell", 1], ["rim", 1]];
    return { ...this._array(this.cuts.id, numbers, parts, 0), count: corners.length };
  }

  /** Return an array of vertices whose numbers are those of `parts` (name, count) behind one another. */
  _array(id, numbers, parts, divisor) {
    const { gl } = this;
    const array = gl.createVertexArray(), buffer = gl.createBuffer();
    const all = parts.reduce((sum, [, count]) => sum + count, 0);
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    let before = 0;
    for (const [name, count] of parts) {
      const place = gl.getAttribLocation(id, name);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * all, 4 * before);
      gl.vertexAttribDivisor(place, divisor);
      before += count;
    }
    gl.bindVertexArray(null);
    return { array, buffer };
  }

  /** Give back what segments or a cut take on the card. */
  release({ array, buffer }) {
    this.gl.deleteVertexArray(array);
    this.gl.deleteBuffer(buffer);
  }
}

/** Put a point into `numbers` as three floats and what is left of them. */
function put(numbers, at, point) {
  point.forEach((value, k) => {
    numbers[at + k] = value;
    numbers[at + 3 + k] = value - numbers[at + k];
  });
}

/** Return the coordinates as floats and what is left of them, four numbers a node each. */
function halves(points) {
  const count = points[0].length;
  const high = new Float32Array(4 * count), low = new Float32Array(4 * count);
  points.forEach((axis, k) => {
    for (let n = 0; n < count; n++) {
      high[4 * n + k] = axis[n];
      low[4 * n + k] = axis[n] - high[4 * n + k];
    }
  });
  return [high, low];
}

function table(gl, numbers, kind, layout, each) {
  const rows = Math.max(1, Math.ceil(numbers.length / each / TEXTURE_WIDTH));
  const padded = new Float32Array(rows * TEXTURE_WIDTH * each);
  padded.set(numbers);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, kind, TEXTURE_WIDTH, rows, 0, layout, gl.FLOAT, padded);
  parameters(gl, gl.NEAREST);
  return texture;
}

function parameters(gl, filter) {
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
}

function program(gl, vertex, fragment) {
  const id = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(id, shader);
  }
  gl.linkProgram(id);
  if (!gl.getProgramParameter(id, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(id));
  const places = new Map();
  const at = (name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(id, name));
    return places.get(name);
  };
  return { id, at };
}
