// The state as a link's fragment: #scene=figures&size=512x512&... and back. Numbers have all their
// digits, so that the same picture comes back, to the bit. What cannot be read is left at its
// default, so an old link still opens.

import { first_side, first_state, kSeldomSet, kShadows, kShows, lens_keys, seldom_set } from "./state.js";

const kShortKeys = {
  method: "method", f: "focal_length_mm", N: "f_number", max: "max_coc_px", scale: "coc_scale",
  samples: "samples",
};

/** Pairs of a key of links and its name in a side. A number of the lens is called as there. */
function side_keys() {
  const short = Object.values(kShortKeys);
  const others = lens_keys().filter((key) => key !== "focus_m" && !short.includes(key));
  return [...Object.entries(kShortKeys), ...others.map((key) => [key, key]),
          ...kSeldomSet.map((key) => [key, key])];
}

function numbers_of(text, count) {
  const numbers = text.split(",").map(Number);
  return numbers.length === count && numbers.every(Number.isFinite) ? numbers : null;
}

function write_side(pairs, side, prefix) {
  pairs.push([`${prefix}dof`, side.dof ? "1" : "0"]);
  const left_out = kSeldomSet.filter((key) => !seldom_set(side).includes(key));
  for (const [key, name] of side_keys()) {
    const value = side[name];
    if (value === null || left_out.includes(name)) continue;
    pairs.push([prefix + key, String(value)]);
  }
  if (side.focus.at) pairs.push([`${prefix}at`, side.focus.at.join(",")]);
  else pairs.push([`${prefix}focus`, String(side.focus.m)]);
}

/** What a link holds of a shader and its passes at the most, in bytes. */
export const kMostLinkBytes = 16384;

const kOwnMethod = /^shader-0x[0-9a-f]+\.toml$/;
/** Whether a method is the visitor's shader. */
export const is_own_method = (name) => kOwnMethod.test(name ?? "");

export const bytes_of = ({ text, passes }) => new TextEncoder().encode(text + passes).length;

/** UTF-8 in the letters that a link leaves as they are (RFC 4648, section 5), and back. */
function packed(text) {
  const bytes = Array.from(new TextEncoder().encode(text), (byte) => String.fromCharCode(byte));
  return btoa(bytes.join("")).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}
function unpacked(letters) {
  try {
    const bytes = atob(letters.replaceAll("-", "+").replaceAll("_", "/"));
    return new TextDecoder().decode(Uint8Array.from(bytes, (byte) => byte.charCodeAt(0)));
  } catch {
    return null;
  }
}

/** The shader that a link carries, {text, passes}, or null. */
export function shader_of(words) {
  const [text, passes] = ["shader", "passes"].map((key) => unpacked(words.get(key) ?? "!"));
  return text === null || passes === null ? null : { text, passes };
}

/** Puts the compiled shader in the place of what the link calls it; without one, two-pass. */
export function take_shader(words, method) {
  for (const key of ["method", "b.method"]) {
    if (is_own_method(words.get(key))) words.set(key, method ?? "two-pass");
  }
}

/** The fragment, without the #. Of the visitor's own files it has the name. */
export function link_of(state) {
  const pairs = [];
  if (state.failure) {
    pairs.push(["case", state.failure.name], ["value", String(state.failure.value)]);
  } else if (state.scene.startsWith("/own/")) {
    pairs.push(["own", state.scene.slice("/own/".length)]);
  } else {
    pairs.push(["scene", state.scene]);
  }
  pairs.push(["size", state.size.join("x")], ["frame", String(state.time)], ["show", state.show]);
  write_side(pairs, state.sides[0], "");
  if (state.sides[1]) {
    write_side(pairs, state.sides[1], "b.");
    pairs.push(["divider", String(state.divider)], ["editing", String(state.editing)]);
  }
  if (state.camera) {
    const { position_m, target_m, fov_y_degrees } = state.camera;
    pairs.push(["camera", [...position_m, ...target_m, fov_y_degrees].join(",")]);
  }
  const { light, shadows, textures, impostors, effect, backdrop_m } = state.look;
  if (light) pairs.push(["light", light.join(",")]);
  if (shadows) pairs.push(["shadows", shadows]);
  if (!textures) pairs.push(["textures", "0"]);
  if (impostors) pairs.push(["impostors", impostors]);
  if (effect) pairs.push(["effect", effect]);
  if (backdrop_m) pairs.push(["backdrop", String(backdrop_m)]);
  if (state.photo.on) {
    const { sensor, keep, lock, subject } = state.photo;
    pairs.push(["sensor", sensor], ["keep", keep], ["lock", lock ? "1" : "0"]);
    if (subject) pairs.push(["subject", "1"]);
  }
  if (state.object_m) pairs.push(["object", String(state.object_m)]);
  const is_shown = state.sides.some(({ method }) => is_own_method(method));
  if (state.shader && is_shown && bytes_of(state.shader) <= kMostLinkBytes) {
    pairs.push(["shader", packed(state.shader.text)], ["passes", packed(state.shader.passes)]);
  }
  return pairs.map(([key, value]) => `${key}=${encodeURIComponent(value)}`).join("&")
      .replaceAll("%2C", ",").replaceAll("%3A", ":");
}

