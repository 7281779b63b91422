// The bodies of the photo: lines that hold together at one scale. Their names, lines and distances; which is selected.

import { dot, ray, subtract, times, unit } from "./matrices.js";

export const GROUND = "ground"; // what `store.body` holds where the ground is selected
const LETTERS = 26;
const MUCH = Math.log(1.5); // log factor from which a move is told as a factor

/** A, B ... Z, A2, B2 and so on. */
function letters(number) {
  const turn = Math.floor(number / LETTERS);
  return String.fromCharCode(65 + (number % LETTERS)) + (turn > 0 ? turn + 1 : "");
}

/** The camera depth at which a line in space passes nearest to the ray of a pixel, measured across the line. */
export function depthAt(state, { ends }, pixel) {
  const through = ray(state.K, state.R_cam_from_world, pixel);
  const along = unit(subtract(ends[1], ends[0]));
  const across = (vector) => subtract(vector, times(along, dot(vector, along)));
  const seen = across(through);
  return dot(seen, across(ends[0])) / dot(seen, seen);
}

export function middleOf({ segment }) {
  return [0, 1].map((k) => (segment[0][k] + segment[1][k]) / 2);
}

export function lengthOf({ segment }) {
  return Math.hypot(segment[1][0] - segment[0][0], segment[1][1] - segment[0][1]);
}

/** "12 % farther" or "2.9 times as far", from the log of a factor. */
export function movedText(log) {
  if (log > MUCH) return `${Math.exp(log).toPrecision(2)} times as far`;
  const percent = 100 * Math.abs(Math.expm1(log));
  return `${percent.toFixed(percent < 9.95 ? 1 : 0)} % ${log > 0 ? "farther" : "nearer"}`;
}

/**
 * What the state says of bodies, by number. Numbers are new in every model; a body is told by its lines.
 *
 * `store.body` is the id of a line of the selected body, GROUND, or null; `store.bodyHover` the number of the body
 * under the pointer where no line of it is.
 */
export class Bodies {
  #names = new Map(); // of lines, by id: the letter of their body
  #state = null;

  constructor(store) {
    this.store = store;
    Object.assign(store, { body: null, bodyHover: null });
    store.listen((changed) => changed.has("state") && this.#renew());
    this.#renew();
  }

  #renew() {
    const { state } = this.store;
    if (this.#state?.bodies === state.bodies && this.#state?.lines === state.lines) return;
    this.#state = state;
    this.list = state.bodies ?? [];
    this.byId = new Map(this.list.map((body) => [body.id, body]));
    this.linesOf = new Map(this.list.map(({ id, lines }) => [id, this.#present(lines)]));
    this.letters = this.#named();
  }

  /** Lines by their ids, the longest in the photo first. */
  #present(ids) {
    const lines = ids.map((id) => this.store.lines.get(id)).filter((line) => line?.ends);
    return lines.sort((a, b) => lengthOf(b) - lengthOf(a));
  }

  /** A letter for each body: that which most of its lines had before, else the next one that nobody has. */
  #named() {
    const taken = new Set();
    const found = new Map();
    for (const { id, lines } of this.list) {
      const votes = new Map();
      for (const line of lines) {
        const letter = this.#names.get(line);
        if (letter && !taken.has(letter)) votes.set(letter, (votes.get(letter) ?? 0) + 1);
      }
      const [most] = [...votes].sort((a, b) => b[1] - a[1]);
      if (most) found.set(id, most[0]);
      if (most) taken.add(most[0]);
    }
    let next = 0;
    for (const { id } of this.list) {
      if (found.has(id)) continue;
      while (taken.has(letters(next))) next++;
      found.set(id, letters(next));
      taken.add(letters(next));
    }
    for (const { id, lines } of this.list) for (const line of lines) this.#names.set(line, found.get(id));
    return found;
  }

  /** The number of the ground, which moves like a body. */
  get ground() {
    return this.list.length;
  }

  /** The number of the part that is chosen (bodyparts.js), behind that of the ground. */
  get part() {
    return this.list.length + 1;
  }

  /** Let lines, by their ids, be the part that is chosen; none for no part. */
  choosePart(ids) {
    this.linesOf.delete(this.part);
    if (ids) this.linesOf.set(this.part, this.#present(ids));
  }

  get reference() {
    return this.list.find(({ reference }) => reference)?.id ?? null;
  }

  nameOf(id) {
    if (id === this.ground) return "The ground";
    if (id === this.part) return `Part of ${this.nameOf(this.selected)}`;
    return this.letters.has(id) ? `Body ${this.letters.get(id)}` : "No body";
  }

  /** The line that stands for a body: the longest in the photo; undefined for the ground. */
  lineOf(id) {
    return this.linesOf.get(id)?.[0];
  }

  facesOf(id) {
    return this.store.state.planes.flatMap((plane) => (plane.faces ?? []).filter((face) => face.body === id));
  }

  /** The camera depth of the line that stands for a body, in units of the scene; null for the ground. */
  depthOf(id) {
    const line = this.lineOf(id);
    return line ? depthAt(this.store.state, line, middleOf(line)) : null;
  }

  /** A distance as a person reads it: in metres where the scale is known. */
  distanceText(depth) {
    const metres = this.store.state.metres_per_unit;
    return metres ? `${(depth * metres).toPrecision(3)} m` : depth.toPrecision(3);
  }

  /** The number of the selected body, or null. */
  get selected() {
    const { body } = this.store;
    if (body === GROUND) return this.ground;
    const found = body === null ? undefined : this.store.lines.get(body)?.body;
    return found >= 0 ? found : null;
  }

  /** The number of the body under the pointer while bodies are what the tool is about, or null. */
  get hovered() {
    const { hover, bodyHover, tool } = this.store;
    if (bodyHover !== null) return bodyHover;
    const line = tool === "body" && hover?.kind === "line" ? this.store.lines.get(hover.id) : undefined;
    return line?.body >= 0 ? line.body : null;
  }

  /** Select a body by its number, null for none. */
  select(id) {
    this.store.set({ body: id === this.ground ? GROUND : id === null ? null : (this.lineOf(id)?.id ?? null) });
  }

  /** The body that comes `step` places after the selected one, by share of the photo. */
  selectNext(step) {
    if (this.list.length === 0) return;
    const now = this.list.findIndex(({ id }) => id === this.selected);
    const next = now < 0 && step < 0 ? -1 : now + step;
    this.select(this.list[(next + this.list.length) % this.list.length].id);
  }
}
