// Where a body could stand: what a place is as an edit, and the places that a body which is dragged snaps to.

import { depthAt, lengthOf, middleOf } from "./bodies.js";
import { dot, subtract, unit } from "./matrices.js";
import { distance } from "./picking.js";

const SAME = 0.005; // log factor within which two places to snap to are one
const FARTHEST = 1.5; // log factor; what is farther off is nothing that a drag means

/** The edit that says that a body, or a part of it, stands so many times, by a log factor, as far away as it is shown. */
export function placeEdit(bodies, body, log, part = null) {
  const { state } = bodies.store;
  const own = new Set(part?.lines);
  const line = part ? bodies.lineOf(bodies.part) : bodies.lineOf(body);
  const to = bodies.linesOf.get(bodies.reference).find(({ id }) => !own.has(id));
  const [depth, other] = [line, to].map((each) => Math.log(depthAt(state, each, middleOf(each))));
  const edit = { op: "place", line: line.id, to: to.id, log_ratio: depth + log - other };
  return part ? { ...edit, part: part.lines } : edit;
}

/** The direction of an axis in the world, up to its sign: those of the main frame are the world's. */
export function directionOf(state, axis) {
  const main = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] }[axis];
  if (main) return main;
  const line = state.lines.find((each) => each.axis === axis && each.ends);
  return line ? unit(subtract(line.ends[1], line.ends[0])) : null;
}

/** The directions across which planes with both lines may lie: those that neither line runs along. */
export function normalsOf(state, first, second) {
  const frames = Array.from({ length: state.frames }, (_, frame) => (frame === 0 ? "" : String(frame + 1)));
  const axes = [...frames.flatMap((frame) => [`x${frame}`, `y${frame}`]), "z"];
  const isAcross = (axis, line) => {
    const [normal, along] = [directionOf(state, axis), directionOf(state, line.axis)];
    return normal !== null && along !== null && axis !== line.axis && Math.abs(dot(normal, along)) < 0.01;
  };
  return axes.filter((axis) => isAcross(axis, first) && isAcross(axis, second));
}

/** How far, by the log of a factor, the first line would have to go to lie in a plane with the second; null for never. */
export function apartAcross(state, first, second, axis) {
  const normal = directionOf(state, axis);
  const [own, other] = [first, second].map((line) => dot(normal, line.ends[0]));
  return own * other > 0 ? Math.log(other / own) : null;
}

/** The places that a body snaps to, `{log, text}`: other places, planes of other bodies, the ground; of a part the first. */
export function snapsOf(bodies, body, places, part = null) {
  const { state } = bodies.store;
  const found = places.map(({ move, words }) => ({ log: move, text: words.join(", ") || "another place" }));
  found.push({ log: 0, text: "where it was" });
  if (part) return distinct(found.filter(({ log }) => Math.abs(log) < FARTHEST)); // planes are of whole bodies
  const planes = state.planes.filter((plane) => plane.offset !== undefined);
  const ground = planes.find((plane) => plane.body === bodies.ground);
  for (const own of planes.filter((plane) => plane.body === body)) {
    for (const other of planes) {
      if (other.body === body || other.body < 0 || other.axis !== own.axis || other === ground) continue;
      if (own.offset * other.offset <= 0) continue;
      const what = own.axis === "z" ? "at one height with" : "in one plane with";
      found.push({ log: Math.log(other.offset / own.offset), text: `${what} ${bodies.nameOf(other.body)}` });
    }
  }
  const foot = lowestOf(bodies.linesOf.get(body) ?? []);
  if (ground && ground.offset < 0 && foot < 0)
    found.push({ log: Math.log(ground.offset / foot), text: "on the ground" });
  return distinct(found.filter(({ log }) => Math.abs(log) < FARTHEST));
}

/** The height, relative to the camera, of the lowest end of the longest upright lines; NaN where there are none. */
function lowestOf(lines) {
  const upright = lines.filter(({ axis }) => axis === "z").slice(0, 8);
  return Math.min(...upright.flatMap(({ ends }) => ends.map((end) => end[2])));
}

/** Places in order, of those that are one the first named. */
function distinct(places) {
  const kept = [];
  for (const place of places) if (kept.every(({ log }) => Math.abs(log - place.log) > SAME)) kept.push(place);
  return kept.sort((a, b) => a.log - b.log);
}

/** Lines that a person may mean beside another one, the nearest in the photo first. */
export function partnersOf(state, line, wanted) {
  const away = (other) =>
    Math.min(
      ...other.segment.map((end) => distance(end, line.segment)),
      ...line.segment.map((end) => distance(end, other.segment)),
    );
  const found = state.lines.filter((other) => other.ends && other.id !== line.id && wanted(other));
  return found
    .map((other) => [away(other) - 0.1 * lengthOf(other), other])
    .sort((a, b) => a[0] - b[0])
    .map(([, other]) => other);
}
