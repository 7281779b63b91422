// Unfinished work of the tools: points and lines that are not sent yet, with an undo and redo of their own.

/**
 * `lines` are `{ends, axis}`, `points` the first ends of the next line, `proposal` what the server makes of it, `start`
 * what the first end would snap to, `question` a line whose axis is asked for, `stretched` one whose end is dragged.
 */
export class Draft {
  lines = [];
  points = [];
  rubber = null; // [[u, v], [u, v]] px, from the first end to the pointer
  proposal = null; // {axis, ends, snapped, off, is_bent, axes}
  isForced = false; // a person chose the axis of the proposal
  start = null; // {ends: [[u, v]], snapped: [...]}
  question = null; // {ends, reach, axes: [[axis, degrees off it], ...]}
  stretched = null; // {id, end, ends, axis, snapped}
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
    return this.lines.length === 0 && this.points.length === 0 && !this.question;
  }

  get canUndo() {
    return this.#done.length > 0;
  }

  get canRedo() {
    return this.#undone.length > 0;
  }

  /** The next value of lines, points and question, as a step that undo takes back. */
  step(lines, points, question = null) {
    this.#done.push(this.#now);
    this.#undone = [];
    this.#put([lines, points, question]);
  }

  undo() {
    this.#undone.push(this.#now);
    this.#put(this.#done.pop());
  }

  redo() {
    this.#done.push(this.#now);
    this.#put(this.#undone.pop());
  }

  get #now() {
    return [this.lines, this.points, this.question];
  }

  #put([lines, points, question]) {
    Object.assign(this, { lines, points, question, rubber: null, proposal: null, start: null });
    this.#tell();
  }

  /** The line as the pointer would finish it now; no step. */
  follow(rubber, proposal, isForced = false) {
    Object.assign(this, { rubber, proposal, isForced });
    this.#tell();
  }

  /** What the first end would snap to here; no step. */
  hover(start) {
    if (start === this.start) return;
    this.start = start;
    this.#tell();
  }

  /** The line whose end is dragged, as it would be now; null when it is let go. */
  stretch(stretched) {
    if (stretched === this.stretched) return;
    this.stretched = stretched;
    this.#tell();
  }

  /** Nothing is left, and nothing comes back. */
  clear() {
    this.#done = [];
    this.#undone = [];
    this.#put([[], [], null]);
  }
}
