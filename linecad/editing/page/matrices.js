// The little mathematics that drawing needs: 3-vectors as arrays, 3 x 3 as rows, 4 x 4 by columns as WebGL wants them.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => times(a, 1 / (Math.hypot(...a) || 1));

/** Rows times a vector. */
export const applied = (rows, vector) => rows.map((row) => dot(row, vector));

export const transposed = (rows) => [0, 1, 2].map((column) => rows.map((row) => row[column]));

/** The product of two 3 x 3 matrices. */
export const product = (a, b) => a.map((row) => transposed(b).map((column) => dot(row, column)));

/** The product of two 4 x 4 matrices by columns. */
export function product4(a, b) {
  const result = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      for (let k = 0; k < 4; k++) result[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    }
  }
  return result;
}

/** World to view: `right`, `up` and `back` are the axes of the view in the world, `eye` is where it stands. */
export function viewMatrix(right, up, back, eye) {
  const rows = [right, up, back];
  const columns = transposed(rows).map((column) => [...column, 0]);
  return new Float32Array([...columns.flat(), ...rows.map((row) => -dot(row, eye)), 1]);
}

/** View to clip space, from the tangents of what is seen to the left, right, bottom and top, and two depths. */
export function frustum(left, right, bottom, top, near, far) {
  const [width, height, depth] = [right - left, top - bottom, far - near];
  return new Float32Array([
    2 / width,
    0,
    0,
    0,
    0,
    2 / height,
    0,
    0,
    (right + left) / width,
    (top + bottom) / height,
    -(far + near) / depth,
    -1,
    0,
    0,
    (-2 * far * near) / depth,
    0,
  ]);
}

/** View to clip space without perspective, from half of what is seen across and up, and two depths. */
export function orthographic(halfWidth, halfHeight, near, far) {
  const depth = far - near;
  return new Float32Array([
    ...[1 / halfWidth, 0, 0, 0],
    ...[0, 1 / halfHeight, 0, 0],
    ...[0, 0, -2 / depth, 0],
    ...[0, 0, -(far + near) / depth, 1],
  ]);
}

/** Clip coordinates of a point of the world. */
export function projected(matrix, [x, y, z]) {
  return [0, 1, 2, 3].map((row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row]);
}

/** The world's ray through a pixel, camera depth 1, for K with square pixels. */
export function ray(K, rotation, [u, v]) {
  return applied(transposed(rotation), [(u - K[0][2]) / K[0][0], (v - K[1][2]) / K[1][1], 1]);
}

/** The pixel that shows a point of the world, or null where that is behind the camera. */
export function pixelOf(K, rotation, point) {
  const [x, y, depth] = applied(K, applied(rotation, point));
  return depth > 0 ? [x / depth, y / depth] : null;
}

/** The point of the line through `start` and `end` that is nearest to a ray from the origin. */
export function nearestToRay(start, end, direction) {
  const along = unit(subtract(end, start));
  const [r, a] = [unit(direction), dot(along, unit(direction))];
  const across = 1 - a * a;
  if (across < 1e-9) return start;
  return add(start, times(along, (a * dot(start, r) - dot(start, along)) / across));
}
