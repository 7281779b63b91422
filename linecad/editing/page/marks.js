// The marks of crossings, drawn once for a screen and stamped where they are needed.
// A disc is real, a cross is fake; a ring around it says that a person decided; a wide ring that the last solve did.

import { CASING, CHANGED, FAKE, INK, REAL, UNSURE, WRONG } from "./colours.js";
import { isReal } from "./store.js";

export const RADIUS = 5; // CSS px, of a mark at every zoom

// Names are not put together for each of 4,000 crossings.
const LABELS = ["open", "real", "fake", "unsure"];
const NAMES = Object.fromEntries(
  ["real", "fake"].map((shape) => [shape, Object.fromEntries(LABELS.map((label) => [label, `${shape} ${label}`]))]),
);

/** What the mark of a crossing looks like, as a name; crossings of one name look the same. */
export function markOf(crossing) {
  return NAMES[isReal(crossing) ? "real" : "fake"][crossing.label ?? "open"];
}

/** Stamps by name, for one density of the screen. */
export class Marks {
  radius = RADIUS;
  #stamps = new Map();

  constructor(density) {
    this.density = density;
    this.half = Math.ceil((RADIUS + 6) * density); // device px
  }

  /** What a mark at a point (CSS px) may cover, on whole device px: left, top, width, height in CSS px. */
  box(at) {
    const [left, top] = at.map((middle) => (Math.round(middle * this.density) - this.half - 2) / this.density);
    const side = (2 * this.half + 4) / this.density;
    return [left, top, side, side];
  }

  /** A bitmap of (2 half + 1)^2 device px with the mark in its middle. */
  stamp(name) {
    let stamp = this.#stamps.get(name);
    if (!stamp) this.#stamps.set(name, (stamp = this.#drawn(name)));
    return stamp;
  }

  #drawn(name) {
    const canvas = new OffscreenCanvas(2 * this.half + 1, 2 * this.half + 1);
    const context = canvas.getContext("2d");
    context.translate(this.half + 0.5, this.half + 0.5);
    context.scale(this.density, this.density);
    const [shape, label] = name.split(" ");
    if (shape === "changed") ring(context, this.radius + 3.5, 2, CHANGED);
    else if (shape === "wrong") ring(context, this.radius + 4, 3, WRONG);
    else {
      if (label !== "open") ring(context, this.radius + 2.4, 1.6, label === "unsure" ? UNSURE : INK);
      if (shape === "real") disc(context, this.radius, label === "unsure");
      else cross(context, this.radius, label === "unsure");
    }
    return canvas.transferToImageBitmap();
  }
}

function disc(context, radius, grey) {
  circle(context, radius);
  context.fillStyle = INK;
  context.fill();
  circle(context, radius - 1);
  context.fillStyle = grey ? UNSURE : REAL;
  context.fill();
}

function cross(context, radius, grey) {
  const arm = radius * 0.8;
  for (const [width, colour] of [
    [4.2, CASING],
    [2.2, grey ? UNSURE : FAKE],
  ]) {
    context.lineWidth = width;
    context.lineCap = "round";
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(-arm, -arm);
    context.lineTo(arm, arm);
    context.moveTo(arm, -arm);
    context.lineTo(-arm, arm);
    context.stroke();
  }
}

function ring(context, radius, width, colour) {
  for (const [stroke, ink] of [
    [width + 1.6, CASING],
    [width, colour],
  ]) {
    circle(context, radius);
    context.lineWidth = stroke;
    context.strokeStyle = ink;
    context.stroke();
  }
}

function circle(context, radius) {
  context.beginPath();
  context.arc(0, 0, radius, 0, 2 * Math.PI);
}
