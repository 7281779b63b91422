// What is lit up in the model: strokes over everything, for what is selected, hovered, contradicted or measured.

import { WRONG, channels } from "./colours.js";
import { nearestToRay, ray } from "./matrices.js";
import { colourOf } from "./sure.js";
import { themeColour } from "./theme.js";

const LINE_WIDTH = 4.5; // CSS px
const THIN = 2.8; // of one of many
const EDGE_WIDTH = 2.2; // of the outline of a face
export const MEASURE = "#e0007a"; // of what is measured

/** Strokes as `Graphics.lines` takes them. */
export function litStrokes(store) {
  const wrong = store.state.contradiction?.lines ?? [];
  const lit = wrong.map((id) => [{ kind: "line", id }, channels(WRONG)]);
  for (const thing of [store.selection, store.hover]) if (thing) lit.push([thing, themeColour("--model-ink")]);
  return [...lit.flatMap(([thing, colour]) => strokesOf(store, thing, colour)), ...measured(store)];
}

function strokesOf(store, thing, colour) {
  const found = store.find(thing);
  if (!found) return [];
  if (thing.kind === "line") return lineLit(store, found, colour);
  if (thing.kind === "face") return planeLit(store, found.plane, colour);
  return crossingLit(store, found, colour);
}

function lineLit(store, line, colour, width = LINE_WIDTH) {
  if (!line.ends) return [];
  const [start, end] = line.ends;
  return [
    { start, end, colour: [...colour, 1], width: (width + 2.4) * devicePixelRatio },
    { start, end, colour: [...channels(colourOf(store, line)), 1], width: (width - 1.6) * devicePixelRatio },
  ];
}

/** The lines of a plane and the outlines of its faces. */
function planeLit(store, plane, colour) {
  const rings = plane.faces.filter((face) => store.showsFace(face)).flatMap((face) => [face.outline, ...face.holes]);
  const edges = rings.flatMap((ring) =>
    ring.map((start, index) => ({
      start,
      end: ring[(index + 1) % ring.length],
      colour: [...colour, 0.85],
      width: EDGE_WIDTH * devicePixelRatio,
    })),
  );
  const lines = plane.lines.map((id) => store.lines.get(id)).filter((line) => line && store.showsLine(line));
  return [...edges, ...lines.flatMap((line) => lineLit(store, line, colour, THIN))];
}

function crossingLit(store, crossing, colour) {
  const points = crossingInSpace(store, crossing);
  const lines = crossing.lines.map((id) => store.lines.get(id)).filter((line) => line?.ends);
  const apart =
    points.length === 2
      ? [{ start: points[0], end: points[1], colour: [...colour, 0.8], width: 1.5 * devicePixelRatio }]
      : [];
  const dots = points.map((at) => dot(at, colour, 11));
  return [...lines.flatMap((line) => lineLit(store, line, colour)), ...apart, ...dots];
}

/** Where a crossing is on each of its lines: one point when it is real, two when it is not. */
function crossingInSpace(store, crossing) {
  const { K, R_cam_from_world: rotation } = store.state;
  const through = ray(K, rotation, crossing.pixel);
  const lines = crossing.lines.map((id) => store.lines.get(id)).filter((line) => line?.ends);
  return lines.map((line) => nearestToRay(...line.ends, through));
}

function measured(store) {
  const { points, near } = store.measure;
  const colour = channels(MEASURE);
  const all = [...points, ...(near && points.length < 2 ? [near] : [])].map(({ point }) => point);
  const [start, end] = all;
  const line = end ? [{ start, end, colour: [...colour, 1], width: 2.4 * devicePixelRatio }] : [];
  return [...line, ...all.map((at) => dot(at, colour, 9))];
}

function dot(at, colour, width) {
  return { start: at, end: at, colour: [...colour, 1], width: width * devicePixelRatio };
}
