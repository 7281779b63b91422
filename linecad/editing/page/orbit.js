// The eye that looks at the model: it turns about a point, z up, or stands in the camera of the photo.

import {
  add,
  applied,
  cross,
  frustum,
  orthographic,
  product4,
  ray,
  subtract,
  times,
  transposed,
  viewMatrix,
} from "./matrices.js";

const FIELD = Math.tan((22.5 * Math.PI) / 180); // tangent of half the smaller angle of view
const STEEPEST = (89 * Math.PI) / 180; // rad; straight down or up has no direction that is right
const TURN = 0.006; // rad a CSS px of drag
const INNER = [0.1, 0.9]; // of the line ends: these surely belong to the building
const REACH = 1; // views reach this share of the largest inner range beyond it; the rest are outliers
const SIDEWARDS = 0.45; // rad, from where the model is first seen, off the way the camera looks
const DOWNWARDS = 0.38; // rad
const FARTHER_FOR_CAMERA = 1.6; // times; where the camera is farther off, the model alone is shown
const MARGIN = 1.05; // of the distance at which all is just seen
const NEAR_SHARE = 1 / 2000; // of the depth to what is farthest, where the near plane may stand

/** The points that are no outliers. */
export function withoutOutliers(points) {
  if (points.length === 0) return [];
  const ranges = [0, 1, 2].map((axis) => {
    const sorted = points.map((point) => point[axis]).sort((a, b) => a - b);
    return INNER.map((share) => sorted[Math.round(share * (sorted.length - 1))]);
  });
  const reach = REACH * Math.max(...ranges.map(([low, high]) => high - low), 1e-6);
  return points.filter((point) =>
    point.every((at, axis) => at >= ranges[axis][0] - reach && at <= ranges[axis][1] + reach),
  );
}

/** [lowest, highest] coordinates of one point or more. */
function box(points) {
  return [Math.min, Math.max].map((extreme) =>
    [0, 1, 2].map((axis) => points.reduce((best, point) => extreme(best, point[axis]), points[0][axis])),
  );
}

export class Orbit {
  target = [0, 5, 0];
  azimuth = 0; // rad, 0 looks along y as the camera does
  elevation = 0; // rad, positive looks down
  distance = 5; // scene units from the target to the eye
  inCamera = true; // the view through the camera of the photo
  flat = null; // {name, up, back}: without perspective, in a direction that does not turn
  width = 1; // CSS px, of the stage
  height = 1;

  /** The photo's camera: size in px, K, and the rotation from world to camera. */
  constructor({ width, height }, K, rotation) {
    Object.assign(this, { photoWidth: width, photoHeight: height, K, rotation });
    this.size = 10; // scene units, of what there is to see
  }

  /** Right, up and back in the world. */
  get axes() {
    if (this.inCamera) {
      const [right, down, forward] = this.rotation;
      return [right, times(down, -1), times(forward, -1)];
    }
    if (this.flat) return [cross(this.flat.up, this.flat.back), this.flat.up, this.flat.back];
    const [s, c] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [se, ce] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    const back = [-s * ce, -c * ce, se];
    const right = [c, -s, 0];
    return [right, cross(back, right), back];
  }

  get eye() {
    return this.inCamera ? [0, 0, 0] : add(this.target, times(this.axes[2], this.distance));
  }

  /** World to clip space for the stage as it is. */
  get matrix() {
    const far = 4 * this.size + 2 * Math.hypot(...subtract(this.target, this.eye));
    const [x, y] = this.#tangents().map((tangent) => tangent * this.distance);
    if (this.flat) return product4(orthographic(x, y, -far, far), viewMatrix(...this.axes, this.eye));
    const lens = this.inCamera ? this.#cameraLens(far) : this.#freeLens(far);
    return product4(lens, viewMatrix(...this.axes, this.eye));
  }

