// Parts of the selected body: what may stand by itself, since little holds it to the rest. One of them can be chosen.

export class BodyParts {
  chosen = null; // {lines, probability}, lines by their ids
  #known = null; // {body, version, list}
  #listeners = [];

  constructor(store, actions, bodies) {
    Object.assign(this, { store, actions, bodies });
    store.listen((changed) => {
      if (changed.has("body") || (changed.has("state") && !this.#isCurrent(this.#known))) this.choose(null);
    });
  }

  /** Call `listener` when another part is chosen, or none. */
  listen(listener) {
    this.#listeners.push(listener);
  }

  choose(part) {
    if (part === this.chosen) return;
    this.chosen = part;
    this.bodies.choosePart(part?.lines ?? null);
    for (const listener of this.#listeners) listener();
  }

  #isCurrent(known) {
    return known?.version === this.store.state.version && known.body === this.bodies.selected;
  }

  /** The parts of the selected body, the most doubtful first. */
  async list() {
    const body = this.bodies.selected;
    if (body === null || body === this.bodies.ground) return [];
    if (!this.#isCurrent(this.#known))
      this.#known = { body, version: this.store.state.version, list: this.actions.server.get(`parts/${body}`) };
    return this.#known.list;
  }

  /** Go on to the next part, of those that hold the selected line if a line of the body is selected; then to none. */
  async next() {
    const { messages } = this.actions;
    if (this.bodies.selected === null) return messages.tell("Click a body first; this goes through its parts.");
    let list;
    try {
      list = await this.list();
    } catch (error) {
      this.#known = null;
      return messages.tell(error.message, "error");
    }
    const line = this.store.selectedLine;
    const own = line && line.body === this.bodies.selected ? list.filter(({ lines }) => lines.includes(line.id)) : list;
    if (own.length === 0)
      return messages.tell(
        list.length > 0
          ? "No part of this body holds the selected line; select another line of it."
          : "This body holds together well; nothing of it is likely to stand by itself.",
      );
    this.choose(own[own.indexOf(this.chosen) + 1] ?? null);
  }
}
