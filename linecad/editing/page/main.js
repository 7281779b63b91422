// Starts the page: asks for the state, builds the views, and wires them to the keys.

import { Actions } from "./actions.js";
import { startBodies } from "./bodystart.js";
import { Choosing } from "./choosing.js";
import { Crosshair } from "./crosshair.js";
import { Distant } from "./distant.js";
import { Draft } from "./draft.js";
import { Editing } from "./editing.js";
import { drawFaceTools } from "./facedrawing.js";
import { GroupList } from "./groups.js";
import { Inspector } from "./inspector.js";
import { keyHelp, keyTable, listenToKeys } from "./keys.js";
import { Labelling } from "./labelling.js";
import { fillLegends } from "./legend.js";
import { LengthDialog } from "./lengthdialog.js";
import { LineWalk } from "./linewalk.js";
import { Many } from "./many.js";
import { Measuring } from "./measuring.js";
import { Messages } from "./messages.js";
import { ModelView } from "./modelview.js";
import { Panels } from "./panels.js";
import { PhotoView } from "./photoview.js";
import { Pointer } from "./pointer.js";
import { remember } from "./remember.js";
import { RequestError, Server, takeToken } from "./server.js";
import { Solving } from "./solving.js";
import { Store } from "./store.js";
import { guardTab } from "./tabs.js";
import { startTheme } from "./theme.js";
import { Tools } from "./tools.js";
import { Views } from "./views.js";

const messages = new Messages();

async function start() {
  const token = takeToken();
  if (!token) {
    const text = "Open the whole address that linecad edit printed: its end, from # on, is missing here.";
    return messages.keep("token", text, "error");
  }
  const server = new Server(token);
  const store = new Store();
  const editing = new Editing(server, store, (text, kind) => messages.tell(text, kind));
  await editing.refresh();

  const draft = new Draft();
  const photo = new PhotoView(store, server, draft);
  const model = new ModelView(store);
  const many = new Many(store, editing, messages);
  const lineWalk = new LineWalk(store, photo, messages);
  const actions = new Actions({ store, server, editing, draft, photo, model, messages, many, lineWalk });
  const tools = new Tools(store, actions);
  photo.overlays.push((context, viewport) => drawFaceTools(context, viewport, store, tools.faces));
  const pointer = new Pointer(store, photo, tools);
  const measuring = new Measuring({ store, photo, model, pointer, actions });
  photo.overlays.push((context) => measuring.draw(context));
  actions.crosshair = new Crosshair(store, photo, pointer);
  const panels = new Panels(store, actions, pointer);
  const views = new Views(store, model, messages);
  const choosing = new Choosing(store, actions);
  Object.assign(actions, { measuring, views, choosing });
  const bodies = startBodies({ store, actions, photo, model });
  new Labelling(store, actions);
  new LengthDialog(actions);
  new GroupList(store, actions);
  fillLegends();
  new Inspector(store, actions, tools);
  new Solving(store, actions);
  new Distant(store, actions);
  const table = [...keyTable({ store, actions, tools, pointer, panels, views, choosing }), bodies.keys];
  listenToKeys(table);
  document.querySelector("#help-columns").append(...keyHelp(table));
  startTheme(store);
  remember(store, photo, model);
  await guardTab(server, store, messages, editing);
  globalThis.linecad = { store, actions, editing, photo, model, draft, bodies }; // for the console, and for the tests
  document.body.dataset.ready = "yes";
  await model.loadPhoto(server);
  document.body.dataset.photo = "shown";
}

start().catch((error) => {
  if (!(error instanceof RequestError)) throw error;
  messages.keep("start", error.message, "error", [["Try again", () => location.reload()]]);
});
