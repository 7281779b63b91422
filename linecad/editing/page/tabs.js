// One tab edits at a time: a second one says so, only looks, and may take over.

import { RequestError } from "./server.js";

const EVERY = 5000; // ms
const KEPT_NAME = "linecad-tab"; // of a tab that is being reloaded

/**
 * Ask the server whether this tab is the one that edits, now and again and again, and whether it still answers.
 * Returns when the first answer is there.
 */
export async function guardTab(server, store, messages, editing) {
  // A reloaded tab is the same one. A copy of a tab is not, so the name is kept only while no page is there.
  const tab = sessionStorage.getItem(KEPT_NAME) ?? crypto.randomUUID();
  sessionStorage.removeItem(KEPT_NAME);

  async function ask(takeOver = false) {
    try {
      const { owner, version } = await server.post("hello", { tab, ...(takeOver && { take_over: true }) });
      messages.keep("server", null);
      const isNew = owner && !store.owner;
      store.set({ owner });
      // A tab that only looks shows what the other one does.
      if (isNew || (!owner && version !== store.state.version)) await editing.refresh();
      const text = "This photo is open in another tab, which edits it. This one only looks.";
      messages.keep("tab", owner ? null : text, "warning", [["Edit here", () => ask(true)]]);
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      messages.keep("server", error.message, "error");
    }
  }

  addEventListener("pagehide", () => {
    sessionStorage.setItem(KEPT_NAME, tab);
    server.leave(tab);
  });
  addEventListener("pageshow", (event) => event.persisted && ask());
  await ask();
  setInterval(() => ask(), EVERY);
}
