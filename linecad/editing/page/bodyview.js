// Bodies in both views: the selected one and that under the pointer, what a gesture chose, ghosts of what would move.

import { CASING, CHANGED, INK, channels } from "./colours.js";
import { movedText, middleOf } from "./bodies.js";
import { add, applied, product, subtract, times, unit } from "./matrices.js";
import { themeColour } from "./theme.js";

const GHOST = "#7a3be0"; // what a gesture chose, and where it would put bodies
const FILL = { selected: 0.3, hovered: 0.16 }; // opacity of faces
const GHOST_FACE = 0.55;
const SECONDS = 2.5; // that what moved is shown
const MOST_ARROWS = 12;
const MOST_CHIPS = 6; // bodies whose move is told in the photo; the strip counts the others
const LABEL_HEIGHT = 24; // CSS px
const NEAREST_DEPTH = 1e-3;

export class BodyView {
  #canvas;
  #buffers = {};
  #shownMoves = null; // the list of the state that is shown, or was
  #flash = new Map(); // body -> log factor that it moved by, while that is shown
  #timer = null;
  #asked = false;

  constructor(store, bodies, gestures, photo, model) {
    Object.assign(this, { store, bodies, gestures, photo, model });
    const overlay = photo.canvases.overlay;
    this.#canvas = document.createElement("canvas");
    this.#canvas.id = "bodies-canvas";
    this.#canvas.setAttribute("aria-hidden", "true");
    overlay.before(this.#canvas);
    const seen = ["state", "hover", "body", "bodyHover", "tool", "hidden", "selection"];
    store.listen((changed) => {
      if (changed.has("state")) this.#noticeMoves();
      if (changed.has("tool")) photo.stage.classList.toggle("of-bodies", store.tool === "body");
      if (seen.some((name) => changed.has(name))) this.#renew();
    });
    gestures.listen(() => this.#renew());
    gestures.parts.listen(() => this.#renew());
    const onView = photo.onView;
    photo.onView = () => {
      onView();
      this.#renew(true);
    };
    model.overlays.push((graphics, matrix) => this.#drawModel(graphics, matrix));
    this.#shownMoves = JSON.stringify(store.state.moved ?? []);
  }

  /** Draw again before the next picture of the screen; with `photoAlone` the model is as it was. */
  #renew(photoAlone = false) {
    if (!photoAlone) {
      this.#build();
      this.model.redraw();
    }
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => this.#paint());
  }

  /** What the last fact moved is shown for a moment. */
  #noticeMoves() {
    const moved = this.store.state.moved ?? [];
    const now = JSON.stringify(moved);
    const isNew = now !== this.#shownMoves && moved.length > 0;
    this.#shownMoves = now;
    if (!isNew) return;
    this.#flash = new Map(moved.map(({ body, log_factor }) => [body, log_factor]));
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.#flash = new Map();
      this.#renew();
    }, 1000 * SECONDS);
  }

  /** How many bodies are shown as just moved, for the tests. */
  get flashing() {
    return this.#flash.size;
  }

