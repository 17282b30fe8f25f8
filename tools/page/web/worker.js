// The simulator's worker: loads the build of the module that this browser can run, and answers
// requests one after the other.
//
// To the worker: {id, request, files}. With `files` ([{path, bytes}]) comes an `open`: they take the
// place of all that is below /own/, and if it fails the old ones are there again. A scene from elsewhere
// empties /own/.
// {cancel: id} ends that request early where no memory is shared: a frame that samples the lens lets
// messages in, slice by slice.
// From the worker: {ready: true, build, missing, cancel} once (`cancel` is an Int32Array of one
// number in memory shared with the module, or null), or {failed: "one line"} if nothing can run.
// Then {id, reply, pixels, file} for each request; `pixels` is an ArrayBuffer of RGBA8 rows, `file`
// one of the file that was asked for; either may be absent.
// If the module stops for good, the reply is {error}, and a new module takes its place, in which
// nothing is open: {restarted: true, cancel}.
//
// A request `shader` has a `text`, which GLSL's compiler, a module of its own, compiles first: what
// it made goes on to the module as `compiled`.
//
// A page in one file gives the module's parts as self.softfocus_parts: {script, wasm}, a function
// and a promise of bytes, and loads no other file.
"use strict";

const kMostThreads = 16;
const kSliceMs = 100;

// Modules of a few bytes, each with one instruction of what it asks for. What their bytes say:
// a function that drops a v128.const; one that does an atomic load; one with an empty try and
// catch_all.
const kProbes = {
  simd: [0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 10, 23, 1, 21, 0, 253, 12,
         0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 26, 11],
  atomics: [0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 5, 3, 1, 0, 1, 10, 11, 1,
            9, 0, 65, 0, 254, 16, 2, 0, 26, 11],
  exceptions: [0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 10, 8, 1, 6, 0, 6, 64,
               25, 11, 11],
};

function can_run(probe) {
  return WebAssembly.validate(new Uint8Array(kProbes[probe]));
}

/** The build for this browser, and what it lacks for a faster one. */
function choose_build() {
  const missing = [];
  if (typeof WebAssembly !== "object") return { build: null, missing: ["WebAssembly"] };
  if (!can_run("exceptions")) missing.push("WebAssembly exceptions");
  if (!can_run("simd")) missing.push("WebAssembly SIMD");
  if (!can_run("atomics")) missing.push("WebAssembly atomics");
  if (missing.length > 0) return { build: "plain", missing };
  if (self.softfocus_parts) return { build: "simd", missing: ["threads, which one file has not"] };
  if (!self.crossOriginIsolated) {
    missing.push("threads, for which the host would have to send COOP and COEP headers");
  } else if (typeof SharedArrayBuffer === "undefined") {
    missing.push("WebAssembly threads");
  } else if (thread_count() < 2) {
    missing.push("a second processor core");
  }
  return { build: missing.length > 0 ? "simd" : "threads", missing };
}

function thread_count() {
  return Math.min(navigator.hardwareConcurrency || 1, kMostThreads);
}

async function wasm_of(build) {
  if (self.softfocus_parts) return self.softfocus_parts.wasm();
  const response = await fetch(`softfocus-${build}.wasm`);
  if (!response.ok) throw new Error(`softfocus-${build}.wasm: ${response.status}`);
  return response.arrayBuffer();
}

/** A module that runs, with its threads. */
async function make_module(build, bytes) {
  const threads = build === "threads" ? thread_count() : 1;
  const settings = { wasmBinary: bytes, threads, print: () => {}, printErr: () => {} };
  if (self.softfocus_parts) {
    if (!self.createSoftfocus) self.softfocus_parts.script();
  } else {
    // Each thread loads the script anew.
    settings.mainScriptUrlOrBlob = new URL(`softfocus-${build}.js`, self.location.href).href;
    if (!self.createSoftfocus) importScripts(settings.mainScriptUrlOrBlob);
  }
  const module = await self.createSoftfocus(settings);
  module.FS.mkdir("/own");
  const started = ask(module, { do: "start", threads });
  if (started.error) throw new Error(started.error);
  return module;
}

/** A text in the module's memory, or 0 where there is none left. */
function put_text(module, text) {
  const size = module.lengthBytesUTF8(text) + 1;
  const place = module._malloc(size);
  if (place !== 0) module.stringToUTF8(text, place, size);
  return place;
}

function ask(module, request) {
  const place = put_text(module, JSON.stringify(request));
  if (place === 0) return { error: "there is not enough memory for this request" };
  module._softfocus_request(place);
  module._free(place);
  return JSON.parse(module.UTF8ToString(module._softfocus_reply()));
}

let compiler = null;

/** GLSL's compiler, loaded for the first shader. */
async function loaded_compiler() {
  if (compiler) return compiler;
  if (!Object.keys(kProbes).every(can_run)) {
    throw new Error("the compiler needs WebAssembly's exceptions, SIMD and atomics, which this browser has not");
  }
  const response = self.softfocus_parts ? null : await fetch("softfocus-compiler.wasm");
  if (!response?.ok) throw new Error("this page was built without GLSL's compiler");
  if (!self.createSoftfocusCompiler) importScripts("softfocus-compiler.js");
  compiler = await self.createSoftfocusCompiler({ wasmBinary: await response.arrayBuffer() });
  return compiler;
}

