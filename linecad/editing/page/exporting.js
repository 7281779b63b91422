// Saving the model in a format: not before it holds what was said.

const LOOK = 50; // ms between looks whether the solve has ended
export const LABELS = "labels"; // what a person said alone: no model is waited for

/** Write the model as it is wanted, and tell how that went; what is built behind the last edits is waited for. */
export async function exportModel(format, { store, editing, choosing, messages, server }) {
  const name = format.toUpperCase();
  try {
    await editing.settled();
    if (isBehind(store) && format !== LABELS) {
      messages.tell(`${name} is written when the model holds your corrections; the bar below tells how far it is.`);
      while (isBehind(store)) await new Promise((done) => setTimeout(done, LOOK));
      await editing.settled();
      await editing.refresh();
    } else messages.tell(`Writing ${name}…`);
    const file = await server.download(format, choosing.wanted(format));
    if (store.solve.fresh || format === LABELS) messages.tell(`Saved ${file}.`);
    else messages.tell(`Saved ${file} without your last corrections, which need to be solved.`, "warning");
  } catch (error) {
    messages.tell(error.message, "error");
  }
}

/** Whether a model is on its way that holds more than the one that is there. */
function isBehind(store) {
  return store.solve.state === "running" && !store.solve.fresh;
}
