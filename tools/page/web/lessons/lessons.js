// The tab Lessons: one step at a time, with its task, the state that it sets, and whether the
// student has found what it asks for. What was found is kept while the page is open, and by the
// browser where it allows that.

import { announce, by_id, element } from "../dom.js";
import { read_link } from "../link.js";
import { number_in, start_half } from "./half.js";
import { kSteps } from "./steps.js";
import { blocks_of, inline_nodes, read_lessons } from "./text.js";

const kLookMs = 300;  // between two looks at what the student does
const kStored = "softfocus-lessons";

function stored() {
  try {
    const { at, found } = JSON.parse(localStorage.getItem(kStored));
    return { at: String(at), found: new Set(found) };
  } catch {
    return { at: "", found: new Set() };  // refused, or never begun
  }
}

/** Whether the scene or the case of a link's fragment is open. */
function is_open(fragment, { scene, failure }) {
  const words = read_link(fragment);
  return words.has("case") ? failure?.name === words.get("case") : !failure && scene === words.get("scene");
}

/** Whether an element is on the screen, and nothing over it. */
function is_in_sight(node) {
  const { left, top, bottom } = node.getBoundingClientRect();
  return node.contains(document.elementFromPoint(left + 4, (top + bottom) / 2));
}

async function lessons_text() {
  const part = document.getElementById("softfocus-lessons");
  if (part) return part.textContent;
  const response = await fetch("lesson/teaching.md");
  if (!response.ok) throw new Error(`lesson/teaching.md: ${response.status}`);
  return response.text();
}

/**
 * `world()` is what steps.js looks at; `set_up(fragment)` opens a link's state; `want_truth()` begins
 * to collect the truth; `tabs` are the page's.
 */
