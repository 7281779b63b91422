// The pointer over the photo: pan, zoom at the cursor, hover, clicks and drags for the tools.

import { thingsAt } from "./picking.js";

const CLICK_REACH = 4; // CSS px that a click may slip
const WHEEL_RATE = 0.0016; // log of the scale a CSS px of wheel
const PINCH_RATE = 0.01; // a pinch on a touch pad comes as a wheel with Ctrl
const LINE_HEIGHT = 18; // CSS px, for wheels that count in lines

/** CSS px that a wheel turned, whatever unit its event counts in. */
export function turned(event) {
  const unit = [1, LINE_HEIGHT, 400][event.deltaMode];
  return event.deltaY * unit;
}

/** The factor by which a wheel event zooms. */
export function wheelFactor(event) {
  return Math.exp(-turned(event) * (event.ctrlKey ? PINCH_RATE : WHEEL_RATE));
}

export class Pointer {
  panHeld = false; // the space bar
  at = null; // CSS px of the stage, where the pointer is; null outside
  #drag = null; // {at, moved, pans, draws}

  constructor(store, photo, tools) {
    Object.assign(this, { store, photo, tools });
    this.canvas = photo.canvases.overlay;
    this.onMove = () => {};
    const on = (name, handler) => this.canvas.addEventListener(name, handler);
    on("pointerdown", (event) => this.#down(event));
    on("pointermove", (event) => this.#move(event));
    on("pointerup", (event) => this.#up(event));
    on("pointercancel", () => this.#cancel());
    on("pointerleave", () => this.#leave());
    on("contextmenu", (event) => event.preventDefault());
    on("auxclick", (event) => event.preventDefault());
    this.canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    store.listen((changed) => changed.has("tool") && this.showCursor());
    this.showCursor();
  }

  #place(event) {
    return [event.offsetX, event.offsetY];
  }

  #down(event) {
    if (event.button > 2) return;
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.#place(event);
    const draws = this.tools.draws && event.button === 0 && !this.panHeld;
    const waiting = draws && this.tools.draft.points.length > 0; // for the second click
    this.#drag = {
      at,
      from: at,
      moved: false,
      pans: !draws,
      draws,
      clicks: event.button === 0 && !this.panHeld,
      waiting,
    };
    if (draws && !waiting) this.tools.press(this.photo.viewport.toPhoto(at));
    this.showCursor();
  }

  #move(event) {
    const at = this.#place(event);
    this.at = at;
    const drag = this.#drag;
    if (drag) {
      if (Math.hypot(at[0] - drag.from[0], at[1] - drag.from[1]) > CLICK_REACH) drag.moved = true;
      if (drag.pans && drag.moved) {
        this.photo.change((viewport) => viewport.pan(at[0] - drag.at[0], at[1] - drag.at[1]));
        drag.at = at;
        this.showCursor();
      }
    }
    if (!drag || drag.draws) this.hover();
    if (this.tools.draws) this.tools.follow(this.photo.viewport.toPhoto(at));
    this.onMove();
  }

  #up(event) {
    const drag = this.#drag;
    this.#drag = null;
    if (!drag) return;
    const at = this.#place(event);
    if (drag.draws) {
      const pixel = this.photo.viewport.toPhoto(at);
      if (drag.waiting) this.tools.press(pixel);
      else if (drag.moved) this.tools.release(pixel);
      else if (this.tools.faces.owns) this.tools.faces.lift();
    } else if (drag.clicks && !drag.moved) this.tools.click(at, this.photo.viewport);
    this.showCursor();
  }

  #cancel() {
    this.#drag = null;
    this.showCursor();
  }

  #leave() {
    this.at = null;
    if (!this.#drag) this.store.set({ hover: null });
    this.onMove();
  }

  #wheel(event) {
    event.preventDefault();
    this.photo.change((viewport) => viewport.zoom(wheelFactor(event), this.#place(event)));
    this.hover();
  }

  /** Light up what is under the pointer. */
  hover() {
    if (!this.at || this.store.hidden) return;
    const [thing] = thingsAt(this.store, this.photo.viewport, this.at, this.tools.kinds);
    this.store.set({ hover: thing ?? null });
    this.showCursor();
  }

  /** The next of several things under the pointer is selected. */
  selectNext() {
    if (!this.at) return;
    const things = thingsAt(this.store, this.photo.viewport, this.at);
    if (things.length === 0) return;
    const { selection } = this.store;
    const current = things.findIndex((thing) => thing.kind === selection?.kind && thing.id === selection.id);
    this.store.set({ selection: things[(current + 1) % things.length] });
  }

  showCursor() {
    const cursor = () => {
      if (this.#drag?.pans && this.#drag.moved) return "grabbing";
      if (this.panHeld) return "grab";
      if (this.tools.draws) return "crosshair";
      return this.store.hover ? "pointer" : "default";
    };
    this.canvas.style.cursor = cursor();
  }
}
