// Measuring: two points of lines and faces, in the photo or the model, how far apart they are, also as known length.

import { CASING, INK } from "./colours.js";
import { element, keyButton } from "./dom.js";
import { pixelOf, subtract } from "./matrices.js";
import { MEASURE } from "./lighting.js";
import { pointAt, sightOfModel, sightOfPhoto } from "./sights.js";

const NOTHING = { points: [], near: null };

/** Lengths for people: in metres where the scale is known, else in units of the model. */
export function lengthsText(lengths, metres) {
  const known = metres !== null;
  const text = lengths.map((length) => Number((length * (metres ?? 1)).toPrecision(4)).toString());
  return { text, unit: known ? "m" : "units" };
}

/** The tool; what it has measured is in the store, so that both views draw it. */
export class Measuring {
  constructor({ store, photo, model, pointer, actions }) {
    Object.assign(this, { store, photo, model, actions });
    this.label = element("output", { class: "float measured", id: "model-measure", hidden: true });
    model.stage.append(this.label);
    const [select, light] = [model.onClick, model.onHover];
    model.onClick = (at) => (this.isOn ? this.click(sightOfModel(model), at) : select(at));
    model.onHover = (at) => (this.isOn ? this.#follow(sightOfModel(model), at) : light(at));
    pointer.onMove = () => {
      if (this.isOn && pointer.at) this.#follow(sightOfPhoto(store, photo.viewport), pointer.at);
    };
    store.listen((changed) => {
      if (changed.has("tool") && !this.isOn) this.clear();
      if (changed.has("state")) this.#renew();
    });
    model.canvas.addEventListener("painted", () => this.#placeLabel());
  }

  get isOn() {
    return this.store.tool === "measure";
  }

  get isEmpty() {
    return this.store.measure.points.length === 0;
  }

  clear() {
    if (!this.isEmpty || this.store.measure.near) this.store.set({ measure: NOTHING });
  }

  clickPhoto(at) {
    this.click(sightOfPhoto(this.store, this.photo.viewport), at);
  }

  /** The first point, the second, or the first of the next pair. */
  click(sight, at) {
    const found = pointAt(this.store, sight, at);
    if (!found) return this.actions.messages.tell("Nothing of the model is there: click a line or a face.");
    const { points } = this.store.measure;
    this.store.set({ measure: { points: [...(points.length < 2 ? points : []), found], near: null } });
  }

  #follow(sight, at) {
    if (this.store.measure.points.length === 2) return;
    this.store.set({ measure: { ...this.store.measure, near: pointAt(this.store, sight, at) } });
  }

  /** After an edit or a solve, points whose line or face is gone or has moved are gone. */
  #renew() {
    const { points } = this.store.measure;
    const built = this.built;
    this.built = [this.store.state.lines, this.store.state.planes];
    if (points.length === 0) return;
    if (built && built.some((list, index) => list !== this.built[index])) this.clear();
    else {
      this.photo.redraw("overlay"); // the scale may be another one
      this.#placeLabel();
    }
  }

  /** How far apart the points are, along x, y and z too, as text; null while there are fewer than two. */
  get text() {
    const { points, near } = this.store.measure;
    const [start, end] = [...points, ...(near ? [near] : [])].map(({ point }) => point);
    if (points.length === 0 || !end) return null;
    const parts = subtract(end, start);
    const lengths = [Math.hypot(...parts), ...parts.map(Math.abs)];
    const { text, unit } = lengthsText(lengths, this.store.state.metres_per_unit);
    return { whole: `${text[0]} ${unit}`, parts: `x ${text[1]} · y ${text[2]} · z ${text[3]} ${unit}`, unit };
  }

  /** What the strip below the photo shows. */
  panel() {
    const { points, near } = this.store.measure;
    const found = this.text;
    if (points.length === 0) {
      const at = near ? `Here: ${near.what}. ` : "";
      return [element("p", {}, `${at}Click two points of lines or faces, in the photo or the model.`)];
    }
    if (!found) return [element("p", {}, `From: ${points[0].what}. Click the second point.`)];
    const free = found.unit === "units" ? " · the scale is not known: units of the model" : "";
    const to = points[1] ?? near;
    const words = `, ${found.parts} · from ${points[0].what} to ${to.what}${free}`;
    const ready = points.length === 2;
    return [
      element("p", {}, element("strong", {}, found.whole), words),
      element(
        "div",
        { class: "buttons" },
        keyButton("Length", "M", () => this.askLength(), { disabled: !ready || !this.store.owner }),
      ),
    ];
  }

  /** Ask how long it is: that sets the scale. */
  askLength() {
    const { points } = this.store.measure;
    if (points.length < 2) return this.actions.messages.tell("Click two points first.");
    const { K, R_cam_from_world: rotation } = this.store.state;
    const pixels = points.map(({ point }) => pixelOf(K, rotation, point));
    if (pixels.includes(null)) return this.actions.messages.tell("A point lies behind the camera; choose another one.");
    this.actions.openLength({ points: points.map(({ on }, index) => ({ pixel: pixels[index], ...on })) });
  }

  // --- what is drawn ---

  /** Over the photo, in a context in CSS px of its stage. */
  draw(context) {
    const { points, near } = this.store.measure;
    const sight = sightOfPhoto(this.store, this.photo.viewport);
    const places = [...points, ...(near && points.length < 2 ? [near] : [])]
      .map(({ point }) => sight.toScreen(point))
      .filter(Boolean);
    const [start, end] = places;
    if (end) {
      for (const [ink, width] of [
        [CASING, 5],
        [MEASURE, 2.4],
      ]) {
        context.strokeStyle = ink;
        context.lineWidth = width;
        context.beginPath();
        context.moveTo(...start);
        context.lineTo(...end);
        context.stroke();
      }
      this.#write(context, start.map((at, k) => (at + end[k]) / 2));
    }
    for (const [x, y] of places) {
      context.beginPath();
      context.arc(x, y, 4.5, 0, 2 * Math.PI);
      context.fillStyle = MEASURE;
      context.fill();
      context.lineWidth = 2;
      context.strokeStyle = CASING;
      context.stroke();
    }
  }

  #write(context, [x, y]) {
    const { whole } = this.text;
    context.font = "600 13px system-ui, sans-serif";
    const width = context.measureText(whole).width + 12;
    context.fillStyle = CASING;
    context.beginPath();
    context.roundRect(x - width / 2, y - 26, width, 20, 5);
    context.fill();
    context.fillStyle = INK;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(whole, x, y - 15.5);
  }

  #placeLabel() {
    const found = this.text;
    const { points, near } = this.store.measure;
    const places = [...points, ...(near ? [near] : [])].map(({ point }) => this.model.toScreen(point));
    this.label.hidden = !found || places.includes(null);
    if (this.label.hidden) return;
    this.label.textContent = found.whole;
    this.label.style.left = `${(places[0][0] + places[1][0]) / 2}px`;
    this.label.style.top = `${(places[0][1] + places[1][1]) / 2 - 26}px`;
  }
}
