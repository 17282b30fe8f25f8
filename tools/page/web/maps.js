// Maps of numbers as colours, with a legend in the picture: circles, signed, black where it is
// sharp; depth, from the nearest to the farthest that is seen; the error. Each scale fills itself
// with what the picture has.

import { by_id, element, paint_pixels } from "./dom.js";
import { metres_text, three_digits } from "./units.js";

const kSteps = 512;        // of a scale's colours
const kInfinite = 65504;   // the largest half: what is farther, or nothing, is infinitely far
const kSeen = 0.995;       // part of the errors that the scale reaches
const kLeastError = 0.01;  // a scale's end

// In equal steps, sRGB. Both hues rise in lightness, so that a map reads without colours too.
const kBefore = [[0, 0, 0], [122, 44, 0], [226, 112, 20], [255, 190, 110], [255, 240, 214]];
const kBehind = [[0, 0, 0], [10, 56, 120], [40, 120, 214], [120, 186, 255], [222, 240, 255]];
const kGrey = [[20, 20, 20], [250, 250, 250]];
const kOfInfinity = [70, 92, 130];
/** As dof/measure/heat_map.cpp has them. */
const kHeat = [[0, 0, 0], [23, 15, 64], [69, 18, 110], [117, 33, 128], [168, 51, 122], [217, 74, 102],
               [245, 122, 92], [252, 184, 122], [252, 247, 191]];

const kStops = { coc: [...kBefore.slice(1).reverse(), ...kBehind], depth: kGrey, error: kHeat };

/** The next of 1, 2, 5, 10, ... that is at least `value`. */
export function round_up(value) {
  const ten = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((x) => x * ten).find((x) => x >= value * (1 - 1e-9));
}

function colour_at(stops, part) {
  const place = Math.min(1, Math.max(0, part)) * (stops.length - 1);
  const stop = Math.min(Math.floor(place), stops.length - 2);
  return stops[stop].map((from, i) => Math.round(from + (stops[stop + 1][i] - from) * (place - stop)));
}

/** Below it lies the part kSeen of these values, none negative. */
function quantile(values) {
  const most = values.reduce((a, b) => Math.max(a, b), 0);
  if (!(most > 0)) return 0;
  const counts = new Uint32Array(1024);
  for (const value of values) counts[Math.floor(value / most * 1023)]++;
  let seen = 0;
  const at = counts.findIndex((count) => (seen += count) >= kSeen * values.length);
  return (at + 1) / 1024 * most;
}

const is_far = (metres) => !(metres < kInfinite);

/**
 * The scale of these maps: {kind, least, most}. A map is {kind, numbers, limit}: `numbers` in pixels,
 * metres or FLIP; `limit` is the largest circle that the filter makes.
 */
export function scale_of(maps) {
  const [{ kind }] = maps;
  if (kind === "error") return { kind, least: 0, most: round_up(Math.max(kLeastError, ...maps.map(
      ({ numbers }) => quantile(numbers)))) };
  let [least, most] = [Infinity, 0];
  for (const { numbers } of maps) {
    for (const number of numbers) {
      if (kind === "depth" && is_far(number)) continue;
      const size = Math.abs(number);
      if (size > most) most = size;
      if (size < least) least = size;
    }
  }
  if (kind === "depth") return { kind, least: Math.min(least, most) || 1e-3, most: most || 1 };
  const limit = Math.max(...maps.map((map) => map.limit)) || Infinity;
  const end = Math.min(limit, most > 0 ? round_up(most) : 1);
  return { kind, least: -end, most: Number.isFinite(end) ? end : 1 };
}

/** RGBA of 8 bits. Depths are in equal steps of their logarithm. */
export function coloured({ kind, numbers }, { least, most }) {
  const table = new Uint32Array(Array.from({ length: kSteps + 1 }, (_, i) => packed(colour_at(kStops[kind], i / kSteps))));
  const far = packed(kOfInfinity);
  const pixels = new Uint32Array(numbers.length);
  const [from, to] = kind === "depth" ? [Math.log(least), Math.log(most)] : [least, most];
  const factor = kSteps / Math.max(to - from, 1e-9);
  for (let i = 0; i < numbers.length; ++i) {
    const number = numbers[i];
    if (kind === "depth" && is_far(number)) {
      pixels[i] = far;
      continue;
    }
    const place = ((kind === "depth" ? Math.log(number) : number) - from) * factor;
    pixels[i] = table[place > 0 ? Math.min(kSteps, Math.round(place)) : 0];
  }
  return pixels.buffer;
}

/** A pixel as a little-endian machine keeps its four bytes; browsers run on no other. */
function packed([red, green, blue]) {
  return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
}

const kTitles = {
  coc: "Radius of the circle, px: orange before focus, blue behind",
  depth: "Depth, in equal steps of its logarithm",
  error: "FLIP of each pixel: 0 is equal",
};

function ticks_of({ kind, least, most }, is_cut) {
  if (kind === "depth") return [metres_text(least), metres_text(Math.sqrt(least * most)), metres_text(most)];
  if (kind === "error") return ["0", three_digits(most / 2), `${three_digits(most)} and more`];
  const end = three_digits(most);
  const more = is_cut ? " and more" : "";
  return [`−${end}${more}`, three_digits(-most / 2), "0", three_digits(most / 2), `${end}${more}`];
}

function show_legend(scale, maps) {
  const { kind } = scale;
  const stops = kStops[kind].map((colour) => `rgb(${colour.join()})`);
  const bar = element("div", { class: "scale" });
  bar.style.background = `linear-gradient(to right, ${stops.join()})`;
  const is_cut = maps.some(({ limit, numbers }) => scale.most === limit && numbers.some((x) => Math.abs(x) > limit));
  const ticks = ticks_of(scale, is_cut).map((words) => element("span", {}, words));
  const far = kind === "depth" && maps.some(({ numbers }) => numbers.some(is_far))
      ? [element("span", { class: "infinite" }, "∞")] : [];
  far.forEach(({ style }) => { style.borderColor = `rgb(${kOfInfinity.join()})`; });
  by_id("legend").replaceChildren(element("p", {}, kTitles[kind], ...far), bar, element("div", { class: "ticks" }, ...ticks));
}

/** Maps on the two canvases, which have one scale. */
export function make_maps(canvases) {
  const shown = [null, null];

  return {
    /** `map` as in scale_of, with its size; `only`: the other canvas is not in sight. */
    paint(side, map, only) {
      shown[side] = map;
      const other = shown[1 - side];
      if (only || (other && other.kind !== map.kind)) shown[1 - side] = null;
      const maps = shown.filter(Boolean);
      const scale = scale_of(maps);
      shown.forEach((one, i) => one && paint_pixels(canvases[i], one.width, one.height, coloured(one, scale)));
      show_legend(scale, maps);
      by_id("legend").hidden = false;
    },
    /** A picture has come in the place of that map. */
    clear(side) {
      shown[side] = null;
      by_id("legend").hidden = !shown.some(Boolean);
    },
  };
}
