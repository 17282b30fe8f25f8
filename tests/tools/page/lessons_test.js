// Every number that docs/teaching.md names in a lesson is the module's or the program's, and the
// page's steps are the text's. Run by node, as
//
//   node lessons_test.js softfocus-NAME.js PROGRAM
//
// Each claim below takes a phrase from a step's text. A number of a step that no phrase has, and
// that its "Set it up" does not set, is a failure.
"use strict";

const assert = require("assert");
const { execFileSync } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");
const { pathToFileURL } = require("url");

const [script, program] = process.argv.slice(2).map((name) => path.resolve(name));
const top = path.join(__dirname, "../../..");
const work = fs.mkdtempSync(path.join(os.tmpdir(), "softfocus-lessons-"));
fs.cpSync(path.join(top, "tools/page/web"), work, { recursive: true });
fs.writeFileSync(path.join(work, "package.json"), '{"type": "module"}');
const module_of = (name) => import(pathToFileURL(path.join(work, name)));
const kLesson = path.join(top, "scenes/pipelines/lesson");

async function start_module() {
  const module = await require(script)({
    wasmBinary: fs.readFileSync(script.replace(/js$/, "wasm")), threads: 2, mainScriptUrlOrBlob: script,
  });
  module.FS.mkdir("/own");
  const ask = (request) => {
    const text = JSON.stringify(request);
    const size = module.lengthBytesUTF8(text) + 1;
    const place = module._malloc(size);
    module.stringToUTF8(text, place, size);
    module._softfocus_request(place);
    module._free(place);
    const reply = JSON.parse(module.UTF8ToString(module._softfocus_reply()));
    assert.strictEqual(reply.error, undefined, JSON.stringify(request));
    return reply;
  };
  ask({ do: "start", threads: script.includes("threads") ? 2 : 1 });
  return ask;
}

/** A request's frame, 512x512, of a scene or a case that is opened first. */
function make_frames(ask) {
  let opened = "";
  return (what, settings = {}) => {
    const name = JSON.stringify(what);
    if (name !== opened) ask({ do: "open", ...what });
    opened = name;
    return ask({ do: "frame", size: [512, 512], method: "two-pass", ...settings });
  };
}

/** The FLIP of the last frame against so many views, or against the known answer. */
function flip(ask, views) {
  let reply = ask({ do: "truth", views: 16 });
  while (reply.samples > 0 && reply.samples < views) reply = ask({ do: "truth", views: 64 });
  return reply.flip_mean;
}

const run = (...words) => execFileSync(program, words, { cwd: work, encoding: "utf8",
                                                         stdio: ["ignore", "pipe", "ignore"] });

function compared(a, b) {
  try {
    return JSON.parse(run("compare", a, b, "--json"));
  } catch (error) {
    return JSON.parse(error.stdout);  // status 1: they differ
  }
}

/** FLIP of a lesson's shader, or of the text that `change` makes of it, against the truth there. */
function flip_of_shader(name, scene, change = (text) => text) {
  const text = fs.readFileSync(path.join(kLesson, `${name}.frag`), "utf8");
  fs.writeFileSync(path.join(work, "mine.frag"), change(text));
  fs.writeFileSync(path.join(work, "mine.toml"), '[[pass]]\nshader = "mine.frag"\n');
  run("render", scene, "--size", "512x512", "--multisample", "1", "--method", "mine.toml", "-o", "mine.npy");
  const truth = `${scene}.npy`;
  if (!fs.existsSync(path.join(work, truth))) {
    run("render", scene, "--size", "512x512", "--multisample", "1", "--method", "accumulation", "--samples", "256",
        "-o", truth);
  }
  return compared("mine.npy", truth).flip;
}

/** The pixels of a picture of numbers, as binary64, of one channel. */
function halves_of(file) {
  const bytes = fs.readFileSync(path.join(work, file));
  const begin = 10 + bytes.readUInt16LE(8);
  return Array.from({ length: (bytes.length - begin) / 8 }, (_, i) => {
    const half = bytes.readUInt16LE(begin + 8 * i);
    const exponent = (half >> 10) & 31;
    const part = half & 1023;
    return exponent === 31 ? Infinity : exponent === 0 ? part * 2 ** -24 : (1024 + part) * 2 ** (exponent - 25);
  });
}

