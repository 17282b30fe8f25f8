// The lens seen from the side: the scene before it, the film's side behind it, with the film under a
// magnifier, and the circle among the film's pixels. The object and the focus can be dragged.
//
// Nothing here asks the browser where something lies while it draws, for that would lay the page out
// anew each time: the drawings' widths come from an observer.

import { by_id, svg_element } from "../dom.js";
import { aperture_of, film_height, image_distance } from "./lens.js";
import { round_up } from "../maps.js";
import { make_trail } from "../numbers.js";
import { limit_text, metres_text, millimetres_text, three_digits } from "../units.js";

const kHeight = 150;    // of each drawing, in CSS pixels
const kMagnifier = 58;  // its radius
const kMost_m = 1000;   // that a hand reaches
const kTicks_m = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const kTickRoom = 34;   // between two

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

/**
 * Draws `numbers` (lens, object_m, fov_y_degrees, near_m, far_m, hyperfocal_m, height_px,
 * radius_px, max_coc_px) and lets the object and the focus be dragged:
 * on_object(metres), on_focus(metres).
 */
export function make_lens_diagram({ on_object, on_focus }) {
  const drawings = Object.fromEntries(["world", "camera", "film"].map((name) => [name, by_id(`diagram-${name}`)]));
  const widths = { world: 0, camera: 0, film: 0 };
  let numbers = null;
  let middle_m = 1;  // the distance in the middle of the scene's side
  let held = null;   // {set, left}
  let width = 0;

  const handle_of = (name, label) => svg_element("g", {
    class: `handle ${name}`, tabindex: 0, role: "slider", "aria-label": label, id: `${name}-handle`,
    "aria-valuemin": "0", "aria-valuemax": String(kMost_m) });
  const object = handle_of("object", "Object");
  const focus = handle_of("focus", "Focus");
  const under = svg_element("g");
  drawings.world.append(under, focus, object);

  // Distances go from the lens on the right to infinity on the left, by z / (z + z_middle): a
  // projection, under which straight lines stay straight.
  const lens_x = () => width - 14;
  const reach = () => lens_x() - 22;
  const x_of = (metres) => lens_x() - reach() * (Number.isFinite(metres) ? metres / (metres + middle_m) : 1);
  function metres_at(x) {
    const part = Math.min(Math.max((lens_x() - x) / reach(), 0), 1 - 1e-6);
    return middle_m * part / (1 - part);
  }

  function place_handle(handle, metres, mark) {
    const x = x_of(metres);
    const grip = svg_element("rect", { x: x - 12, y: 12, width: 24, height: kHeight - 36, class: "grip" });
    handle.replaceChildren(grip, ...mark(x));
    handle.setAttribute("aria-valuenow", String(Number(Math.min(metres, kMost_m).toPrecision(3))));
    handle.setAttribute("aria-valuetext", metres_text(metres));
  }

  const anchor_at = (x) => (x < 60 ? "start" : x > width - 60 ? "end" : "middle");

  function ticks(y) {
    const made = [];
    let last = Infinity;
    for (const metres of kTicks_m) {
      const x = x_of(metres);
      if (x > lens_x() - 20 || x < 22 + kTickRoom || last - x < kTickRoom) continue;
      last = x;
      made.push(line(x, y - 3, x, y + 3, "bar"), text(x, y + 15, `${limit_text(metres)} m`, "middle", "quiet"));
    }
    return [...made, line(22, y - 3, 22, y + 3, "bar"), text(22, y + 15, "∞", "middle", "quiet")];
  }

  function draw_world() {
    const { lens, object_m, fov_y_degrees, near_m, far_m, hyperfocal_m } = numbers;
    const base = kHeight - 22;
    const middle = (base + 12) / 2;
    const tangent = Math.tan(fov_y_degrees * Math.PI / 360);
    const room = base - middle - 4;
    // Heights are those at the lens; farther ones shrink as the projection has it.
    const per_pixel = middle_m * tangent / room;
    const half = Math.min(aperture_of(lens) / 2000 / per_pixel, room);
    const seen = (metres) => room * metres / (metres + middle_m);
    const far_x = x_of(far_m);
    const shape = [
      svg_element("path", { class: "seen", d: `M${lens_x()} ${middle}L22 ${middle - room}V${middle + room}Z` }),
      svg_element("rect", { x: far_x, y: middle - room, width: Math.max(x_of(near_m) - far_x, 1), height: 2 * room,
                            class: "sharp" }),
      line(2, middle, width - 2, middle, "axis"), line(22, base, lens_x(), base, "bar"), ...ticks(base)];
    if (Number.isFinite(hyperfocal_m)) {
      const x = x_of(hyperfocal_m);
      shape.push(line(x, middle - 10, x, middle + 10, "hyper"), text(x, middle - 14, "H", "middle", "quiet"));
    }
    if (far_m === Infinity) shape.push(text(26, middle + room - 2, "sharp to ∞", "start", "focus halo"));
    shape.push(svg_element("path", { class: "cone object",
      d: `M${x_of(object_m)} ${middle}L${lens_x()} ${middle - half}V${middle + half}Z` }),
               lens_shape(lens_x(), middle, Math.max(half, 3)));
    under.replaceChildren(...shape);
    const reach_of = Math.max(seen(lens.focus_m), 24);
    place_handle(focus, lens.focus_m, (x) => [
      line(x, middle - reach_of, x, middle + reach_of, "plane"),
      text(x, 10, `focus ${metres_text(lens.focus_m)}`, anchor_at(x), "focus halo")]);
    place_handle(object, object_m, (x) => [
      svg_element("circle", { cx: x, cy: middle, r: 6, class: "dot" }),
      text(x, middle + 22, `object ${metres_text(object_m)}`, anchor_at(x), "object halo")]);
  }

  function draw_camera() {
    const { lens, object_m, fov_y_degrees } = numbers;
    const across = widths.camera;
    const middle = (kHeight - 16) / 2;
    const x0 = 12;
    const v0 = image_distance(lens, lens.focus_m);
    const v = image_distance(lens, object_m);
    const height = film_height(lens, fov_y_degrees);
    const room = middle - 16;
    const glass_x = across - kMagnifier - 4;  // the magnifier's middle
    const per_pixel = Math.max(v0 / (glass_x - kMagnifier - x0 - 24), height / 2 / room, aperture_of(lens) / 2 / room);
    const film_x = x0 + v0 / per_pixel;
    const half = aperture_of(lens) / 2 / per_pixel;
    // The points lie off the axis, one on each side, so that their rays are apart: through the
    // lens's middle to a quarter of the film's height.
    const off = height / 4 / per_pixel;
    // A ray from the lens's rim at `rim` through the image at v, `to` from the film: at infinity the
    // two are parallel, a virtual image has v < 0 and rays that go apart.
    const at = (rim, side, image, x) => {
      const part = (x - x0) / (film_x - x0);
      return middle + side * off * part + rim * half * (1 - (Number.isFinite(image) ? v0 / image : 0) * part);
    };
    const pair = (side, image, end) => [-1, 1].map((rim) => (
        `M${x0} ${middle + rim * half}L${end} ${at(rim, side, image, end)}`)).join("");
    const end = film_x + 18;
    const spread = Math.abs(at(1, 1, v, film_x) - at(-1, 1, v, film_x));
    const on_film = middle + off;
    // So that the circle takes half of the glass, up to a thousand times, or the film a pixel.
    const power = round_up(Math.min(1000, Math.max(1, kMagnifier / Math.max(spread, 1e-6))) / 2);
    const image_x = Number.isFinite(v) && v > 0 ? x0 + v / per_pixel : Infinity;
    const enlarged = (x, y) => `${glass_x + (x - film_x) * power} ${middle + (y - on_film) * power}`;
    const reach_of = kMagnifier / power + 1e-9;
    const near_rays = [-1, 1].map((rim) => (
        `M${enlarged(film_x - reach_of, at(rim, 1, v, film_x - reach_of))}` +
        `L${enlarged(film_x + reach_of, at(rim, 1, v, film_x + reach_of))}`)).join("");
    const glass = svg_element("g", { "clip-path": "url(#magnified)" },
      svg_element("rect", { x: glass_x - kMagnifier, y: middle - kMagnifier, width: 2 * kMagnifier,
                            height: 2 * kMagnifier, class: "inside" }),
      line(glass_x, middle - kMagnifier, glass_x, middle + kMagnifier, "film"),
      svg_element("path", { class: "ray object", d: near_rays }),
      line(glass_x, middle - spread / 2 * power, glass_x, middle + spread / 2 * power, "circle"));
    if (Math.abs(image_x - film_x) < reach_of) {
      glass.append(svg_element("circle", { cx: glass_x + (image_x - film_x) * power,
                                           cy: middle + off * (v / v0 - 1) * power, r: 3.5, class: "dot" }));
    }
    drawings.camera.replaceChildren(
      svg_element("clipPath", { id: "magnified" }, svg_element("circle", { cx: glass_x, cy: middle, r: kMagnifier })),
      line(2, middle, film_x + 14, middle, "axis"),
      svg_element("path", { class: "ray focus", d: pair(-1, v0, film_x) }),
      svg_element("path", { class: "ray object", d: pair(1, v, end) }),
      line(film_x, middle - height / 2 / per_pixel, film_x, middle + height / 2 / per_pixel, "film"),
      line(film_x, on_film - spread / 2, film_x, on_film + spread / 2, "circle"),
      lens_shape(x0, middle, half), text(film_x, 10, `film ${millimetres_text(height)}`, "middle"),
      svg_element("path", { class: "hyper", d: `M${film_x} ${on_film - 5}L${glass_x} ${middle - kMagnifier}` +
                                               `M${film_x} ${on_film + 5}L${glass_x} ${middle + kMagnifier}` }),
      svg_element("circle", { cx: film_x, cy: on_film, r: 5, class: "lens-edge" }),
      glass, svg_element("circle", { cx: glass_x, cy: middle, r: kMagnifier, class: "lens-edge" }),
      text(glass_x, kHeight - 4, `× ${three_digits(power)}`, "middle", "quiet"),
      ...scale_bar(per_pixel, 2 * (film_x - x0), millimetres_text));
    by_id("camera-caption").textContent = 
        `Behind the lens, ${millimetres_text(aperture_of(lens))} wide`;
  }

  function draw_film() {
    const { radius_px, max_coc_px, lens, fov_y_degrees, height_px } = numbers;
    const across = widths.film;
    const room = kHeight - 24;
    const radius = Math.abs(radius_px);
    const drawn = Math.min(radius, 1e6);
    const cells = [8, 16, 32, 64, 128, 256, 512, 1024, 4096, 16384].find((n) => n >= 2.4 * drawn) ??
                  65536;
    const size = room / cells;
    const middle_x = across / 2;
    const middle_y = 4 + room / 2;
    const left = middle_x - Math.floor(middle_x / size) * size;
    const made = [];
    if (size >= 4) {
      let grid = "";
      for (let x = left; x <= across; x += size) grid += `M${x} 4V${4 + room}`;
      for (let i = 0; i <= cells; i++) grid += `M0 ${4 + i * size}H${across}`;
      made.push(svg_element("path", { d: grid, class: "grid" }));
    }
    made.push(svg_element("circle", { cx: middle_x, cy: middle_y, r: Math.max(drawn * size, 1), class: "disc" }));
    const cut = radius > max_coc_px;
    if (max_coc_px * size < room) {
      made.push(svg_element("circle", { cx: middle_x, cy: middle_y, r: max_coc_px * size, class: "limit" }));
    }
    const mm = film_height(lens, fov_y_degrees) / height_px;
    const bar = size >= 4 ? `1 px = ${millimetres_text(mm)}`
                          : `${cells} px = ${millimetres_text(cells * mm)}`;
    drawings.film.replaceChildren(...made, text(4, kHeight - 5, bar, "start", "quiet halo"),
                                  text(across - 4, 14, `radius ${three_digits(radius)} px${cut ? ", cut" : ""}`, "end",
                                       "object halo"));
  }

  function draw() {
    if (!numbers || widths.world === 0) return;
    width = widths.world;
    // While something is dragged the scale stays, or the thing would run away.
    if (!held) middle_m = numbers.lens.focus_m;
    draw_world();
    if (widths.camera > 0) draw_camera();
    if (widths.film > 0) draw_film();
  }

  const least_m = () => numbers.lens.focal_length_mm / 1000 * 1.05;

  function make_handle(handle, set, get) {
    const trail = make_trail();
    handle.addEventListener("pointerdown", (event) => {
      held = { set, left: drawings.world.getBoundingClientRect().left };
      drawings.world.setPointerCapture(event.pointerId);
      handle.focus();
      event.preventDefault();
    });
    handle.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1, PageUp: 8, PageDown: -8 }[event.key];
      if (!steps) return;
      event.preventDefault();
      event.stopPropagation();
      set(trail(get(), steps, () => Number(Math.max(get() * 1.05 ** steps, least_m()).toPrecision(3))));
    });
  }
  make_handle(object, on_object, () => numbers.object_m);
  make_handle(focus, on_focus, () => numbers.lens.focus_m);
  drawings.world.addEventListener("pointermove", (event) => {
    if (!held) return;
    const metres = Math.min(kMost_m, Math.max(least_m(), metres_at(event.clientX - held.left)));
    held.set(Number(metres.toPrecision(3)));
  });
  for (const name of ["pointerup", "pointercancel"]) {
    drawings.world.addEventListener(name, () => {
      held = null;
      draw();
    });
  }
  const observer = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) {
      const name = target.id.slice("diagram-".length);
      widths[name] = contentRect.width > 0 ? Math.max(contentRect.width, 120) : 0;
      if (contentRect.width > 0) target.setAttribute("viewBox", `0 0 ${widths[name]} ${kHeight}`);
    }
    draw();
  });
  for (const drawing of Object.values(drawings)) observer.observe(drawing);

  return {
    show(next) {
      numbers = next;
      draw();
    },
  };
}
