// The panel beside the model: bodies by their share of the photo, the selected one, what was said, what that moved.

import { element, keyButton } from "./dom.js";
import { GESTURES } from "./gesturelist.js";
import { movedText } from "./bodies.js";

const MOST_TIES = 8; // shown of the selected body
const SMALLEST = 0.001; // share of the photo of a body that the list names; smaller ones are counted
const SURE = 0.9; // from this probability on a place is called sure, as in exports
const KEYS = { shift: "⇧" };

export class BodyPanel {
  #places = null; // {body, version, list} of the selected body

  constructor(store, actions, bodies, gestures, said) {
    Object.assign(this, { store, actions, bodies, gestures, said });
    this.panel = element("aside", { id: "bodies-panel", class: "bodies", "aria-label": "Bodies", hidden: true });
    document.querySelector("#workspace").append(this.panel);
    this.button = element(
      "button",
      {
        id: "bodies",
        "aria-expanded": "false",
        "aria-controls": "bodies-panel",
        title: "What holds together, and how sure its place is (B)",
        onclick: () => this.toggle(),
      },
      "Bodies ",
      element("span", { class: "count" }),
    );
    document.querySelector("#notes").before(this.button);
    const shown = ["state", "body", "bodyHover", "hover", "tool", "owner", "saidAgain"];
    store.listen((changed) => {
      if (changed.has("tool") && store.tool === "body") this.open(true);
      if (shown.some((name) => changed.has(name))) this.#renew(changed);
    });
    gestures.listen(() => this.#pressButtons());
    gestures.parts.listen(() => !this.panel.hidden && this.#show());
    this.#renew(new Set(["state"]));
  }

  open(isOpen) {
    this.panel.hidden = !isOpen;
    this.button.setAttribute("aria-expanded", String(isOpen));
    if (isOpen) this.#show();
  }

  toggle() {
    this.open(this.panel.hidden);
    if (!this.panel.hidden && this.store.tool !== "body") this.store.set({ tool: "body" });
  }

  #renew(changed) {
    this.button.querySelector(".count").textContent = String(this.bodies.list.length);
    if (this.panel.hidden) return;
    const isHoverAlone = [...changed].every((name) => name === "hover" || name === "bodyHover");
    if (isHoverAlone) return this.#light();
    this.#show();
  }

  #light() {
    const { hovered } = this.bodies;
    for (const row of this.panel.querySelectorAll("[data-body]"))
      row.classList.toggle("lit", Number(row.dataset.body) === hovered);
  }

