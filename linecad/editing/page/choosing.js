// What of the model is shown, and so exported: how sure it must be, which groups, which detail; and colours that tell
// how sure it is. The server says what stays, by the function that the command line exports by.

import { element } from "./dom.js";
import { distance } from "./picking.js";
import { RequestError } from "./server.js";
import { EVERYTHING } from "./store.js";

const STEP = 0.05; // of the slider
const PLACES = [0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95]; // along a line, where its group may be named

export class Choosing {
  #asking = false;
  #wanted = null; // what to ask next
  #asked = null; // the lists that the last question was about

  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.slider = element("input", {
      type: "range", min: 0, max: 1, step: STEP, value: 0, id: "least-sure",
      "aria-label": "How sure the depth of lines must be",
      oninput: () => this.#set({ confidence: Number(this.slider.value) || null }),
    }); // prettier-ignore
    this.value = element("output", {});
    this.colours = element(
      "button",
      {
        "aria-pressed": "false",
        title: "Colour lines and faces by how sure their depth is (Shift+S)",
        onclick: () => this.toggleColours(),
      },
      "How sure",
    );
    this.groups = this.#select("Groups of lines", [
      ["all", "All groups"],
      ["main", "Main group"],
      ["own", "Group of the selection"],
    ], () => this.#chooseGroups()); // prettier-ignore
    this.detail = this.#select("Detail", [
      ["all", "All lines"],
      ["openings", "Without detail"],
      ["none", "Outlines only"],
    ], () => this.#set({ detail: this.detail.value })); // prettier-ignore
    this.legend = element(
      "p",
      { class: "sure-legend", hidden: true },
      "guess",
      element("i", { class: "ramp sure", "aria-hidden": "true" }),
      "sure",
      element("span", { class: "quiet" }, "that the depth is right"),
    );
    const least = element("label", { title: "Hide what is less sure ([ and ])" }, "at least", this.slider, this.value);
    const panel = element(
      "div",
      { class: "float choosing", role: "group", "aria-label": "What is shown and exported" },
      this.legend,
      element("div", {}, this.colours, least),
      element("div", {}, this.groups, this.detail),
    );
    document.querySelector("#model-stage").append(panel);
    this.note = element("li", { role: "none", class: "exported" });
    document.querySelector("#export-list").prepend(this.note);
    store.listen((changed) => this.#noticed(changed));
    this.#show();
  }

  #select(name, choices, onchange) {
    const options = choices.map(([value, label]) => element("option", { value }, label));
    return element("select", { "aria-label": name, onchange }, ...options);
  }

  #noticed(changed) {
    if (["choice", "colouring", "state", "selection"].some((name) => changed.has(name))) this.#show();
    const { lines, planes } = this.store.state;
    const isNew = lines !== this.#asked?.lines || planes !== this.#asked.planes;
    if (changed.has("choice") || (changed.has("state") && isNew && this.store.choice !== EVERYTHING)) this.#ask();
  }

  #show() {
    const { choice, colouring, state } = this.store;
    const tells = state.lines.some((line) => line.probability !== null);
    this.slider.value = choice.confidence ?? 0;
    this.slider.disabled = !tells;
    this.value.textContent = choice.confidence === null ? "any" : `${Math.round(100 * choice.confidence)} %`;
    this.colours.setAttribute("aria-pressed", String(colouring === "confidence"));
    this.colours.disabled = !tells;
    this.legend.hidden = colouring !== "confidence";
    const all = element("button", { role: "menuitem", onclick: () => this.everything() }, "Show all");
    const told = element("p", {}, "Files hold what is shown, not all of the model.", all);
    const part = choice === EVERYTHING ? [] : [told];
    this.note.replaceChildren(...part, element("p", {}, this.#facadeText()));
    this.groups.value = choice.main ? "own" : choice.groups;
    this.detail.value = choice.detail;
  }

  #facadeText() {
    const plane = this.store.selectedPlane;
    if (plane?.is_facade) return `Elevations are of the selected facade, plane ${plane.id}.`;
    return "Elevations are of the largest facade; select another one for its own.";
  }

  toggleColours() {
    if (!this.colours.disabled) this.store.set({ colouring: this.store.colouring === "axis" ? "confidence" : "axis" });
  }

  /** Show what is surer, or less sure too, by so many steps. */
  step(steps) {
    if (this.slider.disabled) return;
    const next = Math.min(Math.max((this.store.choice.confidence ?? 0) + steps * STEP, 0), 1);
    this.#set({ confidence: Number(next.toFixed(2)) || null });
  }

  everything() {
    this.store.set({ choice: EVERYTHING });
    document.querySelector("#export-list [data-format]").focus(); // the button that was clicked is gone
  }

  #set(fields) {
    const choice = { ...this.store.choice, ...fields };
    const isAll = Object.entries(EVERYTHING).every(([name, value]) => choice[name] === value);
    this.store.set({ choice: isAll ? EVERYTHING : choice });
  }

  #chooseGroups() {
    if (this.groups.value !== "own") return this.#set({ groups: this.groups.value, main: null });
    const line = this.store.selectedLine ?? this.#lineOfFace();
    if (line?.ends) return this.#set({ groups: "main", main: this.#placeOf(line) });
    this.actions.messages.tell("Select a line or a face first: its group is shown.");
    this.#show();
  }

  #lineOfFace() {
    const lines = (this.store.selectedPlane?.lines ?? []).map((id) => this.store.lines.get(id));
    return lines.find((line) => line?.component === this.store.selectedPlane.component);
  }

  /** The place on a line that lines of other groups are farthest from. */
  #placeOf(line) {
    const [start, end] = line.segment;
    const others = this.store.state.lines.filter((other) => other.ends && other.component !== line.component);
    const places = PLACES.map((share) => start.map((at, k) => at + share * (end[k] - at)));
    const room = places.map((place) => Math.min(...others.map((other) => distance(place, other.segment)), Infinity));
    return places[room.indexOf(Math.max(...room))];
  }

  /** Ask what the choice keeps, one question at a time: a slider is faster than the answers. */
  async #ask() {
    this.#wanted = this.store.choice;
    if (this.#asking) return;
    this.#asking = true;
    while (this.#wanted) {
      const choice = this.#wanted;
      this.#wanted = null;
      const { lines, planes } = this.store.state;
      this.#asked = { lines, planes };
      try {
        const answer = choice === EVERYTHING ? null : await this.actions.server.post("shown", choice);
        this.store.set({ shown: answer && { lines: new Set(answer.lines), faces: new Set(answer.faces) } });
        const choices = [["Show all", () => this.everything()]];
        this.actions.messages.keep("choice", answer?.nothing ?? null, "warning", choices);
      } catch (error) {
        if (!(error instanceof RequestError)) throw error;
        this.actions.messages.tell(error.message, "error");
      }
    }
    this.#asking = false;
  }

  /** What goes with a request for a file: the choice, and for drawings the selected facade. */
  wanted(format) {
    const { choice, selectedPlane: plane } = this.store;
    const drawn = format.startsWith("elevation.") && plane?.is_facade ? { plane: plane.id } : {};
    return { ...choice, ...drawn };
  }

  /** Rows of the table of keys. */
  keys() {
    return [
      {
        keys: ["shift+s"],
        shown: "Shift+S",
        text: "Colours tell how sure depths are",
        run: () => this.toggleColours(),
      },
      { keys: ["]"], text: "Show only what is surer, by 5 %", run: () => this.step(1), repeats: true },
      { keys: ["["], text: "Show what is less sure too", run: () => this.step(-1), repeats: true },
    ];
  }
}
