// Time against error of the measured methods: those that no other beats in both are named.

import { by_id, svg_element } from "../dom.js";
import { round_up } from "../maps.js";
import { ms_text, three_digits } from "../units.js";

const kSize = { width: 440, height: 250 };
const kPlot = { left: 46, right: 418, top: 24, bottom: 212 };
const kRadii = 4;  // px, of a dot of the first radius of circles; the next are larger

/** Those that no other is both quicker and better than, the quickest first. */
export function best_of(results) {
  const by_time = results.slice().sort((a, b) => a.ms - b.ms || a.flip_mean - b.flip_mean);
  let best = Infinity;
  return by_time.filter(({ flip_mean }) => {
    const is_best = flip_mean < best;
    best = Math.min(best, flip_mean);
    return is_best;
  });
}

const text = (x, y, words, anchor, kind = "quiet") => (
  svg_element("text", { x, y, "text-anchor": anchor, class: kind }, words));

/** `results` as `compare_methods` replies; `choose(method, radius)` for a dot that is pressed. */
export function draw_methods_chart(results, radii, choose) {
  const chart = by_id("methods-chart");
  chart.closest("figure").hidden = results.length === 0;
  if (results.length === 0) return;
  const times = results.map(({ ms }) => Math.max(ms, 0.1));
  const [from, to] = [10 ** Math.floor(Math.log10(Math.min(...times))), 10 ** Math.ceil(Math.log10(Math.max(...times) * 1.001))];
  const worst = round_up(Math.max(0.001, ...results.map(({ flip_mean }) => flip_mean)));
  const x_of = (ms) => kPlot.left + (kPlot.right - kPlot.left) * Math.log(Math.max(ms, 0.1) / from) / Math.log(to / from);
  const y_of = (flip) => kPlot.bottom - (kPlot.bottom - kPlot.top) * flip / worst;
  const made = [];
  for (let ms = from; ms <= to * 1.001; ms *= 10) {
    made.push(svg_element("line", { x1: x_of(ms), x2: x_of(ms), y1: kPlot.top, y2: kPlot.bottom, class: "grid" }),
              text(x_of(ms), kPlot.bottom + 16, three_digits(ms), "middle"));
  }
  for (const part of [0, 0.5, 1]) {
    const y = y_of(part * worst);
    made.push(svg_element("line", { x1: kPlot.left, x2: kPlot.right, y1: y, y2: y, class: "grid" }),
              text(kPlot.left - 6, y + 4, three_digits(part * worst), "end"));
  }
  made.push(text((kPlot.left + kPlot.right) / 2, kSize.height - 4, "time, ms", "middle"), text(6, 13, "FLIP", "start"));
  const best = best_of(results);
  made.push(svg_element("path", { class: "best", d: best.map(({ ms, flip_mean }, i) => (
      `${i ? "L" : "M"}${x_of(ms)} ${y_of(flip_mean)}`)).join("") }));
  for (const result of results) {
    const { method, radius, ms, flip_mean } = result;
    const dot = svg_element("circle", { cx: x_of(ms), cy: y_of(flip_mean), r: kRadii + 1.5 * radii.indexOf(radius),
                                        class: best.includes(result) ? "dot best" : "dot" });
    dot.append(svg_element("title", {}, `${method}, radius ${radius} px: ${ms_text(ms)} ms, FLIP ${three_digits(flip_mean)}`));
    dot.addEventListener("click", () => choose(method, radius));
    made.push(dot);
  }
  // From the best on, so that a name that finds no room is of a worse one.
  const taken = [];
  for (const { method, radius, ms, flip_mean } of best.slice().reverse()) {
    const words = radii.length > 1 ? `${method}, ${radius}` : method;
    const width = 6.2 * words.length;
    const [x, y] = [x_of(ms), y_of(flip_mean)];
    const is_left = x + 10 + width > kSize.width;
    const box = { left: is_left ? x - 10 - width : x + 10, top: y - 12 };
    if (taken.some((one) => Math.abs(one.top - box.top) < 13 && one.left < box.left + width && box.left < one.left + one.width)) continue;
    taken.push({ ...box, width });
    made.push(text(is_left ? x - 10 : x + 10, y - 2, words, is_left ? "end" : "start", "halo"));
  }
  chart.setAttribute("viewBox", `0 0 ${kSize.width} ${kSize.height}`);
  chart.setAttribute("aria-label", `Time against error. No method is both quicker and better than ${
    best.map(({ method, radius }) => `${method} with radius ${radius} px`).join(", ")}.`);
  chart.replaceChildren(...made);
}
