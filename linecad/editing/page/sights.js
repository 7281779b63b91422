// What a place on the screen is in space: the point of a line or face that is meant there, in the photo or the model.

import { add, cross, dot, pixelOf, ray, subtract, times } from "./matrices.js";

const POINT_REACH = 9; // CSS px, to an end or a corner
const EDGE_REACH = 7; // to a line or the edge of a face
const ONE_PLACE = 2; // CSS px between points that nobody can point at one of
const HIDDEN = 0.01; // of the way to a point: what a face is nearer than by that hides it

/** The photo as a sight: where points are on its stage, and what a place of it looks along. */
export function sightOfPhoto(store, viewport) {
  const { K, R_cam_from_world: rotation } = store.state;
  return {
    toScreen(point) {
      const pixel = pixelOf(K, rotation, point);
      return pixel && viewport.toScreen(pixel);
    },
    along: (at) => [[0, 0, 0], ray(K, rotation, viewport.toPhoto(at))],
    showsHiddenLines: true, // they are drawn over the photo, whatever stands before them
  };
}

/** The model as a sight. In the front of a plane, where depths are not seen, that plane goes before all others. */
export function sightOfModel(model) {
  const matrix = model.orbit.matrix;
  return {
    plane: model.orbit.flat?.name === "front" ? model.store.selectedPlane : undefined,
    toScreen: (point) => model.toScreen(point, matrix),
    along: (at) => model.orbit.sight(at),
    showsHiddenLines: false,
  };
}

/** The first face that is shown along a direction: `{face, plane, point, share}` of the direction's length, or null. */
export function faceAlong(store, [origin, direction]) {
  let best = null;
  for (const { face, plane } of store.faces.values()) {
    if (!store.showsFace(face)) continue;
    const normal = plane.normal;
    const share = (plane.offset - dot(normal, origin)) / dot(normal, direction);
    if (!(share > 0) || (best && share >= best.share)) continue;
    const point = add(origin, times(direction, share));
    if (contains(face, point)) best = { face, plane, point, share };
  }
  return best;
}

/** Whether a point of a face's plane is in one of its triangles. */
function contains(face, point) {
  const corners = [face.outline, ...face.holes].flat();
  return face.triangles.some((triangle) => {
    const [a, b, c] = triangle.map((index) => corners[index]);
    const normal = cross(subtract(b, a), subtract(c, a));
    const side = (from, to) => dot(cross(subtract(to, from), subtract(point, from)), normal) >= 0;
    return side(a, b) && side(b, c) && side(c, a);
  });
}

/**
 * What is meant at a place of a stage, CSS px: `{point, on, what}`, or null where nothing of the model is.
 *
 * Ends and corners go before lines and edges, those before faces; `on` is `{line: id}` or `{face: id}`.
 */
export function pointAt(store, sight, at) {
  const along = sight.along(at);
  const lines = store.state.lines.filter((line) => line.ends && store.showsLine(line));
  const faces = [...store.faces.values()].filter(({ face }) => store.showsFace(face));
  const sides = [
    ...lines.map((line) => ({ ends: line.ends, on: { line: line.id }, what: ["end of a line", "line"] })),
    ...faces.flatMap(({ face }) => edgesOf(face)),
  ];
  const found = nearestEnd(sides, sight, at, store) ?? nearestSide(sides, sight, at, along, store);
  if (found) return found;
  const hit = faceAlong(store, along);
  return hit && { point: hit.point, on: { face: hit.face.id }, what: "face" };
}

function edgesOf(face) {
  return [face.outline, ...face.holes].flatMap((ring) =>
    ring.map((start, index) => ({
      ends: [start, ring[(index + 1) % ring.length]],
      on: { face: face.id },
      what: ["corner of a face", "edge of a face"],
    })),
  );
}

function nearestEnd(sides, sight, at, store) {
  const ends = sides.flatMap(({ ends, on, what }) => ends.map((point) => ({ point, on, what: what[0] })));
  return best(ends, POINT_REACH, sight, at, store);
}

function nearestSide(sides, sight, at, along, store) {
  const places = sides.map(({ ends, on, what }) => ({ point: nearestOnPiece(ends, along), on, what: what[1] }));
  return best(places, EDGE_REACH, sight, at, store);
}

/** Of points that are seen within a reach, CSS px, the nearest one; of several at one place that before the others. */
function best(candidates, reach, sight, at, store) {
  let near = candidates
    .map((candidate) => ({ ...candidate, away: apart(sight.toScreen(candidate.point), at) }))
    .filter(({ away, point, on }) => away < reach && isSeen(store, sight, point, on));
  const meant = near.filter(({ on }) => isOf(sight.plane, on));
  if (meant.length > 0) near = meant;
  if (near.length === 0) return null;
  const least = Math.min(...near.map(({ away }) => away));
  const share = ({ point }) => shareOf(point, sight.along(at));
  const here = near.filter(({ away }) => away < least + ONE_PLACE);
  const first = Math.min(...here.map(share));
  // A line goes before the corner of a face there: it is what a model made anew has again.
  const { point, on, what } = here.find((candidate) => share(candidate) <= first * (1 + HIDDEN));
  return { point, on, what };
}

/** Whether a line or a face, `{line: id}` or `{face: id}`, is of a plane. */
function isOf(plane, { line, face }) {
  return plane !== undefined && (plane.lines.includes(line) || plane.faces.some(({ id }) => id === face));
}

function apart(place, at) {
  return place ? Math.hypot(place[0] - at[0], place[1] - at[1]) : Infinity;
}

/** Whether no face hides a point from where it is looked at. */
function isSeen(store, sight, point, on) {
  if (sight.showsHiddenLines && "line" in on) return true;
  const along = sight.along(sight.toScreen(point));
  const hit = faceAlong(store, along);
  return !hit || hit.share > shareOf(point, along) * (1 - HIDDEN);
}

/** How far along a ray a point is, in lengths of its direction. */
function shareOf(point, [origin, direction]) {
  return dot(subtract(point, origin), direction) / dot(direction, direction);
}

/** The point of a piece of straight line that is nearest to a ray. */
function nearestOnPiece([start, end], [origin, direction]) {
  const along = subtract(end, start);
  const off = subtract(start, origin);
  const [a, b, c] = [dot(along, along), dot(along, direction), dot(direction, direction)];
  const [d, e] = [dot(along, off), dot(direction, off)];
  const across = a * c - b * b;
  const share = across > 1e-12 * a * c ? (b * e - c * d) / across : 0;
  return add(start, times(along, Math.min(Math.max(share, 0), 1)));
}
