// The thin lens of dof/lens.h, for what must follow the pointer without asking the worker.
// Millimetres unless a name ends in _m or _px.

export function aperture_of(lens) {
  return lens.focal_length_mm / lens.f_number;
}

/** v = f z / (z - f), eq. 1; negative in front of the focal length, infinite at it. */
export function image_distance(lens, distance_m) {
  const z = distance_m * 1000;
  return lens.focal_length_mm * z / (z - lens.focal_length_mm);
}

/** c = A f |z - z_f| / (z (z_f - f)), eq. 2. */
export function circle_on_film(lens, distance_m) {
  const z = distance_m * 1000;
  const focus = lens.focus_m * 1000;
  const f = lens.focal_length_mm;
  return aperture_of(lens) * f * Math.abs(z - focus) / (z * (focus - f));
}

/** H = f^2 / (N c) + f, eq. 4. */
export function hyperfocal_distance_m(lens, largest_circle_mm) {
  const f = lens.focal_length_mm;
  return (f * f / (lens.f_number * largest_circle_mm) + f) / 1000;
}

/** The distances between which the circle is at most `largest_circle_mm`: eq. 5 and 6, exactly. */
export function sharp_limits_m(lens, largest_circle_mm) {
  const a_f = aperture_of(lens) * lens.focal_length_mm;
  const spread = largest_circle_mm * (lens.focus_m * 1000 - lens.focal_length_mm);
  return {
    near_m: a_f * lens.focus_m / (a_f + spread),
    far_m: spread < a_f ? a_f * lens.focus_m / (a_f - spread) : Infinity,
  };
}

/** The film that sees the field of view: 2 v0 tan(fov/2). */
export function film_height(lens, fov_y_degrees) {
  return 2 * image_distance(lens, lens.focus_m) * Math.tan(fov_y_degrees * Math.PI / 360);
}

/** The field of view of a film of that height, behind a lens focused at lens.focus_m. */
export function field_of_view_degrees(lens, film_height_mm) {
  return Math.atan(film_height_mm / (2 * image_distance(lens, lens.focus_m))) * 360 / Math.PI;
}

/** The focal length whose lens, focused at focus_m, has that field of view on a film of that height. */
export function focal_length_for(film_height_mm, fov_y_degrees, focus_m) {
  const image_mm = film_height_mm / (2 * Math.tan(fov_y_degrees * Math.PI / 360));
  return image_mm * focus_m * 1000 / (image_mm + focus_m * 1000);
}

/** Signed radius in pixels, negative before the focus. */
export function radius_px(lens, distance_m, fov_y_degrees, height_px, coc_scale) {
  const per_tangent = height_px / (2 * Math.tan(fov_y_degrees * Math.PI / 360));
  const at_infinity = aperture_of(lens) / 2000 / lens.focus_m * per_tangent * coc_scale;
  return at_infinity * (distance_m - lens.focus_m) / distance_m;
}

/** Whether the lens can be focused there. */
export function usable_lens(lens) {
  return lens.focal_length_mm > 0 && lens.f_number > 0 &&
         lens.focus_m * 1000 > lens.focal_length_mm && Number.isFinite(lens.focus_m);
}
