// Rectangles of walls by two corners in the photo: their sides run along the wall's axes, seen in perspective.

import { add, applied, cross, dot, product, ray, subtract, times, unit } from "./matrices.js";

const UP = [0, 0, 1];
const LEVEL = 0.5; // of a normal's upright part, above which a face is no wall

/** The face of a wall that the photo shows at a pixel, as `{plane, face}`; undefined where there is none. */
export function wallAt(state, pixel) {
  const walls = state.planes.flatMap((plane) => plane.faces.map((face) => ({ plane, face })));
  return walls.find(({ face }) => face.opening === null && isUpright(face) && covers(state, face.outline, pixel));
}

/** The face of a window or door at a pixel, as `{plane, face}`; undefined where there is none. */
export function openingAt(state, pixel) {
  const faces = state.planes.flatMap((plane) => plane.faces.map((face) => ({ plane, face })));
  return faces.find(({ face }) => face.opening !== null && covers(state, face.outline, pixel));
}

/** The corners of a face's outline in the photo; null where one is behind the camera. */
export function inPhoto(state, points) {
  const project = product(state.K, state.R_cam_from_world);
  const seen = points.map((point) => applied(project, point));
  return seen.some(([, , depth]) => depth <= 0) ? null : seen.map(([x, y, depth]) => [x / depth, y / depth]);
}

/** The axes of a wall's face: a point of it, along it, its normal. */
function axesOf(face) {
  const [start, second] = face.outline;
  const third = face.outline.find((point) => Math.hypot(...cross(subtract(second, start), subtract(point, start))) > 0);
  const normal = unit(cross(subtract(second, start), subtract(third, start)));
  return { start, normal, along: unit(cross(UP, normal)) };
}

function isUpright(face) {
  return Math.abs(axesOf(face).normal[2]) < LEVEL;
}

function covers(state, outline, [u, v]) {
  const corners = inPhoto(state, outline);
  if (!corners) return false;
  let inside = false;
  corners.forEach(([a, b], index) => {
    const [c, d] = corners[(index + 1) % corners.length];
    if (b > v !== d > v && u < a + ((v - b) / (d - b)) * (c - a)) inside = !inside;
  });
  return inside;
}

/** Where the ray of a pixel meets the wall of a face: how far along it, and how high; null where it does not. */
function onWall(state, face, pixel) {
  const { start, normal, along } = axesOf(face);
  const direction = ray(state.K, state.R_cam_from_world, pixel);
  const factor = dot(start, normal) / dot(direction, normal);
  if (!(factor > 0)) return null;
  const point = times(direction, factor);
  return [dot(point, along), point[2]];
}

/** The corners in the photo of windows by two corners, in rows and columns up to one whose second corner is `last`. */
export function grid(state, face, [first, second], { columns = 1, rows = 1, last = second } = {}) {
  const [a, b, c] = [first, second, last].map((pixel) => onWall(state, face, pixel));
  if (!a || !b || !c) return [];
  const { start, normal, along } = axesOf(face);
  const base = times(normal, dot(start, normal));
  const place = ([u, v]) => add(add(base, times(along, u)), times(UP, v));
  const step = [columns > 1 ? (c[0] - b[0]) / (columns - 1) : 0, rows > 1 ? (c[1] - b[1]) / (rows - 1) : 0];
  const found = [];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const [du, dv] = [step[0] * column, step[1] * row];
      const corners = [a, [b[0], a[1]], b, [a[0], b[1]]].map(([u, v]) => inPhoto(state, [place([u + du, v + dv])])?.[0]);
      if (corners.every(Boolean)) found.push(corners);
    }
  }
  return found;
}

/** How many rows and columns there are up to a window whose second corner is `last`, if gaps are as wide as windows. */
export function countsUpTo(state, face, [first, second], last) {
  const [a, b, c] = [first, second, last].map((pixel) => onWall(state, face, pixel));
  if (!a || !b || !c) return { columns: 1, rows: 1 };
  const [columns, rows] = [0, 1].map((k) => 1 + Math.round(Math.abs(c[k] - b[k]) / (2 * Math.abs(b[k] - a[k]))));
  return { columns, rows };
}
