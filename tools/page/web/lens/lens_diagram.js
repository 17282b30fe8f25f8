// The lens to scale, in three drawings with a scale bar each: what is before the lens in metres,
// what is behind it in millimetres, and the circle on the film among the pixels. One drawing
// cannot hold them: film and scene differ by a factor of a thousand.

import { by_id, svg_element } from "../dom.js";
import { aperture_of, film_height, image_distance } from "./lens.js";
import { make_trail } from "../numbers.js";
import { metres_text, millimetres_text, three_digits } from "../units.js";

const kHeight = 150;  // of each drawing, in CSS pixels

/** The next of 1, 2, 5, 10, ... that is at least `value`. */
function round_up(value) {
  const ten = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((x) => x * ten).find((x) => x >= value * (1 - 1e-9));
}

function line(x1, y1, x2, y2, kind) {
  return svg_element("line", { x1, y1, x2, y2, class: kind });
}

function text(x, y, words, anchor = "start", kind = "") {
  return svg_element("text", { x, y, "text-anchor": anchor, class: kind }, words);
}

/** A bar of a round length that takes at most a third of the drawing. */
function scale_bar(per_pixel, width, words) {
  const length = round_up(width / 3 * per_pixel) > width / 3 * per_pixel
      ? round_up(width / 3 * per_pixel) / 2 : round_up(width / 3 * per_pixel);
  const pixels = length / per_pixel;
  const y = kHeight - 8;
  return [line(8, y, 8 + pixels, y, "bar"), line(8, y - 4, 8, y + 4, "bar"),
          line(8 + pixels, y - 4, 8 + pixels, y + 4, "bar"),
          text(14 + pixels, y + 4, words(length), "start", "quiet")];
}

function lens_shape(x, y, half) {
  const bulge = Math.max(2, half / 5);
  return svg_element("path", {
    d: `M${x} ${y - half}Q${x + bulge} ${y} ${x} ${y + half}Q${x - bulge} ${y} ${x} ${y - half}Z`,
    class: "glass",
  });
}

function clear(svg) {
  const width = Math.max(svg.clientWidth, 120);
  svg.setAttribute("viewBox", `0 0 ${width} ${kHeight}`);
  svg.replaceChildren();
  return width;
}

/**
 * Draws `numbers` (lens, object_m, fov_y_degrees, near_m, far_m, hyperfocal_m, height_px,
 * radius_px, max_coc_px) and lets the object and the focus be dragged:
 * on_object(metres), on_focus(metres).
 */
