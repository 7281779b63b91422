// The model: its lines, its faces with the photo on them, and the camera, seen from anywhere.

import { channels } from "./colours.js";
import { dashed } from "./dashes.js";
import { wheelFactor } from "./gestures.js";
import { paintGizmo } from "./gizmo.js";
import { Graphics } from "./graphics.js";
import { litStrokes } from "./lighting.js";
import { product, projected } from "./matrices.js";
import { Orbit, withoutOutliers } from "./orbit.js";
import { distance } from "./picking.js";
import { faceAlong } from "./sights.js";
import { colourOf } from "./sure.js";
import { themeColour } from "./theme.js";

const FACE_COLOURS = { x: [0.88, 0.83, 0.82], y: [0.83, 0.86, 0.82], z: [0.82, 0.84, 0.89] };
const FACE_OPACITY = { textured: 1, plain: 0.92 };
const WIDTH = { boundary: 2.6, other: 1.3, wall: 3.2 }; // CSS px
const PALER = 0.45; // what is left of the colour that tells how sure a face is
const GUESS_OPACITY = 0.7;
const GUESS_FACE = 0.25; // instead of an opacity: the shader makes such a face pale (graphics.js)
const NEARER = 0.0006; // share of the depth, so that lines are not eaten by the faces they bound
const TEXTURE_SIDE = 4096; // px; a larger photo takes more memory than it shows
const CAMERA_SHARE = 0.06; // of the size of the model, how large the camera is drawn
const LINE_REACH = 8; // CSS px
const CLICK_REACH = 4; // CSS px

