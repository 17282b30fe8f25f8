// A number with its slider, its field and its unit. The slider covers the usual range, evenly for
// the eye; the field takes every number that makes sense.

import { element } from "./dom.js";
import { limit_text, rounded } from "./units.js";

const kSteps = 1000;  // of a slider
const kPage = 100;    // of them, by Page Up and Page Down
const kArrows = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: kPage, PageDown: -kPage };

const kCurves = {
  even: { to: (x) => x, from: (x) => x },
  log: { to: Math.log, from: Math.exp },
  root: { to: Math.sqrt, from: (x) => x * x },
};

/**
 * Steps that can be taken back: after `step(now, by, value)`, a step by as much the other way gives the
 * value from before, which rounding would miss. `value` is called for a new one.
 */
export function make_trail() {
  let trail = [];
  return (now, by, value) => {
    const last = trail[trail.length - 1];
    if (last?.to !== now) trail = [];
    else if (last.by === -by) return trail.pop().from;
    const to = value();
    if (to !== now) trail.push({ from: now, to, by });
    return to;
  };
}

/**
 * Fills `part` with the control. `control` has: id, label, unit, key (shown), tip (a name in
 * tips.js), from and to (the slider's ends), curve, min and max (the field's), digits, decimals (at
 * most) of the slider's values, or values (the only ones, in order, in place of a range), get() and
 * set(value), shown_digits(), spoken(text) (the value as it is read out), allows(value) and wanted, if
 * the field does not take all from min to max: which, and so in words.
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
  const range = element("p", { id: `${control.id}-range`, class: "warning small", role: "alert", hidden: "" });
  part.replaceChildren(row, slider, range);

  const nearest = (value) => values.reduce(
      (best, x, index) => (Math.abs(x - value) < Math.abs(values[best] - value) ? index : best), 0);
  const place_of = (value) =>
      values ? nearest(value) : kSteps * (curve.to(value) - from) / (to - from);
  const value_at = (place) => {
    const at = Math.min(steps, Math.max(0, place));
    if (values) return values[Math.round(at)];
    const value = rounded(curve.from(from + at / kSteps * (to - from)), control.digits ?? 3);
    return control.decimals === undefined ? value : Number(value.toFixed(control.decimals));
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
    slider.setAttribute("aria-valuetext", control.spoken?.(shown) ?? with_unit(shown));
    if (value !== refused_at) show_range(true);
  }

  const with_unit = (text) => `${text} ${control.unit ?? ""}`.trim().replace(" °", "°");
  let refused_at = null;  // the value that an unusable entry has left
  function show_range(usable) {
    refused_at = usable ? null : control.get();
    range.hidden = usable;
    const { label, min, max } = control;
    const wanted = control.wanted ?? `${limit_text(min)} to ${with_unit(limit_text(max))}`;
    range.textContent = usable ? "" : `${label}: give ${wanted}`;
  }

  /** The nearest value at so many places from there, or more, that is another. */
  function value_beyond(now, places) {
    const sign = Math.sign(places);
    for (let at = place_of(now) + places; ; at += sign) {
      const value = clamp(value_at(at));
      if ((value - now) * sign > 0) return value;
      if (sign > 0 ? at >= steps : at <= 0) return now;
    }
  }

  const trail = make_trail();
  function step(places) {
    const now = control.get();
    if (now === null || now === undefined || slider.disabled) return;
    const next = trail(now, places, () => (
        values ? value_at(nearest(now) + Math.sign(places)) : value_beyond(now, places)));
    if (next !== now) control.set(next);
  }

  slider.addEventListener("input", () => control.set(value_at(Number(slider.value))));
  slider.addEventListener("keydown", (event) => {
    const places = kArrows[event.key];
    if (!places || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    step(places);
  });
  field.addEventListener("input", () => {
    const value = field.valueAsNumber;
    const usable = Number.isFinite(value) && value >= control.min && value <= control.max &&
                   (control.allows?.(value) ?? true);
    field.setAttribute("aria-invalid", String(!usable));
    show_range(usable);
    if (usable) control.set(value);
  });
  field.addEventListener("blur", () => {
    field.removeAttribute("aria-invalid");
    update();
  });

  return {
    update,
    /** By a key: a fiftieth of the slider a step, or to the next value. */
    nudge: (count) => step(count * kSteps / 50),
  };
}