export function make_lens_diagram({ on_object, on_focus }) {
  const world = by_id("diagram-world");
  const camera = by_id("diagram-camera");
  const film = by_id("diagram-film");
  let numbers = null;
  let extent_m = 1;
  let held = null;
  let width = 0;

  const object = svg_element("g", { class: "handle object", tabindex: 0, role: "slider",
                                    "aria-label": "Object", id: "object-handle" });
  const focus = svg_element("g", { class: "handle focus", tabindex: 0, role: "slider",
                                   "aria-label": "Focus", id: "focus-handle" });

  const lens_x = () => width - 14;
  const x_of = (metres) => lens_x() - metres / extent_m * (lens_x() - 14);
  const metres_at = (x) => (lens_x() - x) / (lens_x() - 14) * extent_m;

  function place_handle(handle, metres, mark) {
    const x = x_of(Math.min(metres, extent_m));
    const grip = svg_element("rect", { x: x - 12, y: 12, width: 24, height: kHeight - 36,
                                       class: "grip" });
    handle.replaceChildren(grip, ...mark(x));
    handle.setAttribute("aria-valuenow", String(Number(metres.toPrecision(3))));
    handle.setAttribute("aria-valuemin", "0");
    handle.setAttribute("aria-valuemax", String(extent_m));
    handle.setAttribute("aria-valuetext", metres_text(metres));
  }

  function draw_world() {
    const { lens, object_m, fov_y_degrees, near_m, far_m, hyperfocal_m } = numbers;
    const middle = (kHeight - 16) / 2;
    const per_pixel = extent_m / (lens_x() - 14);
    const half = Math.min(aperture_of(lens) / 2000 / per_pixel, middle - 4);
    const seen = (x) => Math.min((lens_x() - x) * Math.tan(fov_y_degrees * Math.PI / 360),
                                 middle - 2);
    const shape = [];
    shape.push(svg_element("path", { class: "seen",
      d: `M${lens_x()} ${middle}L14 ${middle - seen(14)}V${middle + seen(14)}Z` }));
    const far_x = x_of(Math.min(far_m, extent_m));
    const near_x = x_of(Math.min(near_m, extent_m));
    shape.push(svg_element("rect", { x: far_x, y: 2, width: Math.max(near_x - far_x, 0.5),
                                     height: 2 * middle - 4, class: "sharp" }));
    shape.push(line(2, middle, width - 2, middle, "axis"));
    if (hyperfocal_m < extent_m) {
      shape.push(line(x_of(hyperfocal_m), middle - 10, x_of(hyperfocal_m), middle + 10, "hyper"));
      shape.push(text(x_of(hyperfocal_m), middle - 14, "H", "middle", "quiet"));
    }
    const from = x_of(Math.min(object_m, extent_m));
    shape.push(svg_element("path", { class: "cone object",
      d: `M${from} ${middle}L${lens_x()} ${middle - half}V${middle + half}Z` }));
    shape.push(lens_shape(lens_x(), middle, Math.max(half, 3)));
    world.append(...shape);
    const beyond = object_m > extent_m;
    place_handle(focus, lens.focus_m, (x) => [
      line(x, middle - Math.max(seen(x), 24), x, middle + Math.max(seen(x), 24), "plane"),
      text(x, 11, `focus ${metres_text(lens.focus_m)}`,
           x < 60 ? "start" : x > width - 60 ? "end" : "middle", "focus")]);
    place_handle(object, object_m, (x) => [
      svg_element("circle", { cx: x, cy: middle, r: 6, class: "dot" }),
      text(x, kHeight - 26, `${beyond ? "← " : ""}object ${metres_text(object_m)}`,
           x < 60 ? "start" : x > width - 60 ? "end" : "middle", "object")]);
    world.append(focus, object);
    world.append(...scale_bar(per_pixel, width, metres_text));
  }

  function draw_camera() {
    const { lens, object_m, fov_y_degrees } = numbers;
    const across = clear(camera);
    const middle = (kHeight - 16) / 2;
    const x0 = 16;
    const v0 = image_distance(lens, lens.focus_m);
    const v = image_distance(lens, object_m);
    const height = film_height(lens, fov_y_degrees);
    const room = middle - 16;
    const per_pixel = Math.max(v0 / (across - x0 - 56), height / 2 / room,
                               aperture_of(lens) / 2 / room);
    const film_x = x0 + v0 / per_pixel;
    const half = aperture_of(lens) / 2 / per_pixel;
    // Straight lines from the lens's rim through the image at v, cut at the drawing's end. A
    // virtual image has v < 0 and rays that go apart; at infinity they stay parallel.
    const slope = Number.isFinite(v) ? -half / (v / per_pixel) : 0;
    const rays = (x1, y1) => `M${x0} ${middle - half}L${x1} ${middle - y1}M${x0} ${middle + half}` +
                             `L${x1} ${middle + y1}`;
    const end = across - 2;
    camera.append(
      line(2, middle, across - 2, middle, "axis"),
      svg_element("path", { class: "ray focus", d: rays(film_x, 0) }),
      svg_element("path", { class: "ray object", d: rays(end, half + slope * (end - x0)) }),
      line(film_x, middle - height / 2 / per_pixel, film_x, middle + height / 2 / per_pixel,
           "film"));
    by_id("camera-caption").textContent =
        `Behind the lens, ${millimetres_text(aperture_of(lens))} wide`;
    const on_film = Math.abs(half + slope * (film_x - x0));
    camera.append(line(film_x, middle - on_film, film_x, middle + on_film, "circle"),
                  lens_shape(x0, middle, half),
                  text(across - 4, 11, `film ${millimetres_text(height)}`, "end"),
                  ...scale_bar(per_pixel, across, millimetres_text));
  }

  function draw_film() {
    const { radius_px, max_coc_px, lens, fov_y_degrees, height_px } = numbers;
    const across = clear(film);
    const room = kHeight - 24;
    const radius = Math.abs(radius_px);
    const drawn = Math.min(radius, 1e6);
    const cells = [8, 16, 32, 64, 128, 256, 512, 1024, 4096, 16384].find((n) => n >= 2.4 * drawn) ??
                  65536;
    const size = room / cells;
    const middle_x = across / 2;
    const middle_y = 4 + room / 2;
    const left = middle_x - Math.floor(middle_x / size) * size;
    if (size >= 4) {
      let grid = "";
      for (let x = left; x <= across; x += size) grid += `M${x} 4V${4 + room}`;
      for (let i = 0; i <= cells; i++) grid += `M0 ${4 + i * size}H${across}`;
      film.append(svg_element("path", { d: grid, class: "grid" }));
    }
    film.append(svg_element("circle", { cx: middle_x, cy: middle_y, r: Math.max(drawn * size, 1),
                                        class: "disc" }));
    const cut = radius > max_coc_px;
    if (max_coc_px * size < room) {
      film.append(svg_element("circle", { cx: middle_x, cy: middle_y, r: max_coc_px * size,
                                          class: "limit" }));
    }
    const mm = film_height(lens, fov_y_degrees) / height_px;
    const bar = size >= 4 ? `1 square = 1 px = ${millimetres_text(mm)}`
                          : `height = ${cells} px = ${millimetres_text(cells * mm)}`;
    film.append(text(4, kHeight - 5, bar, "start", "quiet halo"),
                text(across - 4, 16, `r = ${three_digits(radius)} px${cut ? ", cut" : ""}`, "end",
                     "object halo"));
  }

  function draw() {
    if (!numbers || world.clientWidth === 0) return;
    width = clear(world);
    // While something is dragged the scale stays, or the thing would run away.
    if (!held) extent_m = round_up(2.2 * numbers.lens.focus_m);
    draw_world();
    draw_camera();
    draw_film();
  }

  function drag(event) {
    if (!held) return;
    const at = event.clientX - world.getBoundingClientRect().left;
    const least = numbers.lens.focal_length_mm / 1000 * 1.05;
    const metres = Math.min(extent_m, Math.max(least, metres_at(at)));
    held(Number(metres.toPrecision(3)));
  }

  function make_handle(handle, set, get) {
    const trail = make_trail();
    handle.addEventListener("pointerdown", (event) => {
      held = set;
      world.setPointerCapture(event.pointerId);
      handle.focus();
      event.preventDefault();
    });
    handle.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1, PageUp: 8, PageDown: -8 }[event.key];
      if (!steps) return;
      event.preventDefault();
      event.stopPropagation();
      const least = numbers.lens.focal_length_mm / 1000 * 1.05;
      set(trail(get(), steps, () => Number(Math.max(get() * 1.05 ** steps, least).toPrecision(3))));
    });
  }
  make_handle(object, on_object, () => numbers.object_m);
  make_handle(focus, on_focus, () => numbers.lens.focus_m);
  world.addEventListener("pointermove", drag);
  for (const name of ["pointerup", "pointercancel"]) {
    world.addEventListener(name, () => {
      held = null;
      draw();
    });
  }
  new ResizeObserver(draw).observe(world);

  return {
    show(next) {
      const focused = document.activeElement;
      numbers = next;
      draw();
      // Moved nodes lose the keyboard's focus.
      if (focused === object || focused === focus) focused.focus();
    },
  };
}
