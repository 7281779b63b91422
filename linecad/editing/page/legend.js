// What lines, marks and faces look like and mean: a legend for the photo and one for the model, to fold away.

import { element } from "./dom.js";

const PHOTO = [
  ["line x", "along x"],
  ["line y", "along y"],
  ["line z", "upright"],
  ["line wide", "wide: two planes meet there"],
  ["line dashed", "dashed: its depth is a guess"],
  ["line dotted", "dotted: not in the model yet"],
  ["mark real", "real: the lines meet in space"],
  ["mark fake", "fake: they only meet in the photo"],
  ["mark unsure", "grey: you were unsure"],
  ["mark said", "dark ring: you said so"],
  ["mark changed", "changed by the last solve"],
  ["mark wrong", "cannot all be true"],
];
const MODEL = [
  ["line through", "drawn through: depth is sure or likely"],
  ["line dashed", "dashed and pale: depth is a guess"],
  ["area sure", "face"],
  ["area guess", "pale face: all its lines are guesses"],
  ["camera", "the camera of the photo"],
];

/** Fills the two legends. */
export function fillLegends() {
  for (const [id, rows] of [
    ["#photo-legend", PHOTO],
    ["#model-legend", MODEL],
  ]) {
    const items = rows.map(([look, text]) =>
      element("li", {}, element("i", { class: `key ${look}`, "aria-hidden": "true" }), text),
    );
    document.querySelector(id).append(element("ul", {}, ...items));
  }
}
