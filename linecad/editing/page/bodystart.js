// Puts together what the page has for bodies.

import { Bodies } from "./bodies.js";
import { BodyGestures } from "./bodygestures.js";
import { bodyKeys, listenToGestureKeys } from "./bodykeys.js";
import { BodyPanel } from "./bodypanel.js";
import { BodyPointer } from "./bodypointer.js";
import { BodyView } from "./bodyview.js";
import { GestureBar } from "./gesturebar.js";
import { SaidList } from "./saidlist.js";

/** `{bodies, gestures, view, said, pointer, keys}`; `actions.clickBody` is what a click of the tool does from now on. */
export function startBodies({ store, actions, photo, model }) {
  const bodies = new Bodies(store);
  const gestures = new BodyGestures(store, actions, bodies);
  const pointer = new BodyPointer(store, bodies, gestures, photo, model);
  const view = new BodyView(store, bodies, gestures, photo, model);
  const said = new SaidList(store, actions, bodies);
  const panel = new BodyPanel(store, actions, bodies, gestures, said);
  new GestureBar(gestures);
  actions.clickBody = (at, viewport) => pointer.clickPhoto(at, viewport);
  listenToGestureKeys(gestures);
  return { bodies, gestures, view, said, pointer, panel, keys: bodyKeys({ bodies, gestures, panel }) };
}
