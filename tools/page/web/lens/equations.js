// Equations 1 to 6 of the thesis, filled with this lens's numbers, and the limits that follow.

import { by_id, element } from "../dom.js";
import { aperture_of, circle_on_film, image_distance } from "./lens.js";
import { metres_text, millimetres_text, pixels_text, three_digits } from "../units.js";

/** "z_f" with its index lowered. */
function with_indices(text) {
  return text.split(/_([a-z]+)/).map((part, index) => (index % 2 ? element("sub", {}, part) : part));
}

function fraction(above, below) {
  return element("span", { class: "frac" }, element("span", {}, ...with_indices(above)),
                 element("span", { class: "unseen" }, " over "),
                 element("span", {}, ...with_indices(below)));
}

function equation(number, name, source, ...parts) {
  return element("div", { class: "equation" },
                 element("span", { class: "number-of" }, number),
                 element("span", { class: "body" }, ...parts.flatMap(
                     (part) => (typeof part === "string" ? with_indices(part) : [part]))),
                 element("span", { class: "source" }, `${name} · ${source}`));
}

function limit(name, value, kind = "") {
  return element("div", { class: kind }, element("dt", {}, name), element("dd", {}, value));
}

/** `numbers` as in lens_diagram.js, with largest_circle_mm, the circle that still counts as sharp. */
export function show_equations(numbers) {
  const { lens, object_m, near_m, far_m, hyperfocal_m, largest_circle_mm, radius_px } = numbers;
  const f = three_digits(lens.focal_length_mm);
  const N = three_digits(lens.f_number);
  const z = three_digits(object_m * 1000);
  const z_f = three_digits(lens.focus_m * 1000);
  const v = image_distance(lens, object_m);
  const A = three_digits(aperture_of(lens));
  const c = circle_on_film(lens, object_m);
  const c_max = three_digits(largest_circle_mm);
  const n = hyperfocal_m / lens.focus_m;
  const H = metres_text(hyperfocal_m);
  by_id("equations").replaceChildren(
    equation("1", "lens law", "image_distance_mm",
             "v = ", fraction("f z", "z − f"), " = ", fraction(`${f} · ${z}`, `${z} − ${f}`),
             ` = ${millimetres_text(v)}`),
    equation("2", `circle on film, its width; its radius is ${pixels_text(Math.abs(radius_px))}`, "coc_on_film_mm",
             "c = ", fraction("A f |z − z_f|", "z (z_f − f)"), " = ",
             fraction(`${A} · ${f} · |${z} − ${z_f}|`, `${z} · (${z_f} − ${f})`),
             ` = ${millimetres_text(c)}`),
    equation("3", "aperture", "aperture_mm",
             "A = ", fraction("f", "N"), " = ", fraction(f, N),
             ` = ${millimetres_text(aperture_of(lens))}`),
    equation("4", "hyperfocal distance", "hyperfocal_m",
             "H = ", fraction("f²", "N c_max"), " + f = ", fraction(`${f}²`, `${N} · ${c_max}`),
             ` + ${f} = ${H}`),
    equation("5", "near limit", "sharp_range",
             "z_near ≈ ", fraction("H", "n + 1"), " = ", fraction(H, `${three_digits(n)} + 1`),
             ` = ${metres_text(hyperfocal_m / (n + 1))}`),
    equation("6", "far limit", "sharp_range",
             "z_far ≈ ", fraction("H", "n − 1"), " = ", fraction(H, `${three_digits(n)} − 1`),
             ` = ${n > 1 ? metres_text(hyperfocal_m / (n - 1)) : "∞"}`),
    element("p", { class: "quiet small" },
            `Lengths in mm. n = H / z_f. Sharp is a circle of one pixel, c_max = ${
              millimetres_text(largest_circle_mm)} on film. The limits above are exact, ` +
            "equations 5 and 6 up to the + f in H. Source: dof/lens.h, docs/lens.md."));
  by_id("limits").replaceChildren(
    limit("Sharp from", metres_text(near_m)),
    limit("Focus", metres_text(lens.focus_m), "focus"),
    limit("Sharp to", metres_text(far_m)),
    limit("Hyperfocal", H),
    limit("Radius at ∞", pixels_text(numbers.at_infinity_px)),
    limit("Object’s radius", pixels_text(Math.abs(radius_px)), "object"));
}