  #freeLens(far) {
    const [x, y] = this.#tangents();
    return frustum(-x, x, -y, y, far * NEAR_SHARE, far);
  }

  #tangents() {
    const aspect = this.width / this.height;
    return aspect > 1 ? [FIELD * aspect, FIELD] : [FIELD, FIELD / aspect];
  }

  /** [origin, direction] of the sight through a place of the stage, CSS px. */
  sight([left, top]) {
    if (this.inCamera) {
      const scale = Math.min(this.width / this.photoWidth, this.height / this.photoHeight);
      const u = (left - this.width / 2) / scale + this.photoWidth / 2 - 0.5;
      const v = (top - this.height / 2) / scale + this.photoHeight / 2 - 0.5;
      return [[0, 0, 0], ray(this.K, this.rotation, [u, v])];
    }
    const [right, up, back] = this.axes;
    const [x, y] = this.#tangents();
    const [sx, sy] = [(2 * left) / this.width - 1, 1 - (2 * top) / this.height];
    const aside = add(times(right, sx * x), times(up, sy * y));
    if (!this.flat) return [this.eye, subtract(aside, back)];
    const far = 4 * this.size + this.distance;
    return [add(add(this.target, times(aside, this.distance)), times(back, far)), times(back, -1)];
  }

  /** All of the photo, as its camera saw it, with room on two sides where the stage has another shape. */
  #cameraLens(far) {
    const [focal, cx, cy] = [this.K[0][0], this.K[0][2] + 0.5, this.K[1][2] + 0.5];
    const scale = Math.min(this.width / this.photoWidth, this.height / this.photoHeight);
    const [spareX, spareY] = [(this.width / scale - this.photoWidth) / 2, (this.height / scale - this.photoHeight) / 2];
    const left = (-cx - spareX) / focal;
    const right = (this.photoWidth - cx + spareX) / focal;
    const top = (cy + spareY) / focal;
    const bottom = -(this.photoHeight - cy + spareY) / focal;
    return frustum(left, right, bottom, top, far * NEAR_SHARE, far);
  }

  /** Leave the camera of the photo where it is, so that a drag goes on from what is seen. */
  #leaveCamera() {
    if (!this.inCamera) return;
    const forward = this.rotation[2];
    this.inCamera = false;
    this.azimuth = Math.atan2(forward[0], forward[1]);
    this.elevation = Math.asin(-forward[2]);
    this.distance = Math.hypot(...this.target);
    this.target = times(forward, this.distance);
  }

  orbit(dx, dy) {
    if (this.flat) return this.pan(dx, dy);
    this.#leaveCamera();
    this.azimuth += dx * TURN;
    this.elevation = Math.min(Math.max(this.elevation + dy * TURN, -STEEPEST), STEEPEST);
  }

  /** Move by CSS px: what is at the target follows the pointer. */
  pan(dx, dy) {
    this.#leaveCamera();
    const [right, up] = this.axes;
    const [x] = this.#tangents();
    const step = (2 * x * this.distance) / this.width;
    this.target = add(this.target, add(times(right, -dx * step), times(up, dy * step)));
  }

  /** Zoom by a factor, towards `at` in CSS px of the stage. */
  zoom(factor, at = [this.width / 2, this.height / 2]) {
    this.#leaveCamera();
    const before = this.distance;
    this.distance = Math.min(Math.max(before / factor, this.size / 5000), this.size * 20);
    const [right, up] = this.axes;
    const [x, y] = this.#tangents();
    const [sx, sy] = [(2 * at[0]) / this.width - 1, 1 - (2 * at[1]) / this.height];
    const gone = before - this.distance;
    this.target = add(this.target, add(times(right, sx * x * gone), times(up, sy * y * gone)));
  }

  throughCamera() {
    this.flat = null;
    this.inCamera = true;
  }

  /** Look without perspective along a direction, at all of these points: `{name, up, back}`. */
  lookFlat(flat, points) {
    this.flat = flat;
    this.inCamera = false;
    if (points.length > 0) this.#stepBack(points);
  }

  /** Turn freely again, in the direction of before. */
  lookFreely() {
    this.flat = null;
    if (this.inCamera) this.#leaveCamera();
  }

  /** Remember how large a model of such points is; nothing moves. */
  measure(points) {
    if (points.length === 0) return;
    const [low, high] = box(points);
    this.size = Math.max(Math.hypot(...subtract(high, low)), 1e-6);
    if (this.inCamera) this.target = times(add(low, high), 0.5);
  }

  /** All of these points, and the camera unless it is far away, from a little to the side of it and above. */
  fit(points) {
    if (points.length === 0) return;
    this.measure(points);
    if (this.flat) return this.#stepBack(points);
    this.inCamera = false;
    const forward = this.rotation[2];
    this.azimuth = Math.atan2(forward[0], forward[1]) + SIDEWARDS;
    this.elevation = DOWNWARDS;
    this.#stepBack(points);
    const alone = [this.target, this.distance];
    this.#stepBack([...points, [0, 0, 0]]);
    if (this.distance > FARTHER_FOR_CAMERA * alone[1]) [this.target, this.distance] = alone;
  }

  /** See all of these points in the direction that the eye has. */
  #stepBack(points) {
    const axes = this.axes;
    const seen = points.map((point) => applied(axes, point));
    const [low, high] = box(seen);
    this.target = applied(transposed(axes), times(add(low, high), 0.5));
    const middle = applied(axes, this.target);
    const [x, y] = this.#tangents();
    this.distance =
      MARGIN *
      seen.reduce((distance, point) => {
        const [right, up, back] = subtract(point, middle);
        const depth = this.flat ? 0 : back;
        return Math.max(distance, depth + Math.abs(right) / x, depth + Math.abs(up) / y);
      }, this.size / 1000);
  }

  /** Where the photo's corners are, at a depth in scene units. */
  photoCorners(depth) {
    const { K, photoWidth: w, photoHeight: h } = this;
    const corners = [
      [-0.5, -0.5],
      [w - 0.5, -0.5],
      [w - 0.5, h - 0.5],
      [-0.5, h - 0.5],
    ];
    const back = transposed(this.rotation);
    return corners.map(([u, v]) =>
      applied(back, [((u - K[0][2]) / K[0][0]) * depth, ((v - K[1][2]) / K[1][1]) * depth, depth]),
    );
  }
}
