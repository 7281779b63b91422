// What the tools for faces draw over the photo, and what they ask for below it.

import { CASING, INK } from "./colours.js";
import { element } from "./dom.js";
import { AREAS, OPENINGS } from "./facetools.js";
import { grid } from "./rectangles.js";

const COLOURS = { ground: "#4f8a3c", sky: "#2f7fc1", clutter: "#a05f2c" };
const UNFILLED = ["window", "door", "wall"]; // what is said of them is their edges
const FILL = 0.22;
const DASHES = [7, 4]; // CSS px, of what was told

/** What was told of faces, and what is being drawn. */
export function drawFaceTools(context, viewport, store, faces) {
  for (const { is, polygon } of store.state.areas)
    trace(context, viewport, polygon, COLOURS[is] ?? INK, { dashes: DASHES, filled: !UNFILLED.includes(is) });
  if (faces.outline.length > 0) {
    trace(context, viewport, faces.outline, COLOURS[faces.area], { open: faces.outline.length < 3 });
    const [x, y] = viewport.toScreen(faces.outline[0]);
    context.fillStyle = COLOURS[faces.area];
    context.fillRect(x - 4, y - 4, 8, 8);
  }
  const { rectangle, chosen } = faces;
  if (rectangle) {
    for (const corners of grid(store.state, rectangle.face, rectangle.corners, { ...rectangle, last: rectangle.last ?? rectangle.corners[1] }))
      trace(context, viewport, corners, INK, { filled: !rectangle.sent });
  }
  if (chosen?.corners) trace(context, viewport, chosen.corners, INK, {});
  for (const id of faces.lines) trace(context, viewport, store.lines.get(id)?.segment ?? [], INK, { open: true });
}

function trace(context, viewport, points, colour, { open = false, dashes = [], filled = true }) {
  if (points.length === 0) return;
  context.beginPath();
  points.forEach((point, index) => {
    const at = viewport.toScreen(point);
    if (index === 0) context.moveTo(...at);
    else context.lineTo(...at);
  });
  if (!open) context.closePath();
  context.lineJoin = "round";
  if (filled && !open) {
    context.globalAlpha = FILL;
    context.fillStyle = colour;
    context.fill();
    context.globalAlpha = 1;
  }
  for (const [ink, width] of [
    [CASING, 4],
    [colour, 2],
  ]) {
    context.setLineDash(dashes);
    context.strokeStyle = ink;
    context.lineWidth = width;
    context.stroke();
  }
  context.setLineDash([]);
}

/** What the panel below the photo shows while a tool for faces is chosen. */
export function facePanel(store, faces) {
  const choice = (field, words) =>
    words.map((word) =>
      element(
        "button",
        { "aria-pressed": String(faces[field] === word), "data-word": word, onclick: () => faces.choose(field, word) },
        `${word[0].toUpperCase()}${word.slice(1)}`,
      ),
    );
  if (store.tool === "area") {
    return [
      element("p", {}, "This is: "),
      element("div", { class: "buttons" }, choice("area", AREAS)),
      element("p", { class: "quiet" }, "Drag around it, or click its corners and press Enter."),
    ];
  }
  if (store.tool === "wall") {
    return [element("p", {}, `${faces.lines.length} of 4 edges: two upright and two level ones. Click a line again to leave it out.`)];
  }
  const { rectangle, chosen } = faces;
  const several = rectangle?.last ? ` ${rectangle.columns} columns, ${rectangle.rows} rows: arrow keys change them.` : "";
  const text = chosen
    ? "A window or door of the model: Del takes it away."
    : `Drag from corner to corner. Drag from inside it to the last one for rows and columns.${several}`;
  return [element("div", { class: "buttons" }, choice("opening", OPENINGS)), element("p", {}, text)];
}
