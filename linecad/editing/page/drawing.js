// What lies over the photo: faces, lines by axis, crossings. The context is in CSS px of the stage.

import { AXIS, CASING, INK, WRONG } from "./colours.js";
import { applied, product } from "./matrices.js";
import { markOf } from "./marks.js";
import { isReal } from "./store.js";

const BOUNDARY = 2.8; // CSS px, width of lines where two planes meet
const OTHER = 1.6;
const CASING_WIDTH = 1.6; // CSS px that the casing is wider than its line
const CASING_OPACITY = 0.75;
const GUESS_DASHES = [6, 3]; // CSS px
const UNSOLVED_DASHES = [2, 4]; // lines that are not in the model yet
const FACE_OPACITY = 0.16;
const HANDLE = 8; // CSS px, of the squares at the ends of the selected line, which can be dragged
const NEAREST_DEPTH = 1e-3; // of a scene's units; nothing nearer to the camera is drawn

/** All layers that are switched on; with a `box` (left, top, width, height) only the marks that touch it. */
export function draw(context, store, viewport, marks, box = [0, 0, viewport.width, viewport.height]) {
  if (store.layers.faces) drawFaces(context, store, viewport);
  drawLines(context, store, viewport);
  drawCrossings(context, store, viewport, marks, box);
}

function drawFaces(context, store, viewport) {
  const { K, R_cam_from_world: rotation, photo } = store.state;
  const project = product(K, rotation);
  context.save();
  context.beginPath();
  context.rect(viewport.x, viewport.y, photo.width * viewport.scale, photo.height * viewport.scale);
  context.clip();
  context.globalAlpha = FACE_OPACITY;
  for (const plane of store.state.planes) {
    context.fillStyle = AXIS[plane.axis];
    for (const face of plane.faces ?? []) {
      context.beginPath();
      for (const ring of [face.outline, ...(face.holes ?? [])]) tracePolygon(context, ring, project, viewport);
      context.fill("evenodd");
    }
  }
  context.restore();
}

function tracePolygon(context, ring, project, viewport) {
  const corners = beforeCamera(ring.map((point) => applied(project, point)));
  corners.forEach(([x, y, depth], index) => {
    const at = viewport.toScreen([x / depth, y / depth]);
    if (index === 0) context.moveTo(...at);
    else context.lineTo(...at);
  });
  context.closePath();
}

/** A polygon of (x, y, depth) without what is behind the camera. */
function beforeCamera(corners) {
  const kept = [];
  corners.forEach((corner, index) => {
    const next = corners[(index + 1) % corners.length];
    const [here, there] = [corner[2] - NEAREST_DEPTH, next[2] - NEAREST_DEPTH];
    if (here >= 0) kept.push(corner);
    if (here >= 0 !== there >= 0) {
      const share = here / (here - there);
      kept.push(corner.map((value, k) => value + share * (next[k] - value)));
    }
  });
  return kept;
}

/** Lines in groups that one stroke draws; boundaries over the others; those that are sure have a light casing. */
function drawLines(context, store, viewport) {
  const groups = new Map();
  for (const line of store.state.lines) {
    if (!store.showsLine(line)) continue;
    const name = styleOf(line);
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(line);
  }
  context.lineCap = "butt";
  for (const boundary of [false, true]) {
    const shown = [...groups].filter(([, [first]]) => first.boundary === boundary);
    const width = boundary ? BOUNDARY : OTHER;
    const sure = shown.filter(([, [first]]) => dashes(first).length === 0);
    context.globalAlpha = CASING_OPACITY;
    strokeLines(
      context,
      viewport,
      sure.flatMap(([, lines]) => lines),
      CASING,
      width + CASING_WIDTH,
    );
    context.globalAlpha = 1;
    for (const [, lines] of shown) {
      context.setLineDash(dashes(lines[0]));
      strokeLines(context, viewport, lines, AXIS[lines[0].axis], width);
      context.setLineDash([]);
    }
  }
}

function styleOf(line) {
  return `${line.axis} ${line.boundary} ${dashes(line).length > 0 ? dashes(line)[0] : ""}`;
}

function dashes(line) {
  if (!line.ends) return UNSOLVED_DASHES;
  return line.guess ? GUESS_DASHES : [];
}

export function strokeLines(context, viewport, lines, colour, width) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  const { scale, x, y } = viewport;
  for (const { segment } of lines) {
    const [[a, b], [c, d]] = segment;
    context.moveTo((a + 0.5) * scale + x, (b + 0.5) * scale + y);
    context.lineTo((c + 0.5) * scale + x, (d + 0.5) * scale + y);
  }
  context.stroke();
}

