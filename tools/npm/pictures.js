// Pictures {width, height, data}: their types, and NumPy's files of them, which the program reads.

import { refuse } from "./engine.js";

const kHalf = 1;
const kFloat = 2;
const kSrgb8 = 4;

// By what arrays say of themselves: those of another realm, as in jest, are no instances of ours.
const kTypes = {
  Uint8Array: { code: kSrgb8, npy: "|u1", texels: { 1: 1, 4: 2 }, opaque: 255 },
  Uint8ClampedArray: { code: kSrgb8, npy: "|u1", texels: { 1: 1, 4: 2 }, opaque: 255 },
  Uint16Array: { code: kHalf, npy: "<f2", texels: { 4: 4 }, opaque: 0x3c00 },
  Float16Array: { code: kHalf, npy: "<f2", texels: { 4: 4 }, opaque: 1 },
  Float32Array: { code: kFloat, npy: "<f4", texels: { 1: 5, 4: 6 }, opaque: 1 },
};
const kTypeNames = Object.keys(kTypes).join(", ");
const kArrays = { uint8: Uint8ClampedArray, float16: Uint16Array, float32: Float32Array };

const tag_of = (value) => Object.prototype.toString.call(value).slice(8, -1);

/** An array with its type, from 64 bits rounded to 32. */
export function typed(name, array) {
  const values = tag_of(array) === "Float64Array" ? Float32Array.from(array)
      : array?.constructor?.name === "Buffer" ? new Uint8Array(array.buffer, array.byteOffset, array.length)
      : array;
  const type = kTypes[tag_of(values)];
  if (!type) refuse(`${name} is ${array === null ? "null" : tag_of(array)}; ${kTypeNames} would do`);
  return { values, type };
}

/** {width, height, channels, values, type} of a picture whose channels are among these. */
export function read_picture(name, picture, wanted) {
  const { values, type } = typed(`${name}.data`, picture?.data);
  const { width, height, slices = 1 } = picture;
  const is_side = (side) => Number.isInteger(side) && side > 0;
  const channels = values.length / (width * height * slices);
  if (![width, height, slices].every(is_side) || !wanted.includes(channels)) {
    refuse(`${name} is ${width}x${height} with ${values.length} numbers; ` +
           `width * height * ${wanted.join(" or ")} would do`);
  }
  return { width, height, slices, channels, values, type };
}

/** The constructor of results: of "uint8", "float16" or "float32", or that of an array. */
export function result_type(name, values) {
  if (name === undefined) return values.constructor;
  if (!Object.hasOwn(kArrays, name)) refuse(`type is ${name}; ${Object.keys(kArrays).join(", ")} would do`);
  return kArrays[name];
}

/** The values with that many channels, each further one as it is, or opaque. */
export function with_channels({ width, height, channels, values }, count, array = values.constructor) {
  const to = typed("the result", new array(0)).type, from = typed("the picture", values).type;
  const { opaque } = to;
  const result = new array(width * height * count);
  const same = to.code === from.code && opaque === from.opaque;
  if (same && count === channels) {
    result.set(values);
    return result;
  }
  for (let i = 0; i < width * height; ++i) {
    for (let c = 0; c < count; ++c) {
      const is_there = same && c < channels;
      result[i * count + c] = is_there ? values[i * channels + c] : c === 3 ? opaque : 0;
    }
  }
  return result;
}

export function npy_of({ width, height, channels, values, type }) {
  const shape = channels === 1 ? `${height}, ${width}` : `${height}, ${width}, ${channels}`;
  const text = `{'descr': '${type.npy}', 'fortran_order': False, 'shape': (${shape}), }`;
  const begin = Math.ceil((10 + text.length + 1) / 64) * 64;
  const bytes = new Uint8Array(begin + values.byteLength).fill(0x20, 0, begin);
  bytes.set([0x93, ...Array.from("NUMPY", (letter) => letter.charCodeAt(0)), 1, 0,
             (begin - 10) & 255, (begin - 10) >> 8]);
  bytes.set(new TextEncoder().encode(text), 10);
  bytes[begin - 1] = 0x0a;
  bytes.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), begin);
  return bytes;
}

let floats = null;  // of all halves

export function floats_of(halves) {
  floats ??= Float32Array.from({ length: 65536 }, (_, bits) => {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return sign * (exponent ? (1024 + fraction) * 2 ** (exponent - 25) : fraction * 2 ** -24);
  });
  return Float32Array.from(halves, (half) => floats[half]);
}

/** A picture with its depth apart, from the file of halves (h, w, 4) that the program writes. */
export function frame_of(npy) {
  const begin = 10 + npy[8] + 256 * npy[9];
  const [, height, width] = /\((\d+), (\d+), 4\)/.exec(new TextDecoder().decode(npy.subarray(10, begin)));
  const all = floats_of(new Uint16Array(npy.slice(begin).buffer));
  const frame = {
    width: Number(width),
    height: Number(height),
    data: new Float32Array(all.length / 4 * 3),
    depth: new Float32Array(all.length / 4),
  };
  for (let i = 0; i < frame.depth.length; ++i) {
    frame.data.set(all.subarray(4 * i, 4 * i + 3), 3 * i);
    frame.depth[i] = all[4 * i + 3];
  }
  return frame;
}
