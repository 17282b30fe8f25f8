// The loop of frames: always the newest state, one frame at a time, coarse while somebody moves
// something and a whole frame would take too long. Nothing here waits for a frame.

import { kUrgent } from "./engine.js";
import { frame_request } from "./state.js";

const kSmoothMs = 50;   // a frame this quick needs no coarse one before it
const kFixedMs = 8;     // about what a frame takes of any size
const kHalfMs = 200;    // longer than this, a coarse frame has a quarter of the width, not a half
const kSettleMs = 180;  // without input this long, the whole frame is drawn
const kLateMs = 1000;   // a coarse frame that takes longer gives way to the next
const kKept = 100;      // timings of one setting, for the report

/** What the picture depends on, as text: equal keys, equal pictures. */
export function picture_key(state) {
  return JSON.stringify([state.scene, state.failure,
                         state.sides.map((side) => frame_request(state, side, 1))]);
}

/** What the time of a frame depends on, but for the view: timings of other settings do not count. */
function setting_key(state) {
  return picture_key({ ...state, camera: null, time: 0 });
}

/**
 * `moving()`: whether the animation plays. `paint(side, reply, pixels, state, preview)` shows a picture;
 * `on_frame(reply, coarse, state)` is told of the edited side's numbers after each frame,
 * `on_error(line)` of a frame that could not be, `on_settled(settled)` whenever the whole picture
 * has come or is not the state's any more.
 */
export function make_frames({ engine, store, moving, paint, on_frame, on_error, on_settled }) {
  let dirty = false;    // the state has changed since the last frame began
  let coarse = false;   // the shown frame is not whole
  let failed = false;   // the state has no picture
  let running = null;   // {began, preview}
  let paused = false;
  let open = false;     // a scene is there
  let last_input = -Infinity;
  let whole_ms = 0;     // what a whole frame is thought to take
  let was_slow = false; // the last whole frame was
  let is_cold = true;   // the scene's first frame takes longer than any other
  let timer = 0;
  let way_timer = 0;
  let timings = [];
  let timed = "";       // the setting that they are of

  const settled = () => open && !dirty && !coarse && !running && !failed;
  const waits = () => !open || dirty || coarse || Boolean(running);

  function preview_of(state) {
    if (state.failure) return 1;  // a coarser case would be another one
    if (whole_ms <= kSmoothMs || performance.now() - last_input > kSettleMs) return 1;
    return whole_ms <= kHalfMs ? 2 : 4;
  }

  function pump() {
    if (running || paused || !open || !(dirty || coarse)) return;
    const rest = last_input + kSettleMs - performance.now();
    if (dirty || rest <= 0) {
      draw();
    } else {
      clearTimeout(timer);
      timer = setTimeout(pump, rest + 1);
    }
  }

  // Ends the running frame, once it is late, for the state has changed.
  function give_way() {
    clearTimeout(way_timer);
    if (!running || !dirty) return;
    const limit_ms = running.preview === 1 ? kSmoothMs : kLateMs;
    const rest = running.began + limit_ms - performance.now();
    if (rest <= 0) engine.cancel_running();
    else way_timer = setTimeout(give_way, rest + 1);
  }

  // The edited side comes last: the truth and the pixel are asked of the last frame.
  function sides_in_order(state) {
    const order = state.sides.map((_, index) => index);
    return order.filter((index) => index !== state.editing).concat(state.editing);
  }

  async function draw() {
    const state = store.get();
    const preview = preview_of(state);
    dirty = false;
    running = { began: performance.now(), preview };
    let last = null;
    for (const index of sides_in_order(state)) {
      // A hash takes longer than showing the picture; nobody reads it from one that moves.
      const request = frame_request(state, state.sides[index], preview, !moving());
      const { reply, pixels } = await engine.ask(request, kUrgent);
      if (reply.cancelled || !open) {
        was_slow ||= open && preview === 1;
        whole_ms = Math.max(whole_ms, (performance.now() - running.began) * preview * preview);
        last = null;
        break;
      }
      if (reply.error) {
        on_error(reply.error);
        last = null;
        break;
      }
      paint(index, reply, pixels, state, preview);
      last = reply;
    }
    const wall_ms = performance.now() - running.began;
    running = null;
    failed = !last;
    if (last) {
      coarse = preview > 1;
      if (coarse) {
        // Without going to and fro: after a slow one a whole frame must be sure to be quick.
        whole_ms = (wall_ms - (was_slow ? 0 : kFixedMs)) * preview * preview;
      } else {
        whole_ms = is_cold ? Math.min(wall_ms, kHalfMs) : wall_ms;
        was_slow = !is_cold && wall_ms > kSmoothMs;
        is_cold = false;
      }
      if (setting_key(state) !== timed) timings = [];
      timed = setting_key(state);
      if (!coarse) timings.push({ wall_ms, draw_ms: last.draw_ms, filter_ms: last.filter_ms });
      if (timings.length > kKept) timings.shift();
      on_error("");
      on_frame(last, coarse, state, wall_ms);
    } else if (!dirty) {
      coarse = false;  // an error will not go away by itself
    }
    pump();
    on_settled(!waits());
  }

  return {
    /** The picture is not the state's any more. `by_hand`: somebody is moving something. */
    want(by_hand = true) {
      dirty = true;
      on_settled(false);
      if (by_hand) last_input = performance.now();
      engine.cancel_background();
      if (by_hand || !moving()) give_way();
      pump();
    },
    pause(on) {
      paused = on;
      if (on && running) {
        dirty = true;
        engine.cancel_running();
      }
      pump();
    },
    /** While a scene is being opened no frame is asked for, and what runs ends early. */
    set_open(on) {
      open = on;
      whole_ms = 0;
      was_slow = false;
      is_cold = true;
      if (!on) {
        engine.cancel_running();
        on_settled(false);
      }
      pump();
    },
    /** Whether the shown picture is whole and the state's. */
    settled,
    busy_for_ms: () => (running ? performance.now() - running.began : 0),
    /** Of whole frames of the state's setting. */
    timings: () => (timed === setting_key(store.get()) ? timings.slice() : []),
  };
}
