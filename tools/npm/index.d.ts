/**
 * Depth of field on pictures with depth, scenes, shaders on an emulated GPU, and comparison of pictures:
 * the bits are the program's, on every machine. All calls wait for each other. They compute in the thread
 * that calls: in a page that must not stand still, call from a worker. Arrays that a call is given may not
 * change until its promise settles.
 */

/** Numbers of a picture: sRGB codes 0 to 255; binary32 of linear light; binary16 as bits, or as it is. */
export type Numbers = Uint8Array | Uint8ClampedArray | Float32Array | Float64Array | Uint16Array;

/** Rows from the top without a gap, channels interleaved: an ImageData is one. */
export interface Picture<Data = Numbers> {
  /** Pixels, 1 to 16384. */
  width: number;
  height: number;
  /** `width * height * channels` numbers. */
  data: Data;
}

/** What the library or the program refuses: `message` is its own sentence. */
export class SoftfocusError extends Error {}

/** The module as it runs. */
export interface Opened {
  threads: number;
  /** "threads" in node and in isolated pages (COOP, COEP) on more than one core; else "simd". */
  build: "threads" | "simd";
  version: string;
}

/**
 * Loads the module, anew if it is there. Optional: any other call does it with all threads.
 * `threads`: 1 to 16; 0, which is usual: all.
 */
export function open(options?: { threads?: number }): Promise<Opened>;

/** Gives back threads and memory, after what runs. The next call loads the module again. */
export function close(): Promise<void>;

/** All depth-of-field methods on a picture, {name: summary}. */
export function methods(): Promise<Record<string, string>>;

/** All arithmetics, such as "llvmpipe", {name: summary}. */
export function profiles(): Promise<Record<string, string>>;

/** The lens, and how to blur. Each may be left out. */
export interface RefocusOptions {
  /** The distance in focus, metres; 2. */
  focusM?: number;
  /** 2 */
  fNumber?: number;
  /** Millimetres; 50. */
  focalLengthMm?: number;
  /** The sensor, millimetres; 36 x 24. The picture takes the largest part that has its shape. */
  sensorWidthMm?: number;
  sensorHeightMm?: number;
  /** In place of the sensor, the vertical field of view, degrees: a camera's `fov` in three.js. 0: none. */
  fovYDegrees?: number;
  /** In place of lens and sensor, the radius of what is infinitely far, pixels. 0: none. */
  blurAtInfinityPx?: number;
  /** Exaggerates the circles of confusion; 1. */
  cocScale?: number;
  /** Cuts them, pixels to 1024. 0, which is usual: none is cut. */
  maxRadiusPx?: number;
  /** Of `methods()`, "disc-layers"; or "auto": the cheapest whose mean FLIP is at most `maxError`. */
  method?: string;
  /** 0.02 */
  maxError?: number;
  /** Of some methods: how readily a background gives colour to what lies before it; 1. */
  leak?: number;
  /** Of importance-ordered, 0 to 1; 0.25. */
  budget?: number;
  /** Of `profiles()`; "ieee". */
  profile?: string;
}

/** An array of the result's numbers. "float16" is bits, in a Uint16Array. */
export interface ResultTypes {
  uint8: ReturnType<typeof Uint8ClampedArray.from>;
  float16: ReturnType<typeof Uint16Array.from>;
  float32: ReturnType<typeof Float32Array.from>;
}

/** Of the result. */
export interface ResultOptions<Type extends keyof ResultTypes> {
  type: Type;
  /** Its channels: as the picture has. A fourth is the picture's, or opaque if the picture has none of
   * this type. */
  channels?: 3 | 4;
}

/**
 * The picture as a lens makes it: `softfocus refocus` on arrays.
 *
 * @param picture 3 or 4 channels; the fourth is not filtered
 * @param depth metres along the camera's axis, a number a pixel; infinity is the horizon. A Uint16Array
 *   holds binary16 as bits
 * @returns a picture with the same type (of binary64 binary32) and channels, unless the options say otherwise.
 *   For a canvas: `{ type: "uint8", channels: 4 }`
 * @throws SoftfocusError for what cannot be
 */
export function refocus<Type extends keyof ResultTypes>(
  picture: Picture, depth: Float32Array | Float64Array | Uint16Array,
  options: RefocusOptions & ResultOptions<Type>,
): Promise<Picture<ResultTypes[Type]>>;
export function refocus<Data extends Numbers>(
  picture: Picture<Data>, depth: Float32Array | Float64Array | Uint16Array,
  options?: RefocusOptions & { channels?: 3 | 4 },
): Promise<Picture<Data extends Float64Array ? Float32Array : Data>>;

/** What an option of the command line may be: `maxCoc: 8` is --max-coc 8, `true` a flag, a list several
 * words. */
export type Option = number | string | boolean | null | undefined | (number | string)[];