/** The request with what its text became, or {error}. */
async function with_compiled({ text, ...request }) {
  try {
    const of = await loaded_compiler();
    const places = [request.name, text].map((words) => put_text(of, words));
    if (places.includes(0)) throw new Error("there is not enough memory for this text");
    const compiled = JSON.parse(of.UTF8ToString(of._softfocus_compile(...places)));
    for (const place of places) of._free(place);
    return compiled.error ? compiled : { ...request, compiled };
  } catch (error) {
    compiler = null;  // out of stack or memory: it is in no known state
    return { error: error.message ?? String(error) };
  }
}

/**
 * The module's memory, which is another buffer each time that it has grown. With threads, any of
 * which may make it grow, only `wasmMemory` knows the newest.
 */
function memory_of(module) {
  return module.wasmMemory?.buffer ?? module.HEAPU8.buffer;
}

/** A copy of the picture, if the reply brought one: then it tells its size. */
function pixels_of(module, reply) {
  if (!reply.width || !reply.height) return undefined;
  const begin = module._softfocus_pixels();
  const bytes = new Uint8Array(memory_of(module), begin, 4 * reply.width * reply.height);
  return bytes.slice().buffer;
}

/** A copy of the file, if the reply tells of one. */
function file_of(module, reply) {
  if (!reply.saved_bytes) return undefined;
  const begin = module._softfocus_saved();
  return new Uint8Array(memory_of(module), begin, reply.saved_bytes).slice().buffer;
}

/** What a page writes 1 to, to end a request early; null where it shares no memory. */
function cancel_of(module) {
  const memory = memory_of(module);
  const is_shared = typeof SharedArrayBuffer !== "undefined" && memory instanceof SharedArrayBuffer;
  return is_shared ? new Int32Array(memory, module._softfocus_cancel(), 1) : null;
}

/** Writes a file below /own/, with its folders. A path cannot lead out of there. */
function write_file({ FS }, { path, bytes }) {
  const names = path.split(/[\\/]+/).filter((name) => name && name !== "." && name !== "..");
  let folder = "/own";
  for (const name of names.slice(0, -1)) {
    folder += `/${name}`;
    if (!FS.analyzePath(folder).exists) FS.mkdir(folder);
  }
  FS.writeFile(`${folder}/${names[names.length - 1]}`, new Uint8Array(bytes), { canOwn: true });
}

function remove_folder({ FS }, folder) {
  for (const name of FS.readdir(folder).filter((one) => one !== "." && one !== "..")) {
    const path = `${folder}/${name}`;
    if (FS.isDir(FS.stat(path).mode)) remove_folder({ FS }, path);
    else FS.unlink(path);
  }
  FS.rmdir(folder);
}

/** Opens what is in the files, which are then all that is below /own/, unless it fails. */
function open_with_files(module, request, files) {
  const { FS } = module;
  FS.rename("/own", "/own-before");
  FS.mkdir("/own");
  let reply;
  try {
    for (const file of files) write_file(module, file);
  } catch (error) {
    reply = { error: `the files cannot be kept: ${error.message ?? error}` };
  }
  reply ??= ask(module, request);
  if (reply.error) {
    remove_folder(module, "/own");
    FS.rename("/own-before", "/own");
  } else {
    remove_folder(module, "/own-before");
  }
  return reply;
}

function open_without_files(module, request) {
  const reply = ask(module, request);
  if (!reply.error && !(request.picture ?? request.scene ?? "").startsWith("/own/")) {
    remove_folder(module, "/own");
    module.FS.mkdir("/own");
  }
  return reply;
}

async function run() {
  const { build, missing } = choose_build();
  if (!build) throw new Error("this browser has no WebAssembly");
  const bytes = await wasm_of(build);
  let module = await make_module(build, bytes);
  let queue = Promise.resolve();
  let cancelled = 0;  // the id of a request

  /** A reply that takes long comes in slices; messages are read between them. */
  async function ask_in_slices(id, request) {
    for (;;) {
      const reply = ask(module, { ...request, slice_ms: kSliceMs });
      if (reply.unfinished === undefined) return reply;
      await new Promise((done) => setTimeout(done, 0));
      if (cancelled === id) return { cancelled: true };
    }
  }

  async function reply_to(id, request, files) {
    if (request.do === "open") {
      return files?.length ? open_with_files(module, request, files) : open_without_files(module, request);
    }
    if (request.do === "frame" && !cancel_of(module)) return ask_in_slices(id, request);
    const asked = request.do === "shader" ? await with_compiled(request) : request;
    return asked.error ? asked : ask(module, asked);
  }

  async function answer({ id, request, files }) {
    let reply, pixels, file;
    try {
      reply = await reply_to(id, request, files);
      pixels = pixels_of(module, reply);
      file = file_of(module, reply);
    } catch (error) {
      // Out of stack, or a mistake of ours: the module's memory is in no known state.
      reply = { error: `the module stopped: ${error.message ?? error}` };
      module.PThread?.terminateAllThreads();
      module = await make_module(build, bytes);
      self.postMessage({ restarted: true, cancel: cancel_of(module) });
    }
    self.postMessage({ id, reply, pixels, file }, [pixels, file].filter(Boolean));
  }

  self.onmessage = ({ data }) => {
    if (data.cancel) cancelled = data.cancel;
    else queue = queue.then(() => answer(data));
  };
  self.postMessage({ ready: true, build, missing, cancel: cancel_of(module) });
}

run().catch((error) => self.postMessage({ failed: String(error.message ?? error) }));
