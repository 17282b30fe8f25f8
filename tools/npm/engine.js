// The WebAssembly module: loads the one that fits this machine and has one job at a time in it. What
// makes it stop, such as too deep a recursion, costs that job alone: the next one starts it anew.

const kMostThreads = 16;
const kIsNode = typeof process === "object" && typeof process.versions?.node === "string";

// Written out, so that bundlers find them. `?no-inline`: vite would make a small file a data: URL, from
// which no thread starts.
const kModules = {
  threads: {
    load: () => import("./browser/softfocus-npm-threads.js"),
    script: new URL("./module/softfocus-npm-threads.js", import.meta.url),
    wasm: new URL("./module/softfocus-npm-threads.wasm", import.meta.url),
    worker: new URL("./module/softfocus-npm-threads.worker.js?no-inline", import.meta.url),
  },
  simd: {
    load: () => import("./browser/softfocus-npm-simd.js"),
    script: new URL("./module/softfocus-npm-simd.js", import.meta.url),
    wasm: new URL("./module/softfocus-npm-simd.wasm", import.meta.url),
  },
  compiler: {
    load: () => import("./browser/softfocus-compiler.js"),
    script: new URL("./module/softfocus-compiler.js", import.meta.url),
    wasm: new URL("./module/softfocus-compiler.wasm", import.meta.url),
  },
};

/** What the library or the program refuses, in its own sentence. */
export class SoftfocusError extends Error {
  name = "SoftfocusError";
}

export function refuse(sentence) {
  throw new SoftfocusError(sentence);
}

const kSilent = { print() {}, printErr() {} };

const of_node = (name) => import(/* webpackIgnore: true */ /* @vite-ignore */ `node:${name}`);

async function load_in_node({ script, wasm, worker }, settings) {
  const [{ createRequire }, { readFile }, { fileURLToPath }] =
      await Promise.all(["module", "fs/promises", "url"].map(of_node));
  const place = fileURLToPath(script);
  return createRequire(import.meta.url)(place)({
    ...kSilent,
    ...settings,
    wasmBinary: await readFile(fileURLToPath(wasm)),
    mainScriptUrlOrBlob: place,
    locateFile: (name) => fileURLToPath(name.endsWith(".wasm") ? wasm : worker),
  });
}

async function load_in_browser({ load, script, wasm, worker }, settings) {
  const [{ default: create }, response] = await Promise.all([load(), fetch(wasm)]);
  if (!response.ok) throw new Error(`${wasm.href}: ${response.status}`);
  return create({
    ...kSilent,
    ...settings,
    wasmBinary: await response.arrayBuffer(),
    mainScriptUrlOrBlob: script.href,
    locateFile: (name) => (name.endsWith(".wasm") ? wasm : worker).href,
  });
}

const load_module = (name, settings) =>
  (kIsNode ? load_in_node : load_in_browser)(kModules[name], settings);

/** How many threads there may be here: pages share no memory unless they are isolated. */
async function most_threads() {
  if (typeof SharedArrayBuffer === "undefined") return 1;
  if (kIsNode) {
    const { availableParallelism, cpus } = await of_node("os");
    return Math.min(availableParallelism?.() ?? cpus().length, kMostThreads);
  }
  const is_ours = kModules.threads.worker.origin === globalThis.location?.origin;
  if (!globalThis.crossOriginIsolated || !is_ours) return 1;
  return Math.min(globalThis.navigator?.hardwareConcurrency || 1, kMostThreads);
}

const kFieldBytes = { size: 4, step: 4, int: 4, pointer: 4, text: 4, long: 8, double: 8 };

/** A module with what a job takes of its memory, until the job ends. */
class Memory {
  #taken = [];

  constructor(module) {
    this.module = module;
    this.stopped = false;
  }

  /** All of it. It is another buffer each time that it has grown. */
  bytes() {
    return new Uint8Array(this.module.wasmMemory?.buffer ?? this.module.HEAPU8.buffer);
  }

  call(name, ...words) {
    try {
      return this.module[`_softfocus_${name}`](...words);
    } catch (error) {
      this.stopped = true;
      return refuse(`softfocus stopped: ${error?.message ?? error}`);
    }
  }

  take(bytes) {
    const place = this.module._malloc(Math.max(bytes, 1));
    if (place === 0) refuse("there is not enough memory");
    this.#taken.push(place);
    return place;
  }

  /** Copies a typed array. */
  put(array) {
    const place = this.take(array.byteLength);
    this.bytes().set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), place);
    return place;
  }

  put_text(text) {
    if (typeof text !== "string") refuse(`${text} is no text`);
    if (text.includes("\0")) refuse(`${JSON.stringify(text)} has a zero in it`);
    return this.put(new TextEncoder().encode(`${text}\0`));
  }

  /** A struct of softfocus.h: its size, and then fields [kind, value]. */
  put_struct(...fields) {
    let end = kFieldBytes.size;
    const placed = fields.map(([kind, value]) => {
      const bytes = kFieldBytes[kind];
      const offset = Math.ceil(end / bytes) * bytes;
      end = offset + bytes;
      return { kind, value, offset };
    });
    const widest = Math.max(...fields.map(([kind]) => kFieldBytes[kind]), kFieldBytes.size);
    const size = Math.ceil(end / widest) * widest;
    const data = new DataView(new ArrayBuffer(size));
    data.setUint32(0, size, true);
    for (const { kind, value, offset } of placed) {
      if (kind === "double") data.setFloat64(offset, value, true);
      else if (kind === "text") data.setUint32(offset, value == null ? 0 : this.put_text(value), true);
      else data.setInt32(offset, value, true);  // what is longer is small here
    }
    return this.put(data);
  }

  /** A copy of `count` numbers in an array of that type. */
  copy(place, type, count) {
    const bytes = this.bytes().slice(place, place + count * type.BYTES_PER_ELEMENT);
    return new type(bytes.buffer, 0, count);
  }

  pointer(place) {
    return new DataView(this.bytes().buffer).getUint32(place, true);
  }

  text(place) {
    return this.module.UTF8ToString(place);
  }

  free() {
    if (!this.stopped) for (const place of this.#taken) this.module._free(place);
    this.#taken = [];
  }
}

