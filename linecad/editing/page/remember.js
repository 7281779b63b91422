// What a reload brings back: zoom, tool, layers, the view of the model and what is hidden, for this tab and this photo.
// The token is no part of it.

const VERSION = 1;
const SLIDERS = ["line-opacity", "photo-opacity"];
const FOLDED = ["photo-legend", "model-legend"];
const ORBIT = ["target", "azimuth", "elevation", "distance", "inCamera"];

const keyOf = ({ name, width, height }) => `linecad-view:${name}:${width}x${height}`;

/** Put back what the tab showed before a reload, and keep it for the next one. */
export function remember(store, photo, model) {
  const key = keyOf(store.state.photo);
  const kept = read(key);
  if (kept) restore(kept, store, photo, model);
  const keep = () => sessionStorage.setItem(key, JSON.stringify(seen(store, photo, model)));
  addEventListener("pagehide", keep);
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && keep());
}

function read(key) {
  try {
    const kept = JSON.parse(sessionStorage.getItem(key));
    return kept?.version === VERSION ? kept : null;
  } catch {
    return null; // written by something else
  }
}

function seen(store, photo, model) {
  const { viewport } = photo;
  const input = (id) => document.getElementById(id);
  return {
    version: VERSION,
    middle: viewport.toPhoto([viewport.width / 2, viewport.height / 2]),
    scale: viewport.scale,
    isFitted: Math.abs(viewport.scale / viewport.fittingScale - 1) < 1e-6,
    tool: store.tool,
    labelling: store.labelling,
    layers: store.layers,
    texture: store.texture,
    selection: store.selection,
    unseen: [...store.unseen],
    locked: [...store.locked],
    orbit: Object.fromEntries(ORBIT.map((name) => [name, model.orbit[name]])),
    share: input("splitter").getAttribute("aria-valuenow"),
    sliders: SLIDERS.map((id) => input(id).value),
    folded: FOLDED.map((id) => !input(id).open),
  };
}

function restore(kept, store, photo, model) {
  const layers = { ...store.layers };
  for (const name of Object.keys(layers)) if (name in kept.layers) layers[name] = kept.layers[name];
  const { tool, labelling, texture, selection } = kept;
  const found = selection !== null && store.find(selection) ? selection : null;
  const groups = { unseen: new Set(kept.unseen), locked: new Set(kept.locked) };
  store.set({ layers, texture, tool, labelling, ...groups, selection: found });
  document.getElementById("workspace").style.setProperty("--photo-share", kept.share);
  document.getElementById("splitter").setAttribute("aria-valuenow", kept.share);
  SLIDERS.forEach((id, index) => {
    const slider = document.getElementById(id);
    slider.value = kept.sliders[index];
    slider.dispatchEvent(new Event("input"));
  });
  FOLDED.forEach((id, index) => (document.getElementById(id).open = !kept.folded[index]));
  photo.change((viewport) => (kept.isFitted ? viewport.fit() : viewport.centre(kept.middle, kept.scale)));
  model.change((orbit) => Object.assign(orbit, kept.orbit));
}
