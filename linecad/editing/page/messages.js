// What the page tells: short news that float and go by themselves, and notices below the bar that stay while they hold.

const SECONDS = { info: 5, warning: 8, error: 12 };
const MOST = 2; // messages that float at a time; an older one gives way

export class Messages {
  #list = document.querySelector("#messages");
  #notices = document.querySelector("#notices");
  #lasting = new Map(); // name -> element

  /** Say something for some seconds. The same text is not said twice at a time, nor beside a notice that says it. */
  tell(text, kind = "info") {
    if ([...this.#notices.children].some((notice) => notice.dataset.text === text)) return;
    this.#dismiss(text);
    const message = this.#add(this.#list, text, kind);
    message.append(button("×", () => message.remove(), "Close this message"));
    while (this.#list.children.length > MOST) this.#list.firstChild.remove();
    setTimeout(() => message.remove(), 1000 * SECONDS[kind]);
  }

  /** A notice that stays until it is called with the text null; `choices` are [label, action] pairs. */
  keep(name, text, kind = "warning", choices = []) {
    const shown = this.#lasting.get(name);
    if (shown?.dataset.text === text) return;
    shown?.remove();
    this.#lasting.delete(name);
    if (text === null) return;
    this.#dismiss(text);
    const message = this.#add(this.#notices, text, kind);
    message.append(...choices.map(([label, action]) => button(label, action)));
    this.#lasting.set(name, message);
  }

  #dismiss(text) {
    for (const shown of [...this.#list.children]) if (shown.dataset.text === text) shown.remove();
  }

  #add(list, text, kind) {
    const message = document.createElement("p");
    message.className = `message ${kind}`;
    message.dataset.text = text;
    const words = document.createElement("span");
    words.textContent = text;
    message.append(words);
    list.append(message);
    return message;
  }
}

function button(label, action, name) {
  const made = document.createElement("button");
  made.textContent = label;
  if (name) made.setAttribute("aria-label", name);
  made.addEventListener("click", action);
  return made;
}
