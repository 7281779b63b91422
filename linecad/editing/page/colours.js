// The colours of lines and crossings: those of the pictures and models that linecad exports.

const FURTHER = ["#ed8c1a", "#0d99a6", "#c233b3", "#8c991a"]; // of the level axes of further frames, in turn
const MOST_FRAMES = 9;
export const AXIS = { x: "#de2929", y: "#1a9e38", z: "#265ceb" };
for (let frame = 2; frame <= MOST_FRAMES; frame++) {
  const first = 2 * ((frame - 2) % 2);
  AXIS[`x${frame}`] = FURTHER[first];
  AXIS[`y${frame}`] = FURTHER[first + 1];
}
export const REAL = "#ffd61f";
export const FAKE = "#cc0d9e";
export const UNSURE = "#8a8a94";
export const CHANGED = "#00b3c4";
export const WRONG = "#ff6a00"; // lines and crossings of a contradiction
export const INK = "#22222a";
export const CASING = "#ffffff";

/** [red, green, blue], 0 to 1, of a colour of this file. */
export function channels(colour) {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255);
}
