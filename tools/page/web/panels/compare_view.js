// One picture or two with a divider: what lies right of it is the second setting's.

import { by_id, paint_pixels } from "../dom.js";
import { make_maps } from "../maps.js";

export function start_compare_view(store) {
  const canvases = [by_id("canvas-a"), by_id("canvas-b")];
  const divider = by_id("divider");
  const maps = make_maps(canvases);
  const marks = [by_id("mark-a"), by_id("mark-b")];

  divider.addEventListener("input", () => store.change({ divider: divider.valueAsNumber / 100 }));
  divider.addEventListener("keydown", (event) => {
    const percent = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!percent) return;
    event.preventDefault();
    divider.value = divider.valueAsNumber + percent;
    store.change({ divider: divider.valueAsNumber / 100 });
  });

  /** A coarse map's circles are in pixels of the coarse picture. */
  function numbers_of(kind, pixels, preview) {
    const numbers = new Float32Array(pixels);
    return kind === "coc" && preview > 1 ? numbers.map((radius) => radius * preview) : numbers;
  }

  function put(side, kind, { width, height, numbers, max_coc_px }, pixels, preview, only) {
    if (numbers) {
      const limit = kind === "coc" ? preview * max_coc_px : Infinity;
      maps.paint(side, { kind, width, height, limit, numbers: numbers_of(kind, pixels, preview) }, only);
    } else {
      maps.clear(side);
      paint_pixels(canvases[side], width, height, pixels);
    }
  }

  return {
    /** `kind` is what `reply` shows. */
    paint(side, kind, reply, pixels, preview) {
      const { width, height } = reply;
      // A failure case is square, whatever size is chosen.
      const aspect = Math.round(100 * width / height) / 100;
      document.documentElement.style.setProperty("--aspect", aspect);
      document.documentElement.dataset.shape = aspect < 1.5 ? "square" : "wide";
      put(side, kind, reply, pixels, preview, store.get().sides.length < 2);
    },
    /** The truth and its error take the place of the edited picture, whichever it is. */
    paint_over(state, kind, reply, pixels) {
      put(state.editing, kind, reply, pixels, 1, true);
    },
    update(state) {
      const two = state.sides.length > 1;
      const over = state.show === "truth" || state.show === "error";
      const split = two && !over;
      canvases[0].hidden = over && state.editing === 1;
      canvases[1].hidden = !two || (over && state.editing === 0);
      canvases[1].style.clipPath = split ? `inset(0 0 0 ${100 * state.divider}%)` : "";
      divider.hidden = !split;
      marks.forEach((mark) => { mark.hidden = !split; });
      if (document.activeElement !== divider) divider.value = 100 * state.divider;
      divider.setAttribute("aria-valuetext", `${Math.round(100 * state.divider)} % from the left`);
    },
  };
}
