// --- Where the grid is seen from: parallel projection, so that lengths on the screen can be compared

const RADIANS = Math.PI / 180;

/** Places in pixels from the middle of the canvas: x to the right, y upwards, z towards the viewer. */
class Camera {
  /** `flat` is a grid in the plane; `box` are its lowest and highest coordinates, `up` the axis upwards. */
  constructor(flat, box, seenFrom, up) {
    this.flat = flat;
    this.up = up;
    this.box = box.map((corner) => (corner.length === 3 ? corner : [...corner, 0]));
    this.home = seenFrom;
    [this.azimuth, this.elevation] = seenFrom;
    this.target = [0, 0, 0];
    this.scale = 1;
    this.flight = null;
  }

  /** Unit vectors to the right, upwards and towards the viewer. */
  get axes() {
    if (this.flat) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const a = this.azimuth * RADIANS, e = this.elevation * RADIANS;
    const towards = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    return [right, cross(towards, right), towards].map((way) => way.map((_, k) => way[(k + 2 - this.up) % 3]));
  }

  /** Return where a point is on the screen. */
  seen(point) {
    const away = point.map((value, k) => value - this.target[k]);
    return this.axes.map((axis) => this.scale * dot(axis, away));
  }

  /** Return the point in the plane of the target that is at x, y on the screen. */
  under(x, y) {
    const [right, up] = this.axes;
    return this.target.map((value, k) => value + (right[k] * x + up[k] * y) / this.scale);
  }

  /** Move by pixels. */
  pan(x, y) {
    this.target = this.under(-x, -y);
  }

  /** Turn by pixels of the mouse. */
  turn(x, y) {
    this.azimuth -= 0.4 * x;
    this.elevation = Math.max(-90, Math.min(90, this.elevation - 0.4 * y));
  }

  /** Enlarge by a factor; what is at x, y stays where it is. */
  zoom(factor, x = 0, y = 0) {
    const largest = 1e13 / Math.max(...this.size()), smallest = 10 / Math.max(...this.size());
    const scale = Math.min(largest, Math.max(smallest, this.scale * factor));
    this.target = this.under(x * (1 - this.scale / scale), y * (1 - this.scale / scale));
    this.scale = scale;
  }

  /** Return the extents of the whole grid. */
  size() {
    return this.box[0].map((low, k) => this.box[1][k] - low);
  }

  /** Return target and scale that show a box whole in `width` x `height` pixels. */
  fitting(box, width, height) {
    const [low, high] = box;
    const middle = low.map((value, k) => (value + high[k]) / 2);
    const extents = this.axes.map((axis) =>
      axis.reduce((sum, part, k) => sum + Math.abs(part) * (high[k] - low[k]), 0));
    const least = 1e-12 * Math.max(...this.size());
    const scale = 0.92 * Math.min(width / Math.max(extents[0], least), height / Math.max(extents[1], least));
    return { target: middle, scale };
  }

  /** Fly to a target and a scale; `draw` is called for every frame on the way. */
  fly(to, draw, seconds = 0.6) {
    const from = { target: this.target, scale: this.scale };
    const begun = performance.now();
    const ratio = Math.log(to.scale / from.scale);
    this.flight = {};
    const flight = this.flight;
    const step = (now) => {
      if (this.flight !== flight) return;
      const t = Math.max(0, Math.min(1, (now - begun) / (1000 * seconds)));
      const part = t * t * (3 - 2 * t);
      this.scale = from.scale * Math.exp(ratio * part);
      // the way on the screen is even: fast while the scale is small
      const way = Math.abs(ratio) < 1e-6 ? part : (1 - Math.exp(-ratio * part)) / (1 - Math.exp(-ratio));
      this.target = t === 1 ? to.target : from.target.map((value, k) => value + (to.target[k] - value) * way);
      if (t === 1) this.flight = null;
      else requestAnimationFrame(step);
      draw();
    };
    requestAnimationFrame(step);
  }

  /** End a flight where it is. */
  stay() {
    this.flight = null;
  }
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** Say whether a box, if any, is small in extents: a body in its far field. */
function small(box, extents) {
  return box && Math.max(...box[0].map((low, k) => box[1][k] - low)) < Math.max(...extents) / 5;
}

/** Return a box with some room around it. */
function boxOf(box) {
  if (!box) return null;
  const [low, high] = box.map((corner) => (corner.length === 3 ? corner : [...corner, 0]));
  const room = 0.18 * Math.max(...low.map((value, k) => high[k] - value));
  return [low.map((value) => value - room), high.map((value) => value + room)];
}
