// The strip over the photo while a gesture is under way: what to do next, what it would do, take it or leave it.

import { element, keyButton } from "./dom.js";
import { gestureOf } from "./gesturelist.js";
import { movedText } from "./bodies.js";

export class GestureBar {
  constructor(gestures) {
    this.gestures = gestures;
    this.bar = element("div", { class: "float gesture", id: "gesture", role: "status", hidden: true });
    document.querySelector("#stage").append(this.bar);
    gestures.listen(() => this.#show());
  }

  #show() {
    const { gestures } = this;
    const { now } = gestures;
    this.bar.hidden = now === null;
    if (!now) return;
    const buttons = () => [...this.bar.querySelectorAll("button")];
    const focused = buttons().indexOf(document.activeElement);
    const { label } = gestureOf(now.kind);
    const { effect } = gestures;
    const isBad = Boolean(now.preview?.refused || now.preview?.conflict) && effect !== null;
    this.bar.replaceChildren(
      element("p", {}, element("strong", {}, label), ` · ${gestures.told}`),
      element("p", { class: isBad ? "bad effect" : "effect" }, this.#place(now), effect ?? (gestures.edit ? "…" : "")),
      element("div", { class: "buttons" }, ...this.#choices(now)),
    );
    if (focused >= 0) buttons()[focused]?.focus();
  }

  #place({ kind, log, snap, normal, second }) {
    if (kind === "move" && log) return element("b", {}, `${movedText(log)}${snap ? `, ${snap.text}` : ""}. `);
    if (kind === "plane" && second && normal) return element("b", {}, `Across ${normal}. `);
    return null;
  }

  #choices({ kind, normals }) {
    const { gestures } = this;
    const turns = kind === "plane" && normals?.length > 1 ? normals : [];
    const steps = [keyButton("Previous", "←", () => gestures.step(-1)), keyButton("Next", "→", () => gestures.step(1))];
    return [
      ...turns.map((axis) => keyButton(`Across ${axis}`, axis.toUpperCase(), () => gestures.turnPlane(axis))),
      ...(kind === "foot" ? [] : steps),
      keyButton("Take it", "Enter", () => gestures.take(), { class: "primary", disabled: gestures.edit === null }),
      keyButton("Leave", "Esc", () => gestures.leave()),
    ];
  }
}
