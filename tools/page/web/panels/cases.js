// The failure cases of `softfocus stress`, each as a scene with its sentence and severity.

import { by_id, element, paint_figure } from "../dom.js";
import { make_number } from "../numbers.js";
import { three_digits } from "../units.js";

/** `open(name, value)` opens a case. `cases` are those of the `scenes` reply. */
export function make_cases({ cases, open }) {
  const list = by_id("cases");
  const part = by_id("severity-part");
  let shown = null;  // {name, value}
  let control = null;

  function telling_value(known) {
    return known.telling ?? known.values[Math.floor(known.values.length / 2)];
  }

  const buttons = new Map();
  for (const known of cases) {
    const button = element("button", { type: "button", "aria-pressed": "false" },
                           element("b", {}, known.name),
                           element("span", {}, known.title ?? known.sentence));
    if (known.title) button.append(element("span", { class: "quiet" }, known.sentence));
    button.addEventListener("click", () => open(known.name, telling_value(known)));
    buttons.set(known.name, button);
    list.append(element("li", {}, button));
  }

  return {
    /** The answer beside the picture, and whether the picture holds; null hides both. */
    show_answer(answer) {
      const part = by_id("case-verdict");
      paint_figure("case-answer", "The answer", answer ?? {});
      const verdict = answer?.reply.verdict;
      part.hidden = !verdict;
      if (!verdict) return;
      const { holds, value, limit, unit, measured, why } = verdict;
      part.replaceChildren(
        element("b", { class: holds ? "is-found" : "warning" }, holds ? "✓ It holds" : "✗ It does not hold"),
        ` with these settings. Measured: ${measured}: ${value === null ? "all is spoilt" : three_digits(value)} ${unit}; ` +
        `up to ${three_digits(limit)} holds: ${why}.`);
    },
    /** Marks the open case, or none for null. */
    show(failure) {
      const changed = failure?.name !== shown?.name;
      shown = failure;
      for (const [name, button] of buttons) {
        button.setAttribute("aria-pressed", String(name === failure?.name));
      }
      const known = cases.find(({ name }) => name === failure?.name);
      part.hidden = !known || known.values.length < 2;
      if (!known) return;
      if (changed) {
        control = make_number(part, {
          id: "severity", label: `Severity: ${known.parameter}`, unit: known.unit ?? "",
          tip: "severity", values: known.values, min: Math.min(...known.values),
          max: Math.max(...known.values), get: () => shown.value,
          set: (value) => open(known.name, value),
        });
      }
      control.update();
    },
  };
}
