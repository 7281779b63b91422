// The tools: what a click on the photo means. Each tool is told of presses, moves and releases, in px of the photo.

import { inNextFrame } from "./axes.js";
import { FACE_TOOLS, FaceTools } from "./facetools.js";
import { Handles } from "./handles.js";
import { nearest, thingsAt } from "./picking.js";
import { Proposals } from "./proposals.js";
import { RequestError } from "./server.js";
import { faceAlong, sightOfPhoto } from "./sights.js";

/** The tools in the order of their buttons. */
export const TOOLS = [
  {
    name: "correct",
    label: "Correct",
    key: "c",
    hint: "Click a crossing to turn it from real to fake or back; click a line to select it",
  },
  {
    name: "select",
    label: "Select",
    key: "v",
    hint: "Click a line, a crossing or a face, or drag a rectangle around many",
  },
  { name: "draw", label: "Draw", key: "d", hint: "Click both ends of a line, or drag; x, y or z fixes its axis" },
  { name: "body", label: "Body", key: "b", hint: "Click a line or a face in either view: it selects its body" },
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
  ...FACE_TOOLS,
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
  reach = 0; // px of the photo within which ends snap
  #finishing = false; // the line is drawn, and whether it lies along an axis is not known yet

  constructor(store, actions) {
    this.store = store;
    this.actions = actions;
    this.draft = actions.draft;
    this.proposals = new Proposals(actions.server);
    this.handles = new Handles(store, actions.draft, actions.editing, this.proposals);
    this.faces = new FaceTools(store, actions);
    store.listen((changed) => changed.has("tool") && this.#leave());
  }

  /** Whether a drag with the left button belongs to the tool and does not move the photo. */
  get draws() {
    return this.store.tool === "draw" || this.store.tool === "frame" || this.faces.owns;
  }

  /** Whether a drag with the left button encloses what it selects. */
  get encloses() {
    return this.store.tool === "select" && !this.store.labelling;
  }

  /** Whether a drag with the left button encloses what it selects. */
  get encloses() {
    return this.store.tool === "select" && !this.store.labelling;
  }

  #leave() {
    this.forcedAxis = null;
    this.draft.clear();
  }

  /** The kinds of things that light up under the pointer. */
  get kinds() {
    if (this.store.tool === "wall") return ["line"];
    if (this.draws || this.store.tool === "measure") return [];
    return ["body", "split", "join"].includes(this.store.tool) ? ["line"] : ["crossing", "line"];
  }

  /** A click that did not move; `at` in CSS px of the stage. */
  click(at, viewport, adds) {
    const [thing] = thingsAt(this.store, viewport, at, this.kinds);
    const found = this.store.find(thing);
    switch (this.store.tool) {
      case "measure":
        return this.actions.measuring.clickPhoto(at);
      case "correct":
        if (thing?.kind === "crossing" && !this.store.labelling) return void this.actions.flip(found);
        break;
      case "body":
        return this.actions.clickBody(at, viewport);
      case "split":
        if (found) this.#edit({ op: "split", line: found.id, at: nearest(viewport.toPhoto(at), found.segment) });
        return;
      case "join":
        return this.#join(found);
      case "select":
        if (adds && thing) return this.actions.many.toggle(thing);
        if (adds) return;
    }
    const face = thing ? null : faceAlong(this.store, sightOfPhoto(this.store, viewport).along(at));
    this.store.set({ selection: thing ?? (face && { kind: "face", id: face.face.id }), many: null });
  }

  /** What a rectangle between two pixels holds is selected. */
  enclose(from, to, adds) {
    this.actions.many.enclose(from, to, adds);
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
    if (this.faces.owns) return this.faces.press(pixel);
    const { points, lines, start } = this.draft;
    if (points.length > 0) return void this.#finish(pixel);
    if (lines.length === 0) this.actions.redoBeforeDraft = this.store.state.redo;
    this.store.set({ selection: null, many: null });
    this.draft.step(lines, [this.#snapped(pixel, start)]);
  }

  /** The place that was shown as where a first end would snap to, while the pointer is near it. */
  #snapped(pixel, start) {
    if (!start?.snapped[0]?.is_end || this.store.tool === "frame") return pixel;
    const [[u, v]] = start.ends;
    return Math.hypot(u - pixel[0], v - pixel[1]) <= this.reach ? [u, v] : pixel;
  }

  follow(pixel) {
    if (this.faces.owns) return this.faces.follow(pixel);
    const [start] = this.draft.points;
    const { reach } = this;
    if (this.#finishing) return;
    if (this.store.tool === "frame") {
      if (start) this.draft.follow([start, pixel], { axis: this.frameAxis, ends: [start, pixel] });
    } else if (start) {
      if (start[0] === pixel[0] && start[1] === pixel[1]) return; // no line yet
      this.draft.follow([start, pixel], this.draft.proposal, this.draft.isForced);
      this.#propose([start, pixel]);
    } else {
      this.proposals.ask({ ends: [pixel], reach }, (near) => {
        const isAwaited = this.store.tool === "draw" && this.draft.points.length === 0;
        if (isAwaited) this.draft.hover(near?.snapped[0] ? near : null);
      });
    }
  }

  /** The end of a drag. */
  release(pixel) {
    if (this.faces.owns) return this.faces.release(pixel);
    if (this.draft.points.length > 0) this.#finish(pixel);
  }

  /** The first end was none. */
  takeBack() {
    if (this.draft.points.length > 0) this.draft.undo();
  }

  async #finish(pixel) {
    const ends = [this.draft.points[0], pixel];
    if (this.#finishing || (ends[0][0] === ends[1][0] && ends[0][1] === ends[1][1])) return;
    if (this.store.tool === "frame") return this.draft.step([...this.draft.lines, { ends, axis: this.frameAxis }], []);
    const [axis, reach] = [this.forcedAxis, this.reach];
    this.proposals.drop();
    if (axis) return this.#draw(ends, axis, reach);
    this.#finishing = true;
    try {
      const made = await this.actions.server.post("propose", { ends, axis, reach });
      if (this.draft.points.length === 0) return; // taken back meanwhile
      if (made.refused) this.actions.messages.tell(made.refused, "warning");
      else if (made.is_bent) this.draft.step(this.draft.lines, [], { ends, reach, axes: made.axes });
      else this.#draw(ends, axis, reach);
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.actions.messages.tell(error.message, "error");
    } finally {
      this.#finishing = false;
    }
  }

  /** Send the line; it is selected, so that its ends can be dragged and its axis changed. */
  async #draw(ends, axis, reach) {
    const before = new Set(this.store.lines.keys());
    this.forcedAxis = null;
    this.draft.clear();
    if (!(await this.#edit({ op: "draw", ends, axis, reach }))) return;
    const drawn = this.store.state.lines.find(({ id, origin }) => origin === "drawn" && !before.has(id));
    if (drawn && this.draft.isEmpty) this.store.set({ selection: { kind: "line", id: drawn.id } });
  }

  /** Ask what a line would become, unless a person has finished or left it when the answer comes. */
  #propose(ends) {
    const [axis, reach] = [this.forcedAxis, this.reach];
    this.proposals.ask({ ends, axis, reach }, (proposal) => {
      if (this.draft.points.length > 0 && this.draft.rubber) {
        this.draft.follow(this.draft.rubber, proposal, axis !== null);
      }
    });
  }

  /** x, y or z: of the line that is asked about or being drawn, of the next for the frame, or of the selected line. */
  axis(axis) {
    if (this.store.tool === "frame") {
      this.frameAxis = axis;
      this.draft.follow(this.draft.rubber, this.draft.proposal && { ...this.draft.proposal, axis });
    } else if (this.draft.question) {
      const { ends, reach } = this.draft.question;
      this.#draw(ends, axis, reach);
    } else if (this.store.tool === "draw" && !this.store.selectedLine) {
      this.forcedAxis = this.forcedAxis === axis ? null : axis;
      const { rubber, points } = this.draft;
      if (points.length > 0 && rubber) this.#propose(rubber);
      else this.draft.follow(null, null);
    } else this.actions.axis(axis);
  }

  /** The same axis of the next of several frames; lines for the frame are of the main one. */
  nextFrame() {
    if (this.store.state.frames === 1) this.actions.messages.tell("All lines are of one frame: x, y and z are its axes.");
    else if (this.store.tool === "frame") this.actions.messages.tell("These lines fix the main frame: x, y or z.");
    else if (this.store.tool !== "draw" || this.store.selectedLine) this.actions.nextFrame();
    else if (this.draft.question) this.axis(inNextFrame(this.draft.question.axes[0][0], this.store.state.frames));
    else {
      const axis = this.forcedAxis ?? this.draft.proposal?.axis ?? "x";
      this.axis(inNextFrame(axis, this.store.state.frames));
    }
  }

  /** Enter: the lines for the frame are all there. */
  async apply() {
    if (this.faces.owns) return this.faces.apply();
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
