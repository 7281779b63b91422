// The list of groups: what the model consists of, to name, hide and lock. What is hidden or locked is a state of the
// tab; a name is a correction, kept by the line that it was given to.

import { counted, element } from "./dom.js";

/** The set with an id in it, or without where it was in. */
function toggled(set, id) {
  const next = new Set(set);
  if (!next.delete(id)) next.add(id);
  return next;
}

export class GroupList {
  #renamed = null; // the component whose name is being written

  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.button = document.querySelector("#groups");
    this.list = document.querySelector("#group-list");
    this.button.addEventListener("click", () => this.toggle());
    store.listen((changed) => ["state", "unseen", "locked", "owner"].some((name) => changed.has(name)) && this.#show());
    this.#show();
  }

  toggle() {
    this.list.hidden = !this.list.hidden;
    this.button.setAttribute("aria-expanded", String(!this.list.hidden));
  }

  #show() {
    const { groups } = this.store.state;
    this.button.disabled = groups.length === 0;
    this.button.querySelector(".count").textContent = String(groups.length);
    if (this.list.contains(document.activeElement) && document.activeElement.matches("input")) return; // still written
    const focused = [...this.list.querySelectorAll("button")].indexOf(document.activeElement);
    this.list.replaceChildren(...groups.map((group) => this.#row(group)));
    if (focused >= 0) this.list.querySelectorAll("button")[focused]?.focus();
  }

  #row(group) {
    const { store } = this;
    const isHidden = store.hiddenGroups.has(group.component);
    const isLocked = store.lockedGroups.has(group.component);
    const share = group.share < 0.01 ? "below 1 %" : `${Math.round(100 * group.share)} %`;
    const guess =
      group.guess > 0.5 ? "depth is a guess" : group.guess > 0.1 ? `${Math.round(100 * group.guess)} % a guess` : null;
    const switches = [
      ["Hide", "hides", isHidden, () => store.set({ unseen: toggled(store.unseen, this.#mark(store.unseen, group)) })],
      ["Lock", "locks", isLocked, () => store.set({ locked: toggled(store.locked, this.#mark(store.locked, group)) })],
    ].map(([text, name, pressed, action]) =>
      element(
        "button",
        { class: name, "aria-pressed": String(pressed), "aria-label": `${text} ${group.name}`, onclick: action },
        text,
      ),
    );
    return element(
      "li",
      { class: group.guess > 0.5 ? "guess" : null },
      this.#renamed === group.component ? this.#input(group) : this.#name(group),
      element("span", { class: "quiet" }, [counted(group.lines, "line"), share, guess].filter(Boolean).join(" · ")),
      element("span", { class: "buttons" }, ...switches, this.#rename(group)),
    );
  }

  /** The line that a set knows a group by, else the one that names it: numbers of groups change with each model. */
  #mark(set, group) {
    return [...set].find((id) => this.store.lines.get(id)?.component === group.component) ?? group.line;
  }

  #name(group) {
    const select = () => {
      this.store.set({ selection: { kind: "line", id: group.line } });
      this.actions.showSelection();
    };
    const title = "Select its longest line, or the one it is named by";
    return element("button", { class: "name", title, onclick: select }, group.name);
  }

  #rename(group) {
    const start = () => {
      this.#renamed = group.component;
      this.#show();
      this.list.querySelector("input").select();
    };
    const attributes = { disabled: !this.store.owner, "aria-label": `Rename ${group.name}`, onclick: start };
    return element("button", attributes, "Rename");
  }

  #input(group) {
    const label = `Name of ${group.name}`;
    const input = element("input", { type: "text", maxlength: "60", value: group.name, "aria-label": label });
    const end = (text) => {
      if (this.#renamed === null) return;
      this.#renamed = null;
      input.blur();
      const name = text?.trim();
      if (text !== null && name !== group.name)
        this.actions.editing.edit({ op: "name", line: group.line, text: name || null });
      this.#show();
    };
    input.addEventListener("keydown", (event) => {
      event.stopPropagation(); // Ctrl+Z takes back what is written here, not a correction
      if (event.key === "Enter") end(input.value);
      if (event.key === "Escape") end(null);
    });
    input.addEventListener("blur", () => end(input.value));
    return input;
  }
}
