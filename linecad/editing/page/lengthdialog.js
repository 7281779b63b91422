// The dialog for a known length: what it would set, and what was understood of what is written.

import { readLength } from "./lengths.js";

/** What a length of a line does now, in one or two sentences. */
export function whatLengthSets(line) {
  if (line.sets_scale) return "It sets the scale of the whole model; where several lengths are known, their mean does.";
  const why = line.ends ? "The depth of this line is a guess (it is dashed)" : "This line is not in the model";
  const instead = "To set the scale, choose a line that is drawn through.";
  return `${why}, so its length sets no scale now. It is kept and counts once the depth is sure. ${instead}`;
}

/** Adds `openLength` to the actions, which takes a line, or `{points}`: two points as an edit names them. */
export class LengthDialog {
  #edit = null; // but for its metres

  constructor(actions) {
    this.actions = actions;
    const part = (name) => document.querySelector(`#length-${name}`);
    this.parts = Object.fromEntries(
      ["dialog", "form", "title", "text", "value", "read", "set", "forget", "cancel"].map((name) => [name, part(name)]),
    );
    actions.openLength = (line) => this.#open(line);
    this.parts.value.addEventListener("input", () => this.#understand());
    this.parts.cancel.addEventListener("click", () => this.parts.dialog.close());
    this.parts.forget.addEventListener("click", () => this.#send(null));
    this.parts.form.addEventListener("submit", (event) => {
      event.preventDefault();
      const { metres } = this.#understand();
      if (metres !== undefined) this.#send(metres);
    });
  }

  #open({ points, ...line }) {
    const metres = line.metres ?? null;
    this.#edit = points ? { op: "distance", points } : { op: "length", line: line.id };
    this.parts.title.textContent = points ? "How far apart are the two points?" : `How long is line ${line.id}?`;
    this.parts.text.textContent = points ? "It sets the scale of the whole model." : whatLengthSets(line);
    this.parts.set.textContent = points || line.sets_scale ? "Set the scale" : "Keep it";
    this.parts.forget.hidden = metres === null;
    this.parts.value.value = metres === null ? "" : String(metres);
    this.#understand();
    this.parts.dialog.showModal();
    this.parts.value.select();
  }

  /** Say what is read, while it is written: nobody learns from a model that 3,5 was taken for 35. */
  #understand() {
    const { value, read, set } = this.parts;
    const isEmpty = value.value.trim() === "";
    const found = isEmpty ? {} : readLength(value.value);
    read.textContent = isEmpty ? "Metres, or with a unit: 350 cm, 11'6\"" : (found.error ?? `= ${found.metres} m`);
    read.classList.toggle("wrong", found.error !== undefined);
    set.disabled = found.metres === undefined;
    return found;
  }

  #send(metres) {
    this.parts.dialog.close();
    return this.actions.editing.edit({ ...this.#edit, metres });
  }
}