/** What a link says, by key; empty for none. */
export function read_link(fragment) {
  const words = new Map();
  for (const pair of fragment.replace(/^#/, "").split("&")) {
    const at = pair.indexOf("=");
    if (at < 1) continue;
    try {
      words.set(pair.slice(0, at), decodeURIComponent(pair.slice(at + 1)));
    } catch {
      // A broken escape: this value is skipped.
    }
  }
  return words;
}

/** The scene or case that a link opens, and the size, before anything is known of the scene. */
export function state_to_open(words) {
  const state = first_state();
  const size = /^([0-9]{1,5})x([0-9]{1,5})$/.exec(words.get("size") ?? "");
  if (size && Number(size[1]) > 0 && Number(size[2]) > 0) {
    state.size = [Number(size[1]), Number(size[2])];
  }
  const value = Number(words.get("value"));
  if (words.has("case") && Number.isFinite(value)) {
    state.failure = { name: words.get("case"), value };
    state.scene = null;
  } else if (words.has("scene")) {
    state.scene = words.get("scene");
  }
  return state;
}

function read_side(words, prefix, side) {
  const read = { ...side };
  if (words.has(`${prefix}dof`)) read.dof = words.get(`${prefix}dof`) !== "0";
  for (const [key, name] of side_keys()) {
    const text = words.get(prefix + key);
    if (text === undefined) continue;
    if (name === "method") read.method = text;
    else if (text !== "" && Number.isFinite(Number(text))) read[name] = Number(text);
  }
  const at = numbers_of(words.get(`${prefix}at`) ?? "", 2);
  const focus = Number(words.get(`${prefix}focus`));
  if (at) read.focus = { at };
  else if (focus > 0) read.focus = { m: focus };
  return read;
}

/** The state of the opened scene with all else that the link says. */
export function with_link(state, words) {
  const read = { ...state, sides: [read_side(words, "", state.sides[0])] };
  if (words.has("b.method")) {
    read.sides.push(read_side(words, "b.", { ...first_side(), ...state.sides[0] }));
  }
  read.editing = read.sides[1] && words.get("editing") === "1" ? 1 : 0;
  const divider = Number(words.get("divider") ?? NaN);
  if (divider >= 0 && divider <= 1) read.divider = divider;
  const time = Number(words.get("frame"));
  if (time > 0) read.time = time;
  if (kShows.includes(words.get("show"))) read.show = words.get("show");
  const camera = numbers_of(words.get("camera") ?? "", 7);
  if (camera) {
    read.camera = { position_m: camera.slice(0, 3), target_m: camera.slice(3, 6),
                    fov_y_degrees: camera[6] };
  }
  read.look = {
    light: numbers_of(words.get("light") ?? "", 3),
    shadows: kShadows.includes(words.get("shadows")) ? words.get("shadows") : null,
    textures: words.get("textures") !== "0",
    impostors: ["auto", "off"].includes(words.get("impostors")) ? words.get("impostors") : null,
    effect: words.get("effect") ?? null,
    backdrop_m: Number(words.get("backdrop")) || null,
  };
  if (words.has("sensor")) {
    read.photo = { on: true, sensor: words.get("sensor"), lock: words.get("lock") === "1",
                   keep: words.get("keep") === "focal-length" ? "focal-length" : "framing",
                   subject: words.get("subject") === "1" };
  }
  const object = Number(words.get("object"));
  if (object > 0) read.object_m = object;
  return read;
}
