// How sure depths are, as colours: those of lines and faces while they tell that and not the axes.

import { AXIS } from "./colours.js";

/** From a guess to a sure depth, sRGB; the legend in views.css has the same ones. Readable by people who see no red. */
export const STOPS = ["#a50026", "#f46d43", "#fdbf5b", "#8fb8d9", "#2b5fa8"];
export const UNTOLD = "#8a8a94"; // lines that are not in the model, faces without lines
const STEPS = 20; // shades in all, so that many lines are one stroke

/** The colour of a probability, null where none is told. */
export function colourOfProbability(probability) {
  if (probability === null || probability === undefined) return UNTOLD;
  const place = (Math.round(probability * STEPS) / STEPS) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  const channelsOf = (stop) => [1, 3, 5].map((at) => parseInt(stop.slice(at, at + 2), 16));
  const [one, other] = [channelsOf(STOPS[below]), channelsOf(STOPS[below + 1])];
  const mixed = one.map((value, k) => Math.round(value + (place - below) * (other[k] - value)));
  return `#${mixed.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

/** The colour of a line, or of a plane's faces over the photo. */
export function colourOf(store, lineOrPlane) {
  return store.colouring === "axis" ? AXIS[lineOrPlane.axis] : colourOfProbability(lineOrPlane.probability);
}