/** A colour of a face, on which lines of the same colour are seen. */
function paler(colour) {
  return colour.map((value) => 1 - (1 - value) * PALER);
}

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
    this.onClick = (at) => this.store.set({ selection: this.thingAt(at) });
    this.onHover = (at) => this.store.set({ hover: this.lineAt(at) });
    this.overlays = []; // functions of the graphics and the matrix that draw more
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
    const has = (...names) => names.some((name) => changed.has(name));
    if (isNew || has("layers", "texture", "colouring", "shown", "unseen", "theme")) this.renew();
    else if (has("hover", "selection", "measure") || contradiction !== this.#built?.contradiction) this.#lightUp();
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
    const before = this.orbit.flat?.name;
    action(this.orbit);
    if (this.orbit.flat?.name !== before) this.renew(); // a plan shows no ceilings
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
    this.renew();
    this.redraw();
  }

  // --- what is drawn ---

  get points() {
    return withoutOutliers(this.store.state.lines.flatMap((line) => line.ends ?? []));
  }

  /** The corners of the faces that are shown too. */
  get allPoints() {
    const faces = this.store.state.planes.flatMap((plane) => plane.faces ?? []);
    const shown = faces.filter((face) => this.store.showsFace(face));
    return withoutOutliers([...this.points, ...shown.flatMap((face) => face.outline)]);
  }

  /** Make anew what is drawn. */
  renew() {
    this.#built = this.store.state;
    this.orbit.K = this.store.state.K;
    this.orbit.rotation = this.store.state.R_cam_from_world;
    const { points } = this;
    if (this.#isEmpty) {
      this.orbit.fit(points); // the first model
      this.onView(); // no longer through the camera
    } else this.orbit.measure(points);
    this.#isEmpty = points.length === 0;
    this.#lines = this.graphics.lines(this.#modelLines(), this.#lines);
    this.#camera = this.graphics.lines(this.#cameraLines(), this.#camera);
    this.#faces = this.graphics.triangles(this.#faceCorners(), this.#faces);
    this.#lightUp();
  }

  #modelLines() {
    const lines = this.store.state.lines
      .filter((line) => line.ends && this.store.showsLine(line))
      .flatMap((line) => (line.guess ? dashed(line, this.orbit.size) : [line]))
      .map((line) => ({
        start: line.ends[0],
        end: line.ends[1],
        colour: [...channels(colourOf(this.store, line)), line.guess ? GUESS_OPACITY : 1],
        width: (line.boundary ? WIDTH.boundary : WIDTH.other) * devicePixelRatio,
      }));
    return this.orbit.flat?.name === "plan" ? [...this.#walls(), ...lines] : lines;
  }

  /** Walls as a plan shows them: faces that stand upright are seen on edge there, as nothing. */
  #walls() {
    const look = { colour: [...themeColour("--model-ink"), 1], width: WIDTH.wall * devicePixelRatio };
    const upright = [...this.store.faces.values()].filter(({ plane }) => plane.normal[2] === 0);
    const faces = upright.filter(({ face }) => this.store.showsFace(face));
    return faces.flatMap(({ face: { outline } }) =>
      outline.map((start, index) => ({ start, end: outline[(index + 1) % outline.length], ...look })),
    );
  }

  /** The camera as a pyramid: its eye, its picture, and a mark on the upper side. */
  #cameraLines() {
    const corners = this.orbit.photoCorners(CAMERA_SHARE * this.orbit.size);
    const colour = [...themeColour("--model-ink"), 1];
    const width = 1.4 * devicePixelRatio;
    const mark = corners[0].map((at, k) => (at + corners[1][k]) / 2 - (corners[3][k] - corners[0][k]) * 0.3);
    const pairs = corners.flatMap((corner, index) => [
      [[0, 0, 0], corner],
      [corner, corners[(index + 1) % 4]],
    ]);
    return [...pairs, [corners[0], mark], [mark, corners[1]]].map(([start, end]) => ({ start, end, colour, width }));
  }

  #faceCorners() {
    const { store } = this;
    const tells = store.colouring !== "axis";
    const opacity = store.texture && !tells ? FACE_OPACITY.textured : FACE_OPACITY.plain;
    const corners = [];
    for (const plane of store.state.planes) {
      if (!store.showsPlane(plane)) continue;
      // Walls of further frames as those of x and y.
      const colour = [...(tells ? paler(channels(colourOf(store, plane))) : FACE_COLOURS[plane.axis[0]]), opacity];
      for (const face of plane.faces ?? []) {
        if (!store.showsFace(face) || (face.kind === "ceiling" && this.orbit.flat?.name === "plan")) continue;
        const points = [face.outline, ...(face.holes ?? [])].flat();
        const shown = face.guess ? [...colour.slice(0, 3), GUESS_FACE] : colour;
        for (const index of face.triangles.flat()) corners.push([...points[index], ...shown]);
      }
    }
    return corners;
  }

  #lightUp() {
    this.#built = { ...this.#built, contradiction: this.store.state.contradiction };
    this.#lit = this.graphics.lines(litStrokes(this.store), this.#lit);
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
    if (this.#lines === null) this.renew(); // the first model is fitted to the stage
    this.canvas.width = Math.round(width * devicePixelRatio);
    this.canvas.height = Math.round(height * devicePixelRatio);
    this.#paint();
  }

  #paint() {
    this.#asked = false;
    if (this.#lines === null) return; // the stage has no size yet
    const matrix = this.orbit.matrix;
    const { K, R_cam_from_world: rotation, photo } = this.store.state;
    const paper = themeColour("--model-paper");
    this.graphics.begin(paper);
    const projection = {
      pixelFromWorld: product(K, rotation),
      photoSize: [photo.width, photo.height],
      textured: this.store.texture && this.store.colouring === "axis",
      paper,
    };
    this.graphics.drawFaces(this.#faces, matrix, projection);
    this.graphics.drawLines(this.#lines, matrix, { nearer: NEARER });
    // Through the camera its pyramid would be a roof over the whole view.
    if (!this.orbit.inCamera) this.graphics.drawLines(this.#camera, matrix);
    for (const draw of this.overlays) draw(this.graphics, matrix);
    this.graphics.drawLines(this.#lit, matrix, { always: true });
    paintGizmo(this.gizmo, this.orbit.axes);
    this.canvas.dispatchEvent(new Event("painted"));
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
      if (drag && !drag.moved && event.button === 0) this.onClick(drag.at);
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
    if (!drag) return this.onHover(at);
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

  /** The line, else the face, under a point of the stage, or null. */
  thingAt(at) {
    const face = faceAlong(this.store, this.orbit.sight(at));
    return this.lineAt(at) ?? (face && { kind: "face", id: face.face.id });
  }

  /** The line under a point of the stage, or null. */
  lineAt(at) {
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
