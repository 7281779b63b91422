// Labelling: one unlabelled crossing after the other in the middle of the photo, a key for each answer.

/** The next crossing without a label behind one, the most telling first and around; undefined when there is none. */
export function nextUnlabelled({ crossings, labelling }, after) {
  const byId = new Map(crossings.map((crossing) => [crossing.id, crossing]));
  const start = labelling.order.indexOf(after) + 1;
  const order = [...labelling.order.slice(start), ...labelling.order.slice(0, start)];
  return order.map((id) => byId.get(id)).find((crossing) => crossing?.label === null);
}

/** Adds `labelAndGoOn`, `nextUnlabelled` and `toggleLabelling` to the actions. */
export class Labelling {
  constructor(store, actions) {
    Object.assign(this, { store, actions });
    actions.labelAndGoOn = (value) => this.#labelAndGoOn(value);
    actions.nextUnlabelled = () => this.#next();
    actions.toggleLabelling = () => this.#toggle();
    const button = document.querySelector("#label-mode");
    button.addEventListener("click", () => this.#toggle());
    store.listen((changed) => changed.has("labelling") && button.setAttribute("aria-pressed", String(store.labelling)));
  }

  #toggle() {
    const labelling = !this.store.labelling;
    this.store.set({ labelling, tool: "correct" });
    if (!labelling) return;
    if (this.store.selectedCrossing?.label === null) this.actions.showSelection();
    else this.#next();
  }

  /** Go on at once: who labels fast must not wait for the server, nor label the same crossing twice. */
  #labelAndGoOn(value) {
    const crossing = this.store.selectedCrossing;
    if (!crossing) return;
    this.actions.editing.edit({ op: "label", crossing: crossing.id, value });
    this.#next();
  }

  #next() {
    const next = nextUnlabelled(this.store.state, this.store.selectedCrossing?.id);
    this.store.set({ selection: next ? { kind: "crossing", id: next.id } : null });
    this.actions.showSelection();
  }
}
