// A number with its slider, its field and its unit. The slider covers the usual range, evenly for
// the eye; the field takes every number that makes sense.

import { element } from "./dom.js";
import { rounded } from "./units.js";

const kSteps = 1000;  // of a slider

const kCurves = {
  even: { to: (x) => x, from: (x) => x },
  log: { to: Math.log, from: Math.exp },
  root: { to: Math.sqrt, from: (x) => x * x },
};

/**
 * Fills `part` with the control. `control` has: id, label, unit, key (shown), tip (a name in
 * tips.js), from and to (the slider's ends), curve, min and max (the field's), digits, or values
 * (the only ones, in order, in place of a range), get() and set(value), shown_digits().
 * Returns {update(), nudge(steps)}.
 */
export function make_number(part, control) {
  const curve = kCurves[control.curve ?? "even"];
  const { values } = control;
  const from = values ? 0 : curve.to(control.from);
  const to = values ? values.length - 1 : curve.to(control.to);
  const steps = values ? Math.max(values.length - 1, 1) : kSteps;

  const field = element("input", { id: control.id, type: "number", step: "any",
                                   min: control.min, max: control.max, inputmode: "decimal" });
  const slider = element("input", { id: `${control.id}-slider`, type: "range", min: 0, max: steps,
                                    step: 1, "aria-label": `${control.label}, slider` });
  const label = element("label", { for: control.id }, control.label);
  if (control.key) label.append(" ", element("kbd", {}, control.key));
  const row = element("div", { class: "line" }, label);
  if (control.tip) {
    row.append(element("button", { class: "why", type: "button", "data-tip": control.tip,
                                   "aria-label": `About: ${control.label}` }, "?"));
  }
  row.append(element("span", { class: "field" }, field,
                     element("span", { class: "unit" }, control.unit ?? "")));
  part.replaceChildren(row, slider);

  const nearest = (value) => values.reduce(
      (best, x, index) => (Math.abs(x - value) < Math.abs(values[best] - value) ? index : best), 0);
  const place_of = (value) =>
      values ? nearest(value) : kSteps * (curve.to(value) - from) / (to - from);
  const value_at = (place) => {
    const at = Math.min(steps, Math.max(0, place));
    if (values) return values[Math.round(at)];
    return rounded(curve.from(from + at / kSteps * (to - from)), control.digits ?? 3);
  };
  const clamp = (value) => Math.min(control.max, Math.max(control.min, value));

  const digits_shown = control.shown_digits ?? (() => 5);

  function update() {
    const value = control.get();
    const shown = value === null || value === undefined ? "" : String(rounded(value, digits_shown()));
    if (document.activeElement !== field || Number(field.value) !== Number(shown)) {
      field.value = shown;
    }
    if (value > 0 || curve !== kCurves.log) {
      const place = Math.min(steps, Math.max(0, place_of(value ?? control.min)));
      if (document.activeElement !== slider || value_at(Number(slider.value)) !== value) {
        slider.value = place;
      }
      slider.style.setProperty("--part", `${100 * place / steps}%`);
    }
    slider.setAttribute("aria-valuetext", `${shown} ${control.unit ?? ""}`);
  }

  slider.addEventListener("input", () => control.set(value_at(Number(slider.value))));
  field.addEventListener("input", () => {
    const value = field.valueAsNumber;
    const usable = Number.isFinite(value) && value >= control.min && value <= control.max;
    field.setAttribute("aria-invalid", String(!usable));
    if (usable) control.set(value);
  });
  field.addEventListener("blur", () => {
    field.removeAttribute("aria-invalid");
    update();
  });

  return {
    update,
    /** By a key: a fiftieth of the slider a step, or to the next value. */
    nudge(count) {
      const step = values ? 1 : kSteps / 50;
      const next = value_at(Math.round(place_of(control.get())) + count * step);
      if (next !== control.get()) control.set(clamp(next));
    },
  };
}
