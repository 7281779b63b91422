// What a person said of bodies, each to be withdrawn; what the last of it moved, and what of that was not asked for.

import { depthAt, middleOf, movedText } from "./bodies.js";
import { element } from "./dom.js";

export class SaidList {
  #moved = []; // {line, log, asked, to, ratio}: what the last fact moved, by lines, since bodies get new numbers
  #undo = 0; // steps of undo when that was told
  #told = ""; // the list of the state that it was made of

  constructor(store, actions, bodies) {
    Object.assign(this, { store, actions, bodies });
    store.listen((changed) => changed.has("state") && this.#notice());
    this.#told = JSON.stringify(store.state.moved ?? []);
    this.#undo = store.state.undo;
  }

  /** The server tells of moves until the scene is built anew; here they stay until something else is done. */
  #notice() {
    const { state, busy } = this.store;
    if (busy > 0) return; // what is shown is not answered yet
    const told = JSON.stringify(state.moved ?? []);
    const isOther = state.undo !== this.#undo;
    if (isOther) this.#moved = [];
    this.#undo = state.undo;
    if (told === this.#told && !isOther) return;
    this.#told = told;
    if ((state.moved ?? []).length > 0)
      this.#moved = state.moved.map((move) => this.#kept(move, state.moved)).filter(Boolean);
  }

  #kept({ body, log_factor: log, asked }, moved) {
    const { bodies } = this;
    const [line, to] = [bodies.lineOf(body), bodies.lineOf(bodies.reference)];
    if (!line || !to) return null;
    const before = moved.find((other) => other.body === bodies.reference)?.log_factor ?? 0;
    const [own, other] = [line, to].map((each) => Math.log(depthAt(this.store.state, each, middleOf(each))));
    return { line: line.id, log, asked, to: to.id, ratio: own - log - (other - before) };
  }

  /** How many moves nobody asked for. */
  get distant() {
    return this.#moved.filter(({ asked }) => !asked).length;
  }

  /** The facts as rows of a list; those of a contradiction are marked. */
  factRows() {
    return this.store.state.facts.map((fact) => {
      const names = [...new Set(fact.bodies.filter((body) => body >= 0))].map((body) => this.bodies.nameOf(body));
      const state = fact.contradicted ? "contradicted" : fact.holds === false ? "missed" : "holds";
      const note = { contradicted: "cannot hold with others", missed: "does not hold now", holds: "" }[state];
      return element(
        "li",
        {
          class: state,
          onpointerenter: () => this.#hover(fact),
          onpointerleave: () => this.store.set({ hover: null }),
        },
        element("span", {}, `${fact.words}: ${names.join(", ") || "no body"}`, note && element("em", {}, ` ${note}`)),
        element(
          "button",
          {
            title: "Take this back, and keep all that was said after it",
            "data-at": `fact-${fact.edit}`,
            disabled: !this.store.owner,
            onfocus: () => this.#hover(fact),
            onblur: () => this.store.set({ hover: null }),
            onclick: () => this.withdraw(fact),
          },
          "Withdraw",
        ),
      );
    });
  }

  #hover({ lines }) {
    const [line] = lines.filter((id) => this.store.lines.has(id));
    if (line !== undefined) this.store.set({ hover: { kind: "line", id: line } });
  }

  withdraw({ edit }) {
    return this.actions.editing.edit({ op: "withdraw", edit });
  }

  /** What the last fact moved; who did not ask for it can have it back. */
  movedRows() {
    return this.#moved.map((move) => {
      const body = this.store.lines.get(move.line)?.body ?? -1;
      const text = `${this.bodies.nameOf(body)} ${movedText(move.log)}`;
      if (move.asked) return element("li", {}, text);
      const refuse = element(
        "button",
        {
          title: "Say that it stays where it was",
          "data-at": `back-${move.line}`,
          disabled: !this.store.owner,
          onclick: () => this.refuse(move),
        },
        "Put back",
      );
      return element(
        "li",
        { class: "distant" },
        element("span", {}, text, element("em", {}, " not asked for")),
        refuse,
      );
    });
  }

  /** Say that a body stays where it was before the last fact. */
  async refuse({ line, to, ratio }) {
    const rest = this.#moved.filter((move) => move.line !== line);
    const isTaken = await this.actions.editing.edit({ op: "place", line, to, log_ratio: ratio });
    if (!isTaken) return;
    this.#moved = rest;
    this.store.set({ saidAgain: (this.store.saidAgain ?? 0) + 1 }); // the lists are to be shown anew
  }
}
