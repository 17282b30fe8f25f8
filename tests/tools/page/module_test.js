// The module answers with the bits that the program draws: run by node, as
//
//   node module_test.js softfocus-NAME.js PROGRAM
"use strict";

const assert = require("assert");
const { execFileSync } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");
const zlib = require("zlib");
const { triangle_glb, triangle_gltf } = require("./triangle_gltf.js");

const [script, program] = process.argv.slice(2).map((name) => path.resolve(name));
const kThreads = 2;
// Of the module, compressed. Exceptions by way of JavaScript take more.
const kMostBytes = script.includes("plain") ? 2.4e6 : 1.9e6;

async function start_module() {
  const create = require(script);
  const module = await create({
    wasmBinary: fs.readFileSync(script.replace(/js$/, "wasm")),
    threads: kThreads,
    mainScriptUrlOrBlob: script,
  });
  module.FS.mkdir("/own");
  const ask = (request) => {
    const text = typeof request === "string" ? request : JSON.stringify(request);
    const size = module.lengthBytesUTF8(text) + 1;
    const place = module._malloc(size);
    module.stringToUTF8(text, place, size);
    module._softfocus_request(place);
    module._free(place);
    return JSON.parse(module.UTF8ToString(module._softfocus_reply()));
  };
  return { module, ask };
}

/** GLSL's compiler beside the module, which it answers for, or null in a build without it. */
async function start_compiler() {
  const place = path.join(path.dirname(script), "softfocus-compiler.js");
  if (!fs.existsSync(place)) return null;
  const compiler = await require(place)({ wasmBinary: fs.readFileSync(place.replace(/js$/, "wasm")) });
  return (text) => {
    const places = ["mine.frag", text].map((words) => {
      const size = compiler.lengthBytesUTF8(words) + 1;
      const at = compiler._malloc(size);
      compiler.stringToUTF8(words, at, size);
      return at;
    });
    const reply = JSON.parse(compiler.UTF8ToString(compiler._softfocus_compile(...places)));
    places.forEach((at) => compiler._free(at));
    return reply;
  };
}

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "softfocus-page-"));

function native_hash(words) {
  const output = execFileSync(program, ["render", ...words, "-o", path.join(folder, "picture.npy"),
                                        "--multisample", "1", "--json"], { stdio: ["ignore", "pipe", "ignore"] });
  return JSON.parse(output).picture_hash;
}

const kFrames = [
  { scene: "cube-room", settings: { size: [200, 120] }, words: ["--size", "200x120", "--method", "two-pass"] },
  { scene: "figures", settings: { size: [128, 128], time: 7, method: "disc-layers", f_number: 1.4,
                                  focus: { at: [0.25, 0.5] } },
    words: ["--size", "128x128", "--frame", "7", "--method", "disc-layers", "--f-number", "1.4",
            "--autofocus", "32,64"] },
  { scene: "sphere-world", settings: { size: [96, 64], max_coc_px: 5, focus: { m: 0.9 },
                                       focal_length_mm: 35, coc_scale: 2 },
    words: ["--size", "96x64", "--max-coc", "5", "--focus", "0.9", "--focal-length", "35",
            "--coc-scale", "2", "--method", "two-pass"] },
  { scene: "random:7", settings: { size: [64, 64], dof: false },
    words: ["--size", "64x64", "--show", "pinhole"] },
  { scene: "portrait", settings: { size: [64, 48], show: "coc" },
    words: ["--size", "64x48", "--show", "coc"] },
  { scene: "dunes", settings: { size: [64, 48], show: "depth" },
    words: ["--size", "64x48", "--show", "depth"] },
  { scene: "lattice", settings: { size: [40, 40], method: "accumulation", samples: 19 },
    words: ["--size", "40x40", "--method", "accumulation", "--samples", "19"] },
];

