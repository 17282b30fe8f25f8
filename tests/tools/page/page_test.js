// The parts of the simulator's page that need no browser: node page_test.js
"use strict";

const assert = require("assert");
const fs = require("fs");
const os = require("os");
const path = require("path");
const { pathToFileURL } = require("url");

// The page's files are modules by where they are used; node asks for a package that says so.
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "softfocus-page-"));
const web = path.join(__dirname, "../../../tools/page/web");
fs.cpSync(web, folder, { recursive: true });
fs.writeFileSync(path.join(folder, "package.json"), '{"type": "module"}');
const module_of = (name) => import(pathToFileURL(path.join(folder, name)));

const tests = [];
const test = (claim, run) => tests.push({ claim, run });
const near = (a, b, part = 1e-5) => assert.ok(Math.abs(a - b) <= part * Math.abs(b), `${a}, not ${b}`);

/** What the module tells of what can be set, as far as it is needed here. */
const kParameters = {
  focus_m: { name: "focus", preset: 2, of_lens: true },
  focal_length_mm: { name: "focal-length", preset: 50, of_lens: true },
  f_number: { name: "f-number", preset: 2, of_lens: true },
  shift_mm: { name: "shift", preset: 0, of_lens: true },  // a number that the page knows nothing of
  coc_scale: { name: "coc-scale", preset: 1 },
  aperture_blades: { name: "aperture-blades", preset: 0 }, highlight_gain: { preset: 1 },
  highlight_threshold: { preset: 0.9 },
  samples: { preset: 64 }, max_coc_px: { most: 1024 }, near: { key: "near_m" }, far: { key: "far_m" },
  scale: { key: "scale" }, offset: { key: "offset" },
};

const kSensors = [{ name: "full-frame", width_mm: 36, height_mm: 24 },
                  { name: "half", width_mm: 18, height_mm: 12 }];

test("a side begins with what the module has for presets", async () => {
  const { first_side, set_parameters } = await module_of("state.js");
  set_parameters(kParameters, kSensors);
  assert.deepStrictEqual([first_side().f_number, first_side().focus.m], [2, 2]);
});

test("a link gives the state back", async () => {
  const { first_side, first_state } = await module_of("state.js");
  const { link_of, read_link, state_to_open, with_link } = await module_of("link.js");
  const state = {
    ...first_state(), scene: "random:18446744073709551615", size: [1024, 512], time: 7,
    show: "error", editing: 1, divider: 0.25, object_m: 2.5,
    camera: { position_m: [1, -2.5, 3], target_m: [0, 0.125, 0], fov_y_degrees: 31.5 },
    photo: { on: true, sensor: "aps-c", keep: "focal-length", lock: true, subject: true },
    sides: [{ ...first_side(), dof: false, focus: { m: 1.25 }, max_coc_px: 12, samples: 16 },
            { ...first_side(), method: "disc-layers", focus: { at: [0.25, 0.75] }, f_number: 5.6,
              shift_mm: -3, aperture_blades: 7, highlight_gain: 4 }],
    look: { ...first_state().look, backdrop_m: 12.5 },
  };
  const words = read_link(`#${link_of(state)}`);
  const opened = state_to_open(words);
  assert.strictEqual(opened.scene, state.scene);
  assert.deepStrictEqual(with_link(opened, words), state);
});

test("a link carries a shader that is shown, up to a length, and what is broken is none", async () => {
  const { first_side, first_state } = await module_of("state.js");
  const { kMostLinkBytes, link_of, read_link, shader_of, take_shader } = await module_of("link.js");
  const method = "shader-0x0123456789abcdef.toml";
  const shader = { text: "// über\nvoid main() {}\n", passes: "[[pass]]\n", method };
  const state = { ...first_state(), shader, sides: [{ ...first_side(), method }] };
  const words = read_link(link_of(state));
  assert.deepStrictEqual(shader_of(words), { text: shader.text, passes: shader.passes });
  take_shader(words, "shader-0x1.toml");
  assert.strictEqual(words.get("method"), "shader-0x1.toml");
  take_shader(words, null);
  assert.strictEqual(words.get("method"), "two-pass");
  assert.strictEqual(shader_of(read_link(link_of({ ...state, sides: [first_side()] }))), null);
  const long = { ...shader, text: "x".repeat(kMostLinkBytes) };
  assert.strictEqual(shader_of(read_link(link_of({ ...state, shader: long }))), null);
  assert.strictEqual(shader_of(read_link("shader=*&passes=AA")), null);
});

