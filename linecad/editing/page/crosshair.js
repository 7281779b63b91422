// A pointer for the keyboard: a cross-hair that arrows move and Enter clicks with, in every tool.

const STEP = 12; // CSS px an arrow key
const FINE_STEP = 1;
const MARGIN = 16; // CSS px from the edge of the stage; beyond it the photo moves instead

export class Crosshair {
  at = null; // CSS px of the stage, or null where it is not shown

  constructor(store, photo, pointer) {
    Object.assign(this, { store, photo, pointer });
    photo.canvases.overlay.addEventListener("pointermove", (event) => event.movementX !== 0 && this.hide());
  }

  get isShown() {
    return this.at !== null;
  }

  toggle() {
    if (this.isShown) return this.hide();
    const { viewport } = this.photo;
    this.photo.canvases.overlay.focus({ preventScroll: true });
    this.#put(this.pointer.at ?? [viewport.width / 2, viewport.height / 2]);
  }

  hide() {
    if (!this.isShown) return;
    this.pointer.letGo();
    this.at = null;
    this.photo.crosshair = null;
    this.photo.redraw("overlay");
  }

  /** Let go of what is held, else hide. */
  leave() {
    if (this.pointer.isHolding) this.pointer.letGo();
    else this.hide();
  }

  /** An arrow key; the photo moves where the cross-hair would leave it. */
  move(x, y, isFine) {
    const step = isFine ? FINE_STEP : STEP;
    const wanted = [this.at[0] + step * x, this.at[1] + step * y];
    const { width, height } = this.photo.viewport;
    const kept = [width, height].map((size, k) => Math.min(Math.max(wanted[k], MARGIN), size - MARGIN));
    if (kept[0] !== wanted[0] || kept[1] !== wanted[1]) {
      this.photo.change((viewport) => viewport.pan(kept[0] - wanted[0], kept[1] - wanted[1]));
    }
    this.#put(kept);
  }

  #put(at) {
    this.at = at;
    this.photo.crosshair = at;
    this.pointer.go(at);
    this.photo.redraw("overlay");
  }

  /** Enter clicks; with Shift it takes hold of an end of the selected line or begins a rectangle. */
  click(holds) {
    this.pointer.clickAt(this.at, holds);
    this.pointer.go(this.at);
  }
}
