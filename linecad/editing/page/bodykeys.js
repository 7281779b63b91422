// The keys for bodies: rows of the table of keys, and those that mean something else while a gesture is under way.

import { GESTURES } from "./gesturelist.js";

/** A group of the table of keys (keys.js). */
export function bodyKeys({ bodies, gestures, panel }) {
  return [
    "Bodies: what stands where",
    [
      ...GESTURES.map(({ kind, key, label, first }) => ({
        keys: [key],
        shown: `Shift+${key.split("+")[1].toUpperCase()}`,
        text: `${label}: ${first[0].toLowerCase()}${first.slice(1)}; arrows choose too, Enter takes it, Esc leaves it`,
        run: () => gestures.begin(kind),
      })),
      {
        keys: ["shift+k"],
        shown: "Shift+K",
        text: "A part of the selected body, the most doubtful first; then Next place or Move",
        run: () => gestures.parts.next(),
      },
      { keys: ["shift+b"], shown: "Shift+B", text: "The list of bodies, open or shut", run: () => panel.toggle() },
      {
        keys: ["shift+pagedown"],
        shown: "Shift+PgDn",
        text: "Select the next body, by share of the photo",
        run: () => bodies.selectNext(1),
        repeats: true,
      },
      {
        keys: ["shift+pageup"],
        shown: "Shift+PgUp",
        text: "Select the body before",
        run: () => bodies.selectNext(-1),
        repeats: true,
      },
    ],
  ];
}

/** Keys that go to the gesture first: called before all others hear of the key. */
export function listenToGestureKeys(gestures) {
  const step = (direction) => (gestures.step(direction), true);
  const nudge = (direction) => (event) => (gestures.nudge(direction, event.shiftKey), true);
  const run = {
    Enter: () => (gestures.take(), true),
    Escape: () => gestures.leave(),
    ArrowRight: () => step(1),
    ArrowLeft: () => step(-1),
    ArrowDown: nudge(1),
    ArrowUp: nudge(-1),
    ...Object.fromEntries(["x", "y", "z"].map((axis) => [axis, () => turn(gestures, axis)])),
  };
  addEventListener(
    "keydown",
    (event) => {
      if (!gestures.now || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.target.closest?.("input, select, textarea, dialog, [role=menu], [role=separator]")) return;
      if (event.key === "Enter" && event.target.closest?.("button")) return;
      if (!run[event.key]?.(event)) return;
      event.preventDefault();
      event.stopPropagation();
    },
    true,
  );
}

/** The plane across an axis; pressed again, across that of the next frame which both lines allow. */
function turn(gestures, axis) {
  const { normal, normals } = gestures.now;
  const own = (normals ?? []).filter((name) => name[0] === axis);
  return own.length > 0 && gestures.turnPlane(own[(own.indexOf(normal) + 1) % own.length]);
}