test("a fault's place is a line of one of the two texts", async () => {
  const { line_range, place_of } = await module_of("panels/shader.js");
  assert.deepStrictEqual(place_of("mine.frag:12: 'x': undeclared"), { id: "shader-text", line: 12 });
  assert.deepStrictEqual(place_of("mine.toml:3: shader"), { id: "shader-passes", line: 3 });
  assert.strictEqual(place_of("this page was built without"), null);
  assert.deepStrictEqual(line_range("ab\ncde\nf", 2), [3, 6]);
  assert.deepStrictEqual(line_range("ab\ncde\nf", 9), [7, 8]);
});

test("a link carries a failure case", async () => {
  const { first_state } = await module_of("state.js");
  const { link_of, read_link, state_to_open } = await module_of("link.js");
  const failure = { name: "near-edge", value: 16 };
  const words = read_link(link_of({ ...first_state(), scene: null, failure }));
  assert.deepStrictEqual(state_to_open(words).failure, failure);
});

test("a link names the visitor's own file", async () => {
  const { first_state } = await module_of("state.js");
  const { link_of, read_link } = await module_of("link.js");
  const words = read_link(link_of({ ...first_state(), scene: "/own/my box/a.obj" }));
  assert.deepStrictEqual([words.get("own"), words.has("scene")], ["my box/a.obj", false]);
});

test("what a link has wrong stays at its default", async () => {
  const { first_state } = await module_of("state.js");
  const { read_link, state_to_open, with_link } = await module_of("link.js");
  const words = read_link("#scene=%E0%A4%A&size=0x9&f=long&focus=-1&camera=1,2&show=all&divider=3&=&x");
  assert.deepStrictEqual(with_link(state_to_open(words), words), first_state());
});

test("the lens has the numbers of `softfocus lens`", async () => {
  const lens_module = await module_of("lens/lens.js");
  // softfocus lens --focal-length 50 --f-number 2 --focus 1.5 --at 0.5 8
  const lens = { focal_length_mm: 50, f_number: 2, focus_m: 1.5 };
  const film_mm = lens_module.film_height(lens, 40);
  near(film_mm, 37.6521);
  near(lens_module.aperture_of(lens), 25);
  near(lens_module.hyperfocal_distance_m(lens, film_mm / 1024), 34.0455);
  const { near_m, far_m } = lens_module.sharp_limits_m(lens, film_mm / 1024);
  near(near_m, 1.43864);
  near(far_m, 1.56683);
  near(lens_module.circle_on_film(lens, 0.5), 1.72414);
  near(lens_module.radius_px(lens, 0.5, 40, 1024, 1), -23.4451);
  near(lens_module.radius_px(lens, 8, 40, 1024, 1), 9.52459);
  near(lens_module.field_of_view_degrees(lens, film_mm), 40);
  assert.strictEqual(lens_module.sharp_limits_m({ ...lens, focus_m: 40 }, film_mm / 1024).far_m, Infinity);
});

test("a locked lens sees what its sensor takes in", async () => {
  const { locked_fov_degrees, nearest_stop } = await module_of("lens/photographer.js");
  const lens = { focal_length_mm: 50, f_number: 2, focus_m: 1e9 };
  const state = { size: [1024, 512], photo: { on: true, sensor: "full-frame", lock: true } };
  near(locked_fov_degrees({ ...state, size: [512, 512] }, lens), 26.9915);  // 24 mm at 50 mm
  near(locked_fov_degrees(state, lens), 20.4079);  // a width of 36 mm leaves 18
  assert.strictEqual(locked_fov_degrees({ ...state, photo: { ...state.photo, lock: false } }, lens), null);
  assert.strictEqual(locked_fov_degrees(state, { ...lens, focus_m: 0.01 }), null);
  assert.strictEqual(nearest_stop(2.05), 2);
});

