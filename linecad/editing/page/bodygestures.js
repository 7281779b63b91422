// What a person says of bodies, in one gesture each: what is chosen so far, what it would do, and taking or leaving it.

import { apartAcross, normalsOf, partnersOf, placeEdit, snapsOf } from "./bodyplaces.js";
import { lengthOf, middleOf, movedText } from "./bodies.js";
import { BodyParts } from "./bodyparts.js";
import { gestureOf } from "./gesturelist.js";

const PARTNERS = 60; // lines that the arrow keys go through
const FOOT_STEP = 6; // px of the photo an arrow key
const MOVE_STEP = 0.01; // log factor an arrow key
const EVEN = 1.2; // odds below which two places are equally likely
const MOVES_BODIES = ["meet", "plane", "place"]; // a foot may move the ground alone, a cut nothing for now
const HOLDS_ALREADY = "That holds already, so nothing moves. It is among your facts now.";
const FINELY = 0.1; // of a step, with Shift

/** The gesture under way, `now`: null or `{kind, body, part, first, second, normal, pixel, fixed, places, index, log, preview}`. */
export class BodyGestures {
  now = null;
  #listeners = [];
  #asking = false;
  #asked = null; // the edit to try out next

  constructor(store, actions, bodies) {
    Object.assign(this, { store, actions, bodies });
    this.parts = new BodyParts(store, actions, bodies);
    store.listen((changed) => this.#noticed(changed));
    this.parts.listen(() => this.leave());
  }

  /** Call `listener` after each change of what is chosen or of what it would do. */
  listen(listener) {
    this.#listeners.push(listener);
  }

  #put(fields) {
    this.now = fields === null ? null : { ...this.now, ...fields };
    for (const listener of this.#listeners) listener();
  }

  #noticed(changed) {
    if (!this.now) return;
    if (changed.has("tool") && this.store.tool !== "body") return this.leave();
    if (changed.has("state") && this.#isStale()) return this.leave();
    const { hover, selection } = this.store;
    if (changed.has("hover") && hover?.kind === "line") this.#consider(this.store.find(hover));
    else if (changed.has("selection") && selection?.kind === "line") this.#consider(this.store.find(selection));
  }

  #isStale() {
    const ids = [this.now.first, this.now.second].filter(Boolean).map(({ id }) => id);
    return (
      ids.some((id) => !this.store.lines.has(id)) ||
      (this.now.body !== undefined && this.now.body !== this.bodies.selected)
    );
  }

  // --- begin and end ---

  /** Begin a gesture with what is selected, the other places at an index; again goes on to the next place, or leaves. */
  begin(kind, index = 0) {
    if (!this.store.owner)
      return this.actions.messages.tell("Another tab edits this photo. Take over first.", "warning");
    if (this.bodies.list.length === 0)
      return this.actions.messages.tell("The bodies are not known yet; they come with the model.");
    if (this.now?.kind === kind) return kind === "place" ? this.step(1) : this.leave();
    const { selectedLine } = this.store;
    if (this.store.tool !== "body") this.store.set({ tool: "body" });
    this.now = null;
    if (kind === "place" || kind === "move") return this.#beginWithBody(kind, index);
    this.#put({ kind, tried: null, preview: null });
    if (selectedLine?.ends) this.choose(selectedLine);
  }

