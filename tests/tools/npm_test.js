// The npm package, installed from its tarball into an empty folder, against the program: the same bits.
//
//   node npm_test.js TARBALL PROGRAM
//
// In Chromium too (CHROMIUM, else `chromium`), if there is playwright-core (NODE_PATH).
"use strict";

const assert = require("assert");
const { execFileSync } = require("child_process");
const fs = require("fs");
const http = require("http");
const { createRequire } = require("module");
const os = require("os");
const path = require("path");
const { pathToFileURL } = require("url");

const [tarball, program] = process.argv.slice(2).map((name) => path.resolve(name));
const kScenes = path.join(__dirname, "../../scenes");
const kMostBytes = 4e6;  // of the tarball

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "softfocus-npm-"));
const at = (name) => path.join(folder, name);

function native(...words) {
  return execFileSync(program, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
}

const native_hash = (...words) => JSON.parse(native("render", ...words, "-o", "picture.npy", "--json")).picture_hash;

/** The first count of the channels of a .npy of halves, as its bits. */
function halves_of(name, count) {
  const file = Uint8Array.from(fs.readFileSync(at(name)));
  const all = new Uint16Array(file.slice(10 + file[8] + 256 * file[9]).buffer);
  return all.filter((_, i) => i % 4 < count);
}

function write_npy(name, shape, descr, array) {
  const text = `{'descr': '${descr}', 'fortran_order': False, 'shape': (${shape.join(", ")}), }`;
  const head = `${text}${" ".repeat(117 - text.length)}\n`;
  const length = Buffer.from([head.length, 0]);
  fs.writeFileSync(at(name), Buffer.concat([Buffer.from("\x93NUMPY\x01\x00", "latin1"), length,
                                            Buffer.from(head), Buffer.from(array.buffer)]));
}

/** A picture and its depth that look like nothing. */
function noise(width, height) {
  let state = 1;
  const next = () => (state = (state * 48271) % 2147483647) / 2147483647;
  return {
    floats: Float32Array.from({ length: width * height * 3 }, next),
    codes: Uint8Array.from({ length: width * height * 3 }, () => next() * 256),
    depth: Float32Array.from({ length: width * height }, () => 1 + 5 * next()),
  };
}

const kGain = `#version 330
uniform sampler2D p;
uniform vec2 gain;
out vec4 c;
void main() { c = texelFetch(p, ivec2(gl_FragCoord.xy), 0) * gain.y; }
`;

const refused = (promise, sentence) => assert.rejects(promise, (error) => {
  assert.match(error.message, sentence);
  assert.strictEqual(error.name, "SoftfocusError");
  return true;
});

const kTests = {
  async "the tarball is small and whole"({ softfocus }) {
    assert.ok(fs.statSync(tarball).size < kMostBytes, `${fs.statSync(tarball).size} bytes`);
    const { scripts, version, dependencies } = JSON.parse(
        fs.readFileSync(at("node_modules/softfocus/package.json"), "utf8"));
    assert.deepStrictEqual([scripts, dependencies], [undefined, undefined]);
    assert.strictEqual(version, (await softfocus.open()).version);
  },

  async "render() of a name, of TOML and of glTF has the program's bits"({ softfocus }) {
    const size = [96, 64];
    const words = ["--size", "96x64"];
    const frame = await softfocus.render("figures", { size, fNumber: 1.4 });
    assert.strictEqual(frame.hash, native_hash("figures", ...words, "--f-number", "1.4"));
    assert.deepStrictEqual([frame.data.length, frame.depth.length], [96 * 64 * 3, 96 * 64]);
    assert.ok(frame.depth.every((depth) => depth > 0));
    const views = { size, method: "accumulation", samples: 8 };
    assert.strictEqual((await softfocus.render("random:7", views)).hash,
                       native_hash("random:7", ...words, "--method", "accumulation", "--samples", "8"));
    const text = fs.readFileSync(path.join(kScenes, "cube-room.toml"), "utf8");
    const files = { "mine/room.toml": text };
    assert.strictEqual((await softfocus.render("mine/room.toml", { size, files })).hash,
                       native_hash("cube-room", ...words));
    const gltf = JSON.stringify({
      asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
      meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
      accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
      bufferViews: [{ buffer: 0, byteLength: 36 }], buffers: [{ byteLength: 36, uri: "points.bin" }],
    });
    const points = new Uint8Array(Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0).buffer);
    fs.writeFileSync(at("model.gltf"), gltf);
    fs.writeFileSync(at("points.bin"), points);
    const model = await softfocus.render("model.gltf", { size, files: { "model.gltf": gltf, "points.bin": points } });
    assert.strictEqual(model.hash, native_hash("model.gltf", ...words));
  },

  async "refocus() has the program's bits, of floats and of codes, in one thread too"({ softfocus }) {
    const [width, height] = [64, 48];
    const { floats, codes, depth } = noise(width, height);
    const cases = [
      { data: floats, descr: "<f4", options: { focusM: 2.5, fNumber: 1.4, fovYDegrees: 30 },
        words: ["--focus", "2.5", "--f-number", "1.4", "--fov", "30"] },
      { data: codes, descr: "|u1", options: { method: "two-pass", profile: "llvmpipe", cocScale: 9 },
        words: ["--focus", "2", "--sensor", "full-frame", "--method", "two-pass", "--profile", "llvmpipe",
                "--coc-scale", "9"] },
      { data: floats, descr: "<f4", options: { method: "auto", focusM: 3, blurAtInfinityPx: 7 },
        words: ["--focus", "3", "--blur-at-infinity", "7", "--method", "auto"] },
    ];
    write_npy("depth.npy", [height, width], "<f4", depth);
    for (const threads of fs.existsSync(at("node_modules/softfocus/module/softfocus-npm-simd.wasm")) ? [1, 0] : [0]) {
      await softfocus.open({ threads });
      for (const { data, descr, options, words } of cases) {
        write_npy("colour.npy", [height, width, 3], descr, data);
        native("refocus", "colour.npy", "depth.npy", "-o", "theirs.npy", "--depth-encoding", "metres", ...words);
        const ours = await softfocus.refocus({ width, height, data }, depth, { ...options, type: "float16" });
        assert.deepStrictEqual(ours.data, halves_of("theirs.npy", 3));
      }
    }
  },

  async "a result has the picture's type and channels, or those that are asked for"({ softfocus }) {
    const [width, height] = [8, 4];
    const depth = new Float32Array(width * height).fill(3);
    const codes = Uint8ClampedArray.from({ length: width * height * 4 }, (_, i) => i);
    const bytes = await softfocus.refocus({ width, height, data: Buffer.from(codes) }, depth, { method: "pinhole" });
    assert.deepStrictEqual(bytes.data, Uint8Array.from(codes));
    const clamped = await softfocus.refocus({ width, height, data: Uint8Array.from(codes) }, depth,
                                            { method: "pinhole", type: "uint8" });
    assert.deepStrictEqual(clamped.data, codes);
    const same = await softfocus.refocus({ width, height, data: codes }, depth, { method: "pinhole" });
    assert.deepStrictEqual(same.data, codes);
    const light = await softfocus.refocus(same, depth, { method: "pinhole", type: "float32", channels: 3 });
    assert.strictEqual(light.data.length, width * height * 3);
    const back = await softfocus.refocus(light, depth, { method: "pinhole", type: "uint8", channels: 4 });
    assert.ok(back.data.every((code, i) => code === (i % 4 === 3 ? 255 : codes[i])));
  },

  async "compare() measures, and passes within a tolerance"({ softfocus }) {
    const a = await softfocus.render("figures", { size: [48, 36] });
    const b = await softfocus.render("figures", { size: [48, 36], fNumber: 4 });
    const same = await softfocus.compare(a, a);
    assert.ok(same.passes && same.equal);
    const other = await softfocus.compare(a, b, { maxFlip: 0.5, threshold: 0.1, diff: true });
    assert.ok(other.passes && !other.equal && other.flip > 0 && other.flip < 0.5);
    assert.ok(other.codes.beyond >= 0 && other.codes.antiAliased >= 0 && other.limits[0].kept);
    assert.strictEqual(Buffer.from(other.diff).toString("latin1", 1, 4), "PNG");
    assert.ok(!(await softfocus.compare(a, b)).passes);
    const files = {};
    for (const [name, of] of [["a", []], ["b", ["--f-number", "4"]]]) {
      native("render", "figures", "--size", "48x36", ...of, "-o", `${name}.npy`);
      files[name] = fs.readFileSync(at(`${name}.npy`));
    }
    const theirs = JSON.parse(execFileSync(program, ["compare", "a.npy", "b.npy", "--json", "--max-flip", "0.5"],
                                           { cwd: folder, encoding: "utf8" }));
    const ours = await softfocus.compare(files.a, files.b, { maxFlip: 0.5 });
    assert.strictEqual(ours.differing, theirs.differing);
    assert.strictEqual(ours.maxHalfUlps, theirs.max_half_ulps);
  },

  async "a shader has the program's bits, and keeps what is set"({ softfocus }) {
    const [width, height] = [7, 5];
    const data = Float32Array.from({ length: width * height * 4 }, (_, i) => i / 16);
    const shader = await softfocus.Shader.compile(kGain, { name: "mine.frag" });
    assert.deepStrictEqual((await shader.uniforms()).sort(), ["gain", "p"]);
    const p = { width, height, data };
    const half = await shader.run(width, height, { uniforms: { gain: [0, 0.5] }, textures: { p } });
    assert.deepStrictEqual(half.data, data.map((value) => value * 0.5));
    await softfocus.open();  // another module
    assert.deepStrictEqual((await shader.run(width, height)).data, half.data);
    await refused(shader.run(1, 1, { uniforms: { gain: 1 } }), /gain/);
    await refused(softfocus.Shader.compile("void main() {\n  wrong;\n}", { name: "mine.frag" }), /^mine\.frag:2: /);
    await shader.free();
    await refused(shader.run(1, 1), /freed/);

    native("render", "figures", "--size", "64x48", "--method", "pinhole", "-o", "sharp.npy");
    const text = `#version 330
uniform sampler2D picture;
out vec4 c;
void main() {
  c.rgb = sin(texture(picture, gl_FragCoord.xy / 61.0).bgr * 3.0) * 0.5 + 0.5;
  c.a = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).a;  // which apply keeps
}
`;
    fs.writeFileSync(at("mine.frag"), text);
    native("apply", "sharp.npy", "--shader", "mine.frag", "-o", "shaded.npy");
    const made = await softfocus.Shader.compile(text);
    const picture = { width: 64, height: 48, data: halves_of("sharp.npy", 4), wrap: "clamp" };
    const shaded = await made.run(64, 48, { textures: { picture } });
    assert.ok((await softfocus.compare(shaded, fs.readFileSync(at("shaded.npy")), { maxUlps: 0 })).passes);
  },

  async "what is wrong is refused in the program's sentence, and nothing has changed"({ softfocus }) {
    const { hash } = await softfocus.render("figures", { size: [32, 32] });
    const picture = { width: 4, height: 2, data: new Float32Array(24) };
    const depth = new Float32Array(8).fill(1);
    await refused(softfocus.render("figurs"), /did you mean 'figures'\?/);
    await refused(softfocus.render("figures", { output: "x.npy" }), /not for this call/);
    await refused(softfocus.render("x.toml", { files: { "../x.toml": "" } }), /no name of a file/);
    await refused(softfocus.render("x.toml", { files: { "x.toml": "[lens]\nwrong = 1" } }), /x\.toml:/);
    await refused(softfocus.refocus(picture, depth, { method: "disc-layer" }), /disc-layers/);
    await refused(softfocus.refocus(picture, depth, { fNumber: -1 }), /f_number/);
    await refused(softfocus.refocus(picture, depth, { fnumber: 1 }), /no option 'fnumber'/);
    await refused(softfocus.refocus(picture, depth, { method: "two-pass\0x" }), /zero/);
    await refused(softfocus.refocus(picture, depth.subarray(1)), /7 numbers/);
    await refused(softfocus.refocus({ ...picture, data: [] }, depth), /picture\.data is Array/);
    await refused(softfocus.compare(picture, { ...picture, height: 1, data: new Float32Array(12) }), /one size/);
    await refused(softfocus.open({ threads: -1 }), /threads is -1/);
    const deep = `void main() { ${"{".repeat(1e5)}`;
    await assert.rejects(softfocus.Shader.compile(deep), /./);
    assert.strictEqual((await softfocus.run(["render"])).status, 2);
    assert.strictEqual((await softfocus.render("figures", { size: [32, 32] })).hash, hash);
  },

  async "run() is the program, with files in and out"({ softfocus }) {
    const words = ["render", "figures", "--size", "32x32", "-o"];
    const { status, files } = await softfocus.run([...words, "a.pfm"]);
    native(...words, "b.pfm");
    const { output } = await softfocus.run(["compare", "a.pfm", "b.pfm", "--json"],
                                           { ...files, "b.pfm": fs.readFileSync(at("b.pfm")) });
    assert.strictEqual(status, 0);
    assert.ok(JSON.parse(output).equal);
    assert.ok(Object.keys(await softfocus.methods()).length > 20);
    assert.match((await softfocus.profiles()).llvmpipe, /./);
  },

  async "toMatchSoftfocusGolden holds pictures against goldens, and takes new ones when asked"({ matcher }) {
    const picture = (added) => ({ width: 16, height: 12, data: Float32Array.from(
        { length: 576 }, (_, i) => i / 576 + added) });
    const goldens = at("goldens/it");
    const match = (of, options, update) => matcher.toMatchSoftfocusGolden.call(
        { testPath: at("it.test.js"), currentTestName: "a sky", snapshotState: { _updateSnapshot: update } },
        of, options);
    const first = await match(picture(0), {}, "new");
    assert.ok(!first.pass);
    assert.match(first.message(), /there is none yet/);
    assert.ok((await match(picture(0), {}, "all")).pass);
    assert.ok((await match(picture(0), {}, "new")).pass);
    const [name] = fs.readdirSync(goldens);
    assert.match(name, /^a_sky~[0-9a-f]{8}\.npy$/);
    const changed = await match(picture(0.05), {}, "none");
    assert.match(changed.message(), /576 of 576 values differ, at most by 0\.05/);
    assert.deepStrictEqual(fs.readdirSync(goldens).map((file) => file.replace(/~\w+/, "")).sort(),
                           ["a_sky.diff.png", "a_sky.got.npy", "a_sky.npy"]);
    assert.ok((await match(picture(0.05), { maxError: 0.1 }, "none")).pass);
    await refused(match(picture(0.05), { maxFlipp: 1 }, "all"), /--max-flip'\?/);
    assert.ok((await match(picture(0.05), {}, "all")).pass);
    assert.deepStrictEqual(fs.readdirSync(goldens), [name]);
  },

  async "node ends by itself, and import() works from CommonJS"() {
    fs.writeFileSync(at("main.cjs"), `import("softfocus").then(async ({ methods, open }) => {
      await open();
      console.log(Object.keys(await methods()).length > 20);
    });`);
    assert.strictEqual(execFileSync(process.execPath, ["main.cjs"], { cwd: folder, encoding: "utf8",
                                                                      timeout: 60000 }), "true\n");
  },
};

function has_browser() {
  try {
    require.resolve("playwright-core");
    return true;
  } catch {
    return false;
  }
}

/** Serves the folder, with the headers that threads need or without. */
function served(isolated) {
  const types = { ".html": "text/html", ".wasm": "application/wasm" };
  const server = http.createServer((request, response) => {
    const file = at(new URL(request.url, "http://localhost").pathname);
    if (isolated) {
      response.setHeader("Cross-Origin-Opener-Policy", "same-origin");
      response.setHeader("Cross-Origin-Embedder-Policy", "require-corp");
    }
    response.setHeader("Content-Type", types[path.extname(file)] ?? "text/javascript");
    response.statusCode = fs.existsSync(file) ? 200 : 404;
    response.end(fs.existsSync(file) ? fs.readFileSync(file) : "");
  });
  return new Promise((done) => server.listen(0, "127.0.0.1", () => done(server)));
}

async function in_browser(isolated) {
  fs.writeFileSync(at("page.html"), `<script type="importmap">
      { "imports": { "softfocus": "./node_modules/softfocus/index.js" } }</script>`);
  const server = await served(isolated);
  const browser = await require("playwright-core").chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
  try {
    const page = await browser.newPage();
    await page.goto(`http://localhost:${server.address().port}/page.html`);
    const { build, hash, shaded } = await page.evaluate(async (text) => {
      const { Shader, open, render } = await import("softfocus");
      const { build } = await open();
      const frame = await render("figures", { size: [64, 48] });
      const shader = await Shader.compile(text);
      const { data } = await shader.run(64, 48, { uniforms: { gain: [0, 2] }, textures: { p: frame } });
      return { build, hash: frame.hash, shaded: data.every((value, i) => i % 4 === 3
          ? value === 2 : value === 2 * frame.data[(i - i % 4) / 4 * 3 + i % 4]) };
    }, kGain);
    assert.strictEqual(build, isolated && os.cpus().length > 1 ? "threads" : "simd");
    assert.strictEqual(hash, native_hash("figures", "--size", "64x48"));
    assert.ok(shaded);
  } finally {
    await browser.close();
    server.close();
  }
}

const kTestsInBrowser = {
  "in an isolated page threads give the same bits": () => in_browser(true),
  "in any other page one thread does": () => in_browser(false),
};

async function main() {
  fs.writeFileSync(at("package.json"), "{}");
  execFileSync("npm", ["install", "--offline", "--ignore-scripts", "--no-audit", "--no-fund", tarball],
               { cwd: folder, stdio: "pipe" });
  const { resolve } = createRequire(at("main.cjs"));
  const load = (name) => import(pathToFileURL(resolve(name)));
  const package_ = { softfocus: await load("softfocus"), matcher: await load("softfocus/matcher") };
  const is_whole = fs.existsSync(at("node_modules/softfocus/module/softfocus-npm-simd.wasm"));
  const tests = { ...kTests, ...(has_browser() ? kTestsInBrowser : {}) };
  if (!is_whole) delete tests["in any other page one thread does"];
  for (const [claim, test] of Object.entries(tests)) {
    try {
      await test(package_);
      console.log(`pass: npm: ${claim}`);
    } catch (error) {
      console.log(`FAIL: npm: ${claim}\n${error.stack}`);
      process.exitCode = 1;
    }
  }
}

main().catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
}).finally(() => fs.rmSync(folder, { recursive: true }));
