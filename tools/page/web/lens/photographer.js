// Photographer's mode: a sensor, stops in thirds, and the field of view that follows from them.

import { sensors } from "../state.js";
import { field_of_view_degrees, usable_lens } from "./lens.js";

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
