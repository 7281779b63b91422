// The tools for faces: an area by a lasso, windows by two corners, a wall by four edges.

import { thingsAt } from "./picking.js";
import { countsUpTo, grid, inPhoto, openingAt, wallAt } from "./rectangles.js";

export const AREAS = ["ground", "sky", "clutter"];
export const OPENINGS = ["window", "door"];
const EDGES = 4;
const CLOSE = 10; // CSS px from its first corner, where a click closes an outline
const MOST_POINTS = 900; // of a lasso
const STEP = 2; // CSS px between points of a lasso
const MOST_OF_GRID = 100;

export const FACE_TOOLS = [
  {
    name: "area",
    label: "Area",
    key: "shift+a",
    shown: "⇧A",
    hint: "Draw around ground, sky or clutter, or click its corners; ⇧A again changes which",
  },
  {
    name: "window",
    label: "Window",
    key: "shift+w",
    shown: "⇧W",
    hint: "Drag from corner to corner; drag from inside it to the last of its rows and columns; click one, then Del",
  },
  { name: "wall", label: "Wall", key: "shift+e", shown: "⇧E", hint: "Click the four edges of a wall: two upright, two level" },
];

/** What is being drawn: `outline` px of an area, `lines` of a wall, `rectangle` of a window; `chosen` is an opening. */
export class FaceTools {
  area = AREAS[0];
  opening = OPENINGS[0];
  outline = [];
  lines = [];
  rectangle = null; // {plane, face, corners, columns, rows, last, sent}
  chosen = null; // {id, outline} of a window or door
  #pressed = false;
  #listeners = [];

  constructor(store, actions) {
    Object.assign(this, { store, actions });
    actions.faces = this;
    store.listen((changed) => {
      if (changed.has("tool")) this.#clear();
      if (changed.has("state")) this.#forget();
    });
  }

  listen(listener) {
    this.#listeners.push(listener);
  }

  #tell() {
    for (const listener of this.#listeners) listener();
    this.actions.photo.redraw("overlay");
  }

