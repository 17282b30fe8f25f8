// One picture or two with a divider: what lies right of it is the second setting's.

import { by_id, paint_pixels } from "../dom.js";

export function start_compare_view(store) {
  const canvases = [by_id("canvas-a"), by_id("canvas-b")];
  const divider = by_id("divider");
  const marks = [by_id("mark-a"), by_id("mark-b")];

  divider.addEventListener("input", () => store.change({ divider: divider.valueAsNumber / 100 }));
  divider.addEventListener("keydown", (event) => {
    const percent = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!percent) return;
    event.preventDefault();
    divider.value = divider.valueAsNumber + percent;
    store.change({ divider: divider.valueAsNumber / 100 });
  });

  return {
    paint(side, { width, height }, pixels) {
      // A failure case is square, whatever size is chosen.
      const aspect = Math.round(100 * width / height) / 100;
      document.documentElement.style.setProperty("--aspect", aspect);
      document.documentElement.dataset.shape = aspect < 1.5 ? "square" : "wide";
      paint_pixels(canvases[side], width, height, pixels);
    },
    /** The truth and its error take the place of the edited picture, whichever it is. */
    paint_over(state, reply, pixels) {
      paint_pixels(canvases[state.editing], reply.width, reply.height, pixels);
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
