// Unfinished work of the tools: points and lines that are not sent yet, with an undo and redo of their own.

/** `lines` are `{ends, axis}`, `points` the first ends of the next line, `proposal` what the server makes of it. */
export class Draft {
  lines = [];
  points = [];
  rubber = null; // [[u, v], [u, v]] px, from the first end to the pointer
  proposal = null; // {axis, ends, snapped}
  #done = [];
  #undone = [];
  #listeners = [];

  listen(listener) {
    this.#listeners.push(listener);
  }

  #tell() {
    for (const listener of this.#listeners) listener();
  }

  get isEmpty() {
    return this.lines.length === 0 && this.points.length === 0;
  }

  get canUndo() {
    return this.#done.length > 0;
  }

  get canRedo() {
    return this.#undone.length > 0;
  }

  /** The next value of lines and points, as a step that undo takes back. */
  step(lines, points) {
    this.#done.push([this.lines, this.points]);
    this.#undone = [];
    this.#put([lines, points]);
  }

  undo() {
    this.#undone.push([this.lines, this.points]);
    this.#put(this.#done.pop());
  }

  redo() {
    this.#done.push([this.lines, this.points]);
    this.#put(this.#undone.pop());
  }

  #put([lines, points]) {
    Object.assign(this, { lines, points, rubber: null, proposal: null });
    this.#tell();
  }

  /** The line as the pointer would finish it now; no step. */
  follow(rubber, proposal) {
    Object.assign(this, { rubber, proposal });
    this.#tell();
  }

  /** Nothing is left, and nothing comes back. */
  clear() {
    this.#done = [];
    this.#undone = [];
    this.#put([[], []]);
  }
}
