// Keys that go from line to line: the next by length, and the nearest in a direction.

/** The lines that are shown, the longest first. */
function byLength(store) {
  const length = ({ segment: [[a, b], [c, d]] }) => Math.hypot(c - a, d - b);
  const shown = store.state.lines.filter((line) => store.showsLine(line));
  return shown.sort((a, b) => length(b) - length(a) || a.id - b.id);
}

function middle({ segment: [[a, b], [c, d]] }) {
  return [(a + c) / 2, (b + d) / 2];
}

/** The line whose middle is nearest to a pixel in a direction, (x, y) of length 1: sideways counts twice. */
export function nearestTowards(lines, from, [x, y]) {
  let best = null;
  let least = Infinity;
  for (const line of lines) {
    const [u, v] = middle(line).map((at, k) => at - from[k]);
    const along = u * x + v * y;
    const beside = Math.abs(u * y - v * x);
    if (along <= 0 || beside > along || along + 2 * beside >= least) continue;
    least = along + 2 * beside;
    best = line;
  }
  return best;
}

export class LineWalk {
  constructor(store, photo, messages) {
    Object.assign(this, { store, photo, messages });
  }

  /** The next line, or the one before it by -1, in the order of length and around. */
  step(by) {
    const lines = byLength(this.store);
    const { selectedLine } = this.store;
    const now = lines.findIndex((line) => line.id === selectedLine?.id);
    const start = now < 0 && by < 0 ? 0 : now;
    this.#choose(lines[(start + by + lines.length) % lines.length]);
  }

  /** The nearest line towards (x, y), from the selected one or from the middle of what is seen. */
  towards(x, y) {
    const { viewport } = this.photo;
    const { selectedLine, selectedCrossing } = this.store;
    const seen = viewport.toPhoto([viewport.width / 2, viewport.height / 2]);
    const from = selectedLine ? middle(selectedLine) : (selectedCrossing?.pixel ?? seen);
    const others = byLength(this.store).filter((line) => line.id !== selectedLine?.id);
    this.#choose(nearestTowards(others, from, [x, y]));
  }

  #choose(line) {
    if (!line) return this.messages.tell("There is no line that way.");
    const { viewport } = this.photo;
    this.store.set({ selection: { kind: "line", id: line.id } });
    const [x, y] = viewport.toScreen(middle(line));
    if (x < 0 || y < 0 || x > viewport.width || y > viewport.height) this.photo.show({ kind: "line", id: line.id });
  }
}
