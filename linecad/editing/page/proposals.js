// What the server makes of a line while the pointer moves: one question at a time, as the pointer is faster.

import { RequestError } from "./server.js";

/** What an end snaps to, in words: "end of line 12", "line 7". */
export function snapText(snap) {
  return snap ? `${snap.is_end ? "end of " : ""}line ${snap.line}` : null;
}

export class Proposals {
  #asking = false;
  #next = null; // {question, hear}

  constructor(server) {
    this.server = server;
  }

  /**
   * Ask, unless a later question comes before; `hear` is called with the answer, or with null where nothing can be made
   * of it, and why.
   */
  async ask(question, hear) {
    this.#next = { question, hear };
    if (this.#asking) return;
    this.#asking = true;
    while (this.#next) {
      const { question: asked, hear: tell } = this.#next;
      this.#next = null;
      try {
        const made = await this.server.post("propose", asked);
        if (made.refused) tell(null, made.refused);
        else tell(made);
      } catch (error) {
        if (!(error instanceof RequestError)) throw error;
        tell(null, error.message);
      }
    }
    this.#asking = false;
  }

  /** Nothing that waits is asked any more. */
  drop() {
    this.#next = null;
  }
}
