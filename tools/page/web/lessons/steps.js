// What the steps of docs/teaching.md set, watch and wait for, by their numbers. tests/tools/page has
// every number that the text names.
//
// state: a link's fragment, for "Set it up"; truth: whether its truth is collected at once
// watch(world): words that follow what the student does
// found(world): whether he has it, in the scene or case of `state`, or anywhere: true; or answer:
// {value(world), part, unit}, a number to type, within that part of it
//
// The world: {state, side, lens, frame, truth, settled, half}: the page's state, its edited side, the
// numbers of lens_view.js, the last frame's reply, the last truth's (of this frame), and what
// half.js has in its fields. half: which of these a step shows.

import { metres_text, millimetres_text, pixels_text, three_digits } from "../units.js";
import { by_id } from "../dom.js";
import { is_own_method } from "../link.js";
import { cut_half, nearest_half, weight_of_bits } from "./half.js";

const near = (value, wanted, part = 0.05) => Math.abs(value - wanted) <= part * Math.abs(wanted);
const kEnoughViews = 64;  // of the truth, to tell an error; a known answer has 0
function flip_text({ truth }) {
  if (!truth) return "";
  const views = truth.samples >= kEnoughViews ? `${truth.samples} views`
                                              : `${truth.samples} of ${kEnoughViews} views`;
  return `FLIP ${three_digits(truth.flip_mean)}${truth.samples > 0 ? `, ${views}` : ""}`;
}
const is_below = ({ truth }, most) =>
    Boolean(truth) && (truth.samples === 0 || truth.samples >= kEnoughViews) && truth.flip_mean < most;
const focus_text = ({ lens }) => `focus ${metres_text(lens.lens.focus_m)}`;
const circle_text = ({ lens }) => `circle ${pixels_text(2 * Math.abs(lens.radius_px))} wide, on film ` +
                                  `${millimetres_text(lens.circle_mm)}`;

/** Methods that make step 2.3's lamps round, as one sees them, and those that do not. */
export const kRound = [
  "one-pass", "importance-ordered", "scatter", "scatter-sorted", "scatter-aperture", "layers", "fields",
  "ray-distribution-buffer", "anisotropic-diffusion", "ring-bucket", "circular-1", "circular-2", "disc-layers",
  "layered", "object-identification", "mipmap", "accumulation", "filtered-views", "warped-accumulation",
  "surface-splatting",
];
export const kNotRound = ["pinhole", "two-pass", "two-pass-single", "diffusion", "generalised-diffusion", "pentagonal",
                          "hexagonal", "post-process"];

/** A picture without a blur is no answer, though its error may be small. */
const is_blurred = ({ side }) => side.dof && side.method !== "pinhole";

/** What follows the FLIP of a number of points that is good enough, but not the least. */
const more_than = ({ side, truth }, least, most) =>
    (side.samples > least && is_below({ truth }, most) ? "; fewer are enough" : "");

const kLens = "scene=figures&f=50&N=2&focus=2";
const kFence = "scene=near-fence&method=accumulation";
const kFenceOfFew = "scene=near-fence&max=13&show=error";  // no circle is larger, and a shader's loop is shorter

// Step 5.4: the scenes on which this page has seen a shader, by its method's name, below.
const kMostOfBoth = { figures: 0.01, "near-fence": 0.105 };
const seen = {};
const seen_of = (side) => (seen[side.method] ??= {});
function better_on_both({ state, side, truth }) {
  if (!is_own_method(side.method)) return false;
  if (is_below({ truth }, kMostOfBoth[state.scene] ?? 0)) seen_of(side)[state.scene] = true;
  return Object.keys(kMostOfBoth).every((scene) => seen_of(side)[scene]);
}
function both_text({ side, truth }) {
  const done = Object.keys(kMostOfBoth).filter((scene) => seen_of(side)[scene]);
  return `${flip_text({ truth })}${done.length > 0 ? `; ${done.join(", ")} ✓` : ""}`;
}