/** Fake ones below real ones; what changed has a ring around it. */
function drawCrossings(context, store, viewport, marks, [x, y, width, height]) {
  const reach = marks.half / marks.density + 1;
  const [left, top] = viewport.toPhoto([x - reach, y - reach]);
  const [right, bottom] = viewport.toPhoto([x + width + reach, y + height + reach]);
  const seen = { changed: [], fake: [], real: [] };
  for (const crossing of store.state.crossings) {
    const [u, v] = crossing.pixel;
    if (u < left || u > right || v < top || v > bottom || !store.showsCrossing(crossing)) continue;
    if (!store.thinning.shows(crossing, viewport.scale)) continue;
    seen[isReal(crossing) ? "real" : "fake"].push(crossing);
    if (crossing.changed && store.layers.changed) seen.changed.push(crossing);
  }
  context.save();
  context.resetTransform();
  for (const crossing of seen.changed) put(context, viewport, marks, "changed", crossing.pixel);
  for (const crossing of seen.fake) put(context, viewport, marks, markOf(crossing), crossing.pixel);
  for (const crossing of seen.real) put(context, viewport, marks, markOf(crossing), crossing.pixel);
  context.restore();
}

/** Stamp a mark, on whole px of the screen so that it stays sharp; the context is in device px. */
function put(context, viewport, marks, name, pixel) {
  const { scale, x, y } = viewport;
  const left = Math.round(((pixel[0] + 0.5) * scale + x) * marks.density - 0.5) - marks.half;
  const top = Math.round(((pixel[1] + 0.5) * scale + y) * marks.density - 0.5) - marks.half;
  context.drawImage(marks.stamp(name), left, top);
}

/**
 * What changes with the pointer: a contradiction, the selection and its crossings, what is under the pointer.
 *
 * `stretched` is the line whose end is dragged, as it would be, or null.
 */
export function drawAttention(context, store, viewport, marks, stretched) {
  const wrong = store.state.contradiction;
  const lit = new Set();
  const light = (id, colour, border) => {
    if (!store.lines.has(id)) return;
    lit.add(id);
    const line = store.lines.get(id);
    glow(context, viewport, id === stretched?.id ? { ...line, segment: stretched.ends } : line, colour, border);
  };
  for (const id of wrong?.lines ?? []) light(id, WRONG, 4);
  for (const id of store.selectedCrossing?.lines ?? []) light(id, INK, 0.5);
  if (store.selectedLine) light(store.selectedLine.id, INK, 2.5);
  for (const id of store.many?.lines ?? []) light(id, INK, 1.8);
  if (store.hover?.kind === "line") light(store.hover.id, INK, 1.2);
  // The lines lie over the marks of the canvas below: those of the lit ones come again on top.
  context.save();
  context.resetTransform();
  for (const crossing of store.state.crossings) {
    const isLit = crossing.lines.some((id) => lit.has(id)) || store.isNear(crossing);
    if (isLit && store.drawsCrossing(crossing, viewport.scale)) {
      put(context, viewport, marks, markOf(crossing), crossing.pixel);
    }
  }
  for (const id of wrong?.crossings ?? []) {
    if (store.crossings.has(id)) put(context, viewport, marks, "wrong", store.crossings.get(id).pixel);
  }
  context.restore();
  for (const id of store.many?.crossings ?? []) dot(context, viewport, store.crossings.get(id).pixel);
  if (store.selectedCrossing) circleAround(context, viewport, marks, store.selectedCrossing, 2.6);
  if (store.hover?.kind === "crossing") circleAround(context, viewport, marks, store.find(store.hover), 1.4);
  if (store.selectedLine) drawHandles(context, viewport, stretched?.ends ?? store.selectedLine.segment);
}

/** Squares on top of all marks. */
function drawHandles(context, viewport, ends) {
  for (const end of ends) {
    const [x, y] = viewport.toScreen(end);
    for (const [side, ink] of [
      [HANDLE + 4, INK],
      [HANDLE + 1, CASING],
      [HANDLE - 3, INK],
    ]) {
      context.fillStyle = ink;
      context.fillRect(x - side / 2, y - side / 2, side, side);
    }
  }
}

/** One of many that are selected: small, since there may be hundreds that are not drawn at this scale. */
function dot(context, viewport, pixel) {
  const [x, y] = viewport.toScreen(pixel);
  for (const [radius, ink] of [
    [3.4, CASING],
    [2.2, INK],
  ]) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = ink;
    context.fill();
  }
}

function circleAround(context, viewport, marks, crossing, width) {
  const [x, y] = viewport.toScreen(crossing.pixel);
  for (const [wide, ink] of [
    [width + 2, CASING],
    [width, INK],
  ]) {
    context.beginPath();
    context.arc(x, y, marks.radius + 6.5, 0, 2 * Math.PI);
    context.lineWidth = wide;
    context.strokeStyle = ink;
    context.stroke();
  }
}

/** A line with a border on each side, `border` CSS px wide, and dots at its ends. */
function glow(context, viewport, line, colour, border) {
  const width = (line.boundary ? BOUNDARY : OTHER) + 0.6;
  context.lineCap = "round";
  for (const [ink, wide] of [
    [CASING, width + 2 * border + 3],
    [colour, width + 2 * border],
    [CASING, width + 1.4],
    [AXIS[line.axis], width],
  ]) {
    strokeLines(context, viewport, [line], ink, wide);
  }
  for (const end of line.segment) {
    const [x, y] = viewport.toScreen(end);
    context.fillStyle = colour;
    context.fillRect(x - 2.5, y - 2.5, 5, 5);
  }
}
