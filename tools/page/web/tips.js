// What stands behind a control: a sentence, the equation, and where it is in the source.

import { by_id } from "./dom.js";
import { parameters } from "./state.js";

/** Of a parameter the sentence is the module's, by its key. */
const kTips = {
  focal_length_mm: [null, "Eq. 1: 1/f = 1/z + 1/v", "dof/lens.h, image_distance_mm"],
  f_number: [null, "Eq. 3: A = f / N", "dof/lens.h, aperture_mm"],
  focus_m: [null, "Eq. 2: c = A f |z − z_f| / (z (z_f − f))", "dof/lens.h, coc_on_film_mm"],
  max_coc_px: [null, "Eq. 10: overlap of the circles",
               "dof/dof.h, DofSettings::max_coc_px; dof/weights.h"],
  coc_scale: [null, "r = scale · (A/2) (z − z_f) / (z z_f) · height / (2 tan(fov/2))",
              "dof/lens.h, pixel_coc"],
  fov_y_degrees: [null, "film height = 2 v0 tan(fov/2)", "dof/lens.h, film_height_mm"],
  samples: [null, "mean of the views (Haeberli and Akeley 1990)",
            "scenes/lens_views/accumulation.h"],
  subject_distance: ["The camera comes nearer to what is in focus or goes back from it; the focus stays on it.",
                     "Eq. 2: c = A f |z − z_f| / (z (z_f − f))", "dof/lens.h, coc_on_film_mm"],
  backdrop_m: [null, "c = A f |z − z_f| / (z (z_f − f))", "scenes/scene.h, set_backdrop"],
  aperture_blades: [null, "a regular polygon within the circle", "dof/lens.h, Aperture"],
  aperture_turn_degrees: [null, "", "dof/lens.h, Aperture"],
  anamorphic: [null, "above 1 the width shrinks, below 1 the height", "dof/lens.h, Aperture"],
  highlight_gain: [null, "L′ = L + (gain − 1) max(L − threshold, 0)", "tools/refocus/options.h, HighlightCurve"],
  highlight_threshold: [null, "L′ = L + (gain − 1) max(L − threshold, 0)",
                        "tools/refocus/options.h, HighlightCurve"],
  object: ["A point on the axis. Drag it in the drawing, or move it here.",
           "Eq. 2: c = A f |z − z_f| / (z (z_f − f))", "dof/lens.h, coc_on_film_mm"],
  flip: ["How different two pictures look to somebody who flips between them: 0 equal, 1 most. The truth stops growing when its own noise is small against the errors.",
         "FLIP (Andersson et al. 2020)", "dof/measure; docs/measures.md; docs/ground-truth.md"],
  severity: ["How hard the case is. A method fails from the severity on at which its error passes the limit.",
             "docs/failures.md has the limits", "tools/stress/cases/stress_case.h"],
};

/** Every button of class "why" shows its tip: pointed at, focused or pressed. */
export function start_tips() {
  const tip = by_id("tip");
  let owner = null;

  function hide() {
    if (!owner) return;
    owner.removeAttribute("aria-describedby");
    owner = null;
    tip.hidden = true;
  }

  function show(button) {
    const [words, equation, source] = kTips[button.dataset.tip] ?? [null, "", "dof/lens.h"];
    hide();
    owner = button;
    tip.replaceChildren(words ?? parameters[button.dataset.tip].text, document.createElement("br"),
                        Object.assign(document.createElement("b"), { textContent: equation }),
                        document.createElement("br"),
                        Object.assign(document.createElement("code"), { textContent: source }));
    tip.hidden = false;
    button.setAttribute("aria-describedby", "tip");
    const at = button.getBoundingClientRect();
    const width = tip.offsetWidth;
    const left = Math.min(at.left, document.documentElement.clientWidth - width - 8);
    const below = at.bottom + tip.offsetHeight + 8 < window.innerHeight;
    tip.style.left = `${Math.max(8, left)}px`;
    tip.style.top = `${below ? at.bottom + 4 : at.top - tip.offsetHeight - 4}px`;
  }

  const button_of = (event) => event.target.closest?.("button.why");
  document.addEventListener("click", (event) => {
    const button = button_of(event);
    if (button) show(button);
    else hide();
  });
  document.addEventListener("mouseover", (event) => {
    const button = button_of(event);
    if (button) show(button);
    // The pointer may go onto the tip itself, to read or copy it.
    else if (owner && !event.target.closest?.("#tip") && document.activeElement !== owner) hide();
  });
  document.addEventListener("focusin", (event) => {
    const button = button_of(event);
    if (button?.matches(":focus-visible")) show(button);
    else if (!button) hide();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") hide();
  });
  document.addEventListener("scroll", hide, { capture: true, passive: true });
}