class Engine extends Memory {
  #context = 0;

  constructor(module, build, threads, said) {
    super(module);
    Object.assign(this, { build, threads, said });
  }

  /** softfocus_context, which keeps threads and the memory that methods work in. */
  context() {
    if (this.#context === 0) {
      const place = this.take(4);
      if (this.call("open", place, this.threads) !== 0) refuse("there is not enough memory");
      this.#context = this.pointer(place);
    }
    return this.#context;
  }

  /** A call of softfocus.h that returns a status. */
  run(name, ...words) {
    const context = this.context();
    if (this.call(name, context, ...words) !== 0) refuse(this.text(this.call("message", context)));
  }

  /** The program with these words, in a folder of these files, {name: bytes or text}. */
  program(words, files) {
    if (this.#context !== 0) this.call("close", this.#context);  // whose threads are needed
    this.#context = 0;
    const { FS } = this.module;
    FS.mkdir("/job");
    FS.chdir("/job");
    this.said.output = [];
    this.said.errors = [];
    try {
      for (const [name, content] of Object.entries(files)) write_file(FS, name, content);
      const places = words.map((word) => this.put_text(word));
      const status = this.call("program", this.put(Uint32Array.from(places)), words.length);
      const [output, errors] = [this.said.output, this.said.errors].map(text_of);
      return { status, output, errors, files: files_below(FS, "/job", "", files) };
    } finally {
      if (!this.stopped) {
        FS.chdir("/");
        remove(FS, "/job");
      }
    }
  }
}

/** A file with its folders. A path cannot lead out of here. */
function write_file(FS, path, content) {
  const names = path.split(/[\\/]+/).filter((name) => name && name !== ".");
  if (names.length === 0 || names.includes("..")) refuse(`'${path}' is no name of a file`);
  names.slice(0, -1).reduce((folder, name) => {
    if (!FS.analyzePath(`${folder}${name}`).exists) FS.mkdir(`${folder}${name}`);
    return `${folder}${name}/`;
  }, "");
  const is_bytes = ArrayBuffer.isView(content);
  if (!is_bytes && typeof content !== "string") refuse(`${path}: a file is bytes or a text`);
  FS.writeFile(names.join("/"), is_bytes
      ? new Uint8Array(content.buffer, content.byteOffset, content.byteLength) : content);
}

const text_of = (bytes) => new TextDecoder().decode(Uint8Array.from(bytes));

const names_in = (FS, folder) => FS.readdir(folder).filter((name) => name !== "." && name !== "..");
const is_folder = (FS, path) => FS.isDir(FS.stat(path).mode);

/** The files there that were not given. */
function files_below(FS, folder, prefix, given) {
  const found = {};
  for (const name of names_in(FS, folder)) {
    const path = `${folder}/${name}`;
    if (is_folder(FS, path)) Object.assign(found, files_below(FS, path, `${prefix}${name}/`, given));
    else if (!Object.hasOwn(given, prefix + name)) found[prefix + name] = FS.readFile(path);
  }
  return found;
}

function remove(FS, path) {
  if (!is_folder(FS, path)) return FS.unlink(path);
  for (const name of names_in(FS, path)) remove(FS, `${path}/${name}`);
  return FS.rmdir(path);
}

let wanted_threads = 0;
let engine = null;
let compiler = null;
let queue = Promise.resolve();

function stop() {
  engine?.module.PThread?.terminateAllThreads();
  engine = null;
}

async function running() {
  if (engine) return engine;
  const threads = wanted_threads || await most_threads();
  const build = threads > 1 ? "threads" : "simd";
  const said = { output: [], errors: [] };  // bytes: no terminal, for which there would be progress
  const module = await load_module(build, {
    threads,
    stdout: (byte) => said.output.push(byte),
    stderr: (byte) => said.errors.push(byte),
  });
  for (const worker of module.PThread?.unusedWorkers ?? []) worker.unref?.();  // node may end
  engine = new Engine(module, build, threads, said);
  return engine;
}

/** Does `work(engine)` after all jobs before it. */
export function job(work) {
  const done = queue.then(async () => {
    const of = await running();
    try {
      return await work(of);
    } finally {
      of.free();
      if (of.stopped) stop();
    }
  });
  queue = done.catch(() => {});
  return done;
}

/** Ends the module after all jobs; the next one starts it with so many threads, 0: all. */
export function restart(threads) {
  const done = queue.then(async () => {
    const most = await most_threads();
    if (!Number.isInteger(threads) || threads < 0 || threads > kMostThreads) {
      refuse(`threads is ${threads}; 1 to ${kMostThreads}, or 0 for all, would do`);
    }
    stop();
    compiler = null;
    wanted_threads = most === 1 ? 1 : threads;
  });
  queue = done.catch(() => {});
  return done;
}

/** The words of SPIR-V that GLSL becomes. */
export async function spirv_of(text, name) {
  compiler ??= new Memory(await load_module("compiler", {}));
  const of = compiler;
  try {
    const reply = of.call("compile", of.put_text(name), of.put_text(text));
    const { error, words } = JSON.parse(of.text(reply));
    return error ? refuse(error) : Uint32Array.from(words);
  } finally {
    of.free();
    if (of.stopped) compiler = null;
  }
}
