// The strip below the photo: what is selected or under the pointer, and what can be done with it.

import { frameOf, letterOf } from "./axes.js";
import { counted, element, keyButton } from "./dom.js";
import { facePanel } from "./facedrawing.js";
import { lengthsText } from "./measuring.js";
import { isReal } from "./store.js";
import { snapText } from "./proposals.js";
import { fixesFrame } from "./tools.js";

// Why a crossing is real or not, by the key of the state.
const REASONS = {
  annotated: "as you said",
  chosen: "chosen by the program",
  "not chosen": "left out by the program",
  impossible: "its lines cannot meet before the camera",
  uninformative: "too near the horizon to tell a depth",
  unstable: "joins bodies that do not keep their place when lines are left out",
  loose: "joins bodies that fewer than two lines join",
  "small group": "its group has fewer than four lines",
  "other group": "not of the largest group, which is asked for alone",
};
const MOST_AXES = 5; // that a line may mean, the nearest first
const KINDS = { L: "L crossing", T: "T crossing", X: "X crossing", collinear: "collinear pair" };
const ORIGINS = { found: "", drawn: "drawn by you", split: "split by you", joined: "joined by you" };

export class Inspector {
  constructor(store, actions, tools) {
    Object.assign(this, { store, actions, tools });
    this.panel = document.querySelector("#inspector");
    const shown = ["state", "selection", "many", "hover", "tool", "labelling", "owner", "measure"];
    store.listen((changed) => shown.some((name) => changed.has(name)) && this.#renew());
    actions.draft.listen(() => this.#renew());
    tools.faces.listen(() => this.#renew());
    this.#renew();
  }

  /** Show what is now; who came here by keys stays on the button where they were. */
  #renew() {
    const buttons = () => [...this.panel.querySelectorAll("button")];
    const focused = buttons().indexOf(document.activeElement);
    this.#show();
    if (focused >= 0) buttons()[focused]?.focus();
  }

  #show() {
    const { store } = this;
    this.panel.classList.toggle("labelling", store.labelling);
    if (store.labelling) return this.panel.replaceChildren(...this.#labelling());
    if (store.tool === "frame") return this.panel.replaceChildren(...this.#frame());
    if (store.tool === "measure") return this.panel.replaceChildren(...this.actions.measuring.panel());
    if (store.many) return this.panel.replaceChildren(...this.actions.many.panel());
    const isDrawn = store.selectedLine && this.actions.draft.isEmpty; // the line that was drawn last
    if (store.tool === "draw" && !isDrawn) return this.panel.replaceChildren(...this.#drawing());
    if (this.tools.faces.owns) return this.panel.replaceChildren(...facePanel(store, this.tools.faces));
    const thing = store.meant;
    const found = store.find(thing);
    if (!found) return this.panel.replaceChildren(...this.#summary());
    const tell = {
      line: () => this.#line(found),
      crossing: () => this.#crossing(found),
      face: () => this.#face(found),
    };
    this.panel.replaceChildren(...tell[thing.kind]());
  }

  #summary() {
    const { lines, crossings, planes } = this.store.state;
    const faces = planes.reduce((count, plane) => count + (plane.faces ?? []).length, 0);
    const real = crossings.filter(isReal).length;
    const text = [
      counted(lines.length, "line"),
      `${counted(crossings.length, "crossing")}, ${real.toLocaleString("en")} of them real`,
      counted(planes.length, "plane"),
      counted(faces, "face"),
    ];
    return [element("p", {}, text.join(" · ")), this.#legend()];
  }

  #legend() {
    const entry = (name, text) => element("span", { class: `legend ${name}` }, text);
    return element(
      "p",
      { class: "quiet legends" },
      entry("real", "real"),
      entry("fake", "fake"),
      entry("said", "you said so"),
      entry("changed", "changed"),
    );
  }

  #crossing(crossing) {
    const found = REASONS[crossing.reason] ?? "not solved yet";
    const unsure = crossing.label === "unsure" ? `you are unsure; ${found}` : "as you said";
    const why = crossing.label === null ? found : unsure;
    const names = crossing.lines.map((id) => `${id} (${this.store.lines.get(id)?.axis ?? "gone"})`);
    const changed = crossing.changed ? ", changed by the last solve" : "";
    const text = element(
      "p",
      {},
      element("strong", {}, isReal(crossing) ? "Real" : "Fake"),
      `, ${why}${changed} · ${KINDS[crossing.kind] ?? crossing.kind} of lines ${names.join(" and ")}`,
    );
    const label = (value, name, key) =>
      keyButton(name, key, () => this.actions.label(value, crossing), {
        "aria-pressed": String(crossing.label === value),
        disabled: !this.store.owner,
      });
    return [
      text,
      element(
        "div",
        { class: "buttons" },
        label("real", "Real", "R"),
        label("fake", "Fake", "F"),
        label("unsure", "Unsure", "U"),
        label(null, "Solver decides", "G"),
      ),
    ];
  }

  #line(line) {
    const facts = [
      line.boundary ? "boundary" : null,
      line.confidence,
      line.probability === null ? null : `depth ${Math.round(100 * line.probability)} % sure`,
      line.ends && line.guess ? "its depth is a guess" : null,
      line.by_depth_map ? "placed by the depth map" : null,
      line.component > 0 ? `in ${this.#group(line.component)}` : null,
      ORIGINS[line.origin],
      line.metres === null ? null : `known to be ${line.metres} m`,
      this.#length(line),
    ];
    const text = element(
      "p",
      {},
      element("strong", {}, `Line ${line.id}`),
      ` along ${line.axis} · ${facts.filter(Boolean).join(" · ")}`,
    );
    const locked = { disabled: !this.store.owner };
    return [
      text,
      element(
        "div",
        { class: "buttons" },
        this.#axes(
          line.axis,
          (name) => this.actions.axis(name),
          () => this.actions.nextFrame(),
          locked,
        ),
        keyButton("Length", "M", () => this.actions.openLength(line), locked),
        keyButton("Delete", "Del", () => this.actions.remove(), locked),
      ),
    ];
  }

  #face({ face, plane }) {
    const { metres_per_unit: metres } = this.store.state;
    const { text, unit } = lengthsText([plane.offset], metres);
    const sure = plane.probability === null ? null : `depth ${Math.round(100 * plane.probability)} % sure`;
    const group = plane.component > 0 ? this.#group(plane.component) : null;
    const where = `plane ${plane.id} at ${plane.axis} = ${text[0]} ${unit}`;
    const facts = [where, counted(plane.lines.length, "line"), sure, group, face.guess ? "a guess" : null];
    const name = face.kind === "other" ? "Face" : `${face.kind[0].toUpperCase()}${face.kind.slice(1)}`;
    return [
      element("p", {}, element("strong", {}, name), ` · ${facts.filter(Boolean).join(" · ")}`),
      element("div", { class: "buttons" }, keyButton("Front", "Shift+F", () => this.actions.views.front())),
    ];
  }

