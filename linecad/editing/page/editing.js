// Edits: each is shown at once, sent to the server one after the other, and replaced by what the server answers.

import { keepingWhatIsSame, stateOf } from "./answers.js";
import { RequestError } from "./server.js";

/** The state that an edit most likely leads to; the server's answer, a moment later, decides. */
export function expected(state, edit) {
  switch (edit.op) {
    case "label":
      return relabelled({
        ...state,
        crossings: replaced(state.crossings, edit.crossing, (crossing) => ({ ...crossing, label: edit.value })),
      });
    case "axis":
      return { ...state, lines: replaced(state.lines, edit.line, (line) => ({ ...line, axis: edit.axis })) };
    case "delete":
      return {
        ...state,
        lines: state.lines.filter((line) => line.id !== edit.line),
        crossings: state.crossings.filter((crossing) => !crossing.lines.includes(edit.line)),
      };
    case "many":
      return expectedOfMany(state, edit.edits);
    default:
      return state; // what the others lead to is geometry, which the server computes
  }
}

/** The same for one step of many edits, in one pass: there may be thousands. */
function expectedOfMany(state, edits) {
  const of = (op) => edits.filter((edit) => edit.op === op);
  const labels = new Map(of("label").map(({ crossing, value }) => [crossing, value]));
  const axes = new Map(of("axis").map(({ line, axis }) => [line, axis]));
  const gone = new Set(of("delete").map(({ line }) => line));
  const changed = (list, values, key) => {
    const change = (each) => (values.has(each.id) ? { ...each, [key]: values.get(each.id) } : each);
    return values.size === 0 ? list : list.map(change);
  };
  const [lines, crossings] = [changed(state.lines, axes, "axis"), changed(state.crossings, labels, "label")];
  if (gone.size === 0) return relabelled({ ...state, lines, crossings });
  return relabelled({
    ...state,
    lines: lines.filter((line) => !gone.has(line.id)),
    crossings: crossings.filter((crossing) => !crossing.lines.some((id) => gone.has(id))),
  });
}

function relabelled(state) {
  const done = state.crossings.filter((crossing) => crossing.label !== null).length;
  return { ...state, labelling: { ...state.labelling, done } };
}

function replaced(list, id, change) {
  return list.map((each) => (each.id === id ? change(each) : each));
}

/** The queue of what is to be sent. Nothing is sent before the answer to what went before it. */
export class Editing {
  #queue = []; // {path, edit, tried}
  #answered = null; // the last state that the server sent
  #hasAsked = false; // a search may be over before anyone asks for it: it runs until its end has been heard of
  #sending = false;
  #idle = [];

  constructor(server, store, tell) {
    this.server = server;
    this.store = store;
    this.tell = tell;
  }

  /** Take over a state that the server sent, unless the answer to a later edit has overtaken it. */
  accept(state) {
    if (state.version < this.#answered?.version) return;
    this.#take(state);
    this.#show();
  }

  /** The next answer may tell how it differs from this one, so nothing in it is changed. */
  #take(state) {
    this.#answered = keepingWhatIsSame(state, this.store.state);
    this.#hasAsked = false;
  }

  /** Make an edit as in the list of `/api/edit`; a promise of whether the server took it. */
  edit(edit) {
    return this.#push("edit", edit);
  }

  undo() {
    return this.#push("undo", null);
  }

  redo() {
    return this.#push("redo", null);
  }

  /** Start a search, after all edits before it have been taken. */
  solve() {
    return this.#push("solve", null);
  }

  /** A promise that everything has been answered. */
  settled() {
    return this.#queue.length === 0 ? Promise.resolve() : new Promise((done) => this.#idle.push(done));
  }

  async refresh() {
    this.accept(await this.#read());
  }

  /** The state as it is now, of which the server sends what the page does not have. */
  async #read() {
    const known = this.#answered;
    return stateOf(await this.server.get(known ? `state?has=${known.answer}` : "state"), known);
  }

  #push(path, edit) {
    if (!this.store.owner) {
      this.tell("Another tab edits this photo. Take over first.", "warning");
      return Promise.resolve(false);
    }
    const locked = edit ? this.store.lockedBy(edit) : undefined;
    if (locked !== undefined) {
      const group = this.store.state.groups.find(({ component }) => component === locked);
      this.tell(`${group?.name ?? `Group ${locked}`} is locked; unlock it in the list of groups.`, "warning");
      return Promise.resolve(false);
    }
    return new Promise((done) => {
      this.#queue.push({ path, edit, done, again: false });
      this.#show();
      this.#send();
    });
  }

  #show() {
    const known = this.#hasAsked ? { ...this.#answered, solve: { state: "running" } } : this.#answered;
    const state = this.#queue.reduce((shown, { edit }) => (edit ? expected(shown, edit) : shown), known);
    this.store.set({ state, busy: this.#queue.length, saved: state.saved, solve: state.solve });
  }

  async #send() {
    if (this.#sending) return;
    this.#sending = true;
    try {
      while (this.#queue.length > 0) {
        const taken = await this.#sendFirst(this.#queue[0]);
        if (taken !== undefined) this.#queue.shift().done(taken);
        this.#show();
      }
    } finally {
      this.#sending = false;
    }
    for (const done of this.#idle.splice(0)) done();
  }

  /** Whether the server took an entry; undefined where it must be sent again, on top of a newer state. */
  async #sendFirst(entry) {
    const known = this.#answered;
    const body = { base_version: known.version, has: known.answer, ...(entry.edit && { edit: entry.edit }) };
    try {
      const answer = await this.server.post(entry.path, body);
      if (entry.path === "solve") this.#hasAsked = true;
      else this.#take(stateOf(answer, known));
      return true;
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      if (error.status !== 409) {
        this.tell(error.message, "error");
        return false;
      }
      await this.#readAgain();
      // A solve that ended meanwhile made the version old, not the edit. What undo would undo is another thing now.
      if (entry.edit && !entry.again) {
        entry.again = true;
        return undefined;
      }
      this.tell("The model changed meanwhile; look at it and try again.", "warning");
      return false;
    }
  }

  async #readAgain() {
    try {
      this.#take(await this.#read());
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.tell(error.message, "error");
    }
  }
}
