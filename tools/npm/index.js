// softfocus for JavaScript; index.d.ts says what each call takes and gives.

import { SoftfocusError, job, refuse, restart, spirv_of } from "./engine.js";
import { frame_of, npy_of, read_picture, result_type, typed, with_channels } from "./pictures.js";

export { SoftfocusError };

const kFragment = 1;
const kFilters = { nearest: 1, bilinear: 2, trilinear: 3 };
const kWraps = { repeat: 1, mirror: 2, clamp: 3 };
const kFloatTexels = 6;
const kRendered = "softfocus-render.npy";

const text_names = ["method", "profile"];
const lens_names = ["focalLengthMm", "fNumber", "focusM", "sensorWidthMm", "sensorHeightMm", "fovYDegrees",
                    "cocScale", "blurAtInfinityPx", "maxRadiusPx", "leak", "budget", "maxError"];
// Of softfocus_init_settings(), but for the method.
const kDefaults = { method: "disc-layers", profile: "ieee", focalLengthMm: 50, fNumber: 2, focusM: 2,
                    sensorWidthMm: 36, sensorHeightMm: 24, fovYDegrees: 0, cocScale: 1,
                    blurAtInfinityPx: 0, maxRadiusPx: 0, leak: 1, budget: 0.25, maxError: 0.02 };

// Of node's Buffer too, whose own slice() is a view.
const copy_of = (array) => Object.getPrototypeOf(Uint8Array.prototype).slice.call(array);

export async function open({ threads = 0 } = {}) {
  await restart(threads);
  return job((engine) => ({ threads: engine.threads, build: engine.build,
                            version: engine.text(engine.call("version")) }));
}

export const close = () => restart(0);

const listed = (kind) => job((engine) => {
  const found = {};
  for (let i = 0;; ++i) {
    const name = engine.call(`${kind}_name`, i);
    if (name === 0) return found;
    found[engine.text(name)] = engine.text(engine.call(`${kind}_summary`, i));
  }
});

export const methods = () => listed("method");
export const profiles = () => listed("profile");

/** What is not known is refused, with what there is. */
function check_names(options, known) {
  for (const name of Object.keys(options)) {
    if (!known.includes(name)) refuse(`there is no option '${name}'; there are ${known.join(", ")}`);
  }
}

function put_settings(engine, options) {
  const value_of = (name) => options[name] ?? kDefaults[name];
  for (const name of lens_names) {
    if (typeof value_of(name) !== "number") refuse(`${name} is ${value_of(name)}; a number would do`);
  }
  return engine.put_struct(...text_names.map((name) => ["text", value_of(name)]),
                           ...lens_names.map((name) => ["double", value_of(name)]));
}

/** The fields of a picture or a target: three colours one after the other, and perhaps depths. */
function pixel_fields(place, { channels, width, type, bytes }, depth) {
  const pixel = channels * bytes;
  return [
    ...[0, 1, 2].map((c) => ["pointer", place + c * bytes]), ["step", pixel], ["step", pixel * width],
    ["pointer", depth?.place ?? 0], ["step", depth?.bytes ?? 0], ["step", (depth?.bytes ?? 0) * width],
    ["int", type.code], ["int", depth?.type.code ?? 0],
  ];
}

export function refocus(picture, depth, options = {}) {
  return job((engine) => {
    check_names(options, [...text_names, ...lens_names, "type", "channels"]);
    const source = read_picture("picture", picture, [3, 4]);
    const { width, height } = source;
    const metres = typed("depth", depth);
    if (metres.values.length !== width * height) {
      refuse(`depth has ${metres.values.length} numbers and the picture ${width}x${height} pixels`);
    }
    const array = result_type(options.type, source.values);
    const channels = options.channels ?? source.channels;
    if (channels !== 3 && channels !== 4) refuse(`channels is ${channels}; 3 or 4 would do`);
    const settings = put_settings(engine, options);
    const values = with_channels(source, channels, array);
    const size_of = ({ BYTES_PER_ELEMENT: bytes }) => bytes;
    const from = engine.put_struct(
        ["int", width], ["int", height],
        ...pixel_fields(engine.put(source.values), { ...source, bytes: size_of(source.values) }, {
          place: engine.put(metres.values), bytes: size_of(metres.values), type: metres.type }),
        ...Array(5).fill(["pointer", 0]), ["int", 0], ["int", 0]);
    const place = engine.put(values);
    const to = engine.put_struct(...pixel_fields(
        place, { channels, width, type: typed("the result", values).type, bytes: size_of(values) }));
    engine.run("refocus", from, settings, to, 0);
    return { width, height, data: engine.copy(place, array, values.length) };
  });
}

const kebab = (name) => name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
const camel = (name) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());

/** {fNumber: 2} is --f-number 2, true a flag, size: [640, 480] 640x480, another list several words. */
function words_of(options) {
  return Object.entries(options).flatMap(([name, value]) => {
    if (["output", "json", "help", "quiet"].includes(name)) refuse(`${name} is not for this call; run() has it`);
    if (value === undefined || value === null || value === false) return [];
    const words = Array.isArray(value) ? value : [value];
    return [`--${kebab(name)}`, ...(value === true ? []
                                    : name === "size" && Array.isArray(value) ? [value.join("x")]
                                    : words.map(String))];
  });
}

/** Camel case for the names in the program's JSON. */
function in_camel_case(value) {
  if (Array.isArray(value)) return value.map(in_camel_case);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([name, of]) => [camel(name), in_camel_case(of)]));
}

export function run(words, files = {}) {
  return job((engine) => engine.program(words, files));
}

