// What a person can do, as one list of calls for buttons, keys and tools alike.

import { inNextFrame } from "./axes.js";
import { isReal } from "./store.js";

const ZOOM_STEP = 1.25;
const PAN_STEP = 80; // CSS px

export class Actions {
  constructor(parts) {
    Object.assign(this, parts); // store, editing, draft, photo, model, messages, server, many, lineWalk
    this.redoBeforeDraft = 0;
    this.openLength = () => {};
  }

  // --- crossings ---

  /** The crossing that keys mean: the one under the pointer, else the selected one. */
  get crossing() {
    const { hover, selection, labelling } = this.store;
    const meant = !labelling && hover?.kind === "crossing" ? hover : selection;
    return meant?.kind === "crossing" ? this.store.find(meant) : undefined;
  }

  /** Say what a crossing is, or all that are selected: real, fake, unsure, or null to leave it to the solver. */
  label(value, chosen) {
    if (!chosen && this.store.many) return this.many.label(value);
    const crossing = chosen ?? this.crossing;
    if (!crossing) return this.messages.tell("Point at a crossing first, or click one.");
    if (!this.store.labelling) this.store.set({ selection: { kind: "crossing", id: crossing.id } });
    return this.editing.edit({ op: "label", crossing: crossing.id, value });
  }

  flip(crossing) {
    return this.label(isReal(crossing) ? "fake" : "real", crossing);
  }

  // --- lines ---

  get line() {
    const { hover, selection } = this.store;
    return (
      this.store.selectedLine ?? (selection === null && hover?.kind === "line" ? this.store.find(hover) : undefined)
    );
  }

  #withLine(action) {
    return this.line ? action(this.line) : this.messages.tell("Click a line first.");
  }

  axis(axis) {
    if (this.store.many) return this.many.axis(axis);
    return this.#withLine((line) => line.axis !== axis && this.editing.edit({ op: "axis", line: line.id, axis }));
  }

  /** The same axis of the next frame, for the line. */
  nextFrame() {
    if (this.store.many) return this.many.nextFrame();
    return this.#withLine((line) => this.axis(inNextFrame(line.axis, this.store.state.frames)));
  }

  remove() {
    if (this.store.many) return this.many.remove();
    return this.#withLine((line) => this.editing.edit({ op: "delete", line: line.id }));
  }

  length() {
    return this.#withLine((line) => this.openLength(line));
  }

  // --- history ---

  undo() {
    if (this.draft.canUndo) this.draft.undo();
    else if (this.store.state.undo > 0 || this.store.busy > 0) this.editing.undo();
  }

  /** What was undone last comes back first: steps of the server that were undone after those of an unfinished line. */
  redo() {
    const serverHas = this.store.state.redo > 0 || this.store.busy > 0;
    if (this.draft.canRedo && this.store.state.redo <= this.redoBeforeDraft) this.draft.redo();
    else if (serverHas) this.editing.redo();
  }

  // --- solve ---

  solveOrStop() {
    if (this.store.solve.state === "running")
      return this.server.post("stop").catch((error) => this.messages.tell(error.message, "error"));
    return this.editing.solve();
  }

  // --- views ---

  /** The view that keys mean: the one with the focus, the photo otherwise. */
  get view() {
    return document.activeElement === this.model.canvas ? this.model : this.photo;
  }

  zoom(steps) {
    const factor = ZOOM_STEP ** steps;
    if (this.view === this.model) this.model.change((camera) => camera.zoom(factor));
    else this.photo.change((viewport) => viewport.zoom(factor));
  }

  /**
   * Arrow keys: the cross-hair moves, else the view goes that way over the photo, or the nearest line there is selected
   * when `shift` is held; the model turns, or moves when `shift` is held.
   */
  arrow(x, y, shift) {
    if (this.view !== this.model && this.crosshair.isShown) this.crosshair.move(x, y, shift);
    else if (this.view !== this.model && shift) this.lineWalk.towards(x, y);
    else if (this.view !== this.model) this.photo.change((viewport) => viewport.pan(-x * PAN_STEP, -y * PAN_STEP));
    else if (shift) this.model.change((camera) => camera.pan(-x * PAN_STEP, -y * PAN_STEP));
    else this.model.change((camera) => camera.orbit(x * PAN_STEP, y * PAN_STEP));
  }

  fit() {
    if (this.view === this.model) this.model.fit();
    else this.photo.change((viewport) => viewport.fit());
  }

  actualPixels() {
    this.photo.change((viewport) => viewport.zoom(1 / devicePixelRatio / viewport.scale));
  }

  showSelection() {
    if (this.store.selection) this.photo.show(this.store.selection, true);
  }

  escape() {
    if (!this.draft.isEmpty) this.draft.clear();
    else if (this.store.labelling) this.toggleLabelling();
    else if (this.crosshair.isShown) this.crosshair.leave();
    else if (this.store.selection || this.store.many) this.store.set({ selection: null, many: null });
    else if (this.store.tool !== "correct") this.store.set({ tool: "correct" });
  }
}