  #linesOf(body) {
    return (this.bodies.linesOf.get(body) ?? []).filter((line) => this.store.showsLine(line));
  }

  // --- the photo ---

  #paint() {
    this.#asked = false;
    const { width, height } = this.photo.canvases.overlay;
    const canvas = this.#canvas;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    if (this.store.hidden) return;
    context.scale(devicePixelRatio, devicePixelRatio);
    context.lineCap = "round";
    const { selected, hovered } = this.bodies;
    if (hovered !== null && hovered !== selected) this.#body(context, hovered, INK, FILL.hovered, 1.2);
    if (selected !== null) this.#body(context, selected, INK, FILL.selected, 2.4);
    if (this.gestures.parts.chosen) this.#strokes(context, this.#linesOf(this.bodies.part), GHOST, 3.2);
    for (const body of this.#flash.keys()) this.#strokes(context, this.#linesOf(body), CHANGED, 3.4);
    const moves = Object.entries(this.gestures.moves).map(([id, log]) => [Number(id), log]);
    for (const [body] of moves) this.#strokes(context, this.#linesOf(body), GHOST, 2.2);
    this.#chosen(context);
    const chips = moves.length > 0 ? moves : [...this.#flash];
    const colour = moves.length > 0 ? GHOST : "#00707c";
    const largest = (id) => (id === this.bodies.part ? 1 : (this.bodies.byId.get(id)?.share ?? 0));
    const taken = [];
    for (const [body, log] of chips.sort((a, b) => largest(b[0]) - largest(a[0])).slice(0, MOST_CHIPS))
      this.#chip(context, body, log, colour, taken);
    if (chips.length === 0 && selected !== null)
      this.#name(context, this.gestures.parts.chosen ? this.bodies.part : selected);
    canvas.dispatchEvent(new Event("painted"));
  }

  #body(context, body, ink, fill, width) {
    context.save();
    context.globalAlpha = fill;
    context.fillStyle = ink;
    const { K, R_cam_from_world: rotation } = this.store.state;
    const project = product(K, rotation);
    for (const face of this.bodies.facesOf(body)) {
      const rings = [face.outline, ...(face.holes ?? [])].map((ring) => ring.map((point) => applied(project, point)));
      if (rings.flat().some(([, , depth]) => depth < NEAREST_DEPTH)) continue;
      context.beginPath();
      for (const ring of rings) {
        ring.forEach(([x, y, depth], index) => {
          const at = this.photo.viewport.toScreen([x / depth, y / depth]);
          if (index === 0) context.moveTo(...at);
          else context.lineTo(...at);
        });
        context.closePath();
      }
      context.fill("evenodd");
    }
    context.restore();
    this.#strokes(context, this.#linesOf(body), ink, width);
  }

  #strokes(context, lines, ink, width) {
    for (const [colour, wide] of [
      [CASING, width + 2],
      [ink, width],
    ]) {
      context.beginPath();
      for (const { segment } of lines) {
        context.moveTo(...this.photo.viewport.toScreen(segment[0]));
        context.lineTo(...this.photo.viewport.toScreen(segment[1]));
      }
      context.strokeStyle = colour;
      context.lineWidth = wide;
      context.stroke();
    }
  }

  /** The lines of a gesture, what it says between them, and a foot. */
  #chosen(context) {
    const { now } = this.gestures;
    if (!now) return;
    const { viewport } = this.photo;
    const lines = [now.first, now.second].filter(Boolean).map((line) => this.store.lines.get(line.id) ?? line);
    this.#strokes(context, lines, GHOST, 5);
    if (lines.length === 2) this.#link(context, ...lines.map((line) => viewport.toScreen(middleOf(line))));
    if (now.pixel && now.first) {
      const place = viewport.toScreen(now.pixel);
      this.#link(context, viewport.toScreen(middleOf(now.first)), place);
      const [x, y] = place;
      context.beginPath();
      context.moveTo(x - 22, y);
      context.lineTo(x + 22, y);
      for (let hatch = -18; hatch <= 18; hatch += 9) {
        context.moveTo(x + hatch, y);
        context.lineTo(x + hatch - 6, y + 8);
      }
      context.strokeStyle = now.fixed ? GHOST : INK;
      context.lineWidth = 2.5;
      context.stroke();
    }
  }

  #link(context, from, to) {
    context.save();
    context.setLineDash([7, 6]);
    context.lineWidth = 1.8;
    context.strokeStyle = GHOST;
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.stroke();
    context.restore();
  }

  #chip(context, body, log, colour, taken) {
    const depth = this.bodies.depthOf(body);
    const { distanceText } = this.bodies;
    const text = (value) => distanceText.call(this.bodies, value);
    const isOver = this.gestures.now !== null;
    const [before, after] = isOver ? [depth, depth * Math.exp(log)] : [depth * Math.exp(-log), depth];
    const words = depth === null ? "" : `  ${text(before)} → ${text(after)}`;
    this.#label(context, body, `${this.bodies.nameOf(body)}: ${movedText(log)}${words}`, colour, taken);
  }

  #name(context, body) {
    this.#label(context, body, this.bodies.nameOf(body), INK);
  }

  /** A label at the longest line of a body, within the stage; not where it would cover one of those `taken`. */
  #label(context, body, text, colour, taken = []) {
    const line = this.bodies.lineOf(body);
    if (!line) return;
    const { viewport } = this.photo;
    context.font = "600 12.5px system-ui, sans-serif";
    const wide = context.measureText(text).width + 14;
    const [left, y] = viewport.toScreen(middleOf(line));
    const x = Math.min(Math.max(left, wide / 2 + 4), viewport.width - wide / 2 - 4);
    if (taken.some((other) => Math.abs(other.x - x) < (other.wide + wide) / 2 && Math.abs(other.y - y) < LABEL_HEIGHT))
      return;
    taken.push({ x, y, wide });
    context.fillStyle = colour;
    context.beginPath();
    context.roundRect(x - wide / 2, y - LABEL_HEIGHT / 2, wide, LABEL_HEIGHT, 6);
    context.fill();
    context.fillStyle = CASING;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, x, y + 0.5);
  }

  // --- the model ---

  #build() {
    const { graphics } = this.model;
    if (!graphics) return;
    const { selected, hovered } = this.bodies;
    const lit = [];
    const ink = themeColour("--model-ink");
    const light = (body, colour, width, factor = 1) => {
      for (const { ends } of this.#linesOf(body)) {
        const [start, end] = ends.map((point) => times(point, factor));
        lit.push({ start, end, colour: [...colour, 1], width: width * devicePixelRatio });
      }
    };
    if (hovered !== null && hovered !== selected) light(hovered, ink, 2);
    if (selected !== null) light(selected, ink, 2.2);
    if (this.gestures.parts.chosen) light(this.bodies.part, channels(GHOST), 3);
    for (const [body, log] of this.#flash)
      (light(body, channels(CHANGED), 4), lit.push(...this.#arrow(body, -log, CHANGED, true)));
    for (const line of [this.gestures.now?.first, this.gestures.now?.second])
      if (line)
        lit.push({
          start: line.ends[0],
          end: line.ends[1],
          colour: [...channels(GHOST), 1],
          width: 6 * devicePixelRatio,
        });
    const corners = [];
    for (const [id, log] of Object.entries(this.gestures.moves)) {
      const [body, factor] = [Number(id), Math.exp(log)];
      light(body, channels(GHOST), 2, factor);
      lit.push(...this.#arrow(body, log, GHOST, false));
      for (const face of this.bodies.facesOf(body)) {
        const points = [face.outline, ...(face.holes ?? [])].flat();
        for (const index of face.triangles.flat())
          corners.push([...times(points[index], factor), ...channels(GHOST), GHOST_FACE]);
      }
    }
    this.#buffers.lit = graphics.lines(lit, this.#buffers.lit);
    this.#buffers.ghost = graphics.triangles(corners, this.#buffers.ghost);
  }

  /** From where a body is to a log factor from there, or the other way. */
  #arrow(body, log, colour, backwards) {
    const line = this.bodies.lineOf(body);
    if (!line || this.#flash.size > MOST_ARROWS) return [];
    const middle = times(add(...line.ends), 0.5);
    const ends = [middle, times(middle, Math.exp(log))];
    const [start, end] = backwards ? ends.reverse() : ends;
    const along = subtract(end, start);
    const aside = times(unit([along[1], -along[0], 0]), 0.12 * Math.hypot(...along));
    const back = subtract(end, times(along, 0.2));
    const stroke = (from, to) => ({
      start: from,
      end: to,
      colour: [...channels(colour), 1],
      width: 2.6 * devicePixelRatio,
    });
    return [stroke(start, end), stroke(end, add(back, aside)), stroke(end, subtract(back, aside))];
  }

  #drawModel(graphics, matrix) {
    const { lit, ghost } = this.#buffers;
    if (!lit) return;
    const { K, R_cam_from_world: rotation, photo } = this.store.state;
    graphics.drawFaces(ghost, matrix, {
      pixelFromWorld: product(K, rotation),
      photoSize: [photo.width, photo.height],
      textured: false,
    });
    graphics.drawLines(lit, matrix, { always: true });
  }
}