test("another sensor keeps the framing or the focal length, and zooming the magnification", async () => {
  const { adapted, zoomed_focus_m } = await module_of("lens/photographer.js");
  const { backed, walked } = await module_of("camera.js");
  const { field_of_view_degrees, film_height } = await module_of("lens/lens.js");
  const lens = { focal_length_mm: 50, f_number: 2, focus_m: 2 };
  const photo = { on: true, sensor: "full-frame", keep: "framing", lock: false, subject: false };
  const state = { size: [512, 512], photo };
  const behind = (patch) => adapted(state, { ...photo, ...patch }, lens, 40);
  const film_mm = film_height(lens, 40);
  const { focal_length_mm } = behind({ sensor: "half" });
  near(film_height({ ...lens, focal_length_mm }, 40), film_mm / 2);
  near(behind({ sensor: "half", keep: "focal-length" }).fov_y_degrees, field_of_view_degrees(lens, film_mm / 2));
  const locked = behind({ lock: true });
  near(film_height({ ...lens, ...locked }, 40), 24);
  assert.deepStrictEqual(behind({ sensor: "half", on: false }), {});
  assert.deepStrictEqual(behind({ keep: "focal-length" }), {});

  const focus_m = zoomed_focus_m(lens, 100);
  const part = (f, z) => f / (z * 1000 - f);
  near(part(100, focus_m), part(50, 2));
  const camera = { position_m: [0, 0, 4], target_m: [0, 0, 0], fov_y_degrees: 40 };
  assert.deepStrictEqual(backed(camera, 2), { ...camera, position_m: [0, 0, 6] });
  assert.deepStrictEqual(backed(camera, -5), walked(camera, 0, 0, 5));
});

test("a step that is taken back gives the value from before", async () => {
  const { make_trail } = await module_of("numbers.js");
  const step = make_trail();
  const up = (x) => step(x, 1, () => Math.round(1.1 * x));
  const down = (x) => step(x, -1, () => Math.round(x / 1.1));
  assert.deepStrictEqual([up(14), up(15), up(17)], [15, 17, 19]);
  assert.deepStrictEqual([down(19), down(17), down(15), down(14)], [17, 15, 14, 13]);
  assert.strictEqual(down(99), 90);  // from a value that no step has led to
});

test("what `refocus` advises is told in the page's words", async () => {
  const { advice_here } = await module_of("panels/picture.js");
  assert.strictEqual(advice_here("a; give the depth as a second file, or say --depth-layer"),
                     "a; give the depth as a second file");
  assert.strictEqual(advice_here("'d' has no depth: x; give another file, or --depth-layer"),
                     "'d' has no depth: x; give another file");
  assert.strictEqual(advice_here("--holes far fills them"), "holes far fills them");
  const command = "softfocus refocus IN.exr --method pinhole";
  assert.strictEqual(advice_here(command), command);
});

test("the camera turns around its target and never over it", async () => {
  const { arm_length_m, dollied, orbited, panned, walked } = await module_of("camera.js");
  const camera = { position_m: [0, 1, 4], target_m: [0, 1, 0], fov_y_degrees: 40 };
  const turned = orbited(camera, Math.PI / 2, 0);
  assert.deepStrictEqual(turned.target_m, camera.target_m);
  near(turned.position_m[0], -4);
  const above = orbited(camera, 0, 9);
  near(arm_length_m(above), 4);
  assert.ok(above.position_m[1] < 5 && above.position_m[2] > 0);
  near(arm_length_m(dollied(camera, 0.5)), 2);
  assert.deepStrictEqual(walked(camera, 0, 0, 1).position_m, [0, 1, 3]);
  assert.deepStrictEqual(walked(camera, 1, 0, 0).target_m, [1, 1, 0]);
  near(panned(camera, 0, 1).target_m[1], 1 + 8 * Math.tan(20 * Math.PI / 180));
});