  #group(component) {
    const found = this.store.state.groups.find((group) => group.component === component);
    return found?.name ?? `group ${component}`;
  }

  #length(line) {
    if (!line.ends) return "not in the model yet";
    const units = Math.hypot(...line.ends[0].map((at, k) => at - line.ends[1][k]));
    const metres = this.store.state.metres_per_unit;
    return metres === null ? null : `${(units * metres).toPrecision(3)} m`;
  }

  #drawing() {
    const { draft } = this.actions;
    if (draft.question) return this.#question(draft.question);
    return [element("p", {}, this.#drawingText(draft)), this.#axisButtons(this.tools.forcedAxis)];
  }

  #drawingText({ points, proposal, start }) {
    const { forcedAxis } = this.tools;
    const near = snapText(start?.snapped[0]);
    if (points.length === 0) return near ? `Click where the line begins: ${near}` : "Click where the line begins";
    if (!proposal) return "Click where the line ends";
    const off = proposal.is_bent ? `, ${Math.round(proposal.off)}° off` : "";
    const how = forcedAxis ? "fixed" : "proposed";
    const [from, to] = proposal.snapped.map(snapText);
    const snaps = `${from ? `, from ${from}` : ""}${to ? `, to ${to}` : ""}`;
    if (off && !forcedAxis) return `Along no axis: ${proposal.axis} is nearest${off}${snaps}; click where it ends`;
    return `Along ${forcedAxis ?? proposal.axis}, ${how}${off}${snaps}; click where it ends`;
  }

  /** A line that lies along no axis is not bent to the nearest: a person says along which it runs. */
  #question({ axes }) {
    const [[nearest, off]] = axes;
    const axis = ([name, degrees]) => {
      const key = name.length === 1 ? name.toUpperCase() : "";
      return keyButton(`${name}, ${Math.round(degrees)}° off`, key, () => this.tools.axis(name), {
        class: `axis ${letterOf(name)}`,
      });
    };
    const cancel = keyButton("Drop it", "Esc", () => this.actions.escape());
    const text = ` The nearest, ${nearest}, is ${Math.round(off)}° off.`;
    return [
      element("p", {}, element("strong", {}, "Along which axis does this line run?"), text),
      element("div", { class: "buttons" }, ...axes.slice(0, MOST_AXES).map(axis), cancel),
    ];
  }

  #axisButtons(current, ...more) {
    const axes = this.#axes(
      current,
      (name) => (this.tools.axis(name), this.#renew()),
      () => (this.tools.nextFrame(), this.#renew()),
    );
    return element("div", { class: "buttons" }, axes, ...more);
  }

  /** Buttons for x, y and z, and one that goes through the frames where there are several. */
  #axes(current, choose, goOn, attributes = {}) {
    const { frames } = this.store.state;
    const axis = (name) =>
      keyButton(name, name.toUpperCase(), () => choose(name), {
        ...attributes,
        class: `axis ${name}`,
        "aria-pressed": String(current !== null && letterOf(current) === name),
        "aria-label": `Axis ${name}`,
      });
    const buttons = ["x", "y", "z"].map(axis);
    if (frames > 1 && this.store.tool !== "frame") {
      const isOfAll = current === null || current === "z";
      const label = isOfAll ? "any frame" : `frame ${frameOf(current)} of ${frames}`;
      buttons.push(keyButton(label, "Q", goOn, { ...attributes, "aria-label": "Next frame" }));
    }
    return element("span", { class: "together", role: "group", "aria-label": "Axis" }, ...buttons);
  }

  #frame() {
    const { lines } = this.actions.draft;
    const count = (axis) => `${axis} ${lines.filter((line) => line.axis === axis).length}`;
    const text = `Lines drawn: ${["x", "y", "z"].map(count).join(", ")}. Two for each of two axes fix the frame.`;
    const ready = fixesFrame(lines);
    return [
      element("p", {}, text),
      this.#axisButtons(
        this.tools.frameAxis,
        keyButton("Use them", "Enter", () => this.tools.apply(), { class: "primary", disabled: !ready }),
        keyButton("Cancel", "Esc", () => (this.actions.draft.clear(), this.store.set({ tool: "correct" }))),
      ),
    ];
  }

  #labelling() {
    const { done, total } = this.store.state.labelling;
    const crossing = this.store.selectedCrossing;
    const progress = element(
      "div",
      { class: "labelled" },
      element("progress", { max: Math.max(total, 1), value: done, "aria-label": "Labelled crossings" }),
      element("span", {}, `${done} of ${total} labelled`),
    );
    if (!crossing) {
      const text = done < total ? "No crossing is chosen." : "All crossings are labelled.";
      return [
        element("p", {}, element("strong", {}, text)),
        element(
          "div",
          { class: "buttons" },
          keyButton("Next", "N", () => this.actions.nextUnlabelled(), { disabled: done === total }),
        ),
        progress,
      ];
    }
    const said =
      crossing.label === null ? `Proposal: ${crossing.real ? "real" : "fake"}.` : `You said ${crossing.label}.`;
    const label = (value, name, key) =>
      keyButton(name, key, () => this.actions.labelAndGoOn(value), {
        class: `large ${value}`,
        "aria-pressed": String(crossing.label === value),
      });
    return [
      element("p", {}, element("strong", {}, "Do these two lines meet in space? "), said),
      element(
        "div",
        { class: "buttons" },
        label("real", "Real", "R"),
        label("fake", "Fake", "F"),
        label("unsure", "Unsure", "U"),
        keyButton("Next", "N", () => this.actions.nextUnlabelled()),
      ),
      progress,
    ];
  }
}
