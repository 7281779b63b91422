// Starts the page: asks for the state, builds the views, and wires them to the keys.

import { Actions } from "./actions.js";
import { Crosshair } from "./crosshair.js";
import { Draft } from "./draft.js";
import { Editing } from "./editing.js";
import { Inspector } from "./inspector.js";
import { keyHelp, keyTable, listenToKeys } from "./keys.js";
import { Labelling } from "./labelling.js";
import { LineWalk } from "./linewalk.js";
import { Many } from "./many.js";
import { Messages } from "./messages.js";
import { ModelView } from "./modelview.js";
import { Panels } from "./panels.js";
import { PhotoView } from "./photoview.js";
import { Pointer } from "./pointer.js";
import { RequestError, Server, takeToken } from "./server.js";
import { Solving } from "./solving.js";
import { Store } from "./store.js";
import { guardTab } from "./tabs.js";
import { Tools } from "./tools.js";

const messages = new Messages();

async function start() {
  const token = takeToken();
  if (!token)
    return messages.keep("token", "Open the address that linecad edit printed: this one lacks its token.", "error");
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
  const pointer = new Pointer(store, photo, tools);
  actions.crosshair = new Crosshair(store, photo, pointer);
  const panels = new Panels(store, actions, pointer);
  new Labelling(store, actions);
  new Inspector(store, actions, tools);
  new Solving(store, actions);
  const table = keyTable({ store, actions, tools, pointer, panels });
  listenToKeys(table);
  document.querySelector("#help-columns").append(...keyHelp(table));
  await guardTab(server, store, messages, editing);
  globalThis.linecad = { store, editing, photo, model, draft }; // for the console, and for the tests
  document.body.dataset.ready = "yes";
  await model.loadPhoto(server);
  document.body.dataset.photo = "shown";
}

start().catch((error) => {
  if (!(error instanceof RequestError)) throw error;
  messages.keep("start", error.message, "error", [["Try again", () => location.reload()]]);
});
