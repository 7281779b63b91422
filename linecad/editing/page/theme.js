// Light or dark: as the system has it until a person chooses; the model takes its colours from the style sheet.

const KEPT = "linecad-theme";
const system = matchMedia("(prefers-color-scheme: dark)");

/** Which of the two is on: "light" or "dark". */
export function theme() {
  return document.documentElement.dataset.theme;
}

function apply() {
  document.documentElement.dataset.theme = localStorage.getItem(KEPT) ?? (system.matches ? "dark" : "light");
}

/** [red, green, blue], 0 to 1, of a colour of the style sheet that is given as #rrggbb. */
export function themeColour(name) {
  const colour = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255);
}

/** Wire the switch of the theme, and tell the store which one is on. */
export function startTheme(store) {
  const button = document.querySelector("#theme");
  const show = () => {
    apply();
    button.setAttribute("aria-pressed", String(theme() === "dark"));
    store.set({ theme: theme() });
  };
  button.addEventListener("click", () => {
    const next = theme() === "dark" ? "light" : "dark";
    // Who chooses what the system has goes with the system again.
    if (next === (system.matches ? "dark" : "light")) localStorage.removeItem(KEPT);
    else localStorage.setItem(KEPT, next);
    show();
  });
  system.addEventListener("change", show);
  show();
}

apply();
