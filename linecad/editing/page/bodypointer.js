// The pointer on bodies, in both views: clicks that select and choose, and the drag of a body along its rays.

import { depthAt } from "./bodies.js";
import { faceAt, seenTriangles } from "./bodypick.js";
import { applied, cross, dot, nearestToRay, product, projected, ray, subtract, times, unit } from "./matrices.js";
import { thingsAt } from "./picking.js";

const CLICK_REACH = 4; // CSS px that a click may slip
const SNAP_REACH = 9; // CSS px from where a snap would put the place that is dragged
const SNAP_LOG = 0.02; // log factor, where the place that is dragged hardly moves on the screen
const FARTHEST = 1.2; // log factor, of a drag
const SAMPLES = 480; // of places along a ray
const SWAY = 0.004; // log factor a CSS px, where a drag in the photo knows no ground

export class BodyPointer {
  #triangles = null; // of the photo, with the planes that they are of
  #drag = null; // {from, place(at) -> log, screen(log) -> at, moved}

  constructor(store, bodies, gestures, photo, model) {
    Object.assign(this, { store, bodies, gestures, photo, model });
    this.#listenToModel();
    this.#listenToPhoto();
  }

  get #isOn() {
    return this.store.tool === "body";
  }

  // --- the photo ---

  /** The face that is seen at a pixel of the photo, `{face, plane}`, or null. */
  faceOfPhoto(pixel) {
    const { K, R_cam_from_world: rotation, planes } = this.store.state;
    if (this.#triangles?.planes !== planes) {
      const project = product(K, rotation);
      const corner = (point) => {
        const [x, y, depth] = applied(project, point);
        return depth > 1e-6 ? [x / depth, y / depth, 1 / depth] : null;
      };
      this.#triangles = { planes, list: seenTriangles(planes, corner) };
    }
    return faceAt(this.#triangles.list, pixel);
  }

  /** A click in the photo with the tool for bodies; `at` in CSS px of the stage. */
  clickPhoto(at, viewport) {
    const [thing] = thingsAt(this.store, viewport, at, ["line"]);
    const pixel = viewport.toPhoto(at);
    const { now } = this.gestures;
    if (now?.kind === "foot" && now.first) return now.fixed ? this.gestures.take() : this.gestures.foot(pixel, true);
    this.#click(this.store.find(thing), thing ? null : this.faceOfPhoto(pixel));
  }

  #click(line, hit) {
    const { gestures, bodies } = this;
    const { now } = gestures;
    const chosen = line ?? this.#lineOfFace(hit);
    if (now && now.kind !== "place" && now.kind !== "move") {
      if (!chosen?.ends) return;
      if (!now.first) this.store.set({ selection: { kind: "line", id: chosen.id } });
      gestures.choose(chosen, line ? null : hit.plane.axis);
      if (gestures.edit && gestures.now?.second?.id === chosen.id) gestures.take();
      return;
    }
    const body = line ? line.body : (hit?.face.body ?? -1);
    this.store.set({ selection: line ? { kind: "line", id: line.id } : null });
    if (now && now.body !== undefined && body !== now.body) gestures.leave();
    if (line?.body >= 0) this.store.set({ body: line.id });
    else bodies.select(body >= 0 ? body : null);
    if (now && now.body === undefined && bodies.selected !== null) {
      gestures.leave();
      gestures.begin(now.kind);
    }
  }

  /** The line that stands for a face: the longest of its plane, rather of its own body. */
  #lineOfFace(hit) {
    if (!hit) return undefined;
    const lines = (hit.plane.lines ?? []).map((id) => this.store.lines.get(id)).filter((line) => line?.ends);
    const length = ({ segment: [[a, b], [c, d]] }) => Math.hypot(c - a, d - b);
    const own = (line) => (line.body === hit.face.body ? 1 : 0);
    return lines.sort((a, b) => own(b) - own(a) || length(b) - length(a))[0];
  }

  /** The number of the body under a place of the photo, or null. */
  #bodyInPhoto(at) {
    const [thing] = thingsAt(this.store, this.photo.viewport, at, ["line"]);
    const body = thing ? this.store.find(thing).body : this.faceOfPhoto(this.photo.viewport.toPhoto(at))?.face.body;
    return body >= 0 ? body : null;
  }

  #listenToPhoto() {
    const stage = document.querySelector("#stage");
    const canvas = this.photo.canvases.overlay;
    const at = (event) => [event.offsetX, event.offsetY];
    stage.addEventListener(
      "pointermove",
      (event) => {
        if (!this.#isOn || event.target !== canvas) return;
        if (this.#drag) return this.#dragTo(at(event), event);
        const { now } = this.gestures;
        if (now?.kind === "foot") return this.gestures.foot(this.photo.viewport.toPhoto(at(event)));
        this.store.set({ bodyHover: now ? null : this.#bodyInPhoto(at(event)) });
      },
      true,
    );
    stage.addEventListener(
      "pointerdown",
      (event) => {
        if (!this.#isOn || event.target !== canvas || event.button !== 0) return;
        if (this.gestures.now?.kind !== "move" || this.#bodyInPhoto(at(event)) !== this.gestures.now.body) return;
        this.#begin(at(event), this.#alongPhoto(at(event)), canvas, event);
      },
      true,
    );
    this.#listenToEnd(stage, canvas);
    canvas.addEventListener("pointerleave", () => this.store.set({ bodyHover: null }));
  }

  /** How a drag of the foot of a wall tells a place: where the ground is as far away as the wall would be. */
  #alongPhoto(from) {
    const { store, bodies, photo } = this;
    const start = this.gestures.now.log;
    const [thing] = thingsAt(store, photo.viewport, from, ["line"]);
    const line = store.find(thing) ?? this.#lineOfFace(this.faceOfPhoto(photo.viewport.toPhoto(from)));
    const ground = store.state.planes.find((plane) => plane.body === bodies.ground);
    const sway = (at) => start - (at[1] - from[1]) * SWAY;
    if (!ground || !line?.ends) return { place: sway, screen: null };
    const { K, R_cam_from_world: rotation } = store.state;
    const place = (at) => {
      const pixel = photo.viewport.toPhoto(at);
      const through = ray(K, rotation, pixel);
      const far = ground.offset / through[2]; // the camera depth of the ground there
      const wall = wallDepth(store.state, line, pixel, through);
      return far > 0 && wall > 0 ? Math.log(far / wall) : sway(at);
    };
    return { place, screen: null };
  }

  // --- the model ---

  #faceOfModel(at) {
    const matrix = this.model.orbit.matrix;
    const { width, height } = this.model.orbit;
    const corner = (point) => {
      const [x, y, z, w] = projected(matrix, point);
      return w > 0 ? [((x / w + 1) / 2) * width, ((1 - y / w) / 2) * height, -z / w] : null;
    };
    return faceAt(seenTriangles(this.store.state.planes, corner), at);
  }

  #listenToModel() {
    const stage = document.querySelector("#model-stage");
    const { canvas } = this.model;
    const at = (event) => [event.offsetX, event.offsetY];
    let from = null;
    stage.addEventListener(
      "pointerdown",
      (event) => {
        if (!this.#isOn || event.target !== canvas || event.button !== 0 || event.shiftKey) return void (from = null);
        from = at(event);
        if (this.gestures.now?.kind !== "move") return;
        const line = this.store.find(this.store.hover);
        const hit = line ? null : this.#faceOfModel(from);
        if ((line?.body ?? hit?.face.body) !== this.gestures.now.body) return;
        this.#begin(from, this.#alongRay(from, line, hit), canvas, event);
      },
      true,
    );
    stage.addEventListener(
      "pointermove",
      (event) => this.#drag && event.target === canvas && this.#dragTo(at(event), event),
      true,
    );
    this.#listenToEnd(stage, canvas);
    // After the view's own listener, which selects a line.
    stage.addEventListener("pointerup", (event) => {
      if (!from || !this.#isOn || event.target !== canvas) return;
      const to = at(event);
      const isClick = Math.hypot(to[0] - from[0], to[1] - from[1]) <= CLICK_REACH;
      from = null;
      if (!isClick) return;
      const line = this.store.selectedLine;
      this.#click(line, line ? null : this.#faceOfModel(to));
    });
  }

  /** How a drag in the model tells a place: the place on the ray of what was taken that is nearest to the pointer. */
  #alongRay(from, line, hit) {
    const start = this.gestures.now.log;
    const point = line ? this.#pointOfLine(line, from) : middle(hit.face.outline);
    const screen = (log) => this.model.toScreen(times(point, Math.exp(log)));
    const reach = [screen(-0.5), screen(0.5)];
    // Looked at along its ray a place does not move: then up is farther.
    const isSeen = !reach.includes(null) && Math.hypot(reach[1][0] - reach[0][0], reach[1][1] - reach[0][1]) > 30;
    if (!isSeen) return { place: (at) => start - (at[1] - from[1]) * SWAY, screen: null };
    const grip = screen(start);
    const place = (at) => {
      const aim = [0, 1].map((k) => grip[k] + at[k] - from[k]);
      let [best, least] = [start, Infinity];
      for (let index = 0; index <= SAMPLES; index++) {
        const log = FARTHEST * ((2 * index) / SAMPLES - 1);
        const seen = screen(log);
        const away = seen ? Math.hypot(seen[0] - aim[0], seen[1] - aim[1]) : Infinity;
        if (away < least) [best, least] = [log, away];
      }
      return best;
    };
    return { place, screen };
  }

  /** The point of a line that is drawn nearest to a place of the stage. */
  #pointOfLine(line, at) {
    const share = (k) => line.ends[0].map((value, axis) => value + k * (line.ends[1][axis] - value));
    const points = Array.from({ length: 21 }, (_, index) => share(index / 20));
    const away = (point) => {
      const seen = this.model.toScreen(point);
      return seen ? Math.hypot(seen[0] - at[0], seen[1] - at[1]) : Infinity;
    };
    return points.reduce((best, point) => (away(point) < away(best) ? point : best));
  }

  // --- drags, in either view ---

  #begin(from, along, canvas, event) {
    this.#drag = { from, moved: false, ...along };
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    event.stopPropagation();
  }

  #dragTo(at, event) {
    event.stopPropagation();
    const drag = this.#drag;
    if (Math.hypot(at[0] - drag.from[0], at[1] - drag.from[1]) > CLICK_REACH) drag.moved = true;
    if (!drag.moved) return;
    const log = Math.min(Math.max(drag.place(at), -FARTHEST), FARTHEST);
    const snap = event.altKey ? null : this.#caught(log, drag.screen);
    this.gestures.moveTo(snap ? snap.log : log, snap);
  }

  /** The place to snap to that is nearest to a place, if it is near. */
  #caught(log, screen) {
    const away = (snap) => {
      const ends = screen ? [screen(log), screen(snap.log)] : [null];
      const near = Math.abs(snap.log - log) / SNAP_LOG;
      if (ends.includes(null)) return near;
      return Math.hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]) / SNAP_REACH;
    };
    const [best] = (this.gestures.now.snaps ?? []).map((snap) => [away(snap), snap]).sort((a, b) => a[0] - b[0]);
    return best && best[0] < 1 ? best[1] : null;
  }

  #listenToEnd(stage, canvas) {
    stage.addEventListener(
      "pointerup",
      (event) => {
        if (!this.#drag || event.target !== canvas) return;
        const { moved } = this.#drag;
        this.#drag = null;
        event.stopPropagation();
        // Released: that is where it stands.
        if (moved) this.gestures.take();
      },
      true,
    );
    stage.addEventListener(
      "pointercancel",
      () => {
        if (this.#drag) this.gestures.leave();
        this.#drag = null;
      },
      true,
    );
  }
}

/** The camera depth at which the upright wall of a line is seen at a pixel; of an upright line itself. */
function wallDepth(state, line, pixel, through) {
  if (line.axis === "z") return depthAt(state, line, pixel);
  const normal = unit(cross(subtract(line.ends[1], line.ends[0]), [0, 0, 1]));
  return dot(normal, nearestToRay(...line.ends, through)) / dot(normal, through);
}

function middle(points) {
  return [0, 1, 2].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
}
