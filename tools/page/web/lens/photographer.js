// Photographer's mode: a sensor, stops in thirds, and the field of view that follows from them.

import { sensors } from "../state.js";
import { field_of_view_degrees, film_height, focal_length_for, usable_lens } from "./lens.js";

/** Stops in thirds as lenses are marked. */
export const kStops = [
  0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4, 4.5, 5, 5.6, 6.3, 7.1,
  8, 9, 10, 11, 13, 14, 16, 18, 20, 22, 25, 29, 32, 36, 40, 45, 51, 57, 64,
];

export function nearest_stop(f_number) {
  return kStops.reduce((best, stop) => (Math.abs(Math.log(stop / f_number)) <
                                        Math.abs(Math.log(best / f_number)) ? stop : best));
}

/** The height of film that a picture of that shape uses: the sensor is cropped to the shape. */
export function used_film_height_mm(sensor, [width, height]) {
  const { width_mm, height_mm } = sensors.find(({ name }) => name === sensor) ?? sensors[0];
  return Math.min(height_mm, width_mm * height / width);
}

/** The vertical field of view of the locked lens, or null if the lens is not locked or usable. */
export function locked_fov_degrees(state, lens) {
  if (!state.photo.on || !state.photo.lock || !usable_lens(lens)) return null;
  const degrees = field_of_view_degrees(lens, used_film_height_mm(state.photo.sensor, state.size));
  return Number(degrees.toPrecision(6));
}

/**
 * What gives way when `photo` becomes `next`, so that the rest is kept: {focal_length_mm} with the
 * framing, {fov_y_degrees} with the focal length, or {}. `lens` has its focus. Where the focal length
 * does not set the field of view, a film twice as high is twice the film that was used.
 */
export function adapted(state, next, lens, fov_y_degrees) {
  const { photo, size } = state;
  const locks = next.on && next.lock && !(photo.on && photo.lock);
  if (!next.on || !usable_lens(lens) || (next.sensor === photo.sensor && !locks)) return {};
  const used_mm = film_height(lens, fov_y_degrees);
  const film_mm = used_film_height_mm(next.sensor, size) *
                  (next.lock ? 1 : used_mm / used_film_height_mm(photo.sensor, size));
  return next.keep === "framing"
      ? { focal_length_mm: Number(focal_length_for(film_mm, fov_y_degrees, lens.focus_m).toPrecision(6)) }
      : { fov_y_degrees: Number(field_of_view_degrees(lens, film_mm).toPrecision(6)) };
}

/**
 * The focus distance at which another focal length shows what is in focus as large on the same film:
 * f / (z - f) stays, so z goes with f.
 */
export function zoomed_focus_m(lens, focal_length_mm) {
  return Number((lens.focus_m * focal_length_mm / lens.focal_length_mm).toPrecision(6));
}
