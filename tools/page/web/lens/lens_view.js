// The lens of the edited setting, as the diagram and the equations show it.

import { circle_on_film, film_height, hyperfocal_distance_m, image_distance, radius_px,
         sharp_limits_m, usable_lens } from "./lens.js";
import { make_lens_diagram } from "./lens_diagram.js";
import { show_equations } from "./equations.js";

/** What is drawn and written, or null for a lens that cannot be. */
export function lens_numbers(state, side, focus_m, object_m, fov_y_degrees) {
  const lens = { focal_length_mm: side.focal_length_mm, f_number: side.f_number, focus_m };
  if (!usable_lens(lens) || !(fov_y_degrees > 0)) return null;
  const height_px = state.size[1];
  const largest_circle_mm = film_height(lens, fov_y_degrees) / height_px;
  const radius_at = (metres) => radius_px(lens, metres, fov_y_degrees, height_px, side.coc_scale);
  return {
    lens, object_m, fov_y_degrees, height_px, largest_circle_mm,
    max_coc_px: side.max_coc_px,
    radius_px: radius_at(object_m),
    at_infinity_px: radius_at(1e12),
    hyperfocal_m: hyperfocal_distance_m(lens, largest_circle_mm),
    image_mm: image_distance(lens, object_m),
    circle_mm: circle_on_film(lens, object_m),
    ...sharp_limits_m(lens, largest_circle_mm),
  };
}

export function start_lens_view(store) {
  const diagram = make_lens_diagram({
    on_object: (metres) => store.change({ object_m: metres }),
    on_focus: (metres) => store.change_side({ focus: { m: metres } }),
  });
  return {
    show(numbers) {
      if (!numbers) return;
      diagram.show(numbers);
      show_equations(numbers);
    },
  };
}
