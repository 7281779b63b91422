// The pointer over the photo: pan, zoom at the cursor, hover, clicks and drags for the tools.

import { Fingers, Wheel, wheelFactor } from "./gestures.js";
import { thingsAt } from "./picking.js";

const CLICK_REACH = 4; // CSS px that a click may slip
const SNAP_REACH = 10; // CSS px within which ends snap

export class Pointer {
  panHeld = false; // the space bar
  at = null; // CSS px of the stage, where the pointer is; null outside
  #drag = null; // {at, from, moved, clicks, waiting, what: "pan", "draw", "enclose" or "handle", handle}
  #wheel = new Wheel();
  #fingers = new Fingers();

  constructor(store, photo, tools) {
    Object.assign(this, { store, photo, tools });
    this.canvas = photo.canvases.overlay;
    this.onMove = () => {};
    const on = (name, handler) => this.canvas.addEventListener(name, handler);
    on("pointerdown", (event) => this.#down(event));
    on("pointermove", (event) => this.#move(event));
    on("pointerup", (event) => this.#up(event));
    on("pointercancel", (event) => this.#cancel(event));
    on("pointerleave", () => this.#leave());
    on("contextmenu", (event) => event.preventDefault());
    on("auxclick", (event) => event.preventDefault());
    this.canvas.addEventListener("wheel", (event) => this.#turn(event), { passive: false });
    store.listen((changed) => changed.has("tool") && this.showCursor());
    this.showCursor();
  }

  #place(event) {
    return [event.offsetX, event.offsetY];
  }

  /** px of the photo within which ends snap now; Ctrl switches it off. */
  #reach(event) {
    return event?.ctrlKey || event?.metaKey ? 0 : SNAP_REACH / this.photo.viewport.scale;
  }

  #down(event) {
    if (event.button > 2) return;
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.#place(event);
    this.#fingers.down(event, at);
    if (this.#fingers.count > 1) return this.letGo();
    const left = event.button === 0 && !this.panHeld;
    const handle = left ? this.tools.handles.at(at, this.photo.viewport) : null;
    const what = this.#whatDrags(left, handle);
    const waiting = what === "draw" && this.tools.draft.points.length > 0; // for the second click
    this.#drag = { at, from: at, moved: false, what, clicks: left, waiting, handle };
    this.tools.reach = this.#reach(event);
    if (what === "draw" && !waiting) this.tools.press(this.photo.viewport.toPhoto(at));
    this.showCursor();
  }

  /** What a drag does; where a tool takes clicks too, a press that does not move stays a click. */
  #whatDrags(left, handle) {
    if (handle) return "handle";
    if (left && this.tools.draws) return "draw";
    return left && this.tools.encloses ? "enclose" : "pan";
  }

  #move(event) {
    const at = this.#place(event);
    this.at = at;
    this.#fingers.move(event, at, this.photo);
    const drag = this.#drag;
    this.tools.reach = this.#reach(event);
    if (drag) {
      if (Math.hypot(at[0] - drag.from[0], at[1] - drag.from[1]) > CLICK_REACH) drag.moved = true;
      if (drag.moved) this.#dragged(drag, at);
    }
    if (!drag || drag.what === "draw") this.hover();
    if (this.tools.draws && drag?.what !== "handle") this.tools.follow(this.photo.viewport.toPhoto(at));
    this.onMove();
  }

  #dragged(drag, at) {
    const { viewport } = this.photo;
    if (drag.what === "pan") {
      this.photo.change(() => viewport.pan(at[0] - drag.at[0], at[1] - drag.at[1]));
      drag.at = at;
    } else if (drag.what === "handle") this.tools.handles.drag(drag.handle, viewport.toPhoto(at), this.tools.reach);
    else if (drag.what === "enclose") {
      this.photo.marquee = [drag.from, at].map((place) => viewport.toPhoto(place));
      this.photo.redraw("overlay");
    }
    this.showCursor();
  }

  #up(event) {
    this.#fingers.up(event);
    const drag = this.#drag;
    this.#drag = null;
    if (!drag) return;
    const at = this.#place(event);
    const pixel = this.photo.viewport.toPhoto(at);
    if (drag.what === "draw") {
      if (drag.waiting) this.tools.press(pixel);
      else if (drag.moved) this.tools.release(pixel);
    } else if (drag.what === "handle" && drag.moved) this.tools.handles.drop(this.tools.reach);
    else if (drag.what === "enclose" && drag.moved) this.#enclose(event.shiftKey);
    else if (drag.clicks && !drag.moved) this.#click(at, event.shiftKey);
    this.showCursor();
  }

  #click(at, adds) {
    if (this.tools.draws) this.tools.press(this.photo.viewport.toPhoto(at)); // beside a handle that was not dragged
    else this.tools.click(at, this.photo.viewport, adds);
  }

  #enclose(adds) {
    const [from, to] = this.photo.marquee;
    this.photo.marquee = null;
    this.photo.redraw("overlay");
    this.tools.enclose(from, to, adds);
  }

  #cancel(event) {
    this.#fingers.up(event);
    this.letGo();
  }

  /** Whether a handle or a corner of a rectangle is held. */
  get isHolding() {
    return this.tools.handles.held !== null || this.photo.marquee !== null;
  }

  /** Whatever was being dragged stays as it was. */
  letGo() {
    const drag = this.#drag;
    this.#drag = null;
    if (drag?.what === "draw" && !drag.waiting) this.tools.takeBack();
    if (this.tools.handles.held) this.tools.handles.cancel();
    this.photo.marquee = null;
    this.photo.redraw("overlay");
    this.showCursor();
  }

  // --- the cross-hair of the keyboard ---

  /** Point at a place of the stage. */
  go(at) {
    this.at = at;
    this.tools.reach = this.#reach();
    const pixel = this.photo.viewport.toPhoto(at);
    const { held } = this.tools.handles;
    if (held) this.tools.handles.drag(held, pixel, this.tools.reach);
    else if (this.photo.marquee) this.photo.marquee = [this.photo.marquee[0], pixel];
    else this.hover();
    if (this.tools.draws && !held) this.tools.follow(pixel);
    this.onMove();
  }

  /** Click at a place; `holds` takes hold of an end of the selected line, or begins a rectangle, and lets go again. */
  clickAt(at, holds) {
    const pixel = this.photo.viewport.toPhoto(at);
    const handle = this.tools.handles.at(at, this.photo.viewport);
    if (this.tools.handles.held) this.tools.handles.drop(this.tools.reach);
    else if (this.photo.marquee) this.#enclose(false);
    else if (holds && handle) this.tools.handles.drag(handle, pixel, this.tools.reach);
    else if (holds && this.tools.encloses) this.photo.marquee = [pixel, pixel];
    else if (this.tools.draws) this.tools.press(pixel);
    else this.tools.click(at, this.photo.viewport, false);
  }

  #leave() {
    this.at = null;
    if (!this.#drag) this.store.set({ hover: null });
    this.onMove();
  }

  #turn(event) {
    event.preventDefault();
    const moved = this.#wheel.move(event);
    this.photo.change((viewport) =>
      moved ? viewport.pan(...moved) : viewport.zoom(wheelFactor(event), this.#place(event)),
    );
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
      if (this.#drag?.what === "pan" && this.#drag.moved) return "grabbing";
      if (this.panHeld) return "grab";
      if (this.#drag?.handle || (this.at && this.tools.handles.at(this.at, this.photo.viewport))) return "move";
      if (this.tools.draws || this.#drag?.what === "enclose") return "crosshair";
      return this.store.hover ? "pointer" : "default";
    };
    this.canvas.style.cursor = cursor();
  }
}