export function start_lessons({ world, set_up, want_truth, tabs }) {
  const half = start_half();
  const answer = by_id("step-answer");
  let chapters = [];
  let at = "";  // the step's key, or a chapter's title
  let found = new Set();
  let begun = false;
  let is_used = false;  // not only looked at: then the strip goes along

  const lesson_of = (key) => chapters.find(({ steps }) => steps.some((step) => step.key === key));
  const step_of = (key) => lesson_of(key)?.steps.find((step) => step.key === key);
  const keys = () => chapters.flatMap(({ steps }) => steps.map(({ key }) => key));

  function keep() {
    try {
      localStorage.setItem(kStored, JSON.stringify({ at, found: [...found] }));
    } catch {
      // Then the page alone keeps it.
    }
  }

  function show_choice() {
    const option = ({ title, steps }) => {
      const count = steps.filter(({ key }) => found.has(key)).length;
      const words = steps.length > 0 ? `${title} (${count} of ${steps.length})` : title;
      return element("option", { value: steps[0]?.key ?? title }, words);
    };
    const group = (label, of) => element("optgroup", { label }, ...of.map(option));
    by_id("lesson").replaceChildren(group("Lessons", chapters.filter(({ steps }) => steps.length > 0)),
                                    group("For teachers", chapters.filter(({ steps }) => steps.length === 0)));
    by_id("lesson").value = lesson_of(at)?.steps[0].key ?? at;
    const buttons = (lesson_of(at)?.steps ?? []).map(({ key, title }) => {
      const mark = found.has(key) ? " ✓" : "";
      const words = found.has(key) ? ", found" : "";
      const button = element("button", { type: "button", "aria-label": `${key} ${title}${words}`,
                                         ...(key === at ? { "aria-current": "step" } : {}) }, `${key}${mark}`);
      button.addEventListener("click", () => show(key));
      return button;
    });
    by_id("step-list").replaceChildren(...buttons);
  }

  function show_state() {
    const words = found.has(at) ? "✓ Found." : kSteps[at]?.found || kSteps[at]?.answer ? "Not found yet." : "";
    for (const id of ["step-state", "strip-state"]) {
      by_id(id).classList.toggle("is-found", found.has(at));
      if (by_id(id).textContent !== words) by_id(id).textContent = words;
    }
  }

  /** Shows a step, or a chapter that has none. */
  function show(key, with_focus = true) {
    is_used = is_used || with_focus;
    at = key;
    const step = step_of(key);
    const rule = kSteps[key] ?? {};
    const chapter = lesson_of(key) ?? chapters.find(({ title }) => title === key);
    const is_first = !step || chapter.steps[0] === step;
    by_id("lesson-text").replaceChildren(...(step ? [] : [element("h2", {}, chapter.title)]),
                                         ...(is_first ? blocks_of(chapter.lines) : []));
    by_id("lesson-step").hidden = !step;
    by_id("strip-title").textContent = step ? `${key} ${step.title}` : "";
    if (step) {
      by_id("step-title").replaceChildren(...inline_nodes(`${key} ${step.title}`));
      const blocks = blocks_of(step.lines);
      const folded = blocks.filter(({ tagName }) => tagName === "DETAILS");
      by_id("step-text").replaceChildren(...blocks.filter((block) => !folded.includes(block)));
      by_id("step-fold").replaceChildren(...folded);
      by_id("step-set").hidden = !rule.state;
      by_id("half-part").hidden = !rule.half;
      if (rule.half) half.choose(rule.half);
      by_id("answer-part").hidden = !rule.answer;
      by_id("answer-unit").textContent = rule.answer?.unit ?? "";
      by_id("step-back").disabled = key === keys()[0];
      by_id("step-next").disabled = key === keys().slice(-1)[0];
      answer.value = "";
    }
    show_choice();
    show_state();
    look();
    keep();
    if (step && with_focus) by_id("step-title").focus();
  }

  function mark() {
    found.add(at);
    show_choice();
    show_state();
    keep();
  }

  function is_found(rule, now) {
    if (!rule.answer) return (!rule.state || rule.anywhere || is_open(rule.state, now.state)) && rule.found?.(now);
    const wanted = rule.answer.value(now);
    return Math.abs(number_in(answer) - wanted) <= rule.answer.part * Math.abs(wanted);
  }

  function look() {
    by_id("lesson-strip").hidden = !is_used || !step_of(at) || is_in_sight(by_id("step-title"));
    const rule = kSteps[at];
    if (!begun || !rule) return;
    const now = { ...world(), half: half.numbers() };
    const is_there = Boolean(now.lens && now.frame);
    const words = is_there ? rule.watch?.(now) ?? "" : "";
    for (const id of ["step-watch", "strip-watch"]) {
      if (by_id(id).textContent !== words) by_id(id).textContent = words;
    }
    if (found.has(at) || !is_there || !now.settled || !is_found(rule, now)) return;
    mark();
    announce("Found.");
  }

  async function begin() {
    if (begun) return;
    begun = true;
    ({ at, found } = stored());
    try {
      chapters = read_lessons(await lessons_text());
    } catch (error) {
      begun = false;
      by_id("lesson-text").textContent = error.message;
      return;
    }
    const known = step_of(at) || chapters.some(({ title }) => title === at);
    show(known ? at : keys()[0], false);
    setInterval(look, kLookMs);
  }

  const go = (by) => {
    const all = keys();
    // What cannot be checked is done when one goes on.
    if (by > 0 && !kSteps[at]?.found && !kSteps[at]?.answer) mark();
    show(all[all.indexOf(at) + by]);
  };
  by_id("lesson").addEventListener("change", ({ target }) => show(target.value, false));
  by_id("step-back").addEventListener("click", () => go(-1));
  by_id("step-next").addEventListener("click", () => go(1));
  by_id("step-set").addEventListener("click", async ({ target }) => {
    const { state, truth } = kSteps[at];
    is_used = true;
    target.setAttribute("aria-disabled", "true");
    await set_up(state);
    target.removeAttribute("aria-disabled");
    if (truth) want_truth();
  });
  answer.addEventListener("input", look);
  by_id("lessons-anew").addEventListener("click", () => {
    found = new Set();
    show(keys()[0]);
  });
  by_id("strip-back").addEventListener("click", () => {
    tabs.choose("tab-lessons");
    by_id("step-title").focus();
  });
  by_id("tab-lessons").addEventListener("click", begin);
  by_id("tab-lessons").addEventListener("focus", begin);  // arrow keys choose a tab and focus it

  /** What the address asks for: a step's key or a lesson's number; the first one if there is none such. */
  async function open_linked() {
    const key = read_link(location.hash).get("lesson");
    if (!key) return;
    tabs.choose("tab-lessons");
    await begin();
    const wanted = step_of(key) ? key : `${key}.1`;
    show(step_of(wanted) ? wanted : keys()[0]);
  }
  window.addEventListener("hashchange", open_linked);
  open_linked();
}
