// The views of the model: from above, the front of a facade, free; beside the view through the camera.

import { element } from "./dom.js";
import { cross, dot, times, unit } from "./matrices.js";

const UP = [0, 0, 1];
const LEVEL = 0.999; // cosine from the upright, from which on a plane is level

/** The plan: the axis that the camera looks along most goes up. */
export function planView(rotation) {
  const forward = rotation[2];
  const axis = Math.abs(forward[0]) > Math.abs(forward[1]) ? 0 : 1;
  const up = [0, 0, 0];
  up[axis] = Math.sign(forward[axis]) || 1;
  return { name: "plan", up, back: UP };
}

/** Straight at a plane from the side of the camera, z up; null where that is level. */
export function frontView({ normal, offset }) {
  if (Math.abs(dot(unit(normal), UP)) > LEVEL) return null;
  const back = unit([normal[0], normal[1], 0]); // of a roof the front is that of its wall
  return { name: "front", up: UP, back: offset > 0 ? times(back, -1) : back };
}

/** Straight at an upright plane that a line lies in, where no plane is known. */
function frontOfLine([start, end]) {
  const along = end.map((at, k) => at - start[k]);
  const normal = cross(along, UP);
  return Math.hypot(...normal) > 1e-6 * Math.hypot(...along) ? frontView({ normal, offset: dot(normal, start) }) : null;
}

export class Views {
  constructor(store, model, messages) {
    Object.assign(this, { store, model, messages });
    const common = { "aria-pressed": "false", disabled: !model.works };
    const button = (name, label, title, action) =>
      element("button", { ...common, "data-view": name, title, onclick: action }, label);
    this.buttons = [
      button("plan", "Plan", "From above, without perspective (Shift+P)", () => this.plan()),
      button("front", "Front", "Straight at the plane of the selected face or line (Shift+F)", () => this.front()),
      button("free", "Free", "Turn freely (Shift+O)", () => this.free()),
    ];
    const named = { class: "float views", role: "group", "aria-label": "Views of the model" };
    model.stage.append(element("div", named, ...this.buttons));
    const before = model.onView;
    model.onView = () => (before(), this.#show());
    this.#show();
  }

  #show() {
    const { orbit } = this.model;
    const now = orbit.flat?.name ?? (orbit.inCamera ? "camera" : "free");
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.view === now));
  }

  #look(flat, points) {
    this.model.change((orbit) => orbit.lookFlat(flat, points));
  }

  plan() {
    if (this.model.works) this.#look(planView(this.store.state.R_cam_from_world), [...this.model.allPoints, [0, 0, 0]]);
  }

  /** The front of the selected plane, or of the largest facade when nothing is selected. */
  front() {
    if (!this.model.works) return;
    const { store } = this;
    const line = store.selectedLine;
    const plane = store.selectedPlane ?? (store.selection ? null : largestFacade(store.state.planes));
    const view = plane ? frontView(plane) : line?.ends ? frontOfLine(line.ends) : null;
    if (plane && !view) return this.plan();
    if (!view) return this.messages.tell("Select a face, or a line of one: its front is shown.");
    const own = plane ? pointsOf(store, plane) : [];
    this.#look(view, own.length > 0 ? own : this.model.points);
  }

  free() {
    if (!this.model.works) return;
    if (this.model.orbit.inCamera) this.model.fit();
    else this.model.change((orbit) => orbit.lookFreely());
  }

  /** Rows of the table of keys. */
  keys() {
    return [
      { keys: ["shift+p"], shown: "Shift+P", text: "The model from above", run: () => this.plan() },
      { keys: ["shift+f"], shown: "Shift+F", text: "The front of the selected face or line", run: () => this.front() },
      { keys: ["shift+o"], shown: "Shift+O", text: "Turn the model freely", run: () => this.free() },
    ];
  }
}

function pointsOf(store, plane) {
  const corners = plane.faces.flatMap((face) => face.outline);
  return corners.length > 0 ? corners : plane.lines.flatMap((id) => store.lines.get(id)?.ends ?? []);
}

function largestFacade(planes) {
  const facades = planes.filter((plane) => plane.is_facade);
  return facades.sort((a, b) => extent(b) - extent(a))[0] ?? null;
}

/** The area of the outlines of a plane's faces. */
function extent(plane) {
  return plane.faces.reduce((sum, { outline }) => sum + areaOf(outline), 0);
}

function areaOf(ring) {
  const sum = [0, 0, 0];
  ring.forEach((point, index) => {
    cross(point, ring[(index + 1) % ring.length]).forEach((part, k) => (sum[k] += part / 2));
  });
  return Math.hypot(...sum);
}
