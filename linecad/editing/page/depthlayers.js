// What a depth map shows over the photo: the map itself, and where it and the model differ; with a legend.

import { element } from "./dom.js";
import { RequestError } from "./server.js";

// By layer, from below: what the two ends of its colours mean (linecad/editing/depth_layers.py).
const ENDS = {
  depth: ["near", "far"],
  difference: ["map 20 % nearer than the model", "20 % farther"],
};

/** The layers of the depth map that are switched on; `onChange` is called when another picture is to be drawn. */
export class DepthLayers {
  #pictures = new Map(); // layer -> {number, bitmap}: the number that the state has for it; no bitmap while it is asked

  constructor(store, server, onChange) {
    Object.assign(this, { store, server, onChange });
    this.legend = document.querySelector("#depth-legend");
  }

  /** The layers that are to be seen now, from below. */
  get #shown() {
    const { state, layers, hidden } = this.store;
    if (state.depth_map === null || hidden) return [];
    return Object.keys(ENDS).filter((name) => layers[name] && state.depth_map[name] !== null);
  }

  /** Ask for what is to be seen and is not there as the state has it; the picture before stays until then. */
  renew() {
    for (const name of this.#shown) {
      const number = this.store.state.depth_map[name];
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
      bitmap = await this.server.depthLayer(name);
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
      const [low, high] = ENDS[name];
      return element("p", {}, low, element("i", { class: `ramp ${name}`, "aria-hidden": "true" }), high);
    });
    this.legend.replaceChildren(...rows, element("p", { class: "quiet" }, this.store.state.depth_map.text));
  }
}
