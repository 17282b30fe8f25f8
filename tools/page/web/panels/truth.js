// The truth: views of the lens, collected in the background for the picture that is shown, until
// they are enough. It begins anew whenever the picture changes.

import { announce, by_id } from "../dom.js";
import { kAsked, kBackground } from "../engine.js";
import { three_digits } from "../units.js";

const kTurnMs = 200;     // of one request, so that input and frames stay quick
const kShownEvery = 16;  // views between two pictures of the growing truth

/**
 * `paint(kind, reply, pixels)` shows the truth or the error; `shown()` is "truth", "error" or null.
 * `on_done(reply)` is told once it is good enough, with null when it is of another picture than the shown one.
 * `settled()`: whether the whole picture of the present state is there; `hindrance()`: why what is
 * shown has no truth, or null.
 */
export function make_truth({ engine, settled, hindrance, shown, paint, on_done, on_error }) {
  let wanted = false;
  let running = false;
  let paused = false;
  let last = null;       // the newest reply
  let views = 4;         // of the next request
  let painted_at = -1;   // samples of the truth that is shown
  const waiting = [];    // told when the truth is good enough

  function say(words) {
    for (const id of ["truth-state", "shader-truth"]) by_id(id).textContent = words;
  }

  function tell() {
    const progress = by_id("truth-progress");
    if (!last) {
      progress.value = 0;
      say(wanted ? hindrance() ?? "waiting for the whole picture" : "not begun");
      return;
    }
    const flip = last.flip_mean === undefined || last.flip_mean === null
        ? "" : ` · FLIP of the picture ${three_digits(last.flip_mean)}`;
    const noise = last.half_set_rms === undefined || last.half_set_rms === null
        ? "" : ` · halves differ by ${three_digits(last.half_set_rms)}`;
    progress.value = last.done ? 1 : Math.min(0.95, Math.log2(1 + last.samples) / 12);
    // A case whose answer is written down needs no views.
    const views_text = last.samples === 0 ? "known answer" : `${last.samples} views`;
    say(`${views_text}${noise}${flip}${last.done ? " · good enough" : ""}`);
  }

  async function show(force) {
    const kind = shown();
    if (!kind || !last) return;
    if (!force && last.samples < painted_at + kShownEvery && !last.done) return;
    const { reply, pixels } = await engine.ask({ do: "truth", show: kind, numbers: true }, kAsked);
    if (reply.error) on_error(reply.error);
    else if (!reply.cancelled && pixels && shown() === kind && settled()) {
      painted_at = reply.samples ?? last.samples;
      paint(kind, reply, pixels);
    }
  }

  async function pump() {
    if (running || paused || !wanted || !settled() || last?.done) return;
    running = true;
    const began = performance.now();
    const { reply } = await engine.ask({ do: "truth", views }, kBackground);
    running = false;
    if (reply.error) {
      last = null;
      say(reply.error);
      wanted = false;
      by_id("truth-on").checked = false;
      return;
    }
    if (!reply.cancelled && settled()) {
      const took = performance.now() - began;
      views = Math.min(64, Math.max(1, Math.round(views * kTurnMs / Math.max(took, 1))));
      last = reply;
      tell();
      await show(painted_at < 0);
      if (last?.done) {
        announce("The truth is good enough.");
        on_done(last);
      }
      if (last?.done) waiting.splice(0).forEach((done) => done());
    }
    pump();
  }

  return {
    /** The picture has changed; what was collected is of another one. */
    renew() {
      if (last?.done) on_done(null);
      last = null;
      painted_at = -1;
      tell();
      pump();
    },
    want(on) {
      wanted = on;
      by_id("truth-on").checked = on;
      tell();
      pump();
    },
    pause(on) {
      paused = on;
      pump();
    },
    /** The whole picture is there. */
    go: pump,
    /** Shows the truth or the error as far as it is known. */
    show: () => show(true),
    wanted: () => wanted,
    /** Resolves once the truth is good enough. */
    when_done: () => (last?.done ? Promise.resolve() : new Promise((done) => waiting.push(done))),
    numbers: () => last,
  };
}
