// A number as a half keeps it, and a weight as eight bits keep it. binary64 holds all of it exactly.

import { by_id, element } from "../dom.js";

const kMostHalf = 65504;

/** To nearest, ties to even. */
function nearest_even(x) {
  const below = Math.floor(x);
  if (x - below !== 0.5) return Math.round(x);
  return below % 2 === 0 ? below : below + 1;
}

/** The step from half to half around a number: 2^-10 of its power of two, 2^-24 at the least. */
export function half_step(value) {
  let step = 2 ** -24;
  while (step < 32 && Math.abs(value) >= step * 2048) step *= 2;
  return step;
}

/** The nearest half; a tie goes to the even one. From 65520 on it is infinite. */
export function nearest_half(value) {
  const half = nearest_even(value / half_step(value)) * half_step(value);
  return Math.abs(half) > kMostHalf ? Math.sign(half) * Infinity : half;
}

/** What is left when the bits that a half has not are cut off. */
export function cut_half(value) {
  const half = Math.trunc(value / half_step(value)) * half_step(value);
  return Math.sign(half) * Math.min(Math.abs(half), kMostHalf);
}

/** The weight of a bilinear filter by so many bits. */
export function weight_of_bits(fraction, bits) {
  return nearest_even(fraction * 2 ** bits) / 2 ** bits;
}

const words_of = (value) => (Number.isFinite(value) ? String(value) : value > 0 ? "infinity" : "−infinity");

/** The number in a field, with a point or a comma; NaN if there is none. */
export function number_in({ value }) {
  const text = value.trim().replace(",", ".");
  return text === "" ? NaN : Number(text);
}

/**
 * Two fields and what becomes of their numbers. `choose(kind)` shows one of them, "number" or
 * "weight"; `numbers()` tells what stands there.
 */
export function start_half() {
  const value = by_id("half-value");
  const weight = by_id("half-weight");
  const rows = by_id("half-rows");
  let kind = "number";
  const numbers = () => ({ value: number_in(value), weight: number_in(weight) });
  function show() {
    const now = numbers();
    const row = (...cells) => element("tr", {}, element("th", { scope: "row" }, cells[0]),
                                      ...cells.slice(1).map((cell) => element("td", {}, cell)));
    const known = (number, from) => (Number.isFinite(number) ? words_of(from(number)) : "–");
    rows.replaceChildren(...(kind === "number" ? [
      row("to the nearest half, ties to even", known(now.value, nearest_half)),
      row("cut to a half", known(now.value, cut_half)),
      row("step from half to half there", known(now.value, half_step)),
    ] : [row("the weight in 8 bits", known(now.weight, (number) => weight_of_bits(number, 8)))]));
  }
  function choose(wanted) {
    kind = wanted;
    for (const [field, of] of [[value, "number"], [weight, "weight"]]) {
      for (const node of [field, ...field.labels]) node.hidden = of !== kind;
    }
    show();
  }
  for (const field of [value, weight]) field.addEventListener("input", show);
  choose(kind);
  return { numbers, choose };
}
