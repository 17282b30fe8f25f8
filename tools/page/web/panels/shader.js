// A filter of the visitor's: its shader and its passes, compiled while he types. It is a method
// like the others; here it stands beside his GPU and the truth.

import { announce, by_id, element, paint_figure } from "../dom.js";
import { kAsked } from "../engine.js";
import { bytes_of, is_own_method, kMostLinkBytes } from "../link.js";
import { frame_request } from "../state.js";
import { difference_text } from "./gpu.js";

const kPauseMs = 600;  // of typing, before the text is compiled

// Pipelines beside the page in lesson/; the shader of the last one is the module's own.
const kExamples = [
  { name: "gather", words: "First: a gather that leaks" },
  { name: "weights", words: "Second: weights that mend it" },
  { name: "two_pass", words: "two-pass" },
];

/** "mine.frag:12: ..." as {id, line} of the box that it is of, or null. */
export function place_of(fault) {
  const found = /^mine\.(frag|toml):(\d+)/.exec(fault);
  return found && { id: found[1] === "frag" ? "shader-text" : "shader-passes", line: Number(found[2]) };
}

/** Where a line of a text begins and ends; the last one for a number beyond. */
export function line_range(text, line) {
  const lines = text.split("\n");
  const index = Math.min(line, lines.length) - 1;
  const begin = lines.slice(0, index).reduce((sum, one) => sum + one.length + 1, 0);
  return [begin, begin + lines[index].length];
}

async function fetched(name) {
  const response = await fetch(`lesson/${name}`);
  if (!response.ok) throw new Error(`lesson/${name}: ${response.status}`);
  const text = await response.text();
  return name.endsWith(".toml") ? text.replace(/(shader = )"[^"]*"/g, '$1"mine.frag"') : text;
}

/** `settled()`: whether the whole picture is shown. `want_truth()` begins to collect it. */
export function start_shader({ engine, store, settled, want_truth }) {
  const text = by_id("shader-text");
  const passes = by_id("shader-passes");
  const state = by_id("shader-state");
  const fault = by_id("shader-fault");
  let timer = 0;
  let runs = 0;

  function show_fault(line, select) {
    fault.hidden = !line;
    fault.textContent = line;
    const place = place_of(line);
    if (!place || !select) return;
    const box = by_id(place.id);
    box.focus();
    box.setSelectionRange(...line_range(box.value, place.line));
    const height = parseFloat(getComputedStyle(box).lineHeight);
    box.scrollTop = Math.max(0, (place.line - box.rows / 2) * height);
  }

  function show_size() {
    const lines = text.value.split("\n").length;
    by_id("shader-lines").textContent = Array.from({ length: lines }, (_, i) => i + 1).join("\n");
    const bytes = bytes_of({ text: text.value, passes: passes.value });
    by_id("shader-bytes").textContent = bytes <= kMostLinkBytes
        ? `The link carries the text: ${bytes} of at most ${kMostLinkBytes} bytes.`
        : `${bytes} bytes are too many for the link, which carries ${kMostLinkBytes}.`;
  }

  /** Compiles what is in the boxes. Resolves to the method's name, or to null with a fault shown. */
  async function compile(select) {
    const run = ++runs;
    const asked = { text: text.value, passes: passes.value };
    state.textContent = "compiling…";
    const { reply } = await engine.ask({ do: "shader", name: "mine.frag", ...asked }, kAsked);
    if (run !== runs) return null;  // the text has changed meanwhile
    state.textContent = reply.error ? "" : (reply.warnings ?? []).join(" · ");
    show_fault(reply.error ?? "", select);
    if (reply.error) return null;
    store.change({ shader: { ...asked, method: reply.method } });
    return reply.method;
  }

  async function run(select) {
    clearTimeout(timer);
    show_size();
    const method = await compile(select);
    if (!method) return;
    store.change_side({ method, dof: true });
    if (!store.get().picture) want_truth();
  }

  function load(shader) {
    text.value = shader.text;
    passes.value = shader.passes;
    text.scrollTop = 0;
    show_size();
  }

  let given = "";  // the text of the last example
  let own = null;  // what the visitor made of it, before another one took its place

  /** A text that no example has is one more to begin with, so that each of them can be chosen again. */
  function show_own() {
    if (text.value === "" || text.value === given) return;
    if (example.lastChild.value !== "own") example.append(element("option", { value: "own" }, "Your text"));
    example.value = "own";
  }

  async function begin_with(name) {
    const now = { text: text.value, passes: passes.value };
    const mine = own ?? now;
    if (text.value !== given) own = now;
    try {
      if (name === "own") {
        load(mine);
      } else if (name !== "two_pass") {
        load({ text: await fetched(`${name}.frag`), passes: await fetched(`${name}.toml`) });
      } else {
        const { reply } = await engine.ask({ do: "shader_text", name: "two_pass.frag" }, kAsked);
        load({ text: reply.text, passes: await fetched("two_pass.toml") });
      }
      given = text.value;
      await run(false);
    } catch (error) {
      show_fault(error.message, false);
    }
  }

  async function beside_gpu() {
    if (!settled() || !is_own_method(store.side().method)) {
      state.textContent = "run the shader first, and wait for the whole picture";
      return;
    }
    state.textContent = "drawing…";
    const request = { ...frame_request(store.get(), store.side(), 1), do: "gl_frame" };
    const where = await engine.ask({ ...request, gl_show: "difference" }, kAsked);
    state.textContent = "";
    if (where.reply.error) {
      show_fault(where.reply.error, false);
      return;
    }
    const { filter } = where.reply.differing;
    const words = filter ? `Your shader, of the GPU’s sharp picture: ${difference_text(filter)}`
                         : "Depth of field is off: nothing is filtered";
    by_id("shader-differences").replaceChildren(element("li", {}, words),
                                                element("li", {}, `Profile ${where.reply.profile}`));
    announce(words);
    paint_figure("shader-where", "Where values differ; black is equal", where);
    for (const [id, gl_show, caption] of [["shader-emulated", "emulated", "Here, of the GPU’s sharp picture"],
                                          ["shader-on-gpu", "picture", "On your GPU"]]) {
      paint_figure(id, caption, await engine.ask({ do: "gl_frame", gl_show }, kAsked));
    }
  }

  const example = by_id("shader-example");
  example.append(...kExamples.map(({ name, words }) => element("option", { value: name }, words)));
  example.addEventListener("change", () => begin_with(example.value));
  for (const box of [text, passes]) {
    box.addEventListener("input", () => {
      show_size();
      show_own();
      clearTimeout(timer);
      timer = setTimeout(() => run(false), kPauseMs);
    });
  }
  text.addEventListener("scroll", () => { by_id("shader-lines").scrollTop = text.scrollTop; });
  by_id("shader-run").addEventListener("click", () => run(true));
  by_id("shader-gpu").addEventListener("click", beside_gpu);

  return {
    /** The tab is there if the page was built with the compiler. */
    async find_compiler() {
      const response = globalThis.softfocus_worker
          ? null : await fetch("softfocus-compiler.wasm", { method: "HEAD" }).catch(() => null);
      by_id("tab-shader").hidden = !response?.ok;
    },
    /** The tab is opened: with the first example, unless there is a text. */
    open() {
      if (text.value === "") begin_with(kExamples[0].name);
    },
    /** Compiles a link's text. Resolves to the method's name, or to null. */
    restore(shader) {
      load(shader);
      show_own();
      return compile(false);
    },
    /** In a new module, the same text once more. */
    again: () => (store.get().shader ? compile(false) : null),
  };
}