/** The program's answer; its own sentence if it refused. */
function answer(engine, words, files, passes = [0]) {
  const { status, output, errors, files: made } = engine.program(words, files);
  if (!passes.includes(status)) {
    const lines = errors.trimEnd().split("\n").filter((line) => !line.includes(": warning: "));
    refuse(lines.join("\n").replace(/^softfocus: /, "") || `softfocus ended with status ${status}`);
  }
  return { status, made, json: in_camel_case(JSON.parse(output)) };
}

export function render(scene, { files = {}, ...options } = {}) {
  return job((engine) => {
    const words = ["render", scene, "--output", kRendered, "--json", ...words_of(options)];
    const { made, json } = answer(engine, words, files);
    if (!made[kRendered]) refuse("this makes no picture, or several; run() is for that");
    return { ...frame_of(made[kRendered]), hash: json.pictureHash };
  });
}

function file_of(name, picture) {
  const is_file = ArrayBuffer.isView(picture);
  return is_file ? picture : npy_of(read_picture(name, picture, [1, 3, 4]));
}

export function compare(a, b, { diff = false, ...options } = {}) {
  return job((engine) => {
    const words = ["compare", "a", "b", "--json", ...words_of(options), ...(diff ? ["--diff", "diff.png"] : [])];
    const { status, made, json } = answer(engine, words, { a: file_of("a", a), b: file_of("b", b) }, [0, 1]);
    return { ...json, passes: status === 0, ...(diff ? { diff: made["diff.png"] } : {}) };
  });
}

export class Shader {
  #words;
  #uniforms = new Map();
  #textures = new Map();
  #engine = null;  // that has the shader
  #place = 0;

  constructor(words) {
    this.#words = words;
  }

  static compile(text, { name = "shader" } = {}) {
    return job(async (engine) => {
      const shader = new Shader(await spirv_of(text, name));
      shader.#in(engine);
      return shader;
    });
  }

  /** The shader in this engine, with all that was set if the engine is another one. */
  #in(engine) {
    if (this.#words === null) refuse("the shader was freed");
    if (this.#engine === engine) return this.#place;
    const source = engine.put_struct(
        ["int", kFragment], ["text", null], ["pointer", engine.put(this.#words)],
        ["size", this.#words.length], ["text", null], ["text", null], ["pointer", 0], ["size", 0],
        ["pointer", 0], ["pointer", 0]);
    const place = engine.take(4);
    engine.run("compile_shader", source, place);
    this.#place = engine.pointer(place);
    for (const [name, numbers] of this.#uniforms) this.#set(engine, name, numbers);
    for (const [name, texture] of this.#textures) this.#set_texture(engine, name, texture);
    this.#engine = engine;
    return this.#place;
  }

  #set(engine, name, numbers) {
    engine.run("set_uniform", this.#place, engine.put_text(name), engine.put(numbers), numbers.length);
    this.#uniforms.set(name, numbers);
  }

  #set_texture(engine, name, texture) {
    const { filter = "bilinear", wrap = "repeat" } = texture;
    if (!Object.hasOwn(kFilters, filter) || !Object.hasOwn(kWraps, wrap)) {
      refuse(`${name}: one of ${Object.keys(kFilters).join(", ")} and ` +
             `one of ${Object.keys(kWraps).join(", ")} would do`);
    }
    let picture = read_picture(name, texture, [1, 3, 4]);
    if (!picture.type.texels[picture.channels]) {
      if (picture.channels === 1) refuse(`${name}: one channel of halves is no texture; float32 would do`);
      const rows = { ...picture, height: picture.height * picture.slices };
      picture = { ...picture, channels: 4, values: with_channels(rows, 4) };
    }
    const { width, height, slices, channels, values, type } = picture;
    const texels = engine.put_struct(
        ["int", width], ["int", height], ["int", type.texels[channels]], ["pointer", engine.put(values)],
        ["step", 0], ["int", texture.slices ? slices : 0], ["step", 0]);
    const edge = kWraps[wrap];
    const sampler = engine.put_struct(["int", kFilters[filter]], ["int", edge], ["int", edge], ["int", 0],
                                      ["int", edge]);
    engine.run("set_texture", this.#place, engine.put_text(name), texels, sampler);
    this.#textures.set(name, { ...texture, data: copy_of(texture.data) });
  }

  uniforms() {
    return job((engine) => {
      const place = this.#in(engine);
      const names = [];
      for (let i = 0;; ++i) {
        const name = engine.call("uniform_name", place, i);
        if (name === 0) return names;
        names.push(engine.text(name));
      }
    });
  }

  run(width, height, { uniforms = {}, textures = {}, profile = "ieee" } = {}) {
    return job((engine) => {
      const place = this.#in(engine);
      for (const [name, value] of Object.entries(uniforms)) {
        const numbers = Array.isArray(value) || ArrayBuffer.isView(value) ? value : [value];
        this.#set(engine, name, Float64Array.from(numbers, Number));
      }
      for (const [name, texture] of Object.entries(textures)) this.#set_texture(engine, name, texture);
      const is_side = (side) => Number.isInteger(side) && side >= 1 && side <= 16384;
      if (!is_side(width) || !is_side(height)) refuse(`${width}x${height} is no size; 1 to 16384 would do`);
      const count = width * height * 4;
      const pixels = engine.put(new Float32Array(count));
      const target = engine.put_struct(["int", width], ["int", height], ["int", kFloatTexels],
                                       ["pointer", pixels], ["step", 0], ["int", 0], ["step", 0]);
      const targets = engine.put(Uint32Array.of(target));
      engine.run("run_shader", place, engine.put_struct(["pointer", targets], ["int", 1], ["text", profile],
                                                        ["long", 0]));
      return { width, height, data: engine.copy(pixels, Float32Array, count) };
    });
  }

  free() {
    return job((engine) => {
      if (this.#engine === engine) engine.call("free_shader", this.#place);
      this.#engine = this.#words = null;
    });
  }
}
