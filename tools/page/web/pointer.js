// Mouse, pen, fingers and keys on the picture: orbit, pan, dolly, walk, and where to focus.

import { arm_length_m, dollied, orbited, panned, walked } from "./camera.js";

const kClickPx = 5;      // a press that moves less is a click
const kTurn = 4;         // radians of orbit across the picture's height
const kWalkPart = 0.8;   // of the distance to the target, a second
const kTurnPerS = 1.2;   // radians, by the arrow keys
const kShortPressS = 0.04;  // a key moves at least as much as in that time

const kWalkKeys = {
  KeyW: [0, 0, 1], KeyS: [0, 0, -1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0],
  PageUp: [0, 1, 0], PageDown: [0, -1, 0],
};
const kOrbitKeys = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const kDollyKeys = { "+": -1, "=": -1, "-": 1, _: 1 };

/**
 * `camera()` gives the camera or null where there is none, `move(camera)` sets it,
 * `focus_at([x, y])` takes a place in the picture, `focus_place()` gives the last one or null,
 * `point_at([x, y] or null)` is told where the pointer rests. `turn_light(right, up)`, in radians,
 * turns the light in place of the camera, and returns whether it did.
 */
export function start_pointer(picture, { camera, move, turn_light, focus_at, focus_place, point_at }) {
  const down = new Map();  // pointers by id: {x, y}
  let travelled = 0;
  let pan = false;
  let several = false;

  const place_of = (event) => {
    const box = picture.getBoundingClientRect();
    const part = (at, from, size) => Math.min(1, Math.max(0, (at - from) / size));
    return [part(event.clientX, box.left, box.width), part(event.clientY, box.top, box.height)];
  };
  const moved = (change) => {
    const now = camera();
    if (now) move(change(now));
  };

  function gesture_of() {
    const [a, b] = [...down.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  }

  picture.addEventListener("pointerdown", (event) => {
    if (event.target.id === "divider") return;
    if (down.size === 0) {
      travelled = 0;
      several = false;
    }
    pan = event.button > 0 || event.shiftKey || event.ctrlKey;
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    several ||= down.size > 1;
    picture.setPointerCapture(event.pointerId);
    picture.focus({ preventScroll: true });
    event.preventDefault();
  });

  picture.addEventListener("pointermove", (event) => {
    const last = down.get(event.pointerId);
    if (!last) {
      if (event.target.id !== "divider") point_at(place_of(event));
      return;
    }
    const height = picture.clientHeight;
    const before = down.size === 2 ? gesture_of() : null;
    const dx = event.clientX - last.x;
    const dy = event.clientY - last.y;
    travelled += Math.hypot(dx, dy);
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (before) {
      const after = gesture_of();
      moved((c) => panned(dollied(c, before.apart / Math.max(after.apart, 1)),
                          (before.x - after.x) / height, (after.y - before.y) / height));
    } else if (down.size === 1 && travelled > kClickPx) {
      if (!pan && turn_light(dx / height * kTurn, -dy / height * kTurn)) return;
      moved((c) => (pan ? panned(c, -dx / height, dy / height)
                        : orbited(c, dx / height * kTurn, dy / height * kTurn)));
    }
  });

  picture.addEventListener("pointerup", (event) => {
    const was_down = down.delete(event.pointerId);
    if (was_down && down.size === 0 && !several && !pan && travelled <= kClickPx) {
      focus_at(place_of(event));
    }
  });
  picture.addEventListener("pointercancel", (event) => down.delete(event.pointerId));
  picture.addEventListener("pointerleave", () => point_at(null));
  picture.addEventListener("contextmenu", (event) => event.preventDefault());
  picture.addEventListener("wheel", (event) => {
    // With Ctrl the browser zooms the page, or a trackpad pinches.
    const notches = event.deltaMode === 0 ? event.deltaY / 100 : event.deltaY / 3;
    if (!camera()) return;
    event.preventDefault();
    moved((c) => dollied(c, 1.1 ** Math.max(-4, Math.min(4, notches))));
  }, { passive: false });

  const held = new Set();
  let last_turn = 0;

  function move_on(seconds) {
    const turn = kTurnPerS * seconds;
    const turned = [...held].filter((key) => kOrbitKeys[key] && turn_light(
        kOrbitKeys[key][0] * turn, kOrbitKeys[key][1] * turn));
    moved((c) => {
      let next = c;
      const speed = kWalkPart * arm_length_m(c) * seconds;
      for (const key of held) {
        if (turned.includes(key)) continue;
        const walk = kWalkKeys[key];
        const orbit = kOrbitKeys[key];
        if (walk) next = walked(next, walk[0] * speed, walk[1] * speed, walk[2] * speed);
        else next = orbited(next, -orbit[0] * turn, orbit[1] * turn);
      }
      return next;
    });
  }

  function walk_on(now) {
    if (held.size === 0) return;
    // The browser's clock of frames may lag behind that of keys.
    move_on(Math.min(Math.max(now - last_turn, 0) / 1000, 0.1));
    last_turn = now;
    requestAnimationFrame(walk_on);
  }

  function hold(code) {
    if (held.has(code)) return;
    held.add(code);
    move_on(kShortPressS);
    if (held.size > 1) return;
    last_turn = performance.now();
    requestAnimationFrame(walk_on);
  }

  document.addEventListener("keyup", (event) => held.delete(event.code));
  window.addEventListener("blur", () => held.clear());

  return {
    /** Takes a key if it moves something; `on_picture`: the picture has the keyboard's focus. */
    key(event, on_picture) {
      if (event.ctrlKey || event.metaKey) return false;
      const by_arrow = kOrbitKeys[event.code];
      if (by_arrow && on_picture && (event.shiftKey || event.altKey)) {
        const [x, y] = focus_place() ?? [0.5, 0.5];
        const clamp = (at) => Math.min(1, Math.max(0, Number(at.toFixed(3))));
        focus_at([clamp(x + by_arrow[0] * 0.02), clamp(y - by_arrow[1] * 0.02)]);
        return true;
      }
      if (event.altKey) return false;
      if (on_picture && event.key === "Enter") {
        focus_at(focus_place() ?? [0.5, 0.5]);
        return true;
      }
      if (event.key in kDollyKeys) {
        if (!event.repeat || camera()) moved((c) => dollied(c, 1.1 ** kDollyKeys[event.key]));
        return true;
      }
      const walks = kWalkKeys[event.code] && !event.shiftKey &&
                    (on_picture || !event.code.startsWith("Page"));
      if (walks || (by_arrow && on_picture)) {
        hold(event.code);
        return true;
      }
      return false;
    },
  };
}