/** Those of `softfocus render`, in camel case; some of them. */
export interface RenderOptions {
  /** Scene files, models and textures by name: {"scene.toml": text, "model.glb": bytes}. */
  files?: Files;
  /** Pixels; [512, 512]. */
  size?: [width: number, height: number] | string;
  method?: string;
  /** Metres. */
  focus?: number;
  fNumber?: number;
  /** Millimetres. */
  focalLength?: number;
  cocScale?: number;
  /** Of accumulation and its kin. */
  samples?: number;
  [option: string]: Option | Files;
}

/** Bytes or texts by name; a name may have folders. */
export type Files = Record<string, ArrayBufferView | string>;

/** A picture of linear light, 3 channels, and its depth. */
export interface Frame extends Picture<Float32Array> {
  /** Metres, a number a pixel. */
  depth: Float32Array;
  /** "0x..." of the picture's bits, as `softfocus render --json` tells it. */
  hash: string;
}

/**
 * `softfocus render`.
 *
 * @param scene a name such as "figures" or "random:7", or one of `files`: .toml, .gltf, .glb, .obj, .ply, .stl
 * @throws SoftfocusError
 */
export function render(scene: string, options?: RenderOptions): Promise<Frame>;

/** Those of `softfocus compare`, in camel case; some of them. */
export interface CompareOptions {
  /** Tolerances (docs/measures.md). */
  maxFlip?: number;
  /** Of any red, green or blue, linear light. */
  maxError?: number;
  maxUlps?: number;
  /** A number, or "1%". */
  maxPixels?: number | string;
  /** Of `maxPixels`. */
  maxDifference?: number;
  search?: number;
  /** Count as pixelmatch does, too: 0 to 1. */
  threshold?: number;
  /** Wants `diff`, a PNG of where they differ. */
  diff?: boolean;
  [option: string]: Option;
}

/** How far `a` is from `b`. Numbers that are infinite are null. */
export interface Comparison {
  /** The tolerance among the options is kept; without one, all bits are equal. */
  passes: boolean;
  equal: boolean;
  values: number;
  differing: number;
  maxHalfUlps: number;
  /** Of any red, green or blue, linear light. */
  maxError: number | null;
  mse: number | null;
  psnrDb: number | null;
  toneMappedMse: number | null;
  toneMappedPsnrDb: number | null;
  ssim: number | null;
  /** Mean, 0 to 1. */
  flip: number | null;
  /** With `hdrFlip: true`. */
  hdrFlip?: number | null;
  first: { x: number; y: number; channel: string; a: number; b: number } | null;
  /** With `threshold`, in codes of 8 bits. */
  codes?: {
    ae: number; mae: number; rmse: number; psnrDb: number | null; pae: number;
    beyond: number; antiAliased: number;
  };
  /** With a tolerance. */
  limits?: { option: string; limit: number; value: number | null; kept: boolean }[];
  diff?: Uint8Array;
  [more: string]: unknown;
}

/**
 * `softfocus compare`.
 *
 * @param a of 1, 3 or 4 channels; or the bytes of a file: PNG, JPEG, HDR, PFM, NPY
 * @param b which `a` should be
 * @throws SoftfocusError
 */
export function compare(
  a: Picture | Uint8Array, b: Picture | Uint8Array, options?: CompareOptions,
): Promise<Comparison>;

/** What a command did. */
export interface Run {
  /** 0: done. `compare`: 1 if they differ. */
  status: number;
  output: string;
  errors: string;
  /** What it wrote. */
  files: Record<string, Uint8Array>;
}

/**
 * The program itself, for what has no call here: run(["refocus", "a.png", "d.png", "-o", "b.png"], files).
 * There are render, refocus, apply, inspect, scenes, methods, effects, profiles, lens and compare.
 */
export function run(words: string[], files?: Files): Promise<Run>;

/** A picture of 1, 3 or 4 channels to sample. Codes of 8 bits are 0 to 1, linear. */
export interface Texture extends Picture {
  filter?: "nearest" | "bilinear" | "trilinear";
  wrap?: "repeat" | "mirror" | "clamp";
  /** Of a sampler3D, sampler2DArray or samplerCube, one below the other. */
  slices?: number;
}

/**
 * A fragment shader: GLSL, plain or as Shadertoy, three.js, libretro and gl-transitions have it. The first
 * row of textures and results has the smallest gl_FragCoord.y.
 */
export class Shader {
  private constructor();
  /**
   * @param options `name` is for errors
   * @throws SoftfocusError "NAME:LINE: ..."
   */
  static compile(text: string, options?: { name?: string }): Promise<Shader>;
  /** The names of all uniforms and textures. */
  uniforms(): Promise<string[]>;
  /**
   * Sets these uniforms and textures, which stay until they are set again, and runs the shader at every
   * pixel. Matrices are column by column.
   *
   * @returns its first output, 4 channels
   * @throws SoftfocusError
   */
  run(width: number, height: number, options?: {
    uniforms?: Record<string, number | boolean | ArrayLike<number>>;
    textures?: Record<string, Texture>;
    profile?: string;
  }): Promise<Picture<Float32Array>>;
  /** Gives back its memory. */
  free(): Promise<void>;
}