  async #beginWithBody(kind, index) {
    const { bodies } = this;
    const body = bodies.selected;
    const part = this.parts.chosen;
    this.#put({ kind, body, part, preview: null, log: 0, index: -1, places: null });
    if (body === null) return this.#put({ body: undefined });
    if (!part && (body === bodies.reference || body === bodies.ground)) {
      const why = body === bodies.ground ? "goes where feet say" : "is the one that the others are placed against";
      const instead = body === bodies.ground ? "" : ", or a part of it (Shift+K)";
      this.actions.messages.tell(`${bodies.nameOf(body)} ${why}; choose another body${instead}.`);
      return this.leave();
    }
    let places = [];
    try {
      const { server } = this.actions;
      places = part ? await server.post("part", { lines: part.lines }) : await server.get(`places/${body}`);
    } catch (error) {
      this.actions.messages.tell(error.message, "error");
    }
    if (this.now?.kind !== kind || this.now.body !== body || this.now.part !== part) return;
    this.#put({ places, snaps: snapsOf(bodies, body, places, part) });
    if (kind === "place" && places.length > 0) this.#showPlace(index % places.length);
  }

  #showPlace(index) {
    this.#put({ index, log: this.now.places[index].move });
    this.#try();
  }

  leave() {
    if (!this.now) return false;
    this.#asked = null;
    this.#put(null);
    return true;
  }

  /** Say what was chosen: one edit; a promise of whether it was taken. */
  async take() {
    const edit = this.edit;
    if (!edit) {
      this.actions.messages.tell(this.told);
      return false;
    }
    this.leave();
    const isTaken = await this.actions.editing.edit(edit);
    if (isTaken && MOVES_BODIES.includes(edit.op) && this.#nothingMoved()) this.actions.messages.tell(HOLDS_ALREADY);
    return isTaken;
  }

  #nothingMoved() {
    const { moved, contradiction, facts } = this.store.state;
    return moved.length === 0 && contradiction === null && facts.at(-1)?.holds === true;
  }

  // --- what is chosen ---

  /** A line, and the axis across which its plane lies where a face was clicked. */
  choose(line, normal = null) {
    if (!this.now || !line?.ends) return;
    const { kind, first } = this.now;
    if (!("first" in this.now) || !first) this.#put({ first: line, faceNormal: normal });
    else if (kind !== "foot" && line.id !== first.id) this.#second(line, normal);
  }

  /** A line under the pointer or selected by keys is tried out as the second one. */
  #consider(line) {
    const { kind, first, second, fixed } = this.now;
    if (!first || !line?.ends || line.id === first.id || line.id === second?.id || fixed) return;
    if (gestureOf(kind).second && kind !== "foot") this.#second(line, null);
  }

  #second(second, normal) {
    const { kind, first, faceNormal } = this.now;
    let normals = [];
    if (kind === "plane") {
      normals = normalsOf(this.store.state, first, second);
      const wanted = [normal, faceNormal].find((axis) => axis && normals.includes(axis));
      const apart = (axis) => Math.abs(apartAcross(this.store.state, first, second, axis) ?? Infinity);
      normals.sort((a, b) => (b === wanted) - (a === wanted) || apart(a) - apart(b));
    }
    this.#put({ second, normals, normal: normals[0] ?? null });
    this.#try();
  }

  /** Another of the directions across which two parallel lines may lie in a plane. */
  turnPlane(axis) {
    if (this.now?.kind !== "plane" || !this.now.normals?.includes(axis)) return false;
    this.#put({ normal: axis });
    this.#try();
    return true;
  }

  /** Where the wall of the chosen line meets the ground, px of the photo; `fixed` after a click. */
  foot(pixel, fixed = false) {
    if (this.now?.kind !== "foot" || !this.now.first || (this.now.fixed && !fixed)) return;
    this.#put({ pixel, fixed });
    this.#try();
  }

  /** The body is so many times, by a log factor, as far as it was; `snap` is what it was caught by. */
  moveTo(log, snap = null) {
    this.#put({ log, snap });
    this.#try();
  }

  /** Arrow keys: the next or previous line, place, or place to snap to. */
  step(direction) {
    const { kind, first, second, places, snaps, log, index } = this.now;
    if (kind === "place") {
      if (!places?.length) return;
      return this.#showPlace((index + direction + places.length) % places.length);
    }
    if (kind === "move") {
      const beyond = (snaps ?? []).filter((snap) => direction * (snap.log - log) > 1e-6);
      const next = direction > 0 ? beyond[0] : beyond.at(-1);
      return next && this.moveTo(next.log, next);
    }
    if (!first || kind === "foot") return this.#stepFirst(direction);
    const partners = partnersOf(this.store.state, first, (line) => this.#fits(line)).slice(0, PARTNERS);
    const at = partners.findIndex(({ id }) => id === second?.id);
    if (partners.length === 0) return;
    const next = at < 0 && direction < 0 ? -1 : at + direction;
    this.#second(partners[(next + partners.length) % partners.length], null);
  }

  #stepFirst(direction) {
    const { first } = this.now;
    const own = this.bodies.linesOf.get(this.bodies.selected) ?? this.store.state.lines.filter(({ ends }) => ends);
    const lines = [...own].sort((a, b) => lengthOf(b) - lengthOf(a));
    const at = lines.findIndex(({ id }) => id === first?.id);
    if (lines.length === 0) return;
    const next = lines[((at < 0 && direction < 0 ? 0 : at) + direction + lines.length) % lines.length];
    this.#put({ first: next, second: null, preview: null, pixel: null, fixed: false });
    this.store.set({ selection: { kind: "line", id: next.id } });
  }

  /** Whether a line can be the second one of the gesture. */
  #fits(line) {
    const { kind, first } = this.now;
    if (kind === "cut") return line.body >= 0;
    if (line.body < 0 || line.body === first.body) return false;
    if (kind === "height") return line.axis !== "z";
    return kind !== "meet" || line.axis !== first.axis;
  }

  /** Arrow keys up and down: the foot goes along its line, the body along its rays. */
  nudge(direction, finely) {
    const { kind, first, pixel, log } = this.now;
    const share = finely ? FINELY : 1;
    if (kind === "move") return this.moveTo(log - direction * MOVE_STEP * share);
    if (kind !== "foot" || !first) return;
    const [u, v] = pixel ?? lowerEnd(first);
    this.foot([u, v + (pixel ? direction * FOOT_STEP * share : 0)], true);
  }

  // --- what it would do ---

  /** The edit that is chosen so far, or null. */
  get edit() {
    const { kind, body, part, first, second, normal, pixel, log, index } = this.now ?? {};
    switch (kind) {
      case "foot":
        return first && pixel ? { op: "foot", line: first.id, pixel } : null;
      case "place":
        return index >= 0 ? placeEdit(this.bodies, body, log, part) : null;
      case "move":
        if (body === undefined || Math.abs(log) <= 1e-9) return null;
        return placeEdit(this.bodies, body, log, part);
      case "plane":
        return second && normal ? { op: "plane", lines: [first.id, second.id], normal } : null;
      case "height":
        return second ? { op: "plane", lines: [first.id, second.id], normal: "z" } : null;
      default:
        return second ? { op: kind, lines: [first.id, second.id] } : null;
    }
  }

  /** What to do next, or what is missing. */
  get told() {
    const { kind, first, second, normals, body, places, index } = this.now;
    if (kind === "place" && places?.length === 0) return "Nothing speaks for another place; move it by hand (Shift+D)";
    if (kind === "place" && body !== undefined)
      return index >= 0 ? this.#placeText(places[index]) : "Looking for other places";
    if (kind === "move" && body !== undefined)
      return "Drag it in the model, or by its foot in the photo; arrows step, left and right snap";
    if (!first) return gestureOf(kind).first;
    if (kind === "plane" && second && normals.length === 0) return "These two lines can lie in no plane of the axes";
    return gestureOf(kind).second;
  }

  #placeText({ worth, words }) {
    const { places, index } = this.now;
    const odds = Math.exp(Math.abs(worth));
    const against =
      odds < EVEN
        ? "about as likely as where it is"
        : `odds ${odds.toFixed(odds < 9.5 ? 1 : 0)} : 1 ${worth > 0 ? "for" : "against"} it`;
    return `Place ${index + 1} of ${places.length}: ${words.join(", ") || "no evidence of its own"} · ${against}`;
  }

  /** What the edit would move, in words, or null while that is not known. */
  get effect() {
    const { preview, tried } = this.now;
    if (!preview || tried !== JSON.stringify(this.edit)) return null;
    if (preview.refused) return preview.refused;
    if (preview.conflict) return preview.conflict.text;
    const moves = Object.entries(preview.moves).map(([id, log]) => [Number(id), log]);
    if (moves.length === 0) return this.now.kind === "cut" ? "Nothing moves now" : "It holds already: nothing moves";
    moves.sort((a, b) => this.#share(b[0]) - this.#share(a[0]));
    const [[id, log], ...others] = moves;
    const depth = this.bodies.depthOf(id);
    const from =
      depth === null ? "" : `: ${this.bodies.distanceText(depth)} → ${this.bodies.distanceText(depth * Math.exp(log))}`;
    const more = others.length > 0 ? ` · ${others.length} more` : "";
    return `${this.bodies.nameOf(id)} ${movedText(log)}${from}${more}`;
  }

  #share(id) {
    return id === this.bodies.part ? 1 : (this.bodies.byId.get(id)?.share ?? 0); // what was chosen comes first
  }

  /** The log factors by which bodies are shown moved, by number. */
  get moves() {
    const { kind, body, part, log, places, index, preview, tried } = this.now ?? {};
    if (preview?.moves && tried === JSON.stringify(this.edit)) return preview.moves;
    if (kind === "move" && log) return { [part ? this.bodies.part : body]: log };
    if (kind === "place" && index >= 0) return Object.fromEntries(places[index].bodies.map((id) => [id, log]));
    return {};
  }

  /** Ask what the edit would do, one question at a time: the pointer is faster than the answers. */
  async #try() {
    this.#asked = this.edit;
    if (this.#asking) return;
    this.#asking = true;
    while (this.#asked) {
      const asked = this.#asked;
      this.#asked = null;
      let preview;
      try {
        await this.actions.editing.settled();
        preview = await this.actions.server.post("preview", { base_version: this.store.state.version, edit: asked });
      } catch (error) {
        preview = null; // the lines have changed: the gesture ends with them
        if (error.status !== 409) this.actions.messages.tell(error.message, "error");
      }
      const tried = JSON.stringify(asked);
      if (this.now && JSON.stringify(this.edit) === tried) this.#put({ preview, tried });
    }
    this.#asking = false;
  }
}

/** The end of a line that is lower in the photo; the middle of a level one. */
export function lowerEnd(line) {
  if (line.axis !== "z") return middleOf(line);
  const [one, other] = line.segment;
  return one[1] > other[1] ? one : other;
}