/** What the program stores of these numbers, by a profile. */
function stored_by(profile, numbers) {
  fs.writeFileSync(path.join(work, "numbers.frag"), `#version 300 es
precision highp float;
uniform float numbers[${numbers.length}];
out vec4 colour;
void main() { colour = vec4(numbers[int(gl_FragCoord.x)]); }
`);
  fs.writeFileSync(path.join(work, "numbers.toml"), `[[pass]]\nshader = "numbers.frag"\n` +
                   `uniforms = { numbers = [${numbers.join(", ")}] }\n`);
  run("render", "figures", "--size", `${numbers.length}x1`, "--method", "numbers.toml", "--profile", profile,
      "--multisample", "1", "-o", "numbers.npy");
  return halves_of("numbers.npy");
}

/** What a bilinear fetch gives at a fraction of the way from a texel 0 to a texel 1, times 256. */
function weight_by(profile, fraction) {
  fs.writeFileSync(path.join(work, "first.frag"), `#version 300 es
precision highp float;
out vec4 colour;
void main() { colour = vec4(gl_FragCoord.x > 1.0 ? 1.0 : 0.0); }
`);
  fs.writeFileSync(path.join(work, "second.frag"), `#version 300 es
precision highp float;
uniform sampler2D step_picture;
out vec4 colour;
void main() { colour = vec4(256.0 * texture(step_picture, vec2((0.5 + ${fraction.toFixed(6)}) / 2.0, 0.5)).r); }
`);
  fs.writeFileSync(path.join(work, "weight.toml"), `[[pass]]
shader = "first.frag"
name = "step_picture"
width = 2
height = 1
[[pass]]
shader = "second.frag"
inputs = { step_picture = "step_picture" }
`);
  run("render", "figures", "--size", "2x1", "--method", "weight.toml", "--profile", profile, "--multisample", "1",
      "-o", "weight.npy");
  return halves_of("weight.npy")[0];
}

const kFigures = { scene: "figures" };
const kFence = { scene: "near-fence" };
const kGrouped = (number) => number.toLocaleString("en");

