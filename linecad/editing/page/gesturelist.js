// What a person can say of bodies: the gestures with their keys and what they ask for.

/** The gestures in the order of their buttons; those with `second` are about two lines. */
export const GESTURES = [
  {
    kind: "meet",
    key: "shift+m",
    label: "Meet",
    first: "Click an edge of one body",
    second: "Click the edge of another body that meets it",
  },
  {
    kind: "height",
    key: "shift+h",
    label: "Same height",
    first: "Click a level line: an eave, a sill, a cornice",
    second: "Click a line at the same height",
  },
  {
    kind: "plane",
    key: "shift+j",
    label: "One plane",
    first: "Click a line or a face",
    second: "Click a line or a face in the same plane",
  },
  {
    kind: "foot",
    key: "shift+g",
    label: "On the ground",
    first: "Click a line of a wall, best an upright one",
    second: "Click where this wall meets the ground",
  },
  {
    kind: "cut",
    key: "shift+x",
    label: "Not connected",
    first: "Click a line of one part",
    second: "Click a line of the part that is not connected with it",
  },
  { kind: "place", key: "shift+n", label: "Next place", first: "Click a body" },
  { kind: "move", key: "shift+d", label: "Move", first: "Click a body" },
];

export function gestureOf(kind) {
  return GESTURES.find((gesture) => gesture.kind === kind);
}
