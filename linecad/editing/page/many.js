// Many lines and crossings at once: what a rectangle encloses, and one step for all of them.

import { inNextFrame } from "./axes.js";
import { counted, element, keyButton } from "./dom.js";

/** What a rectangle between two pixels of the photo holds, as far as it is shown: lines with both ends. */
export function enclosed(store, [a, b], [c, d]) {
  const [left, right, top, bottom] = [Math.min(a, c), Math.max(a, c), Math.min(b, d), Math.max(b, d)];
  const holds = ([u, v]) => u >= left && u <= right && v >= top && v <= bottom;
  const { lines, crossings } = store.state;
  return {
    lines: lines.filter((line) => store.showsLine(line) && line.segment.every(holds)).map(({ id }) => id),
    crossings: crossings.filter((one) => store.showsCrossing(one) && holds(one.pixel)).map(({ id }) => id),
  };
}

/** The things of two lots, each once. */
function together(one, other) {
  return Object.fromEntries(["lines", "crossings"].map((kind) => [kind, [...new Set([...one[kind], ...other[kind]])]]));
}

export class Many {
  constructor(store, editing, messages) {
    Object.assign(this, { store, editing, messages });
  }

  /** Select what a rectangle holds, or add it to what is selected. */
  enclose(from, to, adds) {
    const inside = enclosed(this.store, from, to);
    this.#select(adds ? together(this.#now(), inside) : inside);
  }

  /** Add one thing to what is selected, or take it away. */
  toggle({ kind, id }) {
    const now = this.#now();
    const list = kind === "line" ? "lines" : "crossings";
    const ids = now[list].includes(id) ? now[list].filter((each) => each !== id) : [...now[list], id];
    this.#select({ ...now, [list]: ids });
  }

  /** The lot that is selected, also where it is one thing. */
  #now() {
    const { many, selection } = this.store;
    if (many) return many;
    const ids = (kind) => (selection?.kind === kind ? [selection.id] : []);
    return { lines: ids("line"), crossings: ids("crossing") };
  }

  #select(lot) {
    const things = [
      ...lot.lines.map((id) => ({ kind: "line", id })),
      ...lot.crossings.map((id) => ({ kind: "crossing", id })),
    ];
    if (things.length > 1) this.store.set({ selection: null, many: lot });
    else this.store.set({ many: null, selection: things[0] ?? null });
  }

  // --- one step for all ---

  label(value) {
    const { crossings } = this.store.many;
    if (crossings.length === 0) return this.messages.tell("No crossing is selected.");
    return this.#step(crossings.map((crossing) => ({ op: "label", crossing, value })));
  }

  axis(axis) {
    return this.#turn(() => axis);
  }

  nextFrame() {
    return this.#turn((line) => inNextFrame(line.axis, this.store.state.frames));
  }

  #turn(axisOf) {
    const lines = this.store.many.lines.map((id) => this.store.lines.get(id));
    if (lines.length === 0) return this.messages.tell("No line is selected.");
    const turned = lines.filter((line) => line.axis !== axisOf(line));
    return this.#step(turned.map((line) => ({ op: "axis", line: line.id, axis: axisOf(line) })));
  }

  remove() {
    const { lines } = this.store.many;
    if (lines.length === 0) return this.messages.tell("No line is selected.");
    return this.#step(lines.map((line) => ({ op: "delete", line })));
  }

  #step(edits) {
    if (edits.length === 0) return undefined;
    return this.editing.edit(edits.length === 1 ? edits[0] : { op: "many", edits });
  }

  /** What the strip below the photo shows of them. */
  panel() {
    const { many, owner, state } = this.store;
    const counts = [
      many.lines.length > 0 ? counted(many.lines.length, "line") : null,
      many.crossings.length > 0 ? counted(many.crossings.length, "crossing") : null,
    ];
    const button = (label, key, action, attributes = {}) =>
      keyButton(label, key, action, { disabled: !owner, ...attributes });
    const word = (value, name, key) => button(name, key, () => this.label(value));
    const lines = [
      ...["x", "y", "z"].map((axis) => {
        const attributes = { class: `axis ${axis}`, "aria-label": `Axis ${axis}` };
        return button(axis, axis.toUpperCase(), () => this.axis(axis), attributes);
      }),
      ...(state.frames > 1 ? [button("next frame", "Q", () => this.nextFrame())] : []),
      button("Delete lines", "Del", () => this.remove()),
    ];
    const crossings = [
      word("real", "Real", "R"),
      word("fake", "Fake", "F"),
      word("unsure", "Unsure", "U"),
      word(null, "Solver decides", "G"),
    ];
    return [
      element("p", {}, element("strong", {}, counts.filter(Boolean).join(", ")), " selected"),
      element(
        "div",
        { class: "buttons" },
        ...(many.crossings.length > 0 ? crossings : []),
        ...(many.lines.length > 0 ? lines : []),
      ),
    ];
  }
}