/** The claims by step: phrases that its text must have, with numbers as they are computed here. */
function make_claims({ ask, frame, lens, half, steps: { kSteps, kRound, kNotRound } }) {
  const pixel = (x, y) => ask({ do: "pixel", x, y });
  const thin = { focal_length_mm: 50, f_number: 2, focus_m: 2 };
  const kFov = ask({ do: "open", scene: "figures" }).camera.fov_y_degrees;
  const film_of = (of) => lens.film_height(of, kFov);
  const is_before = (x, other) => pixel(x, 60).depth_m < pixel(other, 60).depth_m;
  const is_darker = (x, other) => pixel(x, 60).colour_linear[0] < pixel(other, 60).colour_linear[0];
  const accumulated = (what, samples) => frame(what, { method: "accumulation", samples });

  return {
    1.1: () => {
      frame(kFigures);
      return [`cone, ${pixel(256, 250).depth_m.toFixed(2)} m away`, `cube, ${pixel(143, 184).depth_m.toFixed(2)} m`];
    },
    1.2: () => {
      frame(kFigures);
      const focus_m = pixel(169, 317).depth_m;
      const found = (of_m) => kSteps["1.2"].found({ state: { show: "coc" }, lens: { lens: { focus_m: of_m } } });
      assert.ok(!found(0.8) && !found(0.88));  // before and behind the ring
      assert.ok(found(focus_m));
      return [`about ${focus_m.toFixed(2)} m`];
    },
    1.3: () => {
      const circle_mm = lens.circle_on_film(thin, 4);
      const { at } = JSON.parse(run("lens", "--focal-length", "50", "--f-number", "2", "--focus", "2", "--fov",
                                    String(kFov), "--height", "512", "--at", "4", "--json"));
      assert.ok(Math.abs(at[0].coc_on_film_mm - circle_mm) < 1e-6, "softfocus lens");
      const wide_px = circle_mm / film_of(thin) * 512;
      return [`A = 50 / 2 = ${lens.aperture_of(thin)} mm`, "25 · 50 · 2000 / (4000 · 1950)",
              `= ${circle_mm.toFixed(3)} mm`, `film that the page takes is ${film_of(thin).toFixed(1)} mm high`,
              `a picture of 512 pixels the circle is ${wide_px.toFixed(1)} pixels`,
              `radius, ${(wide_px / 2).toFixed(2)} pixels`];
    },
    1.4: () => {
      const at_infinity = lens.circle_on_film(thin, 1e9);
      assert.ok(Math.abs(lens.circle_on_film(thin, 1) - at_infinity) < 1e-6);
      return [`${at_infinity.toFixed(3)} mm here`, "At 1 m, half", "z_f| / z is 1 at z = z_f / 2"];
    },
    1.5: () => {
      const [wide, narrow] = [2, 4].map((f_number) => lens.circle_on_film({ ...thin, f_number }, 1));
      assert.ok(Math.abs(narrow - wide / 2) < 1e-9);
      return ["f/4. A = f / N", "f/2, f/2.8, f/4", `object stands at 1 m`];
    },
    1.6: () => {
      const longer = { ...thin, focal_length_mm: 100, f_number: 4 };
      const radius = (of) => lens.radius_px(of, 1, kFov, 512, 1);
      assert.ok(Math.abs(radius(longer) - radius(thin)) < 1e-9);
      const times = (of) => (of(longer) / of(thin)).toFixed(2);
      return ["to 100 mm", `f/4: a hole of ${lens.aperture_of(longer)} mm again`,
              `it is ${times((of) => lens.circle_on_film(of, 1))} times as wide`, `film is ${times(film_of)} times`];
    },
    1.7: () => {
      // The film that sees the field of view moves with the focus; so H is where both are equal.
      const of = (focus_m) => ({ focal_length_mm: 35, f_number: 8, focus_m });
      let focus_m = 4;
      for (let i = 0; i < 50; ++i) focus_m = lens.hyperfocal_distance_m(of(focus_m), film_of(of(focus_m)) / 512);
      const { near_m } = lens.sharp_limits_m(of(focus_m), film_of(of(focus_m)) / 512);
      return [`H = ${focus_m.toFixed(2)} m here`, `H/2 = ${near_m.toFixed(2)} m`];
    },
    1.8: () => {
      const full = { ...thin, focus_m: 1 };
      const fov = lens.field_of_view_degrees(full, 24);
      let focal_length_mm = 15;
      for (let i = 0; i < 50; ++i) {
        focal_length_mm *= lens.field_of_view_degrees({ ...full, focal_length_mm }, 7.3) / fov;
      }
      const hole_mm = focal_length_mm / 2;
      return ["50 mm and f/2", `field of view is ${fov.toFixed(1)}°`, "the stop at f/2", "both say f/2",
              `About ${focal_length_mm.toFixed(1)} mm`,
              `hole is ${hole_mm.toFixed(1)} mm wide in place of ${lens.aperture_of(full)} mm`,
              `${(lens.aperture_of(full) / hole_mm).toFixed(1)} times`];
    },

    2.1: () => [`The lens is ${frame(kFigures).aperture_mm} mm wide`],
    2.2: () => {
      const what = { scene: "sphere-world" };
      assert.match(fs.readFileSync(path.join(top, "scenes/sphere-world.toml"), "utf8"), /^count = 250$/m);
      const { largest_coc_px } = frame(what, { max_coc_px: 2 });
      const enough = Math.ceil(largest_coc_px);
      assert.ok(frame(what, { max_coc_px: enough }).cut_share === 0);
      assert.ok(frame(what, { max_coc_px: enough - 1 }).cut_share > 0);
      return ["250 balls, and a filter of 2 pixels", `${largest_coc_px.toFixed(1)} pixels, so ${enough}`,
              "π R²", "2 (2 R − 1)",
              `For R = ${enough} that is ${kGrouped(Math.round(Math.PI * enough ** 2))} and ${2 * (2 * enough - 1)}`];
    },
    2.3: () => {
      const { methods } = ask({ do: "scenes" });
      assert.deepStrictEqual([...kRound, ...kNotRound].sort(), methods.map(({ name }) => name).sort());
      return [];
    },
    2.4: () => {
      const of = (method) => (frame({ case: "leak-far", value: 16 }, { method }), flip(ask));
      of("two-pass");
      assert.ok(is_before(5, 400) && pixel(5, 60).coc_radius_px === 0 && is_darker(5, 400));
      assert.ok(of("scatter") > 0.01 && of("scatter-sorted") < 0.005 && of("two-pass") < 0.005 && of("pinhole") === 0);
      return ["FLIP below 0.005", "0 is equal"];
    },
    2.5: () => {
      const of = (method) => (frame({ case: "near-edge", value: 16 }, { method }), flip(ask));
      of("two-pass");
      assert.ok(is_before(5, 400) && pixel(400, 60).coc_radius_px === 0 && is_darker(400, 5));
      for (const method of ["disc-layers", "layers", "mipmap", "object-identification", "ray-distribution-buffer"]) {
        assert.ok(of(method) < 0.005, method);
      }
      assert.ok(of("two-pass") > 0.02);
      return ["FLIP below 0.005"];
    },
    2.6: () => {
      const of = (method) => (frame({ case: "near-bars", value: 16 }, { method, samples: 64 }), flip(ask, 256));
      const { methods } = ask({ do: "scenes" });
      const of_one = methods.filter(({ name, kind }) => kind === "filter" && name !== "layered");
      const best = Math.min(...of_one.map(({ name }) => of(name)));
      assert.ok(best > 0.26, String(best));
      assert.ok(of("accumulation") < 0.1 && of("layered") < 0.1);
      return ["FLIP below 0.1", "none comes below 0.26"];
    },

    3.1: () => {
      accumulated(kFence, 64);
      return ["Here are 4 points", `From about 64 on, with a FLIP of ${flip(ask, 512).toFixed(3)}`];
    },
    3.2: () => {
      frame(kFigures);
      let reply = ask({ do: "truth", views: 8 });
      while (!reply.done) reply = ask({ do: "truth", views: 8 });
      return [`After ${reply.samples} views`, `differ by ${reply.half_set_rms.toFixed(5)} of white`];
    },
    3.3: () => {
      const [few, many] = [64, 256].map((samples) => JSON.parse(run(
          "render", "figures", "--size", "512x512", "--multisample", "1", "--method", "accumulation", "--samples",
          String(samples), "--until", "1e-9", "-o", "few.npy", "--json")).sampling.half_set_rms);
      return [`with 64 views the halves differ by ${few.toFixed(5)}`, `with 256 by ${many.toFixed(5)}`,
              `a factor of 2.`, `${(few / many).toFixed(1)}. With random`];
    },
    3.4: () => {
      const of = (samples) => (accumulated(kFigures, samples), flip(ask, 256));
      const filter = (method) => (frame(kFigures, { method }), flip(ask, 256));
      const [best, two_pass, three, six, seven] = [filter("disc-layers"), filter("two-pass"), of(3), of(6), of(7)];
      assert.ok(six > best && seven < best && three < two_pass);
      const { methods } = ask({ do: "scenes" });
      for (const { name, kind } of methods) {
        if (kind === "filter") assert.ok(filter(name) > 0.8 * best, name);
      }
      return [`FLIP of ${best.toFixed(3)}`, `\`two-pass\` has ${two_pass.toFixed(3)}`, "Even 3 points",
              `7 points have ${seven.toFixed(3)}, and 6 have ${six.toFixed(3)}`, "worth 6 sharp"];
    },
    3.5: () => {
      const of = (samples) => (accumulated(kFence, samples), flip(ask, 512));
      const filter = (method) => (frame(kFence, { method }), flip(ask, 512));
      const [one, two, six, seven] = [1, 2, 6, 7].map(of);
      const [two_pass, best] = [filter("two-pass"), filter("disc-layers")];
      assert.ok(one > two_pass && two < two_pass && six > best && seven < best);
      return [`\`two-pass\` has ${two_pass.toFixed(3)} here`, `2, with ${two.toFixed(3)}`,
              `\`disc-layers\` has ${best.toFixed(3)} here, and needs 7 points`];
    },

    4.1: () => {
      const { hash } = frame(kFigures);
      assert.strictEqual(JSON.parse(run("render", "figures", "--size", "512x512", "--method", "two-pass",
                                        "--multisample", "1", "--json", "-o", "hash.npy")).picture_hash, hash);
      return [`It is ${hash}`, `${kGrouped(4 * 512 * 512)} numbers`];
    },
    4.2: () => {
      const [before, after] = [1, 1.0001].map((m) => frame(kFigures, { focus: { m } }).hash);
      assert.notStrictEqual(before, after);
      for (const m of ["1", "1.0001"]) {
        run("render", "figures", "--size", "512x512", "--multisample", "1", "--method", "two-pass", "--focus", m, "-o",
            `focus-${m}.npy`);
      }
      const { values, differing, histogram } = compared("focus-1.npy", "focus-1.0001.npy");
      const last_bit = histogram.find(({ half_ulps }) => half_ulps === "1").values;
      return ["from 1 m to 1.0001 m", `${kGrouped(differing)} of the ${kGrouped(values)} numbers`,
              `${kGrouped(last_bit)} of them by the last bit`];
    },
    4.3: () => {
      const numbers = [0.1, ...Array.from({ length: 60 }, (_, i) => 2000 + i), 4098, 65504, 65519, 65520, 70000];
      const stored = stored_by("ieee", numbers);
      assert.deepStrictEqual(numbers.map(half.nearest_half), stored);
      const missing = numbers.find((number, i) => number !== stored[i] && Number.isInteger(number));
      assert.strictEqual(stored_by("ieee", Array.from({ length: 256 }, (_, i) => 8 * i)).every(
          (number, i) => number === 8 * i), true);
      return ["with 16 bits: 1 for the sign, 5 for the power of two, 10 for the rest",
              `0.1\nbecomes ${stored[0]}`, "above 0 that", `${missing}. From ${missing - 1} on`,
              `a step of ${half.half_step(missing)}`, "largest is 65504; 65520 and more", "70,000"];
    },
    4.4: () => {
      const numbers = [2049, 2050, 2051, 2052, 0.1, 1 / 3, 70000, 3 * 2 ** -25, 2 ** -25, 1e-5];
      const [nearest, cut] = ["ieee", "llvmpipe"].map((profile) => stored_by(profile, numbers));
      const stored = (by) => numbers.map((number) => by(Math.fround(number)));
      assert.deepStrictEqual([stored(half.nearest_half), stored(half.cut_half)], [nearest, cut]);
      return ["2049 is in the middle between two halves, 2048 and 2050. The standard IEEE 754",
              "goes towards 0", `last bit is 0: ${nearest[0]}`, "number above 2048",
              `2051, in the middle between 2050 and 2052. Rounded it becomes ${nearest[2]}`, "last bit is 0. Cut",
              `it becomes ${cut[2]}`];
    },
    4.5: () => {
      const wanted = 256 * half.weight_of_bits(0.3, 8);
      assert.strictEqual(weight_by("d3d11", 0.3), wanted);
      assert.ok(Math.abs(weight_by("ieee", 0.3) - 76.8) < 0.05);
      return ["0.3 of one, 0.7 of the other", "in 8 bits", "Type 0.3", "How many 256ths", "not 0.3 of",
              `0.3 · 256 = 76.8, so ${wanted}, and ${wanted} / 256 = ${wanted / 256}`, "only 256 steps"];
    },
    4.6: () => [],

    5.1: () => [`FLIP is ${flip_of_shader("gather", "figures").toFixed(3)}`],
    5.2: () => {
      const weights = flip_of_shader("weights", "figures");
      assert.ok(weights < 0.01 && flip_of_shader("gather", "figures") > 0.01);
      return ["share 1 / r²", "with 1 if r is below 1", "below 0.010", `has ${weights.toFixed(3)}`];
    },
    5.3: () => {
      // A smaller filter, which is quicker, cuts no circle of the fence.
      const { max_coc_px } = /max=(?<max_coc_px>\d+)/.exec(kSteps["5.3"].state).groups;
      assert.ok(frame(kFence).largest_coc_px < Number(max_coc_px));
      return [`${flip_of_shader("weights", "near-fence").toFixed(3)} for the second example, ` +
                `${flip_of_shader("gather", "near-fence").toFixed(3)} for the first`];
    },
    5.4: ({ text }) => {
      const line = /^ {4}(if \(texel.*)$/m.exec(text)[1];
      const change = (shader) => shader.replace(/if \(texel\.a > depth_m\).*/, line);
      const [figures, fence] = ["figures", "near-fence"].map((scene) => flip_of_shader("weights", scene, change));
      assert.ok(figures < 0.01 && fence < 0.105);
      const best = [kFigures, kFence].map((what) => (frame(what, { method: "disc-layers" }), flip(ask, 256)));
      return ["below 0.010 on *Figures* and below 0.105 on *Near fence*",
              `${figures.toFixed(3)} and ${fence.toFixed(3)}. \`disc-layers\` has ${best[0].toFixed(3)} and ` +
              `${best[1].toFixed(3)}`];
    },
    5.5: () => ["It may be 0"],
  };
}

const kNumbers = /(?<![A-Za-z])[0-9][0-9,]*(?:\.[0-9]+)?(?:x[0-9a-f]+)?/g;

/** The numbers of a step's text that neither its phrases nor its state have. */
function numbers_left(text, phrases, state) {
  let left = text;
  for (const phrase of phrases) {
    const words = phrase.split(/\s+/).map((word) => word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
    const pattern = new RegExp(words.join("\\s+"));
    assert.match(left, pattern);
    left = left.replace(pattern, " ");
  }
  const set = [...(state ?? "").matchAll(/=([0-9.]+)(?:&|$)/g)].map(([, number]) => number);
  return [...left.replace(/`[^`]*`/g, " ").matchAll(kNumbers)].map(([number]) => number)
      .filter((number) => !set.includes(number));
}

async function main() {
  const ask = await start_module();
  const lens = await module_of("lens/lens.js");
  const half = await module_of("lessons/half.js");
  const steps_of_page = await module_of("lessons/steps.js");
  const { kSteps } = steps_of_page;
  const { read_lessons } = await module_of("lessons/text.js");
  const chapters = read_lessons(fs.readFileSync(path.join(top, "docs/teaching.md"), "utf8"));
  const steps = chapters.flatMap((chapter) => chapter.steps);
  const claims = make_claims({ ask, frame: make_frames(ask), lens, half, steps: steps_of_page });
  const tests = [["the steps of the page and of the text are the same", () => {
    const keys = steps.map(({ key }) => key);
    assert.deepStrictEqual(Object.keys(kSteps).sort(), [...keys].sort());
    assert.deepStrictEqual(Object.keys(claims).sort(), [...keys].sort());
    for (const { key, lines } of steps) {
      const text = lines.join("\n");
      assert.match(text, /^\*\*See\.\*\* /m, key);
      assert.match(text, /^<details><summary>Answer<\/summary>$/m, key);
    }
  }]];
  for (const { key, title, lines } of steps) {
    tests.push([`the numbers of ${key} ${title}`, () => {
      const text = lines.join("\n");
      assert.deepStrictEqual(numbers_left(text, claims[key]({ text }), kSteps[key].state), []);
    }]);
  }
  tests.push(["the teacher's disc of diffraction", () => {
    const questions = chapters.find(({ title }) => title === "Questions for the class").lines.join("\n");
    assert.match(questions, new RegExp(`2\\.44 · 0\\.55 µm · 22 = ${(2.44 * 0.55 * 22).toFixed(1)} µm`));
  }]);
  tests.push(["numbers with a point and with a comma are read alike", () => {
    const read = ["0.32", " 0,32 ", "-1", "", "x"].map((value) => half.number_in({ value }));
    assert.deepStrictEqual(read, [0.32, 0.32, -1, NaN, NaN]);
  }]);
  for (const [claim, test] of tests) {
    if (process.env.ONLY && !claim.includes(process.env.ONLY)) continue;
    try {
      test();
      console.log(`pass: lessons: ${claim}`);
    } catch (error) {
      console.log(`FAIL: lessons: ${claim}\n${error.stack}`);
      process.exitCode = 1;
    }
  }
}

main().catch((error) => {
  console.error(error);
  process.exitCode = 1;
}).finally(() => {
  fs.rmSync(work, { recursive: true });
  process.exit();  // threads would keep node alive
});
