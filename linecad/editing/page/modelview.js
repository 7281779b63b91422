// The model: its lines, its faces with the photo on them, and the camera, seen from anywhere.

import { AXIS, INK, WRONG, channels } from "./colours.js";
import { wheelFactor } from "./gestures.js";
import { Graphics } from "./graphics.js";
import { nearestToRay, product, projected, ray } from "./matrices.js";
import { Orbit, withoutOutliers } from "./orbit.js";
import { distance } from "./picking.js";

const PAPER = [0.965, 0.965, 0.97];
const FACE_COLOURS = { x: [0.88, 0.83, 0.82], y: [0.83, 0.86, 0.82], z: [0.82, 0.84, 0.89] };
const FACE_OPACITY = { textured: 1, plain: 0.92 };
const WIDTH = { boundary: 2.6, other: 1.3, lit: 4.5 }; // CSS px
const GUESS_OPACITY = 0.45;
const NEARER = 0.0006; // share of the depth, so that lines are not eaten by the faces they bound
const TEXTURE_SIDE = 4096; // px; a larger photo takes more memory than it shows
const CAMERA_SHARE = 0.06; // of the size of the model, how large the camera is drawn
const LINE_REACH = 8; // CSS px
const CLICK_REACH = 4; // CSS px

/** The right half of the page. Without WebGL 2 it says so and does nothing else. */
export class ModelView {
  #asked = false;
  #lines = null;
  #camera = null;
  #faces = null;
  #lit = null;
  #drag = null;
  #isEmpty = true;
  #built = null; // the state that the buffers hold

  constructor(store) {
    this.store = store;
    this.canvas = document.querySelector("#model-canvas");
    this.stage = document.querySelector("#model-stage");
    this.gizmo = document.querySelector("#gizmo");
    this.orbit = new Orbit(store.state.photo, store.state.K, store.state.R_cam_from_world);
    this.onView = () => {};
    try {
      this.graphics = new Graphics(this.canvas);
    } catch {
      this.#say("The model needs WebGL 2, which this browser does not offer. The photo side works without it.");
      return;
    }
    this.canvas.addEventListener("webglcontextlost", () =>
      this.#say("The graphics card was lost; reload the page to see the model."),
    );
    store.listen((changed) => this.#noticed(changed));
    this.#listenToPointer();
    new ResizeObserver(() => this.#resized()).observe(this.stage);
    this.#resized();
  }

  get works() {
    return this.graphics !== undefined;
  }

  #say(text) {
    const note = document.querySelector("#model-note");
    note.textContent = text;
    note.hidden = false;
  }

  #noticed(changed) {
    const { lines, planes, contradiction } = this.store.state;
    const isNew = changed.has("state") && (lines !== this.#built?.lines || planes !== this.#built.planes);
    if (isNew || changed.has("layers") || changed.has("texture")) this.#rebuild();
    else if (changed.has("hover") || changed.has("selection") || contradiction !== this.#built?.contradiction)
      this.#lightUp();
    else return;
    // One picture of the screen later: a click on the photo is not to wait for the model to be drawn.
    requestAnimationFrame(() => this.redraw());
  }

  /** How many strokes light something up. */
  get litCount() {
    return this.#lit.count;
  }

  change(action) {
    if (!this.works) return;
    action(this.orbit);
    this.redraw();
    this.onView();
  }

  fit() {
    this.change((orbit) => orbit.fit(this.points));
  }

  /** Take over the photo, in the largest level that fits the card and the memory. */
  async loadPhoto(server) {
    if (!this.works) return;
    const { photo } = this.store.state;
    const side = Math.min(this.graphics.largestTexture, TEXTURE_SIDE);
    const size = (level) => [Math.ceil(photo.width / 2 ** level), Math.ceil(photo.height / 2 ** level)];
    let level = 0;
    while (level < photo.levels - 1 && Math.max(...size(level)) > side) level++;
    const [width, height] = size(level);
    this.graphics.preparePhoto(width, height);
    const loads = [];
    for (let row = 0; row * photo.tile < height; row++) {
      for (let column = 0; column * photo.tile < width; column++) {
        const load = async () => {
          const bitmap = await server.tile(level, column, row);
          this.graphics.addTile(bitmap, column * photo.tile, row * photo.tile);
          bitmap.close();
        };
        loads.push(load());
      }
    }
    await Promise.all(loads);
    this.graphics.finishPhoto();
    this.#rebuild();
    this.redraw();
  }

  // --- what is drawn ---

  get points() {
    return withoutOutliers(this.store.state.lines.flatMap((line) => line.ends ?? []));
  }

  #rebuild() {
    this.#built = this.store.state;
    this.orbit.K = this.store.state.K;
    this.orbit.rotation = this.store.state.R_cam_from_world;
    const { points } = this;
    if (this.#isEmpty)
      this.orbit.fit(points); // the first model
    else this.orbit.measure(points);
    this.#isEmpty = points.length === 0;
    this.#lines = this.graphics.lines(this.#modelLines(), this.#lines);
    this.#camera = this.graphics.lines(this.#cameraLines(), this.#camera);
    this.#faces = this.graphics.triangles(this.#faceCorners(), this.#faces);
    this.#lightUp();
  }

  #modelLines() {
    return this.store.state.lines
      .filter((line) => line.ends && this.store.showsLine(line))
      .map((line) => ({
        start: line.ends[0],
        end: line.ends[1],
        colour: [...channels(AXIS[line.axis]), line.guess ? GUESS_OPACITY : 1],
        width: (line.boundary ? WIDTH.boundary : WIDTH.other) * devicePixelRatio,
      }));
  }

  /** The camera as a pyramid: its eye, its picture, and a mark on the upper side. */
  #cameraLines() {
    const corners = this.orbit.photoCorners(CAMERA_SHARE * this.orbit.size);
    const colour = [...channels(INK), 1];
    const width = 1.4 * devicePixelRatio;
    const mark = corners[0].map((at, k) => (at + corners[1][k]) / 2 - (corners[3][k] - corners[0][k]) * 0.3);
    const pairs = corners.flatMap((corner, index) => [
      [[0, 0, 0], corner],
      [corner, corners[(index + 1) % 4]],
    ]);
    return [...pairs, [corners[0], mark], [mark, corners[1]]].map(([start, end]) => ({ start, end, colour, width }));
  }

