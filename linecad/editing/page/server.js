// Requests to the server that started this page: the token goes with each, and every answer that is no success throws.

const TOKEN_KEY = "linecad-token";

// What a user is to do when linecad edit has ended, or another one runs at its address.
const GONE =
  "linecad edit has ended, or does not answer. What you corrected is saved: " +
  "start it again with the same photo and go on in the page that it opens.";
const OTHER =
  "linecad edit was started again. What you corrected is saved: " +
  "close this tab and go on in the page that it opened, or open the address that it printed.";

/** An answer of the server that is no success; `status` is the HTTP status, 0 where no answer came at all. */
export class RequestError extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

/** The token from the address, or of before a reload. It leaves the address bar, so that no picture shows it. */
export function takeToken() {
  if (location.hash.length > 1) {
    sessionStorage.setItem(TOKEN_KEY, location.hash.slice(1));
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem(TOKEN_KEY);
}

/** The talk with the server at this page's own origin. */
export class Server {
  constructor(token) {
    this.token = token;
  }

  async #ask(path, options = {}) {
    const headers = { "X-Linecad-Token": this.token, ...options.headers };
    let answer;
    try {
      answer = await fetch(`/api/${path}`, { ...options, headers, cache: "no-store" });
    } catch {
      throw new RequestError(0, GONE);
    }
    if (!answer.ok) throw new RequestError(answer.status, await reason(answer));
    return answer;
  }

  /** The JSON value at a path. */
  async get(path) {
    return (await this.#ask(path)).json();
  }

  /** The JSON answer to a JSON value. */
  async post(path, value = {}) {
    const headers = { "Content-Type": "application/json" };
    return (await this.#ask(path, { method: "POST", headers, body: JSON.stringify(value) })).json();
  }

  /** Say that a tab goes; nobody is there any more to hear the answer. */
  leave(tab) {
    const headers = { "Content-Type": "application/json", "X-Linecad-Token": this.token };
    fetch("/api/hello", {
      method: "POST",
      headers,
      keepalive: true,
      body: JSON.stringify({ tab, leaving: true }),
    }).catch(() => {});
  }

  /** A tile of the photo as a bitmap that a canvas can draw. */
  tile(level, column, row, signal) {
    return this.#bitmap(`tile/${level}/${column}/${row}`, { signal });
  }

  /** A layer over the photo, of the depth map or the parts of the photo, as a bitmap of the photo's shape. */
  layer(name) {
    return this.#bitmap(name === "cells" ? name : `depth/${name}`);
  }

  async #bitmap(path, options) {
    return createImageBitmap(await (await this.#ask(path, options)).blob());
  }

  /**
   * Save what is wanted of the model (linecad/editing/wanted.py) in a format.
   *
   * Name and content are the server's, the browser asks where to or takes its folder.
   */
  async download(format, wanted = {}) {
    const query = new URLSearchParams({ wanted: JSON.stringify(wanted) });
    const answer = await this.#ask(`export/${encodeURIComponent(format)}?${query}`);
    const said = /filename="([^"]+)"/.exec(answer.headers.get("Content-Disposition") ?? "");
    const link = document.createElement("a");
    link.href = URL.createObjectURL(await answer.blob());
    link.download = said ? said[1] : `model.${format}`;
    link.click();
    // The browser has taken the content over when the click returns, but not all have read the address by then.
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    return link.download;
  }
}

async function reason(answer) {
  try {
    const { error } = await answer.json();
    if (typeof error === "string") return error;
  } catch {
    // Not JSON: the status has to do.
  }
  if (answer.status === 401) return OTHER;
  return `The server answered ${answer.status} ${answer.statusText}.`;
}
