// The tools: what a click on the photo means. Each tool is told of presses, moves and releases, in px of the photo.

import { inNextFrame } from "./axes.js";
import { nearest, thingsAt } from "./picking.js";
import { faceAlong, sightOfPhoto } from "./sights.js";

/** The tools in the order of their buttons. */
export const TOOLS = [
  {
    name: "correct",
    label: "Correct",
    key: "c",
    hint: "Click a crossing to turn it from real to fake or back; click a line to select it",
  },
  { name: "select", label: "Select", key: "v", hint: "Click a line, a crossing or a face to see what it is" },
  { name: "draw", label: "Draw", key: "d", hint: "Click both ends of a line, or drag; x, y or z fixes its axis" },
  { name: "split", label: "Split", key: "k", hint: "Click where a line is to be cut in two" },
  { name: "join", label: "Join", key: "j", hint: "Click two lines that are one" },
  {
    name: "measure",
    label: "Measure",
    key: "i",
    hint: "Click two points of lines or faces, here or in the model; M gives their distance, which sets the scale",
  },
  {
    name: "frame",
    label: "Axes",
    key: "a",
    hint: "Draw lines along the axes: two or more for two of them; then Enter",
  },
];

const FRAME_AXES = 2; // axes that fix a frame
const FRAME_LINES = 2; // lines that fix a vanishing point

/** Whether lines drawn for the frame suffice: two for each of two axes. */
export function fixesFrame(lines) {
  const enough = ["x", "y", "z"].filter((axis) => lines.filter((line) => line.axis === axis).length >= FRAME_LINES);
  return enough.length >= FRAME_AXES;
}

export class Tools {
  forcedAxis = null; // of the line that is being drawn
  frameAxis = "x"; // of the next line for the frame
  #asking = false;
  #asked = null; // what to ask next, while an answer is awaited

  constructor(store, actions) {
    this.store = store;
    this.actions = actions;
    this.draft = actions.draft;
    store.listen((changed) => changed.has("tool") && this.#leave());
  }

  /** Whether a drag with the left button belongs to the tool and does not move the photo. */
  get draws() {
    return this.store.tool === "draw" || this.store.tool === "frame";
  }

  #leave() {
    this.forcedAxis = null;
    this.draft.clear();
  }

  /** The kinds of things that light up under the pointer. */
  get kinds() {
    if (this.draws || this.store.tool === "measure") return [];
    return this.store.tool === "split" || this.store.tool === "join" ? ["line"] : ["crossing", "line"];
  }

  /** A click that did not move; `at` in CSS px of the stage. */
  click(at, viewport) {
    const [thing] = thingsAt(this.store, viewport, at, this.kinds);
    const found = this.store.find(thing);
    switch (this.store.tool) {
      case "measure":
        return this.actions.measuring.clickPhoto(at);
      case "correct":
        if (thing?.kind === "crossing" && !this.store.labelling) return void this.actions.flip(found);
        break;
      case "split":
        if (found) this.#edit({ op: "split", line: found.id, at: nearest(viewport.toPhoto(at), found.segment) });
        return;
      case "join":
        return this.#join(found);
    }
    const face = thing ? null : faceAlong(this.store, sightOfPhoto(this.store, viewport).along(at));
    this.store.set({ selection: thing ?? (face && { kind: "face", id: face.face.id }) });
  }

  #join(line) {
    const first = this.store.selectedLine;
    if (!line || !first || first.id === line.id) {
      this.store.set({ selection: line ? { kind: "line", id: line.id } : null });
      return;
    }
    this.#edit({ op: "join", lines: [first.id, line.id] });
    this.store.set({ selection: null });
  }

  // --- drawing ---

  /** The first end, or the second by a second click. */
  press(pixel) {
    const { points, lines } = this.draft;
    if (points.length > 0) return this.#finish(pixel);
    if (lines.length === 0) this.actions.redoBeforeDraft = this.store.state.redo;
    this.draft.step(lines, [pixel]);
  }

  follow(pixel) {
    const [start] = this.draft.points;
    if (!start) return;
    if (this.store.tool === "frame") this.draft.follow([start, pixel], { axis: this.frameAxis, ends: [start, pixel] });
    else {
      this.draft.follow([start, pixel], this.draft.proposal);
      this.#propose({ ends: [start, pixel], axis: this.forcedAxis });
    }
  }

  /** The end of a drag. */
  release(pixel) {
    if (this.draft.points.length > 0) this.#finish(pixel);
  }

  #finish(pixel) {
    const ends = [this.draft.points[0], pixel];
    if (ends[0][0] === ends[1][0] && ends[0][1] === ends[1][1]) return;
    if (this.store.tool === "frame") return this.draft.step([...this.draft.lines, { ends, axis: this.frameAxis }], []);
    const axis = this.forcedAxis;
    this.#asked = null;
    this.forcedAxis = null;
    this.draft.clear();
    this.#edit({ op: "draw", ends, axis });
  }

  /** Ask what a line would become, one question at a time: the pointer is faster than the answers. */
  async #propose(question) {
    this.#asked = question;
    if (this.#asking) return;
    this.#asking = true;
    while (this.#asked) {
      const asked = this.#asked;
      this.#asked = null;
      try {
        const proposal = await this.actions.server.post("propose", asked);
        if (this.draft.points.length > 0 && this.draft.rubber) this.draft.follow(this.draft.rubber, proposal);
      } catch {
        if (this.draft.points.length > 0) this.draft.follow(this.draft.rubber, null); // nothing can be made of it
      }
    }
    this.#asking = false;
  }

  /** x, y or z: the axis of the line that is being drawn, of the next one for the frame, or of the selected line. */
  axis(axis) {
    if (this.store.tool === "frame") {
      this.frameAxis = axis;
      this.draft.follow(this.draft.rubber, this.draft.proposal && { ...this.draft.proposal, axis });
    } else if (this.store.tool === "draw") {
      this.forcedAxis = this.forcedAxis === axis ? null : axis;
      const { rubber, points } = this.draft;
      if (points.length > 0 && rubber) this.#propose({ ends: rubber, axis: this.forcedAxis });
      else this.draft.follow(null, null);
    } else this.actions.axis(axis);
  }

  /** The same axis of the next of several frames; lines for the frame are of the main one. */
  nextFrame() {
    if (this.store.state.frames === 1) this.actions.messages.tell("All lines are of one frame: x, y and z are its axes.");
    else if (this.store.tool === "frame") this.actions.messages.tell("These lines fix the main frame: x, y or z.");
    else if (this.store.tool !== "draw") this.actions.nextFrame();
    else {
      const axis = this.forcedAxis ?? this.draft.proposal?.axis ?? "x";
      this.axis(inNextFrame(axis, this.store.state.frames));
    }
  }

  /** Enter: the lines for the frame are all there. */
  async apply() {
    if (this.store.tool !== "frame" || this.draft.lines.length === 0) return;
    if (!fixesFrame(this.draft.lines)) {
      this.actions.messages.tell("Draw at least two lines for each of two axes.", "warning");
      return;
    }
    const lines = this.draft.lines;
    if (await this.#edit({ op: "frame", lines })) {
      this.draft.clear();
      this.store.set({ tool: "correct" });
    }
  }

  #edit(edit) {
    return this.actions.editing.edit(edit);
  }
}
