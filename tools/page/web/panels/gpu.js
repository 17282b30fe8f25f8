// Your GPU: WebGL2 draws and filters the shown frame with the project's GLSL, and every value is
// compared with the module's.

import { by_id, element, paint_figure, save_text } from "../dom.js";
import { kAsked, kBackground } from "../engine.js";
import { frame_request } from "../state.js";
import { ms_text } from "../units.js";

/** What this browser lacks, as a sentence, or "". */
function missing_here() {
  const canvas = typeof OffscreenCanvas === "undefined" ? null : new OffscreenCanvas(1, 1);
  if (!canvas) return "This browser has no OffscreenCanvas, so the worker cannot reach the GPU.";
  const gl = canvas.getContext("webgl2");
  if (!gl) return "This browser has no WebGL2.";
  const lacks = gl.getExtension("EXT_color_buffer_float")
      ? "" : "WebGL2 is here, but without EXT_color_buffer_float: it cannot draw into 16-bit floats.";
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return lacks;
}

export function difference_text({ values, of, largest_half_ulps, first }) {
  if (values === 0) return `all ${of} values are equal`;
  const place = first ? `; the first at ${first.x}, ${first.y}` : "";
  return `${values} of ${of} values differ, by at most ${largest_half_ulps} half-ULPs${place}`;
}

/** `settled()`: whether the whole picture of the present state is shown. */
export function start_gpu({ engine, store, settled }) {
  const state = by_id("gpu-state");
  const buttons = ["gpu-draw", "gpu-probe", "gpu-crosscheck"].map(by_id);
  let opened = null;  // the reply of gl_open
  let stop = false;

  function show_support(line, works) {
    by_id("gpu-support").textContent = line;
    for (const button of buttons) button.disabled = !works;
  }

  async function open() {
    if (opened) return true;
    const { reply } = await engine.ask({ do: "gl_open" }, kAsked);
    if (reply.error) {
      show_support(reply.error, true);
      state.textContent = "";
      return false;
    }
    opened = reply;
    show_support(`${reply.renderer}, ${reply.version}`, true);
    return true;
  }

  function show_numbers(reply) {
    const { draw, filter, frame } = reply.differing;
    const head = ["Stage", "Module, ms", "Your GPU, ms"].map((word) => element("th", { scope: "col" }, word));
    const row = (name, module_ms, gpu_ms) => element(
        "tr", {}, element("th", { scope: "row" }, name), element("td", {}, ms_text(module_ms)),
        element("td", {}, ms_text(gpu_ms)));
    const body = element("tbody");
    if (draw) body.append(row("Draw", reply.emulated_draw_ms, reply.draw_ms));
    if (filter) body.append(row("Filter", reply.emulated_filter_ms, reply.filter_ms));
    by_id("gpu-table").parentElement.hidden = false;
    by_id("gpu-table").replaceChildren(element("thead", {}, element("tr", {}, ...head)), body);
    by_id("gpu-differences").replaceChildren(
        element("li", {}, `Profile ${reply.profile}`),
        ...(draw ? [element("li", {}, `Draw: ${difference_text(draw)}`)] : []),
        ...(filter ? [element("li", {}, `Filter, of the GPU’s sharp picture: ${difference_text(filter)}`)]
                   : [element("li", {}, "Filter: two-pass, one-pass and the tab Shader alone have shaders")]),
        element("li", {}, `Frame: ${difference_text(frame)}`));
  }

  async function draw() {
    if (!settled()) {
      state.textContent = "wait for the whole picture";
      return;
    }
    state.textContent = "drawing…";
    if (!await open()) return;
    const request = { ...frame_request(store.get(), store.side(), 1), do: "gl_frame" };
    const where = await engine.ask({ ...request, gl_show: "difference" }, kAsked);
    state.textContent = where.reply.error ?? "";
    if (where.reply.error) return;
    show_numbers(where.reply);
    paint_figure("gpu-where", "Where values differ; black is equal", where);
    const picture = await engine.ask({ do: "gl_frame", gl_show: "picture" }, kAsked);
    if (!picture.reply.error) paint_figure("gpu-picture", "Your GPU’s picture", picture);
  }

  async function probe() {
    if (!await open()) return;
    state.textContent = "probing…";
    const { reply } = await engine.ask({ do: "gl_probe" }, kAsked);
    state.textContent = reply.error ?? "The module has this profile now; draw again.";
    if (!reply.toml) return;
    by_id("gpu-profile-part").hidden = false;
    by_id("gpu-profile").textContent = reply.toml;
  }

  function row_of(name, reply) {
    const differs = reply.error || reply.differing > 0;
    const words = reply.error ?? (differs ? `${reply.differing}, at most ${reply.largest_ulps} ULPs`
                                          : "0");
    return element("tr", differs ? { class: "differs" } : {},
                   element("th", { scope: "row" }, name),
                   element("td", {}, String(reply.values ?? "–")),
                   element("td", { class: "words" }, words));
  }

  async function crosscheck() {
    if (!await open()) return;
    stop = false;
    const body = element("tbody");
    const head = ["Case", "Values", "Differing"].map((word) => element("th", { scope: "col" }, word));
    const list = (await engine.ask({ do: "gl_crosscheck" }, kAsked)).reply;
    if (list.error) {
      state.textContent = list.error;
      return;
    }
    by_id("gpu-cases").parentElement.hidden = false;
    by_id("gpu-cases").replaceChildren(element("thead", {}, element("tr", {}, ...head)), body);
    by_id("gpu-crosscheck").textContent = "Stop";
    let done = 0;
    let differing = 0;
    for (const { name } of list.cases) {
      let reply = { cancelled: true };
      while (reply.cancelled && !stop) {
        ({ reply } = await engine.ask({ do: "gl_crosscheck", case: name }, kBackground));
      }
      if (stop) break;
      done++;
      differing += reply.error || reply.differing > 0 ? 1 : 0;
      body.append(row_of(name, reply));
      state.textContent = `${done} of ${list.cases.length}, ${differing} differ`;
    }
    by_id("gpu-crosscheck").textContent = "Compare all cases";
  }

  by_id("gpu-draw").addEventListener("click", draw);
  by_id("gpu-probe").addEventListener("click", probe);
  by_id("gpu-crosscheck").addEventListener("click", () => {
    if (by_id("gpu-crosscheck").textContent === "Stop") stop = true;
    else crosscheck();
  });
  by_id("gpu-download").addEventListener("click", () => {
    save_text("my-gpu.toml", by_id("gpu-profile").textContent, "application/toml");
  });
  const lacks = missing_here();
  show_support(lacks || "WebGL2 and EXT_color_buffer_float are here.", !lacks);
  return { draw };
}
