// The bars, menus and dialogs around the two views.

import { element, icon } from "./dom.js";
import { exportModel, LABELS } from "./exporting.js";
import { isReal } from "./store.js";
import { TOOLS } from "./tools.js";

const LABELS_ITEM = { name: LABELS, label: "crossings as a person labelled them, for linecad evaluate" };
const LABELLING_HINT = "R real, F fake, U unsure; a click chooses another crossing";
const NARROWEST = 20; // per cent of the width that either view keeps
const WIDEST = 85;
const DIVIDED = 60; // per cent for the photo, at first
const DIVIDER_STEP = 2; // per cent an arrow key

export class Panels {
  constructor(store, actions, pointer) {
    Object.assign(this, { store, actions, pointer });
    this.#makeTools();
    this.#makeLayers();
    this.#makeBar();
    this.#makeZoom();
    this.#makeModelBar();
    this.#makeNotes();
    this.#makeExport();
    this.#makeSplitter();
    document.querySelector("#photo-name").textContent = store.state.photo.name;
    document.title = `${store.state.photo.name} · linecad edit`;
  }

  // --- tools and layers ---

  #makeTools() {
    const hint = document.querySelector("#hint");
    const buttons = TOOLS.map(({ name, label, key, shown = key.toUpperCase(), hint: text }) =>
      element(
        "button",
        { "data-tool": name, title: `${text} (${shown})`, onclick: () => this.actions.faces.take(name) },
        icon(name),
        element("span", {}, label),
        element("kbd", {}, shown),
      ),
    );
    document.querySelector("#tools").append(...buttons);
    const show = () => {
      for (const button of buttons)
        button.setAttribute("aria-pressed", String(button.dataset.tool === this.store.tool));
      hint.textContent = this.store.labelling
        ? LABELLING_HINT
        : TOOLS.find(({ name }) => name === this.store.tool).hint;
    };
    this.store.listen((changed) => (changed.has("tool") || changed.has("labelling")) && show());
    show();
  }

  #makeLayers() {
    const counts = new Map();
    const buttons = this.store.offeredLayers.map(({ name, label, key, about }) => {
      const count = element("span", { class: "count" });
      counts.set(name, count);
      return element(
        "button",
        {
          class: `layer ${name}`,
          "data-layer": name,
          title: `${about ?? `Show or hide ${label.toLowerCase()}`} (${key})`,
          onclick: () => this.store.toggleLayer(name),
        },
        element("i", { "aria-hidden": "true" }),
        label,
        count,
      );
    });
    document.querySelector("#layers").prepend(...buttons);
    const show = () => {
      const { crossings } = this.store.state;
      const real = crossings.filter(isReal).length;
      const numbers = {
        real,
        fake: crossings.length - real,
        changed: crossings.filter((crossing) => crossing.changed).length,
      };
      for (const [name, number] of Object.entries(numbers)) counts.get(name).textContent = number.toLocaleString("en");
      const { depth_map: map } = this.store.state;
      for (const button of buttons) {
        const { layer } = button.dataset;
        button.setAttribute("aria-pressed", String(this.store.layers[layer]));
        // No model is there to compare with, or the map was left out; no model tells parts.
        button.disabled = layer === "cells" ? this.store.state.cells === null : map?.[layer] === null;
      }
    };
    this.store.listen((changed) => (changed.has("layers") || changed.has("state")) && show());
    show();
    for (const [slider, canvases] of [
      ["#line-opacity", ["drawing", "overlay"]],
      ["#photo-opacity", ["photo"]],
    ]) {
      const input = document.querySelector(slider);
      input.addEventListener("input", () => {
        for (const name of canvases) this.actions.photo.canvases[name].style.opacity = input.value / 100;
      });
    }
  }

  // --- the bar on top ---

  #makeBar() {
    const on = (id, action) => document.querySelector(id).addEventListener("click", action);
    on("#undo", () => this.actions.undo());
    on("#redo", () => this.actions.redo());
    on("#help", () => this.openHelp());
    const show = () => {
      const { draft } = this.actions;
      document.querySelector("#undo").disabled = !draft.canUndo && this.store.state.undo === 0 && this.store.busy === 0;
      document.querySelector("#redo").disabled = !draft.canRedo && this.store.state.redo === 0 && this.store.busy === 0;
    };
    this.store.listen((changed) => (changed.has("state") || changed.has("busy")) && show());
    this.actions.draft.listen(show);
    show();
  }

  openHelp() {
    document.querySelector("#help-dialog").showModal();
  }

  #makeExport() {
    const button = document.querySelector("#export");
    const list = document.querySelector("#export-list");
    const items = [...this.store.state.formats, LABELS_ITEM].map(({ name, label }) =>
      element(
        "li",
        { role: "none" },
        element(
          "button",
          { role: "menuitem", "data-format": name, onclick: () => this.#export(name) },
          element("b", {}, name.toUpperCase()),
          label,
        ),
      ),
    );
    list.append(...items);
    const open = (isOpen) => {
      list.hidden = !isOpen;
      button.setAttribute("aria-expanded", String(isOpen));
      if (isOpen) list.querySelector("button").focus();
    };
    this.openExport = () => open(list.hidden);
    button.addEventListener("click", () => open(list.hidden));
    list.addEventListener("keydown", (event) => {
      const all = [...list.querySelectorAll("button")];
      const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (step) all[(all.indexOf(document.activeElement) + step + all.length) % all.length].focus();
      if (event.key === "Escape" || event.key === "Tab") open(false);
      if (event.key === "Escape") button.focus();
      if (step) event.preventDefault();
    });
    addEventListener("pointerdown", (event) => !event.target.closest(".menu") && open(false));
    this.closeExport = () => open(false);
  }

  #export(format) {
    this.closeExport();
    exportModel(format, this.actions);
  }

  // --- the two views ---

  #makeZoom() {
    const { photo } = this.actions;
    const value = document.querySelector("#zoom-value");
    const on = (id, action) => document.querySelector(id).addEventListener("click", () => photo.change(action));
    on("#zoom-in", (viewport) => viewport.zoom(1.25));
    on("#zoom-out", (viewport) => viewport.zoom(1 / 1.25));
    on("#zoom-fit", (viewport) => viewport.fit());
    photo.onView = () => {
      const share = 100 * photo.viewport.scale * devicePixelRatio;
      value.textContent = `${share < 10 ? share.toFixed(1) : Math.round(share).toLocaleString("en")} %`;
    };
    photo.onView();
  }

  #makeModelBar() {
    const { model } = this.actions;
    const camera = document.querySelector("#model-camera");
    const texture = document.querySelector("#model-texture");
    for (const button of [camera, texture, document.querySelector("#model-fit")]) button.disabled = !model.works;
    camera.addEventListener("click", () => this.toggleCamera());
    texture.addEventListener("click", () => this.store.set({ texture: !this.store.texture }));
    document.querySelector("#model-fit").addEventListener("click", () => model.fit());
    model.onView = () => camera.setAttribute("aria-pressed", String(model.orbit.inCamera));
    this.store.listen(
      (changed) => changed.has("texture") && texture.setAttribute("aria-pressed", String(this.store.texture)),
    );
    model.onView();
  }

  #makeNotes() {
    const button = document.querySelector("#notes");
    const list = document.querySelector("#note-list");
    button.addEventListener("click", () => {
      list.hidden = !list.hidden;
      button.setAttribute("aria-expanded", String(!list.hidden));
    });
    const show = () => {
      const { notes, details } = this.store.state;
      button.disabled = notes.length + details.length === 0;
      button.querySelector(".count").textContent = String(notes.length);
      const rows = (lines) => element("ul", {}, ...lines.map((line) => element("li", {}, line)));
      const isOpen = list.querySelector("details")?.open ?? false;
      const summary = element("summary", {}, "What the program did");
      const more = element("details", { open: isOpen, hidden: details.length === 0 }, summary, rows(details));
      list.replaceChildren(rows(notes), more);
    };
    this.store.listen((changed) => changed.has("state") && show());
    show();
  }

  toggleCamera() {
    const { model } = this.actions;
    if (model.orbit.inCamera) model.fit();
    else model.change((orbit) => orbit.throughCamera());
  }

  holdSpace(down) {
    this.pointer.panHeld = down;
    this.pointer.showCursor();
  }

  #makeSplitter() {
    const splitter = document.querySelector("#splitter");
    const workspace = document.querySelector("#workspace");
    const put = (share) => {
      const kept = Math.min(Math.max(share, NARROWEST), WIDEST);
      splitter.setAttribute("aria-valuenow", String(Math.round(kept)));
      workspace.style.setProperty("--photo-share", String(kept));
    };
    const now = () => Number(splitter.getAttribute("aria-valuenow"));
    splitter.addEventListener("pointerdown", (event) => splitter.setPointerCapture(event.pointerId));
    splitter.addEventListener("pointermove", (event) => {
      if (!splitter.hasPointerCapture(event.pointerId)) return;
      const left = document.querySelector("#photo-pane").getBoundingClientRect().left;
      put((100 * (event.clientX - left)) / (workspace.getBoundingClientRect().right - left));
    });
    splitter.addEventListener("dblclick", () => put(DIVIDED));
    splitter.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -DIVIDER_STEP, ArrowRight: DIVIDER_STEP }[event.key];
      if (step) put(now() + step);
    });
  }
}