test("the error of a picture without depth of field is that of the pinhole", async () => {
  const { first_side, first_state, frame_request } = await module_of("state.js");
  const off = { ...first_side(), dof: false };
  assert.strictEqual(frame_request(first_state(), off, 1).dof, false);
  const measured = frame_request({ ...first_state(), show: "error" }, off, 1);
  const bladed = { ...first_side(), method: "scatter-aperture", aperture_blades: 5 };
  const blades_of = (patch) => frame_request({ ...first_state(), ...patch }, bladed, 1).aperture_blades;
  assert.deepStrictEqual([blades_of({}), blades_of({ failure: { name: "leak-far", value: 1 } })], [5, undefined]);
  assert.deepStrictEqual([measured.dof, measured.method, measured.show], [true, "pinhole", "image"]);
});

test("of dropped files the scene is opened, else the model", async () => {
  const { scene_among } = await module_of("panels/own_files.js");
  assert.strictEqual(scene_among(["a/b.obj", "b.mtl", "c.OBJ"]), "c.OBJ");
  assert.strictEqual(scene_among(["c.obj", "deep/room.toml"]), "deep/room.toml");
  assert.strictEqual(scene_among(["scene.bin", "scene.gltf", "base.png"]), "scene.gltf");
  assert.strictEqual(scene_among(["car.GLB", "car.stl"]), "car.GLB");
  assert.strictEqual(scene_among(["a.png"]), undefined);
});

test("of two dropped pictures one is the depth", async () => {
  const { picture_among } = await module_of("panels/own_files.js");
  const found = (...paths) => picture_among(paths);
  assert.deepStrictEqual(found("b_depth.png", "b.jpg"), { picture: "b.jpg", depth: "b_depth.png" });
  assert.deepStrictEqual(found("im0.png", "disp0.pfm"), { picture: "im0.png", depth: "disp0.pfm" });
  assert.deepStrictEqual(found("a.z.png", "a.png"), { picture: "a.png", depth: "a.z.png" });
  assert.deepStrictEqual(found("depths/a.png", "depths/b.png"), { picture: "depths/a.png", depth: "depths/b.png" });
  assert.deepStrictEqual(found("a.npy", "a.npy.json"), { picture: "a.npy", depth: null });
  assert.strictEqual(found("a.png", "b.png", "c.png"), undefined);
  assert.strictEqual(found("notes.txt"), undefined);
});

test("a picture's request and its command have the numbers that its encoding takes", async () => {
  const { picture_request } = await module_of("panels/picture.js");
  const { refocus_command } = await module_of("panels/hashes.js");
  const { first_side, first_state, with_picture } = await module_of("state.js");
  const listing = {
    encodings: [{ name: "metres", needs: "", takes: "scale offset" },
                { name: "device", needs: "near far", takes: "" },
                { name: "circles", needs: "", takes: "" }],
    readings: [{ name: "holes", key: "holes" }, { name: "depth-fit", key: "depth_fit" }],
    methods: [{ name: "two-pass" }, { name: "scatter-aperture", stretch: true }],
  };
  const picture = { depth: "/own/my d.png", encoding: "device", numbers: { near_m: 1, far_m: 9, scale: 2 },
                    choices: { depth_fit: "crop" } };
  assert.deepStrictEqual(picture_request("/own/a.png", picture, listing, null), {
    do: "open", picture: "/own/a.png", depth: "/own/my d.png", encoding: "device", near_m: 1, far_m: 9,
    depth_fit: "crop" });
  const believed = picture_request("/own/a.png", { ...picture, encoding: null }, listing, "metres");
  assert.deepStrictEqual([believed.encoding, believed.scale, believed.near_m], [null, 2, undefined]);

  const side = { ...first_side(), method: "accumulation", focus: { at: [0.5, 1] } };
  const state = with_picture({ ...first_state(), scene: "/own/a.png", picture, show: "truth", sides: [side] },
                             { width: 300, height: 200 }, [{ name: "two-pass", kind: "filter" }]);
  assert.deepStrictEqual([state.show, state.sides[0].method], ["image", "two-pass"]);
  assert.strictEqual(
      refocus_command(state, state.sides[0], listing),
      "softfocus refocus a.png 'my d.png' -o picture.png --json --depth-encoding device --near 1 --far 9 " +
      "--depth-fit crop --method two-pass --focus-at 150,199 --focal-length 50 --f-number 2 --shift 0 --coc-scale 1");
  assert.strictEqual(refocus_command(state, { ...side, dof: false }, listing), null);
  const set = { aperture_blades: 5, highlight_gain: 8 };
  const seldom = (method) => / --method (.*) --focus-at/.exec(
      refocus_command(state, { ...state.sides[0], ...set, method }, listing))[1];
  assert.strictEqual(seldom("two-pass"), "two-pass --highlights 8,0.9");
  assert.strictEqual(seldom("scatter-aperture"), "scatter-aperture --aperture-blades 5 --highlights 8,0.9");
  const of_circles = { ...state, picture: { ...state.picture, encoding: "circles" } };
  assert.strictEqual(
      refocus_command(of_circles, state.sides[0], listing),
      "softfocus refocus a.png --circles 'my d.png' -o picture.png --json --depth-fit crop --method two-pass");
});

