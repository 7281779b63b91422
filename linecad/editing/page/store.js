// What the page knows: the state that the server sent, with the edits under way laid over it, and what is seen here.

import { Thinning } from "./thinning.js";

/**
 * The layers that can be switched on and off, in the order of their buttons; `key` is the digit that does it.
 *
 * Those of a depth map are there where the photo has one, and off at first.
 */
export const LAYERS = [
  { name: "real", label: "Real", key: "1" },
  { name: "fake", label: "Fake", key: "2" },
  { name: "changed", label: "Changed", key: "3" },
  { name: "x", label: "x", key: "4" },
  { name: "y", label: "y", key: "5" },
  { name: "z", label: "z", key: "6" },
  { name: "faces", label: "Faces", key: "7" },
  { name: "depth", label: "Depth map", key: "8", ofMap: true },
  { name: "difference", label: "Map and model", key: "9", ofMap: true },
];

/**
 * One value that all views draw. `set` stores fields and tells every listener the names of those that changed.
 *
 * `state` is what `/api/state` answers. `hover` and `selection` are null or `{kind: "line"|"crossing", id}`; `many` is
 * null or what is selected in its place, ids in `{lines, crossings}`.
 */
export class Store {
  state = null;
  lines = new Map(); // id -> line
  crossings = new Map(); // id -> crossing
  layers = Object.fromEntries(LAYERS.map(({ name, ofMap }) => [name, !ofMap]));
  hidden = false; // everything over the photo, while a key is held
  hover = null;
  selection = null;
  many = null;
  thinning = new Thinning();
  tool = "correct";
  labelling = false;
  owner = true; // false in a second tab, which only looks
  saved = true;
  solve = { state: "idle" };
  busy = 0; // edits that the server has not answered yet
  texture = true; // the photo on the faces of the model
  #listeners = [];

  /** Call `listener` with a Set of names of fields after each change. */
  listen(listener) {
    this.#listeners.push(listener);
  }

  set(fields) {
    const changed = new Set();
    for (const [name, value] of Object.entries(fields)) {
      if (this[name] === value || (isThing(value) && same(this[name], value))) continue;
      this[name] = value;
      changed.add(name);
    }
    if (changed.has("state")) {
      this.lines = new Map(this.state.lines.map((line) => [line.id, line]));
      this.crossings = new Map(this.state.crossings.map((crossing) => [crossing.id, crossing]));
      this.thinning.renew(this.state);
      for (const name of ["hover", "selection"]) {
        if (this[name] && !this.find(this[name])) {
          this[name] = null;
          changed.add(name);
        }
      }
    }
    if (this.many && (changed.has("state") || changed.has("selection")) && this.#keepMany()) changed.add("many");
    if (changed.size > 0) for (const listener of this.#listeners) listener(changed);
  }

  /** Of many things those that are there still, none beside a selected one; whether that changes them. */
  #keepMany() {
    const lines = this.many.lines.filter((id) => this.lines.has(id));
    const crossings = this.many.crossings.filter((id) => this.crossings.has(id));
    const isSame = lines.length === this.many.lines.length && crossings.length === this.many.crossings.length;
    if (isSame && !this.selection) return false;
    this.many = this.selection || lines.length + crossings.length === 0 ? null : { lines, crossings };
    return true;
  }

  /** The line or crossing that a `{kind, id}` names, or undefined. */
  find(thing) {
    if (!thing) return undefined;
    return (thing.kind === "line" ? this.lines : this.crossings).get(thing.id);
  }

  /** The selected line, or undefined when nothing or a crossing is selected. */
  get selectedLine() {
    return this.selection?.kind === "line" ? this.find(this.selection) : undefined;
  }

  /** The selected crossing, or undefined. */
  get selectedCrossing() {
    return this.selection?.kind === "crossing" ? this.find(this.selection) : undefined;
  }

  /** The layers that this photo has. */
  get offeredLayers() {
    return LAYERS.filter(({ ofMap }) => !ofMap || this.state.depth_map !== null);
  }

  showsLine(line) {
    return this.layers[line.axis[0]]; // x2, x3 and so on of further frames go with x
  }

  showsCrossing(crossing) {
    return this.layers[isReal(crossing) ? "real" : "fake"] || (this.layers.changed && crossing.changed);
  }

  /** Whether a crossing is drawn at a scale, and can be clicked there: those of what is selected are at every one. */
  drawsCrossing(crossing, scale) {
    return this.showsCrossing(crossing) && (this.thinning.shows(crossing, scale) || this.isNear(crossing));
  }

  /** Whether a crossing is selected, or one of the selected line or of a contradiction. */
  isNear({ id, lines }) {
    const { selection, state } = this;
    if (state.contradiction?.crossings.includes(id)) return true;
    return selection?.kind === "line" ? lines.includes(selection.id) : selection?.id === id;
  }

  toggleLayer(name) {
    this.set({ layers: { ...this.layers, [name]: !this.layers[name] } });
  }
}

/** Whether a crossing is to be real: a person's word goes before the model, which may be older. */
export function isReal({ label, real }) {
  return label === "real" || label === "fake" ? label === "real" : real;
}

function isThing(value) {
  return value !== null && typeof value === "object" && "kind" in value && "id" in value;
}

/** Whether two of `{kind, id}` or null name the same thing. */
export function same(one, other) {
  return one === other || (one && other && one.kind === other.kind && one.id === other.id);
}
