// Dashes of lines in space: as long in the model wherever one looks from, so that they do not crawl when it turns.

const DASH = 1 / 160; // of the size of the model
const SHARE = 0.6; // of a dash and its gap that is drawn
const MOST = 60; // of one line

/** A line, as `{ends}` and what it has else, in pieces with gaps between them. */
export function dashed(line, size) {
  const [start, end] = line.ends;
  const length = Math.hypot(...start.map((at, k) => end[k] - at));
  const count = Math.min(Math.max(Math.round((length * SHARE) / (DASH * size)), 2), MOST);
  const at = (share) => start.map((value, k) => value + share * (end[k] - value));
  // The last piece ends where the line does.
  const step = 1 / (count - 1 + SHARE);
  return Array.from({ length: count }, (_, number) => ({
    ...line,
    ends: [at(number * step), at((number + SHARE) * step)],
  }));
}