export const kSteps = {
  1.1: { state: "scene=figures", watch: focus_text,
         found: ({ side, lens }) => side.focus.at?.[0] < 0.5 && near(lens.lens.focus_m, 1.48) },
  1.2: { state: "scene=figures&show=coc", watch: focus_text,
         found: ({ state, lens }) => state.show === "coc" && near(lens.lens.focus_m, 0.84, 0.03) },
  1.3: { state: `${kLens}&object=4`, answer: { value: () => 0.3205, part: 0.02, unit: "mm" } },
  1.4: { state: `${kLens}&object=4`,
         watch: ({ lens }) => `object ${metres_text(lens.object_m)}, ${millimetres_text(lens.circle_mm)}`,
         found: ({ lens }) => near(lens.lens.focus_m, 2) && near(lens.object_m, 1) },
  1.5: { state: `${kLens}&object=1`, watch: circle_text,
         found: ({ side, lens }) => side.focal_length_mm === 50 && near(side.f_number, 4) && near(lens.object_m, 1) },
  1.6: { state: `${kLens}&object=1`, watch: circle_text,
         found: ({ side, lens }) => near(side.focal_length_mm, 100, 0.01) && near(side.f_number, 4) &&
                                    near(lens.object_m, 1) },
  1.7: { state: "scene=figures&f=35&N=8&focus=1",
         watch: ({ lens }) => `focus ${metres_text(lens.lens.focus_m)}, sharp from ${metres_text(lens.near_m)} to ` +
                              `${metres_text(lens.far_m)}`,
         found: ({ side, lens }) => side.focal_length_mm === 35 && side.f_number === 8 &&
                                    lens.far_m === Infinity && lens.lens.focus_m <= 1.05 * lens.hyperfocal_m },
  1.8: { state: "scene=figures&f=50&N=2&focus=1&sensor=full-frame&keep=focal-length&lock=1",
         watch: ({ lens }) => `field of view ${three_digits(lens.fov_y_degrees)}°, hole ` +
                              `${millimetres_text(lens.lens.focal_length_mm / lens.lens.f_number)}`,
         found: ({ state, side, lens }) => state.photo.sensor === "phone" && side.f_number === 2 &&
                                           Math.abs(lens.fov_y_degrees - 25.7) <= 1 },

  2.1: { state: "scene=figures", found: ({ state, side }) => !side.dof && state.show === "depth" },
  2.2: { state: "scene=sphere-world&max=2",
         watch: ({ side, frame }) => (
           frame.cut_share > 0 ? `${three_digits(100 * frame.cut_share)} % of the pixels have a circle that is cut`
           : side.max_coc_px < frame.largest_coc_px + 1 ? "no circle is cut" : "no circle is cut; smaller is enough"),
         found: ({ side, frame }) => frame.cut_share === 0 && side.max_coc_px !== null &&
                                      side.max_coc_px < frame.largest_coc_px + 1 },
  2.3: { state: "scene=night-lights&method=two-pass&b.method=two-pass&editing=1",
         found: ({ state }) => state.sides[0].method === "two-pass" && kRound.includes(state.sides[1]?.method) },
  2.4: { state: "case=leak-far&value=16&method=scatter", truth: true, watch: flip_text,
         found: (world) => is_blurred(world) && is_below(world, 0.005) },
  2.5: { state: "case=near-edge&value=16&method=two-pass", truth: true, watch: flip_text,
         found: (world) => is_below(world, 0.005) },
  2.6: { state: "case=near-bars&value=16&method=two-pass", truth: true, watch: flip_text,
         found: (world) => is_below(world, 0.1) },

  3.1: { state: `${kFence}&samples=4`, watch: ({ side }) => `${side.samples} points`,
         found: ({ side }) => side.method === "accumulation" && side.samples >= 48 },
  3.2: { state: "scene=figures", found: ({ state, truth }) => state.show === "truth" && Boolean(truth?.done),
         watch: ({ truth }) => (truth ? `${truth.samples} views, halves differ by ` +
                                        `${three_digits(truth.half_set_rms ?? NaN)}` : "") },
  3.3: { answer: { value: () => 0.00242 / 0.00076, part: 0.03, unit: "" } },
  3.4: { state: "scene=figures&method=accumulation&samples=1", truth: true,
         watch: (world) => flip_text(world) + more_than(world, 7, 0.006),
         found: ({ side, ...world }) => side.method === "accumulation" && side.samples === 7 &&
                                        is_below(world, 0.006) },
  3.5: { state: `${kFence}&samples=1`, truth: true,
         watch: (world) => flip_text(world) + more_than(world, 2, 0.153),
         found: ({ side, ...world }) => side.method === "accumulation" && side.samples === 2 &&
                                        is_below(world, 0.153) },

  4.1: { state: "scene=figures&method=two-pass", watch: ({ frame }) => frame.hash ?? "",
         found: ({ frame }) => frame.hash === "0x6817b540da3a8207" },
  4.2: { state: "scene=figures&method=two-pass", watch: ({ frame }) => frame.hash ?? "",
         found: ({ side, frame }) => side.focus.m === 1.0001 && Boolean(frame.hash) },
  4.3: { half: "number", found: ({ half }) => half.value === 2049 },
  4.4: { half: "number",
         found: ({ half: { value } }) => value > 2048 && Number.isInteger(value) &&
                                         nearest_half(value) !== cut_half(value) },
  4.5: { half: "weight", answer: { value: () => 256 * weight_of_bits(0.3, 8), part: 0, unit: "256ths" } },
  4.6: { state: "scene=figures&method=two-pass", found: () => by_id("gpu-differences").textContent !== "" },

  5.1: { state: "scene=figures", watch: flip_text,
         found: ({ state, side, truth }) => state.show === "error" && is_own_method(side.method) && Boolean(truth) },
  5.2: { watch: flip_text,
         found: ({ state, side, ...world }) => state.scene === "figures" && is_own_method(side.method) &&
                                               is_below(world, 0.01) },
  5.3: { state: kFenceOfFew, watch: flip_text,
         found: ({ side, ...world }) => is_own_method(side.method) && is_below(world, 0.12) },
  5.4: { state: kFenceOfFew, watch: both_text, found: better_on_both, anywhere: true },
  5.5: { found: () => by_id("shader-differences").textContent !== "" },
};