  #faceCorners() {
    if (!this.store.layers.faces) return [];
    const opacity = this.store.texture ? FACE_OPACITY.textured : FACE_OPACITY.plain;
    const corners = [];
    for (const plane of this.store.state.planes) {
      const colour = [...FACE_COLOURS[plane.axis[0]], opacity]; // walls of further frames as those of x and y
      for (const face of plane.faces ?? []) {
        const points = [face.outline, ...(face.holes ?? [])].flat();
        for (const index of face.triangles.flat()) corners.push([...points[index], ...colour]);
      }
    }
    return corners;
  }

  /** Where a crossing is on each of its lines: one point when it is real, two when it is not. */
  #crossingInSpace(crossing) {
    const { K, R_cam_from_world: rotation } = this.store.state;
    const through = ray(K, rotation, crossing.pixel);
    const lines = crossing.lines.map((id) => this.store.lines.get(id)).filter((line) => line?.ends);
    return lines.map((line) => nearestToRay(...line.ends, through));
  }

  #lightUp() {
    this.#built = { ...this.#built, contradiction: this.store.state.contradiction };
    const wrong = this.store.state.contradiction?.lines ?? [];
    const lit = wrong.map((id) => [{ kind: "line", id }, channels(WRONG)]);
    for (const thing of [this.store.selection, this.store.hover]) if (thing) lit.push([thing, channels(INK)]);
    this.#lit = this.graphics.lines(
      lit.flatMap(([thing, colour]) => this.#litLines(thing, colour)),
      this.#lit,
    );
  }

  #litLines(thing, colour) {
    const found = this.store.find(thing);
    if (!found) return [];
    const lineLit = (line) => {
      const [start, end] = line.ends;
      return [
        { start, end, colour: [...colour, 1], width: (WIDTH.lit + 2.4) * devicePixelRatio },
        { start, end, colour: [...channels(AXIS[line.axis]), 1], width: (WIDTH.lit - 1.6) * devicePixelRatio },
      ];
    };
    if (thing.kind === "line") return found.ends ? lineLit(found) : [];
    const points = this.#crossingInSpace(found);
    const lines = found.lines
      .map((id) => this.store.lines.get(id))
      .filter((line) => line?.ends)
      .flatMap(lineLit);
    const dots = points.map((point) => ({
      start: point,
      end: point,
      colour: [...colour, 1],
      width: 11 * devicePixelRatio,
    }));
    const apart =
      points.length === 2
        ? [{ start: points[0], end: points[1], colour: [...colour, 0.8], width: 1.5 * devicePixelRatio }]
        : [];
    return [...lines, ...apart, ...dots];
  }

  redraw() {
    if (!this.works || this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => this.#paint());
  }

  #resized() {
    const [width, height] = [this.stage.clientWidth, this.stage.clientHeight];
    if (width === 0 || height === 0) return;
    Object.assign(this.orbit, { width, height });
    if (this.#lines === null) this.#rebuild(); // the first model is fitted to the stage
    this.canvas.width = Math.round(width * devicePixelRatio);
    this.canvas.height = Math.round(height * devicePixelRatio);
    this.#paint();
  }

  #paint() {
    this.#asked = false;
    if (this.#lines === null) return; // the stage has no size yet
    const matrix = this.orbit.matrix;
    const { K, R_cam_from_world: rotation, photo } = this.store.state;
    this.graphics.begin(PAPER);
    const projection = {
      pixelFromWorld: product(K, rotation),
      photoSize: [photo.width, photo.height],
      textured: this.store.texture,
    };
    this.graphics.drawFaces(this.#faces, matrix, projection);
    this.graphics.drawLines(this.#lines, matrix, { nearer: NEARER });
    // Through the camera its pyramid would be a roof over the whole view.
    if (!this.orbit.inCamera) this.graphics.drawLines(this.#camera, matrix);
    this.graphics.drawLines(this.#lit, matrix, { always: true });
    this.#paintGizmo();
    this.canvas.dispatchEvent(new Event("painted"));
  }

  /** The three axes as they lie now. */
  #paintGizmo() {
    const side = 72; // CSS px
    this.gizmo.width = this.gizmo.height = side * devicePixelRatio;
    const context = this.gizmo.getContext("2d");
    context.scale(devicePixelRatio, devicePixelRatio);
    context.translate(side / 2, side / 2);
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineWidth = 2.4;
    context.lineCap = "round";
    const arms = ["x", "y", "z"].map((name, axis) => [name, this.orbit.axes.map((direction) => direction[axis])]);
    for (const [name, [right, up]] of arms.sort((a, b) => a[1][2] - b[1][2])) {
      context.strokeStyle = context.fillStyle = AXIS[name];
      context.beginPath();
      context.moveTo(0, 0);
      context.lineTo(22 * right, -22 * up);
      context.stroke();
      context.fillText(name, 29 * right, -29 * up);
    }
  }

  // --- the pointer ---

  #listenToPointer() {
    const on = (name, handler, options) => this.canvas.addEventListener(name, handler, options);
    on("pointerdown", (event) => {
      this.canvas.focus({ preventScroll: true });
      this.canvas.setPointerCapture(event.pointerId);
      const at = [event.offsetX, event.offsetY];
      this.#drag = { at, from: at, moved: false, pans: event.button !== 0 || event.shiftKey };
    });
    on("pointermove", (event) => this.#move([event.offsetX, event.offsetY]));
    on("pointerup", (event) => {
      const drag = this.#drag;
      this.#drag = null;
      if (drag && !drag.moved && event.button === 0) this.store.set({ selection: this.#lineAt(drag.at) });
    });
    on("pointercancel", () => (this.#drag = null));
    on("pointerleave", () => this.#drag || this.store.set({ hover: null }));
    on("contextmenu", (event) => event.preventDefault());
    const wheel = (event) => {
      event.preventDefault();
      this.change((orbit) => orbit.zoom(wheelFactor(event), [event.offsetX, event.offsetY]));
    };
    on("wheel", wheel, { passive: false });
  }

  #move(at) {
    const drag = this.#drag;
    if (!drag) return this.store.set({ hover: this.#lineAt(at) });
    if (Math.hypot(at[0] - drag.from[0], at[1] - drag.from[1]) > CLICK_REACH) drag.moved = true;
    if (!drag.moved) return;
    const step = [at[0] - drag.at[0], at[1] - drag.at[1]];
    drag.at = at;
    this.change((orbit) => (drag.pans ? orbit.pan(...step) : orbit.orbit(...step)));
  }

  /** CSS px of the stage where a point of the world is seen; null behind the eye. */
  toScreen(point, matrix = this.orbit.matrix) {
    const [x, y, , w] = projected(matrix, point);
    return w > 0 ? [((x / w + 1) / 2) * this.orbit.width, ((1 - y / w) / 2) * this.orbit.height] : null;
  }

  /** The line under a point of the stage, or null. */
  #lineAt(at) {
    const matrix = this.orbit.matrix;
    let best = null;
    let reach = LINE_REACH;
    for (const line of this.store.state.lines) {
      if (!line.ends || !this.store.showsLine(line)) continue;
      const ends = line.ends.map((point) => this.toScreen(point, matrix));
      if (ends.includes(null)) continue;
      const away = distance(at, ends);
      if (away < reach) [best, reach] = [{ kind: "line", id: line.id }, away];
    }
    return best;
  }
}
