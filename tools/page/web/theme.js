// Light or dark: as the system has it, or as the visitor says.

import { by_id } from "./dom.js";

const kThemes = ["system", "light", "dark"];

export function start_theme() {
  const button = by_id("theme");
  let at = 0;
  try {
    at = Math.max(0, kThemes.indexOf(localStorage.getItem("softfocus-theme")));
  } catch {
    // Storage may be refused; then the choice lasts as long as the page.
  }
  function apply() {
    const theme = kThemes[at];
    if (theme === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
    const words = theme === "system" ? "as the system" : theme;
    button.setAttribute("aria-label", `Colours: ${words}`);
    button.title = `Colours: ${words}`;
  }
  button.addEventListener("click", () => {
    at = (at + 1) % kThemes.length;
    try {
      localStorage.setItem("softfocus-theme", kThemes[at]);
    } catch {
      // As above.
    }
    apply();
  });
  apply();
}
