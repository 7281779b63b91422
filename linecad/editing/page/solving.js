// The search for a better model: its progress while it runs, and what came out of it.

import { counted } from "./dom.js";
import { RequestError } from "./server.js";

const POLL = 150; // ms, while it runs
const LAZY_POLL = 1000; // ms, while something is not saved yet

export class Solving {
  #timer = null;
  #ran = false;
  #since = 0; // ms, when the search was first seen to run

  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.#ran = this.running;
    this.button = document.querySelector("#solve");
    this.text = document.querySelector("#solve-text");
    this.bar = document.querySelector("#solve-progress");
    this.saved = document.querySelector("#saved");
    this.button.addEventListener("click", () => actions.solveOrStop());
    store.listen((changed) => this.#noticed(changed));
    this.#show();
    this.#showContradiction();
    this.#watch();
  }

  get running() {
    return this.store.solve.state === "running";
  }

  #noticed(changed) {
    const ended = this.#ran && !this.running;
    if (this.running && !this.#ran) this.#since = performance.now();
    this.#ran = this.running;
    if (ended) this.#ended();
    if (changed.has("solve") || changed.has("state") || changed.has("saved") || changed.has("owner")) {
      this.#show();
      this.#watch();
    }
    if (changed.has("state")) this.#showContradiction();
  }

  #watch() {
    if (this.#timer !== null || (!this.running && this.store.saved)) return;
    this.#timer = setTimeout(() => this.#ask(), this.running ? POLL : LAZY_POLL);
  }

  async #ask() {
    const wasRunning = this.running;
    try {
      const { solve, saved } = await this.actions.server.get("progress");
      // A search that was started while this was asked is not what the answer tells of.
      if (wasRunning === this.running) {
        if (wasRunning && solve.state !== "running") await this.#readModel();
        else this.store.set({ solve, saved });
      }
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.actions.messages.tell(error.message, "error");
    }
    this.#timer = null;
    this.#watch();
  }

  /** The end of a search and its model at once: until they are here, the page shows that it runs. */
  async #readModel() {
    await this.actions.editing.settled();
    await this.actions.editing.refresh();
  }

  #ended() {
    const { contradiction, crossings, solve } = this.store.state;
    const { hasAsked } = this.actions;
    this.actions.hasAsked = false;
    if (contradiction) return; // a notice says so
    if (solve.error) this.actions.messages.tell(solve.error, "error");
    else if (!hasAsked) return; // the scene was built anew behind what was said of bodies
    else if (!solve.fresh) this.actions.messages.tell("The lines changed while it was solved; solve again.", "warning");
    else {
      const changed = crossings.filter((crossing) => crossing.changed).length;
      this.actions.messages.tell(
        changed ? `Solved: ${counted(changed, "crossing")} changed; rings show where.` : "Solved: no crossing changed.",
      );
    }
  }

  #show() {
    const { store } = this;
    const { solve } = store;
    this.button.textContent = this.running ? "Stop" : "Solve again";
    this.button.classList.toggle("running", this.running && this.actions.hasAsked);
    this.button.disabled = !store.owner;
    const { fresh } = solve;
    this.button.classList.toggle("waiting", !this.running && !fresh);
    const isBehind = this.running && !this.actions.hasAsked;
    const elapsed = performance.now() - this.#since;
    const ran = this.running ? progressText(solve, elapsed) : resultText(solve, fresh);
    this.text.textContent = isBehind ? "Building the scene anew" : ran;
    this.bar.hidden = !this.running;
    // A gap that is closed is not the end: planes and faces are still to be built.
    const isSearching = !solve.stage && typeof solve.gap === "number" && solve.gap > 0;
    if (isSearching) this.bar.value = Math.max(0, 1 - Math.min(solve.gap, 1));
    else this.bar.removeAttribute("value");
    this.saved.textContent = store.saved && store.busy === 0 ? "Saved" : "Saving…";
  }

  #showContradiction() {
    const { contradiction } = this.store.state;
    const show = () => {
      const [crossing] = contradiction.crossings;
      const thing =
        crossing === undefined ? { kind: "line", id: contradiction.lines[0] } : { kind: "crossing", id: crossing };
      this.store.set({ selection: thing });
      this.actions.photo.show(thing, true);
    };
    const facts = this.store.state.facts.filter(({ edit }) => contradiction?.facts.includes(edit));
    const withdraw = facts.map(({ edit, words, lines }) => [
      `Withdraw “${words}”${facts.length > 1 ? ` of line ${lines[0]}` : ""}`,
      () => this.actions.editing.edit({ op: "withdraw", edit }),
    ]);
    this.actions.messages.keep("contradiction", contradiction?.text ?? null, "error", [
      ["Show it", show],
      ...withdraw,
      ["Undo the last change", () => this.actions.undo()],
    ]);
  }
}

function progressText(solve, elapsed) {
  const known = [];
  const isSearching = !solve.stage && typeof solve.objective === "number";
  if (solve.stage) known.push(solve.stage);
  if (isSearching) known.push(`best ${rounded(solve.objective)}`);
  if (isSearching && typeof solve.bound === "number") known.push(`bound ${rounded(solve.bound)}`);
  if (isSearching && typeof solve.gap === "number") known.push(`gap ${percent(solve.gap)}`);
  return [...(known.length > 0 ? known : ["starting"]), `${(elapsed / 1000).toFixed(0)} s`].join(" · ");
}

function resultText(solve, fresh) {
  if (!fresh) return "Your corrections are not in the model yet";
  if (typeof solve.seconds !== "number") return "";
  const gap = typeof solve.gap === "number" && solve.gap > 0 ? ` · gap ${percent(solve.gap)}` : "";
  return `${solve.status ?? "solved"} in ${solve.seconds.toFixed(1)} s${gap}`;
}

const rounded = (value) => value.toLocaleString("en", { maximumFractionDigits: 1 });
const percent = (share) => `${(100 * share).toFixed(share < 0.1 ? 2 : 0)} %`;
