// What a solve changed far from everything that was edited: told, shown, and refused in one step where it is wrong.

import { counted } from "./dom.js";

export class Distant {
  constructor(store, actions) {
    Object.assign(this, { store, actions });
    store.listen((changed) => (changed.has("state") || changed.has("owner")) && this.#tell());
    this.#tell();
  }

  /** The crossings that changed far away and about which nobody has said anything yet. */
  get #crossings() {
    const { crossings, solve } = this.store.state;
    return solve.fresh ? crossings.filter(({ far, label }) => far && label === null) : [];
  }

  #tell() {
    const found = this.store.owner ? this.#crossings : [];
    const one = found.length === 1;
    const text = `${counted(found.length, "crossing")} changed far from what you edited, where nothing was said.`;
    this.actions.messages.keep("distant", found.length > 0 ? text : null, "warning", [
      [one ? "Show it" : "Show them", () => this.#select()],
      [one ? "Refuse it" : "Refuse them", () => this.#refuse()],
    ]);
  }

  #select() {
    const ids = this.#crossings.map(({ id }) => id);
    const [first] = ids;
    this.store.set(
      ids.length > 1
        ? { selection: null, many: { lines: [], crossings: ids } }
        : { many: null, selection: { kind: "crossing", id: first } },
    );
    this.actions.photo.show({ kind: "crossing", id: first }, true);
  }

  /** What changed is to be as it was, by the person's word; then it is solved again. */
  async #refuse() {
    const edits = this.#crossings.map(({ id, real }) => ({ op: "label", crossing: id, value: real ? "fake" : "real" }));
    if (await this.actions.editing.edit(edits.length === 1 ? edits[0] : { op: "many", edits })) await this.actions.solveOrStop();
  }
}
