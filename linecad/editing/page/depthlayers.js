// What lies over the photo: the depth map, where it and the model differ, what each part was taken for; with a legend.

import { element } from "./dom.js";
import { RequestError } from "./server.js";

// By layer, from below: what the two ends of its colours mean (linecad/editing/depth_layers.py).
const ENDS = {
  depth: ["near", "far"],
  difference: ["map 20 % nearer than the model", "20 % farther"],
};

/** The number of a layer in a state: another one whenever its picture is; null where there is none. */
function numberOf({ depth_map: map, cells }, name) {
  return (name === "cells" ? cells?.number : map?.[name]) ?? null;
}

/** The layers of pictures that are switched on; `onChange` is called when another picture is to be drawn. */
export class DepthLayers {
  #pictures = new Map(); // layer -> {number, bitmap}: the number that the state has for it; no bitmap while it is asked

  constructor(store, server, onChange) {
    Object.assign(this, { store, server, onChange });
    this.legend = document.querySelector("#depth-legend");
  }

  /** The layers that are to be seen now, from below. */
  get #shown() {
    const { state, layers, hidden } = this.store;
    if (hidden) return [];
    return ["cells", ...Object.keys(ENDS)].filter((name) => layers[name] && numberOf(state, name) !== null);
  }

  /** Ask for what is to be seen and is not there as the state has it; the picture before stays until then. */
  renew() {
    for (const name of this.#shown) {
      const number = numberOf(this.store.state, name);
      if (this.#pictures.get(name)?.number !== number) this.#load(name, number);
    }
    this.#showLegend();
    this.onChange();
  }

  async #load(name, number) {
    const before = this.#pictures.get(name)?.bitmap;
    this.#pictures.set(name, { number, bitmap: before });
    let bitmap = null;
    try {
      bitmap = await this.server.layer(name);
    } catch (error) {
      if (!(error instanceof RequestError)) throw error; // the next model asks again
    }
    if (this.#pictures.get(name).number !== number) return bitmap?.close(); // a newer one was asked for
    before?.close();
    this.#pictures.set(name, { number, bitmap });
    this.onChange();
  }

  /** Draw in a context that is scaled to the photo, whose corner is at 0, 0. */
  draw(context) {
    const { width, height } = this.store.state.photo;
    for (const name of this.#shown) {
      const bitmap = this.#pictures.get(name)?.bitmap;
      if (bitmap) context.drawImage(bitmap, 0, 0, width, height);
    }
  }

  #showLegend() {
    const shown = this.#shown;
    this.legend.hidden = shown.length === 0;
    if (shown.length === 0) return;
    const rows = shown.map((name) => {
      if (name === "cells") return this.#kinds();
      const [low, high] = ENDS[name];
      return element("p", {}, low, element("i", { class: `ramp ${name}`, "aria-hidden": "true" }), high);
    });
    const ofMap = shown.some((name) => name in ENDS);
    this.legend.replaceChildren(...rows);
    if (ofMap) this.legend.append(element("p", { class: "quiet" }, this.store.state.depth_map.text));
  }

  /** The kinds of what parts of the photo were taken for, with their colours. */
  #kinds() {
    const kinds = this.store.state.cells.kinds.map(({ name, colour }) => {
      const swatch = element("i", { class: "swatch", "aria-hidden": "true" });
      swatch.style.background = colour; // an attribute would be against the policy of the page
      return element("span", {}, swatch, name);
    });
    return element("p", { class: "kinds" }, ...kinds);
  }
}
