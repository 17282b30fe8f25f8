// The simulator in its worker: one request at a time, the more urgent first, so that a frame
// overtakes work in the background.
//
// To the worker: {id, request, files}, as worker.js has it; {cancel: id} where no memory is shared.
// From the worker: {ready: true, build, missing, cancel} once (`cancel` is an Int32Array of one
// number in shared memory, or absent), {failed: "one line"} if nothing can run, and then for each
// request {id, reply, pixels, file}, `pixels` an ArrayBuffer of RGBA8 rows, `file` of a file's bytes,
// either perhaps absent. If the module stops for good, {restarted: true, cancel} comes before that
// reply: a new module in which nothing is open.

export const kUrgent = 0;
export const kAsked = 1;
export const kBackground = 2;

/**
 * `on_ready(data)` and `on_failed(line)` are called once, one of them; `on_restarted()` when a new
 * module has taken the place of one that stopped.
 */
export function start_engine({ on_ready, on_failed, on_restarted }) {
  const worker = new Worker(globalThis.softfocus_worker ?? "worker.js");
  const waiting = [];
  let running = null;
  let ready = false;
  let paused = false;
  let next_id = 1;
  let cancel = null;

  function pump() {
    if (running || !ready || waiting.length === 0) return;
    let first = -1;
    waiting.forEach((job, index) => {
      if (paused && job.urgency === kBackground) return;
      if (first < 0 || job.urgency < waiting[first].urgency) first = index;
    });
    if (first < 0) return;
    running = waiting.splice(first, 1)[0];
    if (cancel) Atomics.store(cancel, 0, 0);
    worker.postMessage({ id: running.id, request: running.request, files: running.files },
                       running.files.map((file) => file.bytes));
  }

  function cancel_running() {
    if (!running) return;
    if (cancel) Atomics.store(cancel, 0, 1);
    else worker.postMessage({ cancel: running.id });
  }

  function fail(line) {
    on_failed(line);
    for (const job of [running, ...waiting]) job?.done({ reply: { error: line } });
    running = null;
    waiting.length = 0;
  }

  worker.addEventListener("message", ({ data }) => {
    if (data.failed) {
      fail(data.failed);
    } else if (data.ready) {
      cancel = data.cancel ?? null;
      ready = true;
      on_ready(data);
      pump();
    } else if (data.restarted) {
      cancel = data.cancel ?? null;
      on_restarted();
    } else if (running && data.id === running.id) {
      const job = running;
      running = null;
      job.done({ reply: data.reply, pixels: data.pixels, file: data.file });
      pump();
    }
  });
  worker.addEventListener("error", (event) => {
    event.preventDefault();
    fail(`the simulator stopped: ${event.message || "its worker could not be loaded"}`);
  });

  return {
    /** A promise of {reply, pixels, file}; a failed request gives reply.error, never an exception. */
    ask(request, urgency = kAsked, files = []) {
      return new Promise((done) => {
        waiting.push({ id: next_id++, request, files, urgency, done });
        pump();
      });
    },
    /** Stops the running request early. */
    cancel_running,
    /** Stops what runs in the background, so that a frame need not wait for it. */
    cancel_background() {
      if (running?.urgency === kBackground) cancel_running();
    },
    /** While paused, nothing in the background begins. */
    pause(on) {
      paused = on;
      pump();
    },
  };
}