const kTests = {
  [`the module has at most ${kMostBytes} bytes, compressed`]() {
    const bytes = zlib.gzipSync(fs.readFileSync(script.replace(/js$/, "wasm")), { level: 9 }).length;
    assert.ok(bytes <= kMostBytes, `${bytes}`);
  },

  "a frame has the hash that the program gives"({ ask }) {
    for (const { scene, settings, words } of kFrames) {
      assert.strictEqual(ask({ do: "open", scene }).error, undefined, scene);
      const frame = ask({ do: "frame", ...settings });
      assert.strictEqual(frame.hash, native_hash([scene, ...words]), `${scene} ${words.join(" ")}`);
      const [width, height] = settings.size;
      assert.deepStrictEqual([frame.width, frame.height], [width, height]);
    }
  },

  "a map gives its numbers, and the hash of the program's map"({ ask, module }) {
    const numbers = ({ width, height }) => Array.from(
        new Float32Array(module.HEAPU8.slice(module._softfocus_pixels()).buffer, 0, width * height));
    ask({ do: "open", scene: "figures" });
    for (const show of ["coc", "depth"]) {
      const reply = ask({ do: "frame", size: [64, 48], show, numbers: true });
      assert.strictEqual(reply.hash, native_hash(["figures", "--size", "64x48", "--show", show, "--method", "two-pass"]), show);
      const all = numbers(reply);
      for (const [x, y] of [[8, 17], [32, 24], [10, 36]]) {
        const { depth_m, coc_radius_px } = ask({ do: "pixel", x, y });
        assert.strictEqual(all[64 * y + x], show === "coc" ? coc_radius_px : depth_m, `${show} at ${x}, ${y}`);
      }
      if (show === "coc") assert.ok(Math.min(...all) < 0 && Math.max(...all) > 0);
    }
    assert.strictEqual(ask({ do: "frame", size: [64, 48], numbers: true }).numbers, false);
    const error = ask({ do: "truth", views: 16, show: "error", numbers: true });
    const mean = numbers(error).reduce((sum, value) => sum + value, 0) / (64 * 48);
    assert.ok(Math.abs(mean - error.flip_mean) < 1e-3 * error.flip_mean, `${mean}, not ${error.flip_mean}`);
  },

  "a case's picture is told to hold or not, by the case's own measure"({ ask }) {
    ask({ do: "open", case: "near-edge", value: 16 });
    const verdict_of = (method) => {
      ask({ do: "frame", size: [128, 128], method });
      return ask({ do: "truth" }).verdict;
    };
    const [right, wrong] = [verdict_of("disc-layers"), verdict_of("two-pass")];
    assert.ok(right.holds && right.value <= right.limit);
    assert.ok(!wrong.holds && wrong.value > wrong.limit);
    ask({ do: "open", scene: "figures" });
    ask({ do: "frame", size: [32, 32] });
    assert.strictEqual(ask({ do: "truth", views: 16 }).verdict ?? null, null);
  },

  "the truth has the hash of accumulation with as many samples of the sequence"({ ask }) {
    ask({ do: "open", scene: "clutter" });
    ask({ do: "frame", size: [48, 32] });
    ask({ do: "truth", views: 20 });
    const { samples, hash } = ask({ do: "truth", views: 40, hash: true });
    assert.strictEqual(hash, native_hash(["clutter", "--size", "48x32", "--method", "accumulation",
                                          "--samples", String(samples), "--until", "1e-9"]));
  },

  "a frame that comes in slices has the bits of one that does not"({ ask }) {
    ask({ do: "open", scene: "figures" });
    for (const method of ["accumulation", "filtered-views"]) {
      const settings = { do: "frame", size: [48, 32], method, samples: 40 };
      const seen = [];
      let reply = ask({ ...settings, slice_ms: 0 });
      for (; reply.unfinished; reply = ask({ ...settings, slice_ms: 0 })) seen.push(reply.unfinished);
      assert.deepStrictEqual(seen.slice(-2), [16, 32], method);
      assert.strictEqual(reply.hash, ask(settings).hash, method);
    }
  },

  "a scene of one's own is read from below /own"({ module, ask }) {
    const text = fs.readFileSync(path.join(__dirname, "../../../scenes/figures.toml"));
    module.FS.writeFile("/own/mine.toml", text);
    ask({ do: "open", scene: "/own/mine.toml" });
    const mine = ask({ do: "frame", size: [64, 64] });
    ask({ do: "open", scene: "figures" });
    assert.strictEqual(mine.hash, ask({ do: "frame", size: [64, 64] }).hash);
  },

  "glTF with a texture has the hash that the program gives, in one file and in three"({ module, ask }) {
    const settings = { size: [96, 64] };
    const words = ["--size", "96x64", "--method", "two-pass"];
    const png_file = path.join(folder, "base.png");
    execFileSync(program, ["render", "figures", "--size", "16x16", "-o", png_file], { stdio: "ignore" });
    const png = fs.readFileSync(png_file);
    const files = { "triangle.glb": triangle_glb(png), ...triangle_gltf(png) };
    for (const [name, bytes] of Object.entries(files)) {
      fs.writeFileSync(path.join(folder, name), bytes);
      module.FS.writeFile(`/own/${name}`, bytes);
    }
    for (const name of ["triangle.glb", "triangle.gltf"]) {
      const opened = ask({ do: "open", scene: `/own/${name}` });
      assert.deepStrictEqual(opened.warnings, [], name);
      assert.strictEqual(ask({ do: "frame", ...settings }).hash,
                         native_hash([path.join(folder, name), ...words]), name);
    }
    module.FS.writeFile("/own/broken.glb", files["triangle.glb"].subarray(0, 99));
    assert.match(ask({ do: "open", scene: "/own/broken.glb" }).error, /broken\.glb/);
    for (const name of Object.keys(files)) fs.rmSync(path.join(folder, name));
  },

  "a picture and its depth have the hash and the file that `refocus` gives"({ module, ask }) {
    const run = (...words) => execFileSync(program, words, { cwd: folder, encoding: "utf8",
                                                             stdio: ["ignore", "pipe", "ignore"] });
    const size = ["--size", "96x64"];
    run("render", "figures", ...size, "--show", "pinhole", "-o", "a.png", "--depth-output", "d.png");
    run("render", "figures", ...size, "--show", "pinhole", "-o", "a.pfm", "--depth-output", "d.pfm");
    run("render", "figures", ...size, "--show", "pinhole", "-o", "a.hdr", "--depth-output", "d.npy");
    run("render", "figures", ...size, "--show", "pinhole", "-o", "both.npy");
    run("render", "figures", ...size, "--show", "depth", "-o", "grey.png");
    for (const name of fs.readdirSync(folder)) {  // with the sidecars that tell the field of view
      module.FS.writeFile(`/own/${name}`, fs.readFileSync(path.join(folder, name)));
    }
    const cases = [
      { files: ["a.png", "d.png"], reading: {}, words: [] },
      { files: ["a.pfm", "d.pfm"], reading: { encoding: "metres", scale: 2 },
        words: ["--depth-encoding", "metres", "--scale", "2"] },
      { files: ["a.hdr", "d.npy"], reading: {}, words: [] },
      { files: ["both.npy"], reading: {}, words: [] },
      { files: ["a.png", "grey.png"], reading: { encoding: "gdepth-inverse", near_m: 0.5, far_m: 4 },
        words: ["--depth-encoding", "gdepth-inverse", "--near", "0.5", "--far", "4"] },
    ];
    const lens = { focus: { at: [0.5, 0.5] }, f_number: 1.4, focal_length_mm: 60, coc_scale: 4 };
    for (const { files, reading, words } of cases) {
      const [picture, depth] = files.map((name) => `/own/${name}`);
      const opened = ask({ do: "open", picture, depth: depth ?? null, ...reading });
      assert.strictEqual(opened.error, undefined, files.join(" "));
      for (const method of ["two-pass", "disc-layers", "scatter-aperture"]) {
        const frame = ask({ do: "frame", method, ...lens });
        const said = JSON.parse(run(
            "refocus", ...files, "-o", "result.npy", "--json", "--method", method, ...words,
            "--focus-at", "48,32", "--f-number", "1.4", "--focal-length", "60", "--coc-scale", "4"));
        assert.strictEqual(frame.hash, said.picture_hash, `${files.join(" ")} ${method}`);
        const { saved_bytes } = ask({ do: "save", format: "npy" });
        const begin = module._softfocus_saved();
        const memory = module.wasmMemory?.buffer ?? module.HEAPU8.buffer;
        assert.ok(fs.readFileSync(path.join(folder, "result.npy"))
            .equals(Buffer.from(memory, begin, saved_bytes)), "the file");
      }
    }
    module.FS.writeFile("/own/x.exr", Buffer.from([0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]));
    assert.match(ask({ do: "open", picture: "/own/x.exr" }).error, /refocus IN\.exr .*OUT\.npy/);
    assert.match(ask({ do: "truth", views: 4 }).error, /no scene/);
  },

  "what is wrong is an error, and nothing has changed"({ ask }) {
    ask({ do: "open", scene: "figures" });
    const { hash } = ask({ do: "frame", size: [32, 32] });
    const wrong = [
      "no JSON", "{}", "[]", "1", '{"do": 1}', { do: "nothing" }, { do: "open", scene: "nowhere" },
      { do: "open", scene: "/own/nothing.obj" }, { do: "open", case: "nothing" },
      { do: "frame", size: [0, 1] }, { do: "frame", size: "1x1" }, { do: "frame", method: "none" },
      { do: "frame", f_number: -1 }, { do: "frame", focus: {} }, { do: "frame", f_number: "2" },
      { do: "frame", focal_length_mm: 1e9, focus: { m: 1e-9 } },
      { do: "frame", camera: { position_m: [0, 0, 0], target_m: [0, 0, 0], fov_y_degrees: 40 } },
      { do: "frame", size: [16384, 16384] },
      { do: "pixel", x: 99, y: 0 }, { do: "truth", views: -1 }, { do: "selftest" },
    ];
    for (const request of wrong) {
      const reply = ask(request);
      assert.match(reply.error ?? "", /./, JSON.stringify(request));
      assert.ok(!reply.error.includes("\n"), reply.error);
    }
    assert.strictEqual(ask({ do: "pixel", x: 31, y: 31 }).error, undefined);
    assert.strictEqual(ask({ do: "frame", size: [32, 32] }).hash, hash);
  },

  "without WebGL2 the GPU's requests say so, and the rest works"({ ask }) {
    ask({ do: "open", scene: "figures" });
    const { hash } = ask({ do: "frame", size: [32, 32] });
    for (const request of [{ do: "gl_open" }, { do: "gl_probe" }, { do: "gl_crosscheck" },
                           { do: "gl_frame", size: [32, 32], gl_show: "difference" }]) {
      assert.match(ask(request).error ?? "", /^no WebGL2 here: /, JSON.stringify(request));
    }
    assert.match(ask({ do: "gl_frame", gl_show: "picture" }).error, /no frame of the GPU's yet/);
    assert.strictEqual(ask({ do: "frame", size: [32, 32] }).hash, hash);
  },

  // browser_test.js has all of them.
  "every quick golden hash is the table's"({ ask }) {
    let first = 0;
    for (let total = 1; first < total;) {
      const reply = ask({ do: "selftest", quick: true, first, count: 50 });
      for (const { name, equal } of reply.results) assert.ok(equal, name);
      assert.ok(reply.results.length > 0, `only ${first} of ${reply.total}`);
      first += reply.results.length;
      total = reply.total;
    }
    assert.ok(first > 500, `only ${first}`);
  },
};

const kPipelines = path.join(__dirname, "../../../scenes/pipelines");
const passes_of = (name) => fs.readFileSync(path.join(kPipelines, name), "utf8")
    .replace(/(shader = )"[^"]*"/g, '$1"mine.frag"');

const kTestsOfCompiler = {
  "the compiler names the line of a mistake, and goes on"({ compile }) {
    const text = "#version 300 es\nprecision highp float;\nout vec4 colour;\nvoid main() { colour = vec4(x); }\n";
    for (let i = 0; i < 3; ++i) {
      assert.match(compile(text).error, /^mine\.frag:4: 'x': undeclared identifier/);
      assert.strictEqual(compile(text.replace("x", "1.0")).error, undefined);
    }
    assert.match(compile("void main() {").error, /^mine\.frag:1: /);
    assert.match(compile(`void main() { ${"{".repeat(1e5)}`).error, /./);
  },

  "two-pass as a text of the visitor's has the bits of two-pass"({ ask, compile }) {
    const { text } = ask({ do: "shader_text", name: "two_pass.frag" });
    const compiled = compile(text);
    assert.strictEqual(compiled.error, undefined);
    const { method, error } = ask({ do: "shader", name: "mine.frag", compiled,
                                    passes: passes_of("two_pass.toml") });
    assert.strictEqual(error, undefined);
    ask({ do: "open", scene: "figures" });
    const frame = { do: "frame", size: [96, 96], coc_scale: 3 };
    assert.strictEqual(ask({ ...frame, method }).hash, ask({ ...frame, method: "two-pass" }).hash);
    assert.ok(ask({ do: "truth", views: 8 }).flip_mean > 0);
    assert.match(ask({ do: "shader", name: "mine.frag", compiled, passes: "[[pass]]\nshader = 1" }).error,
                 /^mine\.toml:2: /);
    assert.match(ask({ ...frame, method: "shader-0x1.toml" }).error, /shader-0x1/);
  },

  "the lesson's shaders have the bits that the program gives"({ ask, compile }) {
    ask({ do: "open", scene: "figures" });
    for (const name of ["gather", "weights"]) {
      const place = path.join(kPipelines, "lesson", name);
      const compiled = compile(fs.readFileSync(`${place}.frag`, "utf8"));
      const { method, error } = ask({ do: "shader", name: "mine.frag", compiled,
                                      passes: passes_of(`lesson/${name}.toml`) });
      assert.strictEqual(error, undefined);
      assert.strictEqual(ask({ do: "frame", size: [96, 64], method }).hash,
                         native_hash(["figures", "--size", "96x64", "--method", `${place}.toml`]));
    }
  },
};

async function main() {
  const page = await start_module();
  page.compile = await start_compiler();
  const { threads } = page.ask({ do: "start", threads: script.includes("threads") ? kThreads : 1 });
  const name = `${path.basename(script)}, ${threads} threads`;
  const tests = { ...kTests, ...(page.compile ? kTestsOfCompiler : {}) };
  for (const [claim, test] of Object.entries(tests)) {
    try {
      test(page);
      console.log(`pass: ${name}: ${claim}`);
    } catch (error) {
      console.log(`FAIL: ${name}: ${claim}\n${error.stack}`);
      process.exitCode = 1;
    }
  }
}

main().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
}).finally(() => {
  fs.rmSync(folder, { recursive: true });
  process.exit();  // threads would keep node alive
});
