// The photo and what lies over it: four canvases, so that a pointer that moves redraws the least of them.

import { DepthLayers } from "./depthlayers.js";
import { drawCrosshair, drawDraft, drawMarquee } from "./drawdraft.js";
import { draw, drawAttention } from "./drawing.js";
import { Marks } from "./marks.js";
import { Tiles } from "./tiles.js";
import { Viewport } from "./viewport.js";

const PIXELS_SHOWN = 3; // from this many device px a photo pixel on, pixels are squares instead of being smoothed
const FEW_CHANGED = 10; // crossings; when more have changed, all are drawn anew
const CLOSE = 6; // times the scale at which all of the photo is seen: there one sees what meets where

const CANVASES = ["photo", "depth", "drawing", "overlay"]; // from below

/** The crossings of a list that are not those of the list before it; null where that has others or many differ. */
function differing(before, now) {
  if (before?.length !== now.length || now.some((crossing, index) => crossing.id !== before[index].id)) return null;
  const found = now.filter((crossing, index) => crossing !== before[index]);
  return found.length <= FEW_CHANGED ? found : null;
}

/** Draws what the store holds; `draft` is the unfinished work of the tools. */
export class PhotoView {
  #dirty = new Set(CANVASES);
  #asked = false;
  #marks = null;
  #relabelled = []; // crossings whose marks alone are to be drawn anew
  marquee = null; // two pixels, while a rectangle is drawn
  crosshair = null; // CSS px, where the keyboard points
  #drawn = null; // the state that the canvases hold

  constructor(store, server, draft) {
    this.store = store;
    this.draft = draft;
    this.stage = document.querySelector("#stage");
    this.canvases = Object.fromEntries(
      CANVASES.map((name) => [name, document.querySelector(`#${name}-canvas`)]),
    );
    const photo = store.state.photo;
    this.viewport = new Viewport(photo.width, photo.height);
    this.tiles = new Tiles(server, photo, () => this.redraw("photo"));
    this.depthLayers = new DepthLayers(store, server, () => this.redraw("depth"));
    this.onView = () => {};
    store.listen((changed) => this.#noticed(changed));
    draft.listen(() => this.redraw("overlay"));
    new ResizeObserver(() => this.#resized()).observe(this.stage);
    this.#resized();
    this.viewport.fit();
  }

  #noticed(changed) {
    const parts = ["lines", "planes", "crossings", "contradiction", "K", "R_cam_from_world"];
    const { state } = this.store;
    if (["layers", "hidden", "state"].some((name) => changed.has(name))) this.depthLayers.renew();
    const isNew = parts.filter((name) => state[name] !== this.#drawn?.[name]);
    const relabelled = isNew.join() === "crossings" ? differing(this.#drawn?.crossings, state.crossings) : null;
    this.#drawn = state;
    if (changed.has("layers") || changed.has("hidden") || (isNew.length > 0 && !relabelled)) {
      this.redraw("drawing", "overlay");
    } else if (relabelled) {
      this.#relabelled.push(...relabelled);
      this.redraw("marks", "overlay");
    }
    if (["hover", "selection", "many"].some((name) => changed.has(name))) this.redraw("overlay");
  }

  /** Draw canvases again before the next picture of the screen. */
  redraw(...names) {
    for (const name of names) this.#dirty.add(name);
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => this.#paint());
  }

  /** The viewport has been moved: everything is drawn again. */
  moved() {
    this.redraw(...CANVASES);
    this.onView();
  }

  change(action) {
    action(this.viewport);
    this.moved();
  }

  /** Show a line or crossing in the middle, not smaller than it takes to see it. */
  show(thing, closely = false) {
    const found = this.store.find(thing);
    if (!found) return;
    const middle = found.pixel ?? [0, 1].map((k) => (found.segment[0][k] + found.segment[1][k]) / 2);
    const scale = closely ? Math.max(this.viewport.scale, CLOSE * this.viewport.fittingScale) : this.viewport.scale;
    this.change((viewport) => viewport.centre(middle, scale));
  }

  #resized() {
    const [width, height] = [this.stage.clientWidth, this.stage.clientHeight];
    if (width === 0 || height === 0) return;
    const wasFitted = Math.abs(this.viewport.scale / this.viewport.fittingScale - 1) < 1e-6;
    this.viewport.resize(width, height);
    if (wasFitted) this.viewport.fit();
    for (const canvas of Object.values(this.canvases)) {
      canvas.width = Math.round(width * devicePixelRatio);
      canvas.height = Math.round(height * devicePixelRatio);
    }
    // A canvas whose size is set is empty; it must not be seen so, not even for one picture of the screen.
    for (const name of Object.keys(this.canvases)) this.#dirty.add(name);
    this.#paint();
    this.onView();
  }

  #paint() {
    this.#asked = false;
    const paint = {
      photo: () => this.#paintPhoto(),
      depth: () => this.#paintDepth(),
      marks: () => this.#paintMarks(),
      drawing: () => this.#paintDrawing(),
      overlay: () => this.#paintOverlay(),
    };
    for (const name of this.#dirty) paint[name]();
    this.#dirty.clear();
    this.canvases.overlay.dispatchEvent(new Event("painted"));
  }

  #cleared(name) {
    const canvas = this.canvases[name];
    const context = canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.scale(devicePixelRatio, devicePixelRatio);
    return context;
  }

  /** An empty canvas whose context is scaled to the photo. */
  #clearedForPhoto(name) {
    const context = this.#cleared(name);
    const { x, y, scale } = this.viewport;
    context.translate(x, y);
    context.scale(scale, scale);
    return context;
  }

  #paintPhoto() {
    const context = this.#clearedForPhoto("photo");
    const { scale } = this.viewport;
    const density = scale * devicePixelRatio;
    context.imageSmoothingEnabled = density < PIXELS_SHOWN;
    const part = this.viewport.seen().map((at) => at + 0.5);
    this.tiles.draw(context, this.tiles.level(density), part);
  }

  #paintDepth() {
    this.depthLayers.draw(this.#clearedForPhoto("depth"));
  }

  /** The surroundings of some crossings, as a click on one changes them: all marks take longer than one. */
  #paintMarks() {
    const [relabelled, isDone] = [this.#relabelled, this.#dirty.has("drawing")];
    this.#relabelled = [];
    if (isDone || this.store.hidden) return;
    const context = this.canvases.drawing.getContext("2d");
    const marks = this.#currentMarks();
    for (const { pixel } of relabelled) {
      const box = marks.box(this.viewport.toScreen(pixel));
      context.save();
      context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
      context.beginPath();
      context.rect(...box);
      context.clip();
      context.clearRect(...box);
      draw(context, this.store, this.viewport, marks, box);
      context.restore();
    }
  }

  #paintDrawing() {
    const context = this.#cleared("drawing");
    if (!this.store.hidden) draw(context, this.store, this.viewport, this.#currentMarks());
  }

  #paintOverlay() {
    const context = this.#cleared("overlay");
    if (this.store.hidden) return;
    drawAttention(context, this.store, this.viewport, this.#currentMarks(), this.draft.stretched);
    drawDraft(context, this.viewport, this.draft);
    if (this.marquee) drawMarquee(context, this.viewport, this.marquee);
    if (this.crosshair) drawCrosshair(context, this.viewport, this.crosshair);
  }

  #currentMarks() {
    if (this.#marks?.density !== devicePixelRatio) this.#marks = new Marks(devicePixelRatio);
    return this.#marks;
  }
}
