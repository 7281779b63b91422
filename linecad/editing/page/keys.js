// The keys: one table, from which the help is made too.

import { element } from "./dom.js";
import { TOOLS } from "./tools.js";

/** Rows of the table: `keys` as in KeyboardEvent.key (lower case), with "ctrl+" and "shift+" before them. */
export function keyTable({ store, actions, tools, pointer, panels, views, choosing }) {
  const label = (value) => () => (store.labelling ? actions.labelAndGoOn(value) : actions.label(value));
  return [
    [
      "Crossings",
      [
        { keys: ["r"], text: "The crossing under the pointer, or the selected one, is real", run: label("real") },
        { keys: ["f"], text: "It is fake", run: label("fake") },
        { keys: ["u"], text: "You cannot tell", run: label("unsure") },
        { keys: ["g"], text: "Give it back: the solver decides", run: () => actions.label(null) },
        { keys: ["n"], text: "Next crossing without a label", run: () => actions.nextUnlabelled() },
        { keys: ["l"], text: "Labelling on and off", run: () => actions.toggleLabelling() },
      ],
    ],
    [
      "Lines",
      [
        ...["x", "y", "z"].map((axis) => ({
          keys: [axis],
          text: `The line runs along ${axis}`,
          run: () => tools.axis(axis),
        })),
        { keys: ["q"], text: "It runs along the same axis of the next frame: x, x2, x3", run: () => tools.nextFrame() },
        { keys: ["delete", "backspace"], text: "Delete the selected line", run: () => actions.remove() },
        { keys: ["m"], text: "Give its length in metres", run: () => actions.length() },
        {
          keys: ["enter"],
          text: "Click where the cross-hair is; without it, use the lines drawn for the axes",
          run: () => (actions.crosshair.isShown ? actions.crosshair.click(false) : tools.apply()),
        },
        {
          keys: ["shift+enter"],
          shown: "Shift+Enter",
          text: "At the cross-hair: hold an end of the selected line, or a corner of a rectangle; Enter lets go",
          run: () => actions.crosshair.isShown && actions.crosshair.click(true),
        },
        {
          keys: ["shift+c"],
          text: "A cross-hair in place of the mouse; arrows move it, with Shift finely",
          run: () => actions.crosshair.toggle(),
        },
        {
          keys: ["pagedown"],
          shown: "PgDn",
          text: "Select the next line, the longest first",
          run: () => actions.lineWalk.step(1),
          repeats: true,
        },
        {
          keys: ["pageup"],
          shown: "PgUp",
          text: "Select the line before",
          run: () => actions.lineWalk.step(-1),
          repeats: true,
        },
        { keys: ["."], text: "Select the next of several things under the pointer", run: () => pointer.selectNext() },
      ],
    ],
    [
      "Tools",
      TOOLS.map(({ name, label: tool, key, hint }) => ({
        keys: [key],
        text: `${tool}: ${hint[0].toLowerCase()}${hint.slice(1)}`,
        run: () => tools.faces.take(name),
      })),
    ],
    [
      "History and solving",
      [
        { keys: ["ctrl+z"], text: "Undo, also within an unfinished line", run: () => actions.undo(), repeats: true },
        { keys: ["ctrl+shift+z", "ctrl+y"], text: "Redo", run: () => actions.redo(), repeats: true },
        { keys: ["s"], text: "Solve again; while it runs, stop and keep the best", run: () => actions.solveOrStop() },
        {
          keys: ["escape"],
          text: "Leave the unfinished line or measure, the labelling, the cross-hair, the selection, the tool, in this order",
          run: () => actions.escape(),
        },
        { keys: ["e"], text: "Export", run: () => panels.openExport() },
        { keys: ["?"], text: "This help", run: () => panels.openHelp() },
      ],
    ],
    [
      "View (of the photo, or of the model when that was clicked last)",
      [
        {
          keys: ["+", "="],
          text: "Zoom in; the wheel zooms at the pointer",
          run: () => actions.zoom(1),
          repeats: true,
        },
        { keys: ["-"], text: "Zoom out", run: () => actions.zoom(-1), repeats: true },
        { keys: ["0"], text: "Fit", run: () => actions.fit() },
        { keys: ["shift+0", ")"], text: "Fit the model", run: () => actions.model.fit() },
        { keys: ["o"], text: "One photo pixel on one of the screen", run: () => actions.actualPixels() },
        { keys: ["w"], text: "Bring the selection to the middle", run: () => actions.showSelection() },
        ...[
          ["arrowleft", -1, 0],
          ["arrowright", 1, 0],
          ["arrowup", 0, -1],
          ["arrowdown", 0, 1],
        ].flatMap(([key, x, y], index) => [
          {
            keys: [key],
            shown: index === 0 ? "Arrows" : null,
            text: "Move the photo or the cross-hair; turn the model",
            run: () => actions.arrow(x, y, false),
            repeats: true,
          },
          {
            keys: [`shift+${key}`],
            shown: index === 0 ? "Shift+Arrows" : null,
            text: "Select the nearest line that way; move the cross-hair finely; move the model",
            run: () => actions.arrow(x, y, true),
            repeats: true,
          },
        ]),
        {
          keys: [" "],
          shown: "Space",
          text: "While held: drag moves the photo in every tool",
          held: (down) => panels.holdSpace(down),
        },
        { keys: ["h"], text: "While held: nothing over the photo", held: (down) => store.set({ hidden: down }) },
        { keys: ["t"], text: "See the model through the camera", run: () => panels.toggleCamera() },
        { keys: ["p"], text: "Photo on the faces of the model", run: () => store.set({ texture: !store.texture }) },
        ...views.keys(),
        ...choosing.keys(),
        ...store.offeredLayers.map(({ name, label: layer, key, about }) => ({
          keys: [key],
          text: about ?? `Show or hide: ${layer.toLowerCase()}`,
          run: () => store.toggleLayer(name),
        })),
      ],
    ],
  ];
}

