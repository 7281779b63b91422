// The ends of the selected line: each is dragged along the line, and snaps to what crosses it.

const REACH = 9; // CSS px

export class Handles {
  held = null; // {id, end, at}: the end that is dragged, and the pixel where to
  #refused = null; // why the line cannot end there

  constructor(store, draft, editing, proposals) {
    Object.assign(this, { store, draft, editing, proposals });
  }

  /** The end of the selected line that is at a place of the stage, as {id, end}, or null. */
  at(place, viewport) {
    const line = this.store.selectedLine;
    if (!line || this.store.labelling || !this.draft.isEmpty) return null;
    const away = line.segment.map((end) => {
      const [x, y] = viewport.toScreen(end);
      return Math.hypot(x - place[0], y - place[1]);
    });
    const end = away[0] <= away[1] ? 0 : 1;
    return away[end] <= REACH ? { id: line.id, end } : null;
  }

  drag({ id, end }, pixel, reach) {
    this.held = { id, end, at: pixel };
    this.proposals.ask({ line: id, end, at: pixel, reach }, (stretched, refused = null) => {
      this.#refused = refused;
      if (this.held) this.draft.stretch(stretched && { id, end, ...stretched });
    });
  }

  /** Let go: the line ends there, and is shown so until the server has answered. */
  async drop(reach) {
    const { id, end, at } = this.held;
    if (this.#refused) this.editing.tell(this.#refused, "warning");
    if (this.#refused) return this.cancel();
    this.held = null;
    this.proposals.drop();
    await this.editing.edit({ op: "ends", line: id, end, at, reach });
    if (!this.held) this.draft.stretch(null);
  }

  cancel() {
    this.held = null;
    this.#refused = null;
    this.proposals.drop();
    this.draft.stretch(null);
  }
}
