// Which crossings are drawn at a scale: where they lie close, the more important ones, until the photo is zoomed in.
// What is not drawn cannot be clicked. Nothing here depends on where the photo is moved to, nor on labels, so that a
// click changes no other mark.

const APART = 20; // CSS px between two crossings that are drawn
const TOLD_APART = 12; // between two that a person labelled or the last solve changed
const FIRST = 1 / 8; // of the photo's part that has crossings: the distance at which so few are drawn that none need go
const ALL_SCALE = 16; // CSS px a photo pixel: from here on all are drawn
const FINER = Math.SQRT1_2; // from one distance to the next

/** How much a crossing bears: as long as the shorter of its two lines, then the longer. */
function importance(crossing, length) {
  const [one, other] = crossing.lines.map((id) => length.get(id) ?? 0);
  return Math.min(one, other) + 1e-3 * Math.max(one, other);
}

/**
 * By the id of each crossing, the largest distance (px of the photo) at which it is drawn: then no more important one
 * that is drawn at that distance is nearer.
 */
export function reaches(crossings, lines) {
  const length = new Map(lines.map(({ id, segment: [[a, b], [c, d]] }) => [id, Math.hypot(c - a, d - b)]));
  const bears = new Map(crossings.map((crossing) => [crossing.id, importance(crossing, length)]));
  let left = [...crossings].sort((a, b) => bears.get(b.id) - bears.get(a.id) || a.id - b.id);
  const found = new Map();
  const placed = []; // pixels
  const last = APART / ALL_SCALE;
  for (let apart = FIRST * widest(crossings); left.length > 0 && apart > last; apart *= FINER) {
    const grid = new Grid(apart);
    for (const pixel of placed) grid.add(pixel);
    left = left.filter(({ id, pixel }) => {
      if (grid.hasNear(pixel)) return true;
      grid.add(pixel);
      placed.push(pixel);
      found.set(id, apart);
      return false;
    });
  }
  for (const { id } of left) found.set(id, last);
  return found;
}

/** px that all crossings lie apart at most. */
function widest(crossings) {
  const spans = [0, 1].map((k) => {
    const places = crossings.map(({ pixel }) => pixel[k]);
    return places.reduce((a, b) => Math.max(a, b), -Infinity) - places.reduce((a, b) => Math.min(a, b), Infinity);
  });
  return Math.max(...spans, 1);
}

/** Points in cells as wide as the distance that is asked about. */
class Grid {
  #cells = new Map();

  constructor(apart) {
    this.apart = apart;
  }

  #cell(pixel) {
    return [Math.floor(pixel[0] / this.apart), Math.floor(pixel[1] / this.apart)];
  }

  add(pixel) {
    const [column, row] = this.#cell(pixel);
    const key = column * 2 ** 26 + row;
    if (!this.#cells.has(key)) this.#cells.set(key, []);
    this.#cells.get(key).push(pixel);
  }

  hasNear([u, v]) {
    const [column, row] = this.#cell([u, v]);
    for (let right = -1; right <= 1; right++) {
      for (let down = -1; down <= 1; down++) {
        for (const [x, y] of this.#cells.get((column + right) * 2 ** 26 + row + down) ?? []) {
          if (Math.hypot(x - u, y - v) < this.apart) return true;
        }
      }
    }
    return false;
  }
}

/** The same, kept while lines and crossings stay. */
export class Thinning {
  #reaches = new Map();
  #known = null; // the crossings that they are of

  /** Take note of a state; labels, decisions and depths change nothing. */
  renew({ crossings, lines }) {
    const key = (crossing) => `${crossing.id} ${crossing.pixel}`;
    if (crossings === this.#known) return;
    const before = this.#known;
    this.#known = crossings;
    const isSame = before?.length === crossings.length && crossings.every((one, k) => key(one) === key(before[k]));
    if (!isSame) this.#reaches = reaches(crossings, lines);
  }

  /** Whether a crossing is drawn at a scale, CSS px a photo pixel. */
  shows(crossing, scale) {
    const apart = crossing.label !== null || crossing.changed ? TOLD_APART : APART;
    return apart <= (this.#reaches.get(crossing.id) ?? Infinity) * scale;
  }
}