  #clear() {
    Object.assign(this, { outline: [], lines: [], rectangle: null, chosen: null });
    this.#pressed = false;
    this.#tell();
  }

  /** What is drawn on a wall that is no more is left. */
  #forget() {
    const { rectangle, store } = this;
    if (!rectangle || store.state.planes.some((plane) => plane.faces.includes(rectangle.face))) return;
    this.rectangle = null;
    this.#tell();
  }

  get owns() {
    return FACE_TOOLS.some(({ name }) => name === this.store.tool);
  }

  /** The key or button of a tool: once more changes what it makes. */
  take(name) {
    if (this.store.tool !== name) return this.store.set({ tool: name });
    if (name === "area") this.area = AREAS[(AREAS.indexOf(this.area) + 1) % AREAS.length];
    if (name === "window") this.opening = OPENINGS[(OPENINGS.indexOf(this.opening) + 1) % OPENINGS.length];
    this.#tell();
  }

  choose(field, word) {
    this[field] = word;
    this.#tell();
  }

  get #viewport() {
    return this.actions.photo.viewport;
  }

  #isNear(one, other) {
    return Math.hypot(one[0] - other[0], one[1] - other[1]) * this.#viewport.scale <= CLOSE;
  }

  // --- the pointer, in px of the photo ---

  press(pixel) {
    this.#pressed = true;
    if (this.store.tool === "area") {
      if (this.outline.length > 2 && this.#isNear(pixel, this.outline[0])) return this.apply();
      this.outline = [...this.outline, pixel];
    } else if (this.store.tool === "window") this.#pressWindow(pixel);
    else this.#pick(pixel);
    this.#tell();
  }

  #pressWindow(pixel) {
    const { state } = this.store;
    const made = this.rectangle;
    this.chosen = null;
    if (made && grid(state, made.face, made.corners).some((corners) => isInside(corners, pixel))) {
      this.rectangle = { ...made, from: pixel, sent: false };
      return;
    }
    const wall = wallAt(state, pixel);
    this.rectangle = wall ? { ...wall, corners: [pixel, pixel], columns: 1, rows: 1, last: null } : null;
    if (!wall) this.actions.messages.tell("No wall of the model is here. Solve first, or make one of four edges.");
  }

  follow(pixel) {
    if (!this.#pressed) return;
    if (this.store.tool === "area") {
      const last = this.outline.at(-1);
      const isFar = Math.hypot(pixel[0] - last[0], pixel[1] - last[1]) * this.#viewport.scale >= STEP;
      if (isFar && this.outline.length < MOST_POINTS) this.outline = [...this.outline, pixel];
    } else if (this.store.tool === "window" && this.rectangle) this.#followWindow(pixel);
    this.#tell();
  }

  #followWindow(pixel) {
    const made = this.rectangle;
    if (!made.from) {
      this.rectangle = { ...made, corners: [made.corners[0], pixel] };
      return;
    }
    const last = made.corners[1].map((at, k) => at + pixel[k] - made.from[k]);
    this.rectangle = { ...made, last, ...countsUpTo(this.store.state, made.face, made.corners, last) };
  }

  /** The end of a drag. */
  release(pixel) {
    this.follow(pixel);
    this.#pressed = false;
    if (this.store.tool === "area") this.apply();
    else if (this.store.tool === "window" && this.rectangle) this.#sendWindow();
  }

  /** A press that did not move: a corner of an area; what is at this place of windows. */
  lift() {
    this.#pressed = false;
    if (this.store.tool !== "window" || !this.rectangle) return;
    if (this.rectangle.from) this.rectangle = { ...this.rectangle, from: null, sent: true };
    else {
      const found = openingAt(this.store.state, this.rectangle.corners[0]);
      this.rectangle = null;
      this.chosen = found ? { id: found.face.opening, corners: inPhoto(this.store.state, found.face.outline) } : null;
    }
    this.#tell();
  }

  // --- what is sent ---

  /** Enter: the outline is closed. */
  apply() {
    if (this.store.tool !== "area") return;
    const polygon = this.outline;
    if (!polygon.length) return;
    if (polygon.length < 3) {
      this.actions.messages.tell("An area has three corners or more. Set one more, or press Escape.");
      return;
    }
    this.#clear();
    this.#edit({ op: "region", polygon, is: this.area });
  }

  #sendWindow() {
    const { plane, corners, columns, rows, last } = this.rectangle;
    this.rectangle = { ...this.rectangle, from: null, sent: true };
    this.#tell();
    const several = columns * rows > 1;
    this.#edit({
      op: "window",
      plane: plane.id,
      corners,
      kind: this.opening,
      ...(several && { columns, rows, last }),
    });
  }

  #pick(pixel) {
    const [thing] = thingsAt(this.store, this.#viewport, this.#viewport.toScreen(pixel), ["line"]);
    if (!thing) return;
    this.lines = this.lines.includes(thing.id) ? this.lines.filter((id) => id !== thing.id) : [...this.lines, thing.id];
    if (this.lines.length < EDGES) return;
    const { lines } = this;
    this.#clear();
    this.#edit({ op: "wall", lines });
  }

  /** Arrow keys while there are rows and columns: one more or one less. */
  arrow(x, y) {
    const made = this.rectangle;
    if (this.store.tool !== "window" || !made?.last) return false;
    const changed = (count, by) => Math.min(Math.max(count + by, 1), MOST_OF_GRID);
    this.rectangle = { ...made, columns: changed(made.columns, x), rows: changed(made.rows, y) };
    if (made.sent) this.#sendWindow();
    else this.#tell();
    return true;
  }

  /** Whether a corner or an edge was taken back; what was sent is for the server to take back. */
  undo() {
    this.rectangle = null;
    const { outline, lines } = this;
    this.outline = outline.slice(0, -1);
    this.lines = lines.slice(0, -1);
    this.#tell();
    return outline.length > 0 || lines.length > 0;
  }

  /** Del: no window is where one was clicked. */
  remove() {
    if (!this.chosen?.corners) return false;
    const at = [0, 1].map((k) => this.chosen.corners.reduce((sum, corner) => sum + corner[k], 0) / 4);
    this.#clear();
    this.#edit({ op: "no-window", at });
    return true;
  }

  /** Whether there was something to leave. */
  escape() {
    if (this.outline.length === 0 && this.lines.length === 0 && !this.rectangle && !this.chosen) return false;
    this.#clear();
    return true;
  }

  #edit(edit) {
    return this.actions.editing.edit(edit);
  }
}

function isInside(corners, [u, v]) {
  const sides = corners.map(([a, b], index) => {
    const [c, d] = corners[(index + 1) % corners.length];
    return (c - a) * (v - b) - (d - b) * (u - a) > 0;
  });
  return sides.every((side) => side === sides[0]);
}