  #pressButtons() {
    for (const button of this.panel.querySelectorAll("[data-gesture]"))
      button.setAttribute("aria-pressed", String(button.dataset.gesture === this.gestures.now?.kind));
  }

  /** All of it anew; who came here by keys stays where they were, and so does the scroll. */
  #show() {
    const { panel } = this;
    const controls = () => [...panel.querySelectorAll("button")];
    const at = document.activeElement?.dataset?.at ?? null;
    const index = controls().indexOf(document.activeElement);
    const scroll = panel.scrollTop;
    const { bodies, store } = this;
    const moved = this.said.movedRows();
    const facts = this.said.factRows();
    panel.replaceChildren(
      element("div", { class: "gestures", role: "toolbar", "aria-label": "Say what you know" }, this.#gestureButtons()),
      ...(facts.length > 0 ? [element("h3", {}, "Your facts"), element("ul", { class: "facts" }, facts)] : []),
      ...(moved.length > 0 ? [element("h3", {}, "That moved"), element("ul", { class: "moved" }, moved)] : []),
      ...this.#selected(),
      element("h3", {}, "By share of the photo"),
      ...this.#list(),
    );
    if (bodies.list.length === 0)
      panel.append(
        element(
          "p",
          { class: "quiet" },
          store.solve.state === "running" ? "They come with the model." : "This program places no bodies.",
        ),
      );
    this.#pressButtons();
    panel.scrollTop = scroll;
    const again = at === null ? controls()[index] : panel.querySelector(`[data-at="${at}"]`);
    if (index >= 0) again?.focus();
  }

  #gestureButtons() {
    return GESTURES.map(({ kind, key, label }) =>
      keyButton(label, KEYS.shift + key.split("+")[1].toUpperCase(), () => this.gestures.begin(kind), {
        "data-gesture": kind,
        "data-at": `gesture-${kind}`,
        disabled: !this.store.owner || this.bodies.list.length === 0,
      }),
    );
  }

  #list() {
    const { list, selected } = this.bodies;
    const named = list.filter(({ share, id }) => share >= SMALLEST || id === selected);
    const rows = named.map((body) =>
      element(
        "li",
        {},
        element(
          "button",
          {
            class: `body ${body.guess ? "guess" : "sure"}`,
            "data-body": body.id,
            "data-at": `body-${this.bodies.letters.get(body.id)}`,
            "aria-pressed": String(body.id === selected),
            onclick: () => this.bodies.select(body.id === selected ? null : body.id),
            onpointerenter: () => this.store.set({ bodyHover: body.id }),
            onpointerleave: () => this.store.set({ bodyHover: null }),
            onfocus: () => this.store.set({ bodyHover: body.id }),
            onblur: () => this.store.set({ bodyHover: null }),
          },
          element("span", {}, this.bodies.nameOf(body.id)),
          element("span", { class: "share" }, `${percent(body.share)}`),
          element("span", { class: "sure" }, body.reference ? "all others stand against it" : sureText(body)),
        ),
      ),
    );
    const small = list.length - named.length;
    return [
      element("ul", { class: "shares" }, rows),
      ...(small > 0 ? [element("p", { class: "quiet" }, `and ${small} below 0.1 %`)] : []),
    ];
  }

  #selected() {
    const { bodies } = this;
    const id = bodies.selected;
    if (id === null) return [element("p", { class: "quiet" }, "Click a line or a face to select its body.")];
    const body = bodies.byId.get(id);
    if (!body) return [element("h3", {}, "The ground"), element("p", {}, "It lies where the feet of walls say.")];
    const depth = bodies.depthOf(id);
    const place = `${depth === null ? "no line is in the model" : `${bodies.distanceText(depth)} away`} · ${body.lines.length} lines`;
    const sure = body.reference
      ? "The largest: all others are placed against it."
      : `${sureText(body)}${body.by_depth_map ? ", by the depth map" : ""}`;
    const [counted, refused] = [true, false].map((wanted) => body.ties.filter((tie) => tie.counted === wanted));
    return [
      element("h3", {}, bodies.nameOf(id)),
      element("p", {}, place, element("br"), sure),
      ...this.#ties("Holds it there", counted),
      ...this.#ties("Did not count", refused),
      ...this.#parts(id),
      ...this.#otherPlaces(id, body),
    ];
  }

  /** What may stand by itself: a list that is filled when the server has answered. */
  #parts(id) {
    const { parts } = this.gestures;
    const list = element("ul", { class: "ties parts" });
    const title = element("h4", { hidden: true }, "May stand by itself (", element("kbd", {}, "⇧K"), ")");
    const row = (part) =>
      element(
        "li",
        {},
        element(
          "button",
          {
            class: "place",
            "data-at": `part-${part.lines[0]}-${part.lines.length}`,
            "aria-pressed": String(part === parts.chosen),
            title: "Choose this part; then Next place or Move",
            onclick: () => parts.choose(part === parts.chosen ? null : part),
          },
          `${part.lines.length} lines, belongs here: ${percent(part.probability)}`,
        ),
      );
    const fill = (found) => {
      if (this.bodies.selected !== id) return;
      title.hidden = found.length === 0;
      const shown = found.slice(0, MOST_TIES);
      if (parts.chosen && !shown.includes(parts.chosen)) shown.push(parts.chosen);
      list.replaceChildren(...shown.map(row));
    };
    parts.list().then(fill, () => {}); // the next state asks again
    return [title, list];
  }

  #ties(title, ties) {
    if (ties.length === 0) return [];
    const rows = ties.slice(0, MOST_TIES).map((tie) => element("li", {}, this.#tieText(tie)));
    const more =
      ties.length > MOST_TIES ? [element("li", { class: "quiet" }, `and ${ties.length - MOST_TIES} more`)] : [];
    return [element("h4", {}, title), element("ul", { class: "ties" }, rows, more)];
  }

  #tieText({ other, kind, words, counted, missed }) {
    const to = other !== null ? `with ${this.bodies.nameOf(other)}` : kind === "depth map" ? "" : "with the ground";
    const off = counted || missed < 0.01 ? "" : `, off by ${percent(Math.expm1(missed))}`;
    return `${words} ${to}${off}`;
  }

  #otherPlaces(id, body) {
    if (body.reference) return [];
    const { version } = this.store.state;
    if (this.#places?.body !== id || this.#places.version !== version) {
      this.#places = { body: id, version, list: null };
      this.#ask(this.#places);
    }
    const { list } = this.#places;
    if (list === null) return [];
    if (list.length === 0) return [element("p", { class: "quiet" }, "Nothing speaks for another place.")];
    const rows = list
      .slice(0, MOST_TIES)
      .map(({ move, words }, index) =>
        element(
          "li",
          {},
          element(
            "button",
            { class: "place", title: "Show this place; Enter takes it", onclick: () => this.#try(index) },
            `${movedText(move)}: ${words.join(", ") || "no evidence of its own"}`,
          ),
        ),
      );
    return [element("h4", {}, "Other places"), element("ol", { class: "ties" }, rows)];
  }

  #try(index) {
    this.gestures.leave();
    this.gestures.begin("place", index);
  }

  async #ask(places) {
    try {
      places.list = await this.actions.server.get(`places/${places.body}`);
    } catch {
      places.list = []; // the next state asks again
    }
    if (this.#places === places && !this.panel.hidden) this.#show();
  }
}

function sureText({ probability, guess }) {
  return `${guess ? "a guess" : probability < SURE ? "likely" : "sure"}, ${percent(probability)}`;
}

function percent(share) {
  return `${(100 * share).toFixed(share < 0.0995 ? 1 : 0)} %`;
}
