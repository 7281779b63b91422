// What is under the pointer: crossings before lines, the nearest first.

import { RADIUS } from "./marks.js";

const CROSSING_REACH = 10; // CSS px
const FLIP_REACH = RADIUS + 2; // where a click changes the crossing: what misses its mark means the line
const LINE_REACH = 7;

/** All that a person may mean at a point of the stage, as `{kind, id}`, the most likely first. */
export function thingsAt(store, viewport, at, kinds = ["crossing", "line"]) {
  const pixel = viewport.toPhoto(at);
  const found = [];
  if (kinds.includes("crossing")) {
    const changes = store.tool === "correct" && !store.labelling;
    const reach = (changes ? FLIP_REACH : CROSSING_REACH) / viewport.scale;
    for (const crossing of store.state.crossings) {
      if (Math.abs(crossing.pixel[0] - pixel[0]) > reach || !store.drawsCrossing(crossing, viewport.scale)) continue;
      const away = Math.hypot(crossing.pixel[0] - pixel[0], crossing.pixel[1] - pixel[1]);
      if (away <= reach) found.push([away, { kind: "crossing", id: crossing.id }]);
    }
  }
  const crossings = found.sort((a, b) => a[0] - b[0]).map(([, thing]) => thing);
  const lines = [];
  if (kinds.includes("line")) {
    const reach = LINE_REACH / viewport.scale;
    for (const line of store.state.lines) {
      if (!store.showsLine(line)) continue;
      const away = distance(pixel, line.segment);
      if (away <= reach) lines.push([away, { kind: "line", id: line.id }]);
    }
  }
  return [...crossings, ...lines.sort((a, b) => a[0] - b[0]).map(([, thing]) => thing)];
}

/** The distance of a point from a piece of straight line, both in the same px. */
export function distance(point, [start, end]) {
  const foot = nearest(point, [start, end]);
  return Math.hypot(point[0] - foot[0], point[1] - foot[1]);
}

/** The point of a piece of straight line that is nearest to a point. */
export function nearest([u, v], [[a, b], [c, d]]) {
  const [du, dv] = [c - a, d - b];
  const share = Math.min(Math.max(((u - a) * du + (v - b) * dv) / (du * du + dv * dv || 1), 0), 1);
  return [a + share * du, b + share * dv];
}