/** Listen to the keys of a table, but not where text is typed or a dialog is open. */
export function listenToKeys(table) {
  const pairs = table.flatMap(([, rows]) => rows).flatMap((row) => row.keys.map((key) => [key, row]));
  const byName = new Map(pairs);
  const twice = pairs.find(([key, row]) => byName.get(key) !== row);
  if (twice) throw new Error(`the key ${twice[0]} means two things`);
  const held = new Set();
  addEventListener("keydown", (event) => {
    if (isElsewhere(event)) return;
    const row = byName.get(nameOf(event)) ?? byName.get(nameOf(event, false));
    if (!row || (isButton(event.target) && ["enter", " "].includes(nameOf(event)))) return;
    event.preventDefault();
    if (row.held) {
      if (!event.repeat) row.held(true);
      held.add(row);
    } else if (!event.repeat || row.repeats) row.run();
  });
  addEventListener("keyup", (event) => {
    const row = byName.get(event.key.toLowerCase());
    if (row?.held && held.delete(row)) row.held(false);
  });
  // A button that was clicked by the mouse gives the space bar and Enter back to the photo.
  addEventListener("click", (event) => event.detail > 0 && event.target.closest?.("button")?.blur());
  // The key goes up in another window then, and no event tells of it.
  addEventListener("blur", () => {
    for (const row of held) row.held(false);
    held.clear();
  });
}

/** "ctrl+shift+z"; a sign that needs Shift, such as "?", goes without it. */
function nameOf(event, withShift = true) {
  const control = event.ctrlKey || event.metaKey ? "ctrl+" : "";
  const shift = withShift && event.shiftKey ? "shift+" : "";
  return `${control}${shift}${event.key.toLowerCase()}`;
}

function isElsewhere(event) {
  if (event.altKey || document.querySelector("dialog[open]")) return true;
  const typed = event.target.closest?.("input, select, textarea, [role=menu], [role=separator]");
  return Boolean(typed) && !(event.ctrlKey || event.metaKey);
}

function isButton(target) {
  return target.closest?.("button, a") !== null;
}

const NAMES = {
  " ": "Space",
  delete: "Del",
  backspace: "Backspace",
  escape: "Esc",
  enter: "Enter",
  "ctrl+z": "Ctrl+Z",
  "ctrl+shift+z": "Ctrl+Shift+Z",
  "ctrl+y": "Ctrl+Y",
  "shift+0": "Shift+0",
  "shift+l": "Shift+L",
  "shift+a": "Shift+A",
  "shift+e": "Shift+E",
  "shift+w": "Shift+W",
};
const SPELLED = new Set(["=", ")"]); // the same key with and without Shift on some keyboards: one of the two is told

/** The groups of a table as elements for the help. */
export function keyHelp(table) {
  return table.map(([title, rows]) => {
    const list = rows
      .filter((row) => row.shown !== null)
      .map((row) => {
        const names = row.shown
          ? [row.shown]
          : row.keys.filter((key) => !SPELLED.has(key)).map((key) => NAMES[key] ?? key.toUpperCase());
        return element(
          "div",
          {},
          element(
            "dt",
            {},
            names.map((name) => element("kbd", {}, name)),
          ),
          element("dd", {}, row.text),
        );
      });
    return element("section", {}, element("h3", {}, title), element("dl", {}, list));
  });
}
