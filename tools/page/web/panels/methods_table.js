// The table of methods and radii: time and error of each, one measurement after the other.

import { announce, by_id, element } from "../dom.js";
import { kBackground } from "../engine.js";
import { parameters } from "../state.js";
import { ms_text } from "../units.js";
import { draw_methods_chart } from "./methods_chart.js";

/** Radii from a line of text, at most six; empty if it says none. */
export function read_radii(text) {
  const radii = text.split(/[\s,;]+/).map(Number).filter((x) => x > 0 && x <= parameters.max_coc_px.most);
  return [...new Set(radii)].sort((a, b) => a - b).slice(0, 6);
}

/**
 * `choose(method, radius)` is called for a pressed cell. `picture_shown()` shows the picture, if need be,
 * and resolves to whether it is there.
 */
export function make_methods_table({ engine, methods, truth, choose, picture_shown }) {
  const table = by_id("methods-table");
  const button = by_id("measure");
  const state = by_id("measure-state");
  const results = new Map();  // "method radius" -> reply
  let radii = [];
  let sorted = null;  // {of: "ms" or "flip_mean", radius}, or null: by names, as the list has them
  let run = 0;  // the number of the run; another number stops an older one

  function cells_of(name, radius) {
    const result = results.get(`${name} ${radius}`);
    if (!result) return [element("td", {}, "–"), element("td", {}, "–")];
    if (result.error) return [element("td", { colspan: 2, title: result.error }, "not here")];
    const best = Math.min(...[...results.values()].map((x) => x.flip_mean ?? Infinity));
    const flip = result.flip_mean.toFixed(3);
    const press = element("button", { type: "button", class: "cell",
                                      "aria-label": `${flip}: use ${name} with radius ${radius}` }, flip);
    press.addEventListener("click", () => choose(name, radius));
    const error = element("td", { class: result.flip_mean <= best ? "measured best" : "measured" }, press);
    error.style.setProperty("--part", `${Math.min(100, 300 * result.flip_mean)}%`);
    return [element("td", {}, ms_text(result.ms)), error];
  }

  /** The head of a column that sorts the rows when it is pressed. */
  function column_head(words, tip, next, attributes) {
    const is_here = JSON.stringify(next) === JSON.stringify(sorted);
    const press = element("button", { type: "button", class: "cell", "aria-label": `${words}${tip}: sort` },
                          `${words}${is_here && next ? " ▴" : ""}`);
    press.addEventListener("click", () => {
      sorted = next;
      draw();
      table.querySelector("[aria-sort] button").focus();
    });
    return element("th", { scope: "col", ...(is_here && { "aria-sort": "ascending" }), ...attributes }, press);
  }

  function in_order() {
    if (!sorted) return methods;
    const value = ({ name }) => results.get(`${name} ${sorted.radius}`)?.[sorted.of] ?? Infinity;
    return methods.slice().sort((a, b) => value(a) - value(b) || 0);
  }

  function draw() {
    const head = element("tr", {}, column_head("Method", "", null, { rowspan: 2 }));
    const units = element("tr");
    for (const radius of radii) {
      head.append(element("th", { scope: "colgroup", colspan: 2 }, `radius ${radius} px`));
      units.append(column_head("ms", ` at ${radius} px`, { of: "ms", radius }),
                   column_head("FLIP", ` at ${radius} px`, { of: "flip_mean", radius }));
    }
    draw_methods_chart([...results.values()].filter(({ error }) => !error), radii, choose);
    const body = element("tbody");
    for (const { name, summary } of in_order()) {
      const row = element("tr", {}, element("th", { scope: "row", title: summary }, name));
      for (const radius of radii) row.append(...cells_of(name, radius));
      body.append(row);
    }
    table.replaceChildren(element("thead", {}, head, units), body);
  }

  function stop(words) {
    run++;
    button.textContent = "Measure all methods";
    state.textContent = words;
    announce(words);
  }

  async function measure() {
    const mine = ++run;
    radii = read_radii(by_id("radii").value);
    if (radii.length === 0) return stop(`give radii above 0, up to ${parameters.max_coc_px.most}, such as 8 16 32`);
    by_id("radii").value = radii.join(" ");
    state.textContent = "waiting for the whole picture…";
    if (!await picture_shown()) return stop("there is no picture to measure");
    if (mine !== run) return undefined;
    results.clear();
    if (sorted && !radii.includes(sorted.radius)) sorted = null;
    draw();
    button.textContent = "Stop";
    state.textContent = "collecting the truth…";
    truth.want(true);
    await truth.when_done();
    if (mine !== run) return undefined;
    const total = methods.length * radii.length;
    for (const { name } of methods) {
      for (const radius of radii) {
        let reply = { cancelled: true };
        // A frame cancels what runs in the background: it is asked again.
        while (reply.cancelled && mine === run) {
          const answer = await engine.ask({ do: "compare_methods", methods: [name],
                                            radii: [radius] }, kBackground);
          reply = answer.reply.results?.[0] ?? answer.reply;
        }
        if (mine !== run) return undefined;
        results.set(`${name} ${radius}`, reply);
        state.textContent = `${results.size} of ${total}`;
        draw();
      }
    }
    return stop(`${total} measured`);
  }

  button.addEventListener("click", () => {
    if (button.textContent === "Stop") stop("stopped");
    else measure();
  });
  radii = read_radii(by_id("radii").value);
  draw();

  return {
    /** The measured picture is not shown any more. */
    renew() {
      if (button.textContent === "Stop") stop("stopped: the picture has changed");
      else if (results.size > 0) state.textContent = "of an earlier picture";
    },
  };
}