test("radii are read from a line of text", async () => {
  const { read_radii } = await module_of("panels/methods_table.js");
  assert.deepStrictEqual(read_radii("32, 8;8 x -1 2000"), [8, 32]);
});

/** A worker that answers when it is told to. */
class FakeWorker {
  constructor() {
    FakeWorker.last = this;
    this.sent = [];
    this.heard = {};
  }
  addEventListener(name, heard) { this.heard[name] = heard; }
  postMessage(message) { this.sent.push(message); }
  say(data) { this.heard.message({ data }); }
  answer(reply) { this.say({ id: this.sent[this.sent.length - 1].id, reply }); }
}

async function started_engine(cancel = new Int32Array(new SharedArrayBuffer(4))) {
  globalThis.Worker = FakeWorker;
  const { start_engine } = await module_of("engine.js");
  const failures = [];
  const engine = start_engine({ on_ready() {}, on_failed: (line) => failures.push(line),
                                on_restarted() {} });
  FakeWorker.last.say({ ready: true, cancel });
  return { engine, worker: FakeWorker.last, failures, cancel };
}

test("a frame overtakes work in the background", async () => {
  const { engine, worker } = await started_engine();
  const asked = [engine.ask({ do: "first" }, 2), engine.ask({ do: "background" }, 2),
                 engine.ask({ do: "frame" }, 0)];
  worker.answer({});
  worker.answer({});
  worker.answer({});
  await Promise.all(asked);
  assert.deepStrictEqual(worker.sent.map(({ request }) => request.do), ["first", "frame", "background"]);
});

test("only what runs in the background is cancelled for a frame", async () => {
  const { engine, cancel } = await started_engine();
  engine.ask({ do: "open" }, 1);
  engine.cancel_background();
  assert.strictEqual(cancel[0], 0);
  engine.cancel_running();
  assert.strictEqual(cancel[0], 1);
});

test("without shared memory the worker is told which request to end", async () => {
  const { engine, worker } = await started_engine(null);
  engine.ask({ do: "frame" }, 0);
  const { id } = worker.sent[0];
  engine.cancel_background();
  assert.strictEqual(worker.sent.length, 1);
  engine.cancel_running();
  assert.deepStrictEqual(worker.sent[1], { cancel: id });
});

test("a worker that fails answers every request with its line", async () => {
  const { engine, worker, failures } = await started_engine();
  const asked = [engine.ask({ do: "a" }), engine.ask({ do: "b" })];
  worker.say({ failed: "no WebAssembly" });
  for (const { reply } of await Promise.all(asked)) assert.strictEqual(reply.error, "no WebAssembly");
  assert.deepStrictEqual(failures, ["no WebAssembly"]);
});

test("of many changes only the newest is drawn", async () => {
  const { first_state, make_store } = await module_of("state.js");
  const { make_frames } = await module_of("frames.js");
  const asked = [];
  const engine = {
    ask: (request) => new Promise((done) => asked.push({ request, done })),
    cancel_background() {}, cancel_running() {},
  };
  const store = make_store(first_state());
  const shown = [];
  const frames = make_frames({ engine, store, moving: () => false, paint() {}, on_error() {},
                               on_settled() {},
                               on_frame: (_, coarse, state) => shown.push(state.time) });
  const finish = async () => {
    asked[asked.length - 1].done({ reply: { draw_ms: 1, filter_ms: 1 } });
    await new Promise(setImmediate);
  };
  assert.deepStrictEqual(frames.timings(), []);
  frames.set_open(true);
  for (let time = 1; time <= 5; time++) {
    store.change({ time });
    frames.want();
  }
  await finish();
  assert.ok(!frames.settled());
  await finish();
  assert.deepStrictEqual(shown, [1, 5]);
  assert.strictEqual(asked.length, 2);
  assert.ok(frames.settled());
  assert.strictEqual(frames.timings().length, 2);
  store.change_side({ f_number: 7 });
  assert.deepStrictEqual(frames.timings(), []);  // they are of another setting
});

test("while a slow frame is moved it stays coarse, a quick one whole, whatever its drawing once took", async () => {
  const { first_state, make_store } = await module_of("state.js");
  const { make_frames } = await module_of("frames.js");
  const previews_of = async (whole_ms, gives_way) => {
    const store = make_store(first_state());
    const previews = [];
    let cancel;
    const engine = {
      ask: ({ preview }) => {
        previews.push(preview);
        const ms = 3 + whole_ms / preview ** 2;
        return new Promise((done) => {
          setTimeout(() => done({ reply: { draw_ms: 300 / preview, filter_ms: ms } }), ms);
          cancel = () => done({ reply: { cancelled: true } });
        });
      },
      cancel_background() {}, cancel_running() { if (gives_way) cancel(); },
    };
    const frames = make_frames({ engine, store, moving: () => false, paint() {}, on_error() {}, on_settled() {},
                                 on_frame() {} });
    frames.set_open(true);
    for (let time = 1; time <= 30; time++) {
      store.change({ time });
      frames.want();
      await new Promise((done) => setTimeout(done, 10));
    }
    frames.pause(true);
    return previews;
  };
  assert.ok((await previews_of(15)).every((preview) => preview === 1));
  for (const gives_way of [false, true]) {
    const previews = await previews_of(56, gives_way);
    const tried = previews.filter((preview) => preview === 1).length;
    assert.ok(previews.length > 5 && tried <= 2, `${previews}`);  // the first, and once more
  }
});

test("a frame that becomes late after a change gives way to the next", async () => {
  const { first_state, make_store } = await module_of("state.js");
  const { make_frames } = await module_of("frames.js");
  let cancelled = 0;
  const engine = { ask: () => new Promise(() => {}), cancel_background() {},
                   cancel_running() { ++cancelled; } };
  const frames = make_frames({ engine, store: make_store(first_state()), moving: () => false, paint() {},
                               on_error() {}, on_settled() {}, on_frame() {} });
  frames.set_open(true);
  frames.want();
  frames.want();
  assert.strictEqual(cancelled, 0);
  await new Promise((done) => setTimeout(done, 200));
  assert.strictEqual(cancelled, 1);
});

async function main() {
  let failed = 0;
  let running = "";
  // Node ends without a word when nothing is left that a claim could wait for.
  process.on("exit", (code) => {
    if (code === 0 && running) {
      console.log(`FAIL: ${running}: it waits for what never comes`);
      process.exitCode = 1;
    }
  });
  for (const { claim, run } of tests) {
    running = claim;
    try {
      await run();
      console.log(`pass: ${claim}`);
    } catch (error) {
      failed++;
      console.log(`FAIL: ${claim}\n${error.stack}`);
    }
  }
  running = "";
  fs.rmSync(folder, { recursive: true });
  process.exit(failed ? 1 : 0);
}
main();
