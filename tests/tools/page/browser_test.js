// The simulator's page in a browser, end to end. The pictures' hashes are held against the program.
//
//   node browser_test.js FOLDER PROGRAM [SINGLE_FILE]
//
// FOLDER is what tools/simulator builds, PROGRAM build/softfocus, SINGLE_FILE the page in one file.
// Needs playwright-core (NODE_PATH) and Chromium (CHROMIUM, else `chromium`).
"use strict";

const assert = require("assert");
const { execFileSync, spawn } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");
const { pathToFileURL } = require("url");
const { chromium } = require("playwright-core");
const { triangle_glb, triangle_gltf } = require("./triangle_gltf.js");

const [folder, program, single_file] = process.argv.slice(2).map((name) => path.resolve(name));
const work = fs.mkdtempSync(path.join(os.tmpdir(), "softfocus-browser-"));
const kFrameMs = 60000;
const kMostBytesOfOneFile = 3e6;

const tests = [];
/**
 * `options` are of the browser's context; `at`: the link that is opened. A page has loaded and drawn
 * its first frame. What `run` returns says why it has not tested.
 */
const test = (claim, run, options = {}) => tests.push({ claim, run, options });

const text_of = (page, id) => page.locator(`#${id}`).textContent();

/** Waits for the frame that belongs to the settings of now. Its hash. */
async function drawn(page) {
  const hash = await page.waitForFunction(() => {
    const is_busy = document.getElementById("picture").getAttribute("aria-busy") !== "false";
    const text = document.getElementById("hash-full").textContent;
    return !is_busy && text.startsWith("0x") && text;
  }, null, { timeout: kFrameMs });
  return hash.jsonValue();
}

/** Waits until the page says in one line what went wrong. The line. */
async function error_line(page) {
  await page.waitForSelector("#error:not([hidden])", { timeout: kFrameMs });
  return text_of(page, "error-text");
}

/** The hash by the command that the page names for its frame. */
async function hash_by_program(page) {
  const words = (await text_of(page, "command")).split(" ");
  assert.strictEqual(words.shift(), "softfocus", "the page names no command");
  words[words.indexOf("-o") + 1] = path.join(work, "picture.png");
  const said = execFileSync(program, words, { cwd: work, encoding: "utf8",
                                              stdio: ["ignore", "pipe", "ignore"] });
  return JSON.parse(said).picture_hash;
}

async function equals_program(page) {
  assert.strictEqual(await drawn(page), await hash_by_program(page));
}

async function set_number(page, part, value) {
  const field = page.locator(`#${part} input[type=text], #${part} input[type=number]`).first();
  await field.fill(String(value));
  await field.press("Enter");
}

/** Presses a key on the picture; the frame after it. */
async function press(page, key) {
  await page.locator("#picture").press(key);
  return drawn(page);
}

test("the first frame has the program's bits, and the title its speed", async (page) => {
  await equals_program(page);
  assert.match(await page.title(), /fps.*ms/);
});

test("every control changes the picture to the program's for the same settings", async (page) => {
  const seen = new Set([await drawn(page)]);
  const changed = async (what) => {
    const hash = await drawn(page);
    assert.ok(!seen.has(hash), `${what} changed nothing`);
    seen.add(hash);
    assert.strictEqual(hash, await hash_by_program(page), what);
  };
  await set_number(page, "focal-length-part", 60);
  await changed("focal length");
  await set_number(page, "f-number-part", 1.4);
  await changed("f-number");
  await set_number(page, "focus-part", 1.2);
  await changed("focus distance");
  await set_number(page, "max-coc-part", 3);
  await changed("filter size");
  await set_number(page, "coc-scale-part", 2);
  await changed("scale of the circles");
  await page.locator("#method").selectOption("two-pass");
  await changed("method");
  await page.locator("#coc-map").check({ force: true });
  await changed("map of the circles");
  await page.locator("input[name=show][value=image]").check({ force: true });
  await page.locator("#dof").uncheck();
  await changed("depth of field off");
  await page.locator("#dof").check();
  await page.locator("input[name=size][value='1024x512']").check({ force: true });
  await changed("resolution 1024x512");
  await page.locator("input[name=size][value='1024x1024']").check({ force: true });
  await changed("resolution 1024x1024");
});

test("blades, a stretched aperture, the backdrop's distance are the program's; the subject's moves the camera", async (page) => {
  const seen = new Set([await drawn(page)]);
  const changed = async (part, value) => {
    await set_number(page, part, value);
    await equals_program(page);
    assert.ok(!seen.has(await drawn(page)), `${part} changed nothing`);
    seen.add(await drawn(page));
  };
  await changed("backdrop-part", 12);
  assert.ok(await page.locator("#aperture-why").isVisible());
  assert.ok(!await page.locator("#blades-part").isVisible());
  await page.locator("#method").selectOption("scatter-aperture");
  await changed("blades-part", 5);
  await changed("turn-part", 20);
  await changed("anamorphic-part", 2);
  await page.locator("#blades").fill("2");
  assert.match(await text_of(page, "blades-range"), /0 or 3 to 64/);
  await page.locator("#method").selectOption("accumulation");
  await changed("blades-part", 6);
  assert.ok(!await page.locator("#anamorphic-part").isVisible());
  await page.locator("#method").selectOption("disc-layers");
  await page.locator("#compare").check();
  await set_number(page, "focus-part", 1.6);
  await set_number(page, "subject-distance-part", 3);
  await page.waitForFunction(() => /&focus=2\.8&b\..*&b\.focus=3&/.test(location.hash));
  await page.locator("#compare").uncheck();
  await drawn(page);
  assert.strictEqual(await number_in(page, "focus"), 2.8);
  await page.waitForFunction(() => /camera=[^&]*&.*backdrop=12/.test(location.hash));
  const [x, , z] = /camera=([^&]*)/.exec(new URL(page.url()).hash)[1].split(",").map(Number);
  near(z, 1.5 + 1.4, 2e-3);  // 1.4 m farther
  assert.strictEqual(x, 0);
}, { at: "#scene=portrait" });

test("the light moves by hand; shadows, textures, effects and wires are the program's", async (page) => {
  const plain = await drawn(page);
  await press(page, "j");
  await equals_program(page);
  assert.match(await text_of(page, "shadow-counts"), /casters/);
  await page.selectOption("#shadows", "volumes");
  const still = await drawn(page);
  assert.notStrictEqual(still, plain);
  await page.locator("#light-drag").check();
  const box = await page.locator("#picture").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 - 30, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(() => !document.getElementById("light-home").disabled);
  const moved = await drawn(page);
  assert.notStrictEqual(moved, still);
  await equals_program(page);
  await press(page, "/");
  await equals_program(page);
  await press(page, "/");
  await page.selectOption("#effect", "sharpen");
  await equals_program(page);
  await page.selectOption("#effect", "");
  await press(page, "ArrowRight");
  assert.notStrictEqual(await drawn(page), moved);
  await page.locator("#light-home").click();
  assert.strictEqual(await drawn(page), still);
  await page.locator("#reset").click();
  assert.strictEqual(await drawn(page), plain);
});

test("a click sets the focus, and reset takes all back", async (page) => {
  const first = await drawn(page);
  const box = await page.locator("#picture").boundingBox();
  await page.mouse.click(box.x + 0.3 * box.width, box.y + 0.75 * box.height);
  await equals_program(page);
  assert.match(await text_of(page, "command"), /--autofocus/);
  assert.notStrictEqual(await drawn(page), first);
  await page.locator("#reset").click();
  assert.strictEqual(await drawn(page), first);
});

test("a link carries the whole state", async (page, { context, address }) => {
  await page.locator("#scene").selectOption("cube-room");
  await drawn(page);
  await set_number(page, "f-number-part", 2.8);
  await press(page, "ArrowLeft");  // a camera of its own
  const hash = await drawn(page);
  await page.waitForFunction(() => /N=2\.8.*camera=/.test(location.hash), null, { timeout: 5000 });
  const link = await page.evaluate(() => location.hash);
  const other = await context.newPage();
  await other.goto(address + link);
  assert.strictEqual(await drawn(other), hash);
  await other.close();
});

test("the keyboard alone reaches the ten controls", async (page) => {
  const first = await drawn(page);
  for (const key of ["l", "n", "f", "x", "k", "b", "m", "r"]) {
    const before = await page.evaluate(() => location.hash);
    await press(page, key);
    await page.waitForFunction((old) => location.hash !== old, before, { timeout: 5000 });
  }
  assert.strictEqual(await press(page, "0"), first);
  const [download] = await Promise.all([page.waitForEvent("download"),
                                        page.locator("#picture").press("p")]);
  const report = fs.readFileSync(await download.path(), "utf8");
  assert.match(report, /ms/);
  await page.locator("#picture").press("q");
  assert.strictEqual(await page.locator("#quit").getAttribute("aria-pressed"), "true");
  await page.locator("#picture").press("q");
  assert.strictEqual(await page.locator("#quit").getAttribute("aria-pressed"), "false");
});

test("the animation plays, steps and pauses", async (page) => {
  await page.locator("#scene").selectOption("cube-room");
  const first = await drawn(page);
  await page.locator("#step").click();
  await equals_program(page);
  assert.notStrictEqual(await drawn(page), first);
  await page.locator("#play").click();
  await page.waitForFunction(() => Number(document.getElementById("time").value) > 2, null,
                             { timeout: kFrameMs });
  await page.locator("#play").click();
  await equals_program(page);
});

test("a model that is dropped is drawn; a broken one is a line, and nothing is lost", async (page) => {
  const first = await drawn(page);
  const file = (name, bytes) => ({ name, mimeType: "text/plain", buffer: Buffer.from(bytes) });
  await page.locator("#files").setInputFiles([file("broken.obj", "v x\n")]);
  assert.match(await error_line(page), /broken\.obj/);
  assert.strictEqual(await drawn(page), first);
  const triangle = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
  await page.locator("#files").setInputFiles([file("fine.obj", triangle)]);
  await page.waitForFunction(() => document.getElementById("scene").value === "/own/fine.obj");
  assert.notStrictEqual(await drawn(page), first);
});

/** Drops files of the work folder on the page. */
function drop(page, names) {
  const files = names.map((name) => [name, fs.readFileSync(path.join(work, name)).toString("base64")]);
  return page.evaluate((given) => {
    const transfer = new DataTransfer();
    for (const [name, text] of given) {
      transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    }
    document.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, cancelable: true }));
  }, files);
}

test("glTF that is dropped is drawn, in one file and in three", async (page) => {
  const seen = new Set([await drawn(page)]);
  execFileSync(program, ["render", "figures", "--size", "16x16", "-o", "base.png"], { cwd: work, stdio: "ignore" });
  const png = fs.readFileSync(path.join(work, "base.png"));
  const three = triangle_gltf(png);
  for (const files of [{ "triangle.glb": triangle_glb(png) }, three]) {
    const names = Object.keys(files);
    for (const name of names) fs.writeFileSync(path.join(work, name), files[name]);
    await drop(page, names);
    await page.waitForFunction((name) => document.getElementById("scene").value === `/own/${name}`, names[0],
                               { timeout: kFrameMs });
    seen.add(await drawn(page));
  }
  assert.strictEqual(seen.size, 2);  // both have the same bits
});

test("a picture and its depth are refocused with the program's bits, and scenes come back", async (page) => {
  const first = await drawn(page);
  const run = (...words) => execFileSync(program, words, { cwd: work, stdio: "ignore" });
  run("render", "figures", "--size", "240x160", "--show", "pinhole", "-o", "photo.png",
      "--depth-output", "photo_depth.png");
  run("render", "figures", "--size", "240x160", "--show", "depth", "-o", "grey.png");
  await drop(page, ["photo_depth.png", "photo.png"]);
  await page.waitForSelector("#depth-part:not([hidden])");
  await equals_program(page);
  assert.match(await text_of(page, "command"), /^softfocus refocus photo\.png photo_depth\.png /);
  assert.match(await page.locator("#encoding option").first().textContent(), /millimetres/);
  assert.ok(await page.locator("#no-scene").isVisible());
  const seen = new Set([await drawn(page)]);
  const changed = async (what) => {
    await equals_program(page);
    assert.ok(!seen.has(await drawn(page)), `${what} changed nothing`);
    seen.add(await drawn(page));
  };
  await set_number(page, "coc-scale-part", 6);
  await changed("scale");
  const box = await page.locator("#picture").boundingBox();
  await page.mouse.click(box.x + 0.2 * box.width, box.y + 0.9 * box.height);
  await changed("a click");
  await set_number(page, "f-number-part", 1.2);
  await changed("f-number");
  await page.locator("#method").selectOption("scatter-aperture");
  await set_number(page, "blades-part", 6);
  await changed("blades");
  await set_number(page, "threshold-part", 0.3);
  await set_number(page, "gain-part", 6);
  await changed("highlights");
  await page.locator("#method").selectOption("two-pass");
  await changed("method");
  const [download] = await Promise.all([page.waitForEvent("download"),
                                        page.locator("#save-picture").click()]);
  const file = path.join(work, "saved.png");
  await download.saveAs(file);
  assert.strictEqual(download.suggestedFilename(), "photo-refocused.png");
  execFileSync(program, ["compare", file, path.join(work, "picture.png")], { stdio: "ignore" });
  await press(page, "ArrowLeft");  // no camera
  assert.ok(seen.has(await drawn(page)));

  // 8 bits do not tell what they are.
  await page.locator("#files").setInputFiles(["photo.png", "grey.png"].map((name) => path.join(work, name)));
  assert.match(await error_line(page), /choose/);
  await page.locator("#encoding").selectOption("device");
  await page.locator("#encoding-near").fill("0.5");
  await page.locator("#encoding-near").press("Tab");
  await page.locator("#encoding-far").fill("4");
  await page.locator("#encoding-far").press("Tab");
  await page.waitForFunction(() => document.getElementById("error").hidden, null, { timeout: kFrameMs });
  await equals_program(page);
  if (process.env.SHOT) await page.screenshot({ path: process.env.SHOT });

  await page.locator("#scene").selectOption("figures");
  await page.waitForSelector("#depth-part", { state: "hidden" });
  await page.locator("#method").selectOption("disc-layers");
  assert.strictEqual(await drawn(page), first);
  await equals_program(page);
});

/** A map of numbers. */
function write_pfm(name, width, height, value) {
  const numbers = Float32Array.from({ length: width * height }, (_, i) => (
      value(i % width, height - 1 - Math.floor(i / width))));
  fs.writeFileSync(path.join(work, name), Buffer.concat(
      [Buffer.from(`Pf\n${width} ${height}\n-1.0\n`), Buffer.from(numbers.buffer)]));
}

test("holes, the depth's fit and circles change a picture as the program's options do", async (page) => {
  execFileSync(program, ["render", "figures", "--size", "240x160", "--show", "pinhole", "-o", "colour.png"],
               { cwd: work, stdio: "ignore" });
  const is_hole = (x, y) => x > 80 && x < 120 && y > 60 && y < 100;
  write_pfm("holes_depth.pfm", 240, 160, (x, y) => (is_hole(x, y) ? NaN : x < 100 ? 0.7 : 2));
  write_pfm("wide_depth.pfm", 320, 160, (x) => 0.5 + 0.01 * x);
  write_pfm("circles_depth.pfm", 240, 160, (x) => x / 40 - 3);
  const open = (depth) => page.locator("#files").setInputFiles(
      ["colour.png", depth].map((name) => path.join(work, name)));
  const command_has = (words) => page.waitForFunction((wanted) => (
      document.getElementById("command").textContent.includes(wanted)), words, { timeout: kFrameMs });
  const choose = async (select, value, words) => {
    await page.locator(`#${select}`).selectOption(value);
    await command_has(words);
    await equals_program(page);
    return drawn(page);
  };
  await open("holes_depth.pfm");
  await command_has("holes_depth.pfm");
  await set_number(page, "coc-scale-part", 6);
  await equals_program(page);
  const seen = new Set();
  for (const side of ["near", "far", "infinity"]) {
    seen.add(await choose("reading-holes", side, `--holes ${side}`));
  }
  assert.strictEqual(seen.size, 3);
  await page.locator("#reading-holes").selectOption("refuse");
  assert.match(await error_line(page), /^holes refuse: /);
  assert.strictEqual(await page.locator("#reading-holes").inputValue(), "infinity");

  await open("wide_depth.pfm");
  assert.match(await error_line(page), /another shape/);
  const stretched = await choose("reading-depth-fit", "stretch", "--depth-fit stretch");
  assert.notStrictEqual(await choose("reading-depth-fit", "crop", "--depth-fit crop"), stretched);

  await open("circles_depth.pfm");
  await page.waitForFunction(() => /-3/.test(document.getElementById("depth-seen").textContent));
  await choose("encoding", "circles", "--circles circles_depth.pfm");
  assert.ok(await page.locator("#focus-part").evaluate((part) => Boolean(part.closest("[inert]"))));
});

/** What the page says of the last opening. */
const opened = (page, words) => page.waitForFunction((wanted) => (
    document.getElementById("notice").textContent.includes(wanted)), words, { timeout: kFrameMs });

const text_file = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
/** A square in front of the camera, with a material of a file if one is named. */
const square = (library) => `${library ? `mtllib ${library}\nusemtl red\n` : ""}v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n` +
    "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n";
const kRed = "newmtl red\nKd 1 0 0\n";

/** The mean colour of the picture's middle. */
const middle = (page) => page.evaluate(() => {
  const canvas = document.getElementById("canvas-a");
  return [...canvas.getContext("2d").getImageData(canvas.width / 2, canvas.height / 2, 1, 1).data].slice(0, 3);
});

test("colours are there in browsers that lack light-dark(), color-mix() and :has()", async (page, { context, address }) => {
  await drawn(page);
  await context.route("**/style.css", async (route) => {
    const response = await route.fetch();
    const body = (await response.text()).replace(/light-dark\(|color-mix\(|:has\(/g, "unknown-$&");
    await route.fulfill({ response, body });
  });
  const old = await context.newPage();
  await old.goto(address);
  await drawn(old);
  /** All colours of the sheet by their names, as they are used. */
  const colours = (of) => of.evaluate(() => {
    const names = [...document.styleSheets[0].cssRules].flatMap(({ selectorText, style }) => (
        selectorText === ":root" ? [...style].filter((name) => /^--(?!light|dark)/.test(name)) : []));
    const probe = document.body.appendChild(document.createElement("div"));
    const used = Object.fromEntries(names.map((name) => {
      probe.style.backgroundColor = `var(${name})`;
      return [name, getComputedStyle(probe).backgroundColor];
    }));
    probe.remove();
    return used;
  });
  const seen = new Set();
  for (const colorScheme of ["light", "dark"]) {
    for (const one of [page, old]) await one.emulateMedia({ colorScheme });
    const used = await colours(old);
    assert.deepStrictEqual(used, await colours(page), colorScheme);
    assert.ok(Object.keys(used).length > 10);
    assert.ok(!Object.values(used).includes("rgba(0, 0, 0, 0)"));
    seen.add(await old.evaluate(() => getComputedStyle(document.body).backgroundColor));
  }
  for (const theme of ["light", "dark"]) {  // against the system's
    await old.emulateMedia({ colorScheme: theme === "light" ? "dark" : "light" });
    await old.evaluate((name) => { document.documentElement.dataset.theme = name; }, theme);
    seen.add(await old.evaluate(() => getComputedStyle(document.body).backgroundColor));
  }
  assert.deepStrictEqual([...seen], ["rgb(243, 243, 242)", "rgb(23, 24, 26)"]);
  await old.close();
});

test("the header's milliseconds are the report's, of whole frames of one setting", async (page) => {
  await page.locator("#method").selectOption("scatter-aperture");
  await drawn(page);
  const speed_after = await page.evaluate(async () => {
    const slider = document.getElementById("max-coc-slider");
    for (let place = 0; place <= 1000; place += 100) {
      slider.value = place;
      slider.dispatchEvent(new Event("input"));
      await new Promise((done) => setTimeout(done, 30));
    }
    return document.getElementById("speed").textContent;
  });
  assert.match(speed_after, /^– fps · – ms$/);
  await drawn(page);
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#report").click()]);
  const report = fs.readFileSync(await download.path(), "utf8");
  const [, median] = /Until it is shown +([\d.]+)/.exec(report);
  assert.ok((await text_of(page, "speed")).endsWith(` fps · ${median} ms`), `${await text_of(page, "speed")}, ${median}`);
  assert.ok((await page.title()).includes(` · ${median} ms`));
});

/** Begins a frame that takes minutes, and waits until it is under way. */
async function begin_slow_frame(page) {
  await page.locator("#reset").click();
  await page.locator("#method").selectOption("accumulation");
  await drawn(page);
  await page.locator("input[name=size][value='1024x1024']").check({ force: true });
  await set_number(page, "samples-part", 4096);
  await page.waitForSelector("#busy:not([hidden])", { timeout: kFrameMs });
  await page.waitForTimeout(1500);
}

async function slow_frame_gives_way(page) {
  const seconds_until = async (act, wait) => {
    await begin_slow_frame(page);
    const began = performance.now();
    await act();
    await wait();
    const seconds = (performance.now() - began) / 1000;
    assert.ok(seconds < 20, `${seconds} s`);
    return seconds;
  };
  const scene = await seconds_until(() => page.locator("#scene").selectOption("lattice"),
                                    () => opened(page, "is open"));
  if (process.env.FIGURES) console.log(`  another scene opens after ${scene.toFixed(2)} s`);
  await page.locator("#reset").click();
  const plain = await drawn(page);
  await seconds_until(() => page.locator("#dof").uncheck(), () => page.waitForFunction(() => (
      document.getElementById("picture").getAttribute("aria-busy") === "false"), null, { timeout: kFrameMs }));
  await seconds_until(() => page.locator("#picture").press("q"), () => page.waitForFunction(() => (
      document.getElementById("busy").hidden), null, { timeout: kFrameMs }));
  await page.locator("#picture").press("q");
  await page.locator("#reset").click();
  assert.strictEqual(await drawn(page), plain);
}
test("whatever the visitor does ends a slow frame", slow_frame_gives_way);
if (fs.existsSync(path.join(folder, "softfocus-simd.wasm"))) {
  const in_one_thread = () => { Object.defineProperty(globalThis, "crossOriginIsolated", { value: false }); };
  test("in one thread too whatever the visitor does ends a slow frame", slow_frame_gives_way,
       { script: in_one_thread });
  test("a frame that came in slices has the program's bits", async (page) => {
    await page.locator("#method").selectOption("accumulation");
    await equals_program(page);
    await page.locator("#method").selectOption("filtered-views");
    await equals_program(page);
  }, { script: in_one_thread });
}

test("each drop is a world of its own", async (page) => {
  await page.locator("#files").setInputFiles([text_file("box.obj", square("box.mtl")), text_file("box.mtl", kRed)]);
  await opened(page, "box");
  await drawn(page);
  const [red, green] = await middle(page);
  assert.ok(red > green + 50, "the first is not red");
  await page.locator("#files").setInputFiles([text_file("box2.obj", square("box.mtl"))]);
  assert.match(await error_line(page), /box\.mtl/);
  await opened(page, "box2");
  await drawn(page);
  const grey = await middle(page);
  assert.ok(Math.max(...grey) - Math.min(...grey) < 30, `the second is ${grey}`);
  // The first comes back with its own files.
  await page.locator("#scene").selectOption("/own/box.obj");
  await drawn(page);
  await page.waitForFunction(() => document.getElementById("error").hidden);
  await opened(page, "box");
  await drawn(page);
  assert.deepStrictEqual((await middle(page)).slice(0, 2), [red, green]);
});

test("memory returns after a drop", async (page) => {
  const bytes = () => page.evaluate(async () => (await performance.measureUserAgentSpecificMemory()).bytes);
  const drop_large = async (i) => {
    await page.evaluate(([number, text]) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([text, "#".repeat(6e6), "\n"], `box${number}.obj`));
      document.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, cancelable: true }));
    }, [i, square()]);
    await opened(page, `box${i}`);
    await drawn(page);
  };
  for (let i = 100; i < 103; ++i) await drop_large(i);
  const before = await bytes();
  for (let i = 103; i < 153; ++i) await drop_large(i);
  const after = await bytes();
  if (process.env.FIGURES) console.log(`  50 drops: ${before / 1e6} MB before, ${after / 1e6} MB after`);
  assert.ok(after < before + 30e6, `${before} bytes became ${after}`);
});

const number_in = (page, id) => page.locator(`#${id}`).evaluate((field) => Number(field.value));
const near = (a, b, part = 2e-3) => assert.ok(Math.abs(a - b) <= part * Math.abs(b), `${a}, not ${b}`);

test("another sensor keeps the framing or the focal length, and zooming the subject's size", async (page) => {
  await page.locator("#photo").check();
  const first = await drawn(page);
  const [fov, focal] = [await number_in(page, "fov"), await number_in(page, "focal-length")];
  await page.locator("#sensor").selectOption("micro-four-thirds");
  assert.notStrictEqual(await drawn(page), first);
  near(await number_in(page, "fov"), fov);
  const focus_mm = 1000 * await number_in(page, "focus");
  const image_mm = focal * focus_mm / (focus_mm - focal) * 13 / 24;  // by the sensors' heights
  near(await number_in(page, "focal-length"), image_mm * focus_mm / (image_mm + focus_mm));
  await equals_program(page);
  await page.locator("#sensor").selectOption("full-frame");
  near(await number_in(page, "focal-length"), focal);
  await page.locator("#lock").check();  // by which the framing does not jump
  near(await number_in(page, "fov"), fov);
  const locked = await drawn(page);
  const locked_focal = await number_in(page, "focal-length");
  await page.locator("#keep").selectOption("focal-length");
  await page.locator("#sensor").selectOption("micro-four-thirds");
  assert.notStrictEqual(await drawn(page), locked);
  near(await number_in(page, "focal-length"), locked_focal);
  assert.ok(await number_in(page, "fov") < 0.7 * fov);
  await page.locator("#sensor").selectOption("full-frame");
  near(await number_in(page, "fov"), fov);

  await page.locator("#subject").check();
  const size_of = async () => {
    const metres = await number_in(page, "focus");
    return 1 / (metres * Math.tan(await number_in(page, "fov") * Math.PI / 360));
  };
  const [size, focus] = [await size_of(), await number_in(page, "focus")];
  await set_number(page, "focal-length-part", 2 * locked_focal);
  await drawn(page);
  near(await number_in(page, "focus"), 2 * focus);
  near(await size_of(), size);
  await page.waitForFunction(() => /camera=.*sensor=full-frame&keep=focal-length&lock=1&subject=1/.test(location.hash));
});

test("all methods are measured while circles are shown, or depth of field is off", async (page) => {
  await page.locator("#tab-methods").click();
  await page.locator("#radii").fill("8");
  await page.locator("#coc-map").check({ force: true });
  await drawn(page);
  await page.locator("#truth-on").check();
  assert.match(await text_of(page, "truth-state"), /choose Picture/);
  await page.locator("#measure").click();
  await page.waitForFunction(() => / measured$|of an/.test(document.getElementById("measure-state").textContent),
                             null, { timeout: 4 * kFrameMs });
  assert.match(await text_of(page, "measure-state"), /^\d+ measured$/);
  assert.ok(await page.locator("input[name=show][value=image]").isChecked());
});

test("an unusable number says the range and goes back", async (page) => {
  const hash = await drawn(page);
  for (const [part, value, said] of [["f-number-part", "-1", /^f-number: give 1e-9 to 1e9$/],
                                     ["focal-length-part", "0", /^Focal length: give [\de.-]+ to [\de]+ mm$/],
                                     ["max-coc-part", "", /^Filter size, radius: give 0 to 1024 px/]]) {
    const field = page.locator(`#${part} input[type=number]`);
    const before = await field.inputValue();
    await field.fill(value);
    const range = page.locator(`#${part} [role=alert]`);
    assert.match(await range.textContent(), said);
    await field.blur();
    assert.strictEqual(await field.inputValue(), before);
    assert.ok(await range.isVisible());
    await field.fill(before);
    assert.ok(await range.isHidden());
  }
  assert.strictEqual(await drawn(page), hash);
  await page.locator("#scene").selectOption("cube-room");
  await drawn(page);
  await page.locator("#time").fill("-3");
  await page.locator("#time").press("Enter");
  assert.match(await error_line(page), /give .* to \d/);
  assert.strictEqual(await page.locator("#time").inputValue(), "0");
  await page.locator("#scene").selectOption("random");
  await drawn(page);
  await page.locator("#seed").fill("18446744073709551616");
  await page.locator("#seed").press("Enter");
  assert.match(await error_line(page), /from 0 to 18446744073709551615/);
});

const scene_file = (name) => fs.readFileSync(path.join(__dirname, "../../../scenes", name), "utf8");
const kEffectScene = `${scene_file("cube-room.toml").replace(/^title.*$/m, 'title = "Blooming"')}
[[effect]]
name = "bloom"
`;

test("an own scene is asked for after a reload, and has its settings again", async (page, { context, address }) => {
  const files = [text_file("box.obj", square("box.mtl")), text_file("box.mtl", kRed)];
  await drawn(page);
  await page.locator("#files").setInputFiles(files);
  await opened(page, "box");
  await set_number(page, "focal-length-part", 77);
  await press(page, "ArrowLeft");
  const hash = await drawn(page);
  await page.waitForFunction(() => /own=box\.obj.*f=77.*camera=/.test(location.hash), null, { timeout: 5000 });
  await page.reload();
  assert.match(await error_line(page), /box\.obj.*drop it on the page again/);
  await drawn(page);
  assert.strictEqual(await page.locator("#scene").inputValue(), "portrait");
  await page.locator("#files").setInputFiles(files);
  await opened(page, "box");
  assert.strictEqual(await drawn(page), hash);
  assert.ok(await page.locator("#error").isHidden());
});

test("a folder with a model's name, a file that cannot be read: a line, and all is as before", async (page) => {
  const first = await drawn(page);
  const drop_file = (make) => page.evaluate((body) => {
    const transfer = new DataTransfer();
    const file = new File(["v"], "x.obj");
    if (body === "unreadable") file.arrayBuffer = () => Promise.reject(new Error("it is a folder"));
    transfer.items.add(file);
    Object.defineProperty(transfer, "files", { value: [file] });
    Object.defineProperty(transfer, "items", { value: body === "empty" ? [{ webkitGetAsEntry: () => ({
      name: "x.obj", isFile: false, createReader: () => ({ readEntries: (done) => done([]) }) }) }] : [] });
    const event = new DragEvent("drop", { cancelable: true });
    Object.defineProperty(event, "dataTransfer", { value: { types: ["Files"], items: transfer.items, files: transfer.files } });
    document.dispatchEvent(event);
  }, make);
  await drop_file("unreadable");
  assert.match(await error_line(page), /x\.obj cannot be read: it is a folder; drop/);
  assert.strictEqual(await drawn(page), first);
  assert.strictEqual(await page.locator("#scene").inputValue(), "figures");
  await page.locator("#error-close").click();
  await drop_file("empty");
  assert.match(await error_line(page), /no file/);
  // What can be read still is.
  await page.locator("#files").setInputFiles([text_file("x.obj", square())]);
  await opened(page, "x");
  assert.notStrictEqual(await drawn(page), first);
});

test("a scene that cannot be drawn gives way to the one before", async (page) => {
  await page.locator("#scene").selectOption("cube-room");
  await drawn(page);
  await set_number(page, "f-number-part", 2.8);
  await page.locator("#method").selectOption("accumulation");
  const hash = await drawn(page);
  const of_frames = `${scene_file("figures.toml")}\n[[effect]]\nname = "temporal-aa"\n`;
  await page.locator("#files").setInputFiles([text_file("broken.toml", of_frames)]);
  assert.match(await error_line(page), /temporal-aa.*accumulation.*; what was open before is here again/);
  assert.strictEqual(await drawn(page), hash);
  assert.strictEqual(await page.locator("#scene").inputValue(), "cube-room");
  await equals_program(page);
});

test("a scene that is chosen while all is paused is drawn", async (page) => {
  const first = await drawn(page);
  await page.locator("#picture").press("q");
  await page.locator("#scene").selectOption("cube-room");
  await opened(page, "open");
  assert.notStrictEqual(await drawn(page), first);
  assert.strictEqual(await page.locator("#quit").getAttribute("aria-pressed"), "false");
  assert.ok(await page.locator("#over").isHidden());
});

test("a picture without a depth is told what to do here, not an option of the program", async (page) => {
  const first = await drawn(page);
  execFileSync(program, ["render", "figures", "--size", "64x64", "--show", "pinhole", "-o", "alone.png"],
               { cwd: work, stdio: "ignore" });
  await page.locator("#files").setInputFiles([path.join(work, "alone.png")]);
  const line = await error_line(page);
  assert.match(line, /second file/);
  assert.ok(!line.includes("--"), line);
  assert.strictEqual(await drawn(page), first);
});

test("the page's command has the frame's hash in every scene, and of effects and an open shutter", async (page) => {
  const scenes = await page.locator("#scene option").evaluateAll((options) => (
      options.map(({ value }) => value).filter((value) => value && value !== "random")));
  assert.ok(scenes.includes("windmill"));
  for (const scene of scenes) {
    if (scene !== "figures") {
      await page.locator("#scene").selectOption(scene);
      await opened(page, "open");
    }
    assert.strictEqual(await drawn(page), await hash_by_program(page), scene);
  }
  await page.locator("#scene").selectOption("windmill");
  await page.locator("#method").selectOption("accumulation");
  await page.locator("#step").click();
  await equals_program(page);
  await page.locator("#method").selectOption("two-pass");
  await page.locator("#files").setInputFiles([text_file("scene.toml", kEffectScene)]);
  await opened(page, "Blooming");
  fs.writeFileSync(path.join(work, "scene.toml"), kEffectScene);
  await page.waitForFunction(() => document.getElementById("command").textContent.includes("scene.toml"));
  await equals_program(page);
});

test("each press of an arrow on a slider is a step that shows, and the other way is its inverse", async (page) => {
  const names = ["focal-length", "f-number", "focus", "max-coc", "coc-scale", "fov", "object"];
  await page.locator("#method").selectOption("accumulation");
  for (const name of [...names, "samples"]) {
    const slider = page.locator(`#${name}-slider`);
    const value = () => page.locator(`#${name}`).inputValue();
    const seen = [await value()];
    for (const key of ["ArrowRight", "ArrowUp", "PageUp"]) {
      await slider.press(key);
      seen.push(await value());
    }
    assert.strictEqual(new Set(seen).size, seen.length, `${name}: ${seen}`);
    for (const key of ["PageDown", "ArrowLeft", "ArrowDown"]) {
      seen.pop();
      await slider.press(key);
      assert.strictEqual(await value(), seen[seen.length - 1], `${name}: ${key}`);
    }
  }
  await page.locator("#method").selectOption("two-pass");
  for (const [key, name] of [["l", "focal-length"], ["n", "f-number"], ["f", "focus"], ["x", "max-coc"], ["k", "coc-scale"]]) {
    await set_number(page, `${name}-part`, 3.3);
    const seen = [];
    for (let i = 0; i < 3; ++i) {
      seen.push(await page.locator(`#${name}`).inputValue());
      await page.locator("#picture").press(key);
    }
    assert.strictEqual(new Set(seen).size, 3, `${name}: ${seen}`);
    for (let i = 0; i < 3; ++i) {
      await page.locator("#picture").press(`Shift+${key.toUpperCase()}`);
      assert.strictEqual(await page.locator(`#${name}`).inputValue(), seen.pop(), name);
    }
  }
});

test("sliders tell their values in units, and every canvas has a name", async (page) => {
  await page.locator("#photo").check();
  await page.locator("#photo").uncheck();
  await page.locator("#compare").check();
  await drawn(page);
  const told = async (id) => page.locator(`#${id}`).getAttribute("aria-valuetext");
  assert.match(await told("focal-length-slider"), /^[\d.]+ mm$/);
  assert.match(await told("f-number-slider"), /^f\/[\d.]+$/);
  assert.match(await told("focus-slider"), /^[\d.]+ m$/);
  assert.match(await told("max-coc-slider"), /^[\d.]+ px$/);
  assert.match(await told("coc-scale-slider"), /^[\d.]+ times$/);
  assert.match(await told("fov-slider"), /^[\d.]+°$/);
  assert.match(await told("object-handle"), /^[\d.]+ c?m$/);
  assert.match(await told("divider"), /^50 %/);
  await page.locator("#divider").press("ArrowRight");
  assert.match(await told("divider"), /^51 %/);
  const unnamed = await page.locator("canvas").evaluateAll((all) => (
      all.filter((canvas) => !canvas.getAttribute("aria-label")).map(({ outerHTML }) => outerHTML)));
  assert.deepStrictEqual(unnamed, []);
});

/** Whether the whole picture is in the window. */
const picture_in_sight = (page) => page.evaluate(() => {
  const { top, bottom, left, right } = document.getElementById("picture").getBoundingClientRect();
  return top >= -1 && left >= -1 && bottom <= innerHeight + 1 && right <= innerWidth + 1;
});

for (const [width, height] of [[1440, 900], [1024, 768], [768, 1024], [390, 844]]) {
  test(`the picture stays in sight while every panel scrolls, at ${width}x${height}`, async (page) => {
    for (const shape of ["512x512", "1024x512"]) {
      await page.locator(`input[name=size][value='${shape}']`).evaluate((choice) => choice.click());
      await drawn(page);
      for (const tab of await page.locator("[role=tab]:not([hidden])").all()) {
        await tab.click();
        await page.evaluate(() => {
          for (const part of [document.scrollingElement, ...document.querySelectorAll(".bench, .panel")]) {
            part.scrollTop = part.scrollHeight;
          }
        });
        assert.ok(await picture_in_sight(page), `${shape}, ${await tab.textContent()}`);
      }
      await page.locator("#tab-lens").click();
    }
    const tops = await page.locator("[role=tab]:not([hidden])").evaluateAll((tabs) => tabs.map((tab) => tab.offsetTop));
    assert.strictEqual(new Set(tops).size, 1, "the tabs take several rows");
    if (width < 1440) return;
    const wrapped = await page.evaluate(() => {
      const is_wrapped = (row) => {
        const boxes = [...row.children].map((one) => one.getBoundingClientRect()).filter((box) => box.height > 2);
        return boxes.some((box) => boxes.some((other) => box.top >= other.bottom - 1));
      };
      const rows = document.querySelectorAll("header, .tabs, .line, .choices, .panel .row, .stage .row");
      const bodies = [...document.querySelectorAll(".equation .body")].filter((body) => body.clientHeight > 44);
      return [...[...rows].filter(is_wrapped), ...bodies].map((one) => one.textContent.trim());
    });
    assert.deepStrictEqual(wrapped, []);
  }, { viewport: { width, height } });
}

/** The canvas's colour at a part of its width and height. */
const colour_at = (page, x, y) => page.evaluate(([part_x, part_y]) => {
  const canvas = document.getElementById("canvas-a");
  const place = [Math.floor(part_x * canvas.width), Math.floor(part_y * canvas.height)];
  return [...canvas.getContext("2d").getImageData(...place, 1, 1).data].slice(0, 3);
}, [x, y]);

/** The canvas's luminances: those that 1 and 99 % are below. */
const luminances = (page) => page.evaluate(() => {
  const canvas = document.getElementById("canvas-a");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const all = [];
  for (let i = 0; i < data.length; i += 4) all.push(0.2126 * data[i] + 0.7152 * data[i + 1] + 0.0722 * data[i + 2]);
  all.sort((a, b) => a - b);
  return [0.01, 0.99].map((part) => all[Math.floor(part * (all.length - 1))]);
});

test("the circles' map has two hues, before and behind the focus, and a legend", async (page) => {
  await page.locator("#coc-map").check({ force: true });
  await drawn(page);
  assert.match(await text_of(page, "legend"), /px: orange before focus, blue behind.*−8.*0.*8/);
  const box = await page.locator("#picture").boundingBox();
  const seen = new Set();
  for (const [x, y] of [[0.16, 0.4], [0.76, 0.38], [0.12, 0.72], [0.8, 0.85]]) {
    await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
    await page.waitForFunction((place) => document.getElementById("pixel").textContent.startsWith(place),
                               `${Math.floor(x * 512)}, `);
    const [, side] = /radius [\d.]+ px, (before|behind) the focus/.exec(await text_of(page, "pixel"));
    const [red, , blue] = await colour_at(page, x, y);
    assert.ok(side === "before" ? red > blue + 20 : blue > red + 20, `${side}: ${await colour_at(page, x, y)}`);
    seen.add(side);
  }
  assert.strictEqual(seen.size, 2);
  await page.locator("input[name=show][value=image]").check({ force: true });
  await drawn(page);
  assert.ok(await page.locator("#legend").isHidden());
});

test("the maps of depth and of the error use their whole scale, whatever the scene", async (page) => {
  for (const scene of ["figures", "sphere-world", "near-fence"]) {
    await page.locator("#scene").selectOption(scene);
    await opened(page, "open");
    await page.locator("input[name=show][value=depth]").check({ force: true });
    await drawn(page);
    assert.match(await text_of(page, "legend"), /Depth.*\d c?m.*\d c?m.*\d c?m/);
    const depth = await luminances(page);
    assert.ok(depth[1] - depth[0] > 60, `${scene}: depths from ${depth}`);
    await page.locator("input[name=show][value=error]").check({ force: true });
    await page.waitForFunction(() => /FLIP of each pixel/.test(document.getElementById("legend").textContent), null,
                               { timeout: kFrameMs });
    const error = await luminances(page);
    assert.ok(error[1] > 90, `${scene}: errors up to ${error}`);
    await page.locator("input[name=show][value=image]").check({ force: true });
    await drawn(page);
  }
});

test("the lens's drawing magnifies the film and reaches infinity, and draws without laying out the page", async (page) => {
  const drawing = (name) => page.locator(`#diagram-${name}`);
  assert.match(await drawing("camera").textContent(), /× 20/);
  assert.match(await drawing("world").textContent(), /∞/);
  assert.doesNotMatch(await drawing("world").textContent(), /sharp to ∞/);
  const tall = await drawing("camera").locator("g .circle").evaluate((bar) => bar.getBoundingClientRect().height);
  assert.ok(tall > 20, `the circle on the film is ${tall} px`);
  await set_number(page, "f-number-part", 16);
  await set_number(page, "focus-part", 10);
  await drawn(page);
  assert.match(await drawing("world").textContent(), /sharp to ∞/);
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const layouts = async () => (await session.send("Performance.getMetrics")).metrics
      .find(({ name }) => name === "LayoutCount").value;
  const before = await layouts();
  await page.evaluate(async () => {
    const slider = document.getElementById("focus-slider");
    for (let i = 0; i < 100; ++i) {
      slider.value = 400 + i;
      slider.dispatchEvent(new Event("input"));
      await null;  // the store tells
      await null;
    }
  });
  const count = await layouts() - before;
  if (process.env.FIGURES) console.log(`  100 changes in one turn: ${count} layouts`);
  assert.ok(count <= 5, `${count} layouts`);
});

test("measured methods are dots of time and error, and rows that can be sorted", async (page) => {
  await page.locator("#tab-methods").click();
  await page.locator("#radii").fill("4 8 16");
  await page.locator("#measure").click();
  await page.waitForFunction(() => / measured$/.test(document.getElementById("measure-state").textContent), null,
                             { timeout: 6 * kFrameMs });
  const cells = await page.locator("#methods-table td.measured").count();
  assert.strictEqual(await page.locator("#methods-chart .dot").count(), cells);
  assert.match(await page.locator("#methods-chart").getAttribute("aria-label"), /both quicker and better than \w/);
  const column = async (index) => page.locator("#methods-table tbody tr").evaluateAll((rows, at) => (
      rows.map((row) => Number(row.children[at].textContent)).filter(Number.isFinite)), index);
  for (const [button, index] of [["ms at 8 px: sort", 3], ["FLIP at 8 px: sort", 4]]) {
    await page.getByRole("button", { name: button }).click();
    const values = await column(index);
    assert.deepStrictEqual(values, values.slice().sort((a, b) => a - b), button);
  }
  const cut = await page.locator("#methods-table").evaluate((table) => table.scrollWidth - table.parentElement.clientWidth);
  assert.ok(cut <= 0, `${cut} px of the table are cut off`);
  const [ms] = await column(1);
  assert.ok(ms > 0);
}, { viewport: { width: 1440, height: 900 } });

test("a failure case's answer stands beside its picture, and whether the method holds", async (page) => {
  await page.locator("#tab-cases").click();
  await page.locator("#cases button").nth(2).click();
  await page.waitForSelector("#case-answer:not([hidden])", { timeout: kFrameMs });
  const verdict = /holds? with these settings|does not hold with these settings/;
  assert.match(await text_of(page, "case-verdict"), verdict);
  const by_default = await text_of(page, "case-verdict");
  assert.match(by_default, /It holds/);
  await page.locator("#method").selectOption("two-pass");
  await page.waitForFunction(() => /does not hold/.test(document.getElementById("case-verdict").textContent), null,
                             { timeout: kFrameMs });
  assert.ok(await page.locator("#case-answer").isVisible());
  await page.locator("#scene").selectOption("figures");
  await page.waitForSelector("#case-answer", { state: "hidden" });
});

test("the first sight is a portrait by the default method, and the thesis's scenes are one choice away", async (page) => {
  assert.strictEqual(await page.locator("#scene").inputValue(), "portrait");
  assert.strictEqual(await page.locator("#method").inputValue(), "disc-layers");
  await equals_program(page);
  const thesis = await page.locator("#scene optgroup").first().evaluate((group) => (
      [group.label, ...[...group.children].map(({ value }) => value)]));
  assert.deepStrictEqual(thesis, ["The thesis’s scenes", "figures", "cube-room", "sphere-world"]);
}, { at: "" });

test("a drag never blocks the page for 50 ms, and shows pictures all the while", async (page) => {
  // Where other programs take the cores it would fail by chance.
  if (!process.env.FIGURES) return "it takes an idle machine: set FIGURES";
  const is_busy = os.loadavg()[0] > os.cpus().length;
  await page.evaluate(() => {
    globalThis.long_tasks = [];
    new PerformanceObserver((list) => globalThis.long_tasks.push(...list.getEntries().map(({ duration }) => duration)))
        .observe({ entryTypes: ["longtask"] });
    globalThis.painted = [];
    const put = CanvasRenderingContext2D.prototype.putImageData;
    CanvasRenderingContext2D.prototype.putImageData = function (...words) {
      globalThis.painted.push(performance.now());
      return put.apply(this, words);
    };
  });
  const box = await page.locator("#focus-slider").boundingBox();
  await page.mouse.move(box.x + 0.3 * box.width, box.y + box.height / 2);
  await page.mouse.down();
  const began = await page.evaluate(() => performance.now());
  for (let i = 0; i < 60; ++i) {
    await page.mouse.move(box.x + (0.3 + 0.005 * i) * box.width, box.y + box.height / 2);
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
  const { long_tasks, painted, ended } = await page.evaluate(() => (
      { long_tasks: globalThis.long_tasks, painted: globalThis.painted, ended: performance.now() }));
  const times = [began, ...painted.filter((time) => time > began && time < ended)];
  const gaps = times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b);
  if (process.env.FIGURES) {
    console.log(`  ${gaps.length} pictures in ${(ended - began).toFixed(0)} ms, ${gaps[gaps.length >> 1]?.toFixed(0)} ms apart ` +
                `(median), ${gaps[gaps.length - 1]?.toFixed(0)} at the most; long tasks: ${long_tasks.map(Math.round)}`);
  }
  if (is_busy) return "other programs take the cores";
  assert.deepStrictEqual(long_tasks, []);
  assert.ok(gaps[gaps.length - 1] < 100, `no picture for ${gaps[gaps.length - 1]} ms`);
  return null;
}, { no_gpu: true });  // a GPU that is emulated takes the cores

test("the focus follows the pointer if it is asked to", async (page) => {
  const box = await page.locator("#picture").boundingBox();
  const point = (x, y) => page.mouse.move(box.x + x * box.width, box.y + y * box.height);
  const first = await drawn(page);
  await point(0.3, 0.3);
  assert.strictEqual(await drawn(page), first);
  await page.locator("#focus-follow").check();
  await point(0.16, 0.4);
  await page.waitForFunction(() => /at=0\.1/.test(location.hash), null, { timeout: 5000 });
  const near_cube = await drawn(page);
  assert.notStrictEqual(near_cube, first);
  await equals_program(page);
  await page.locator("#focus-follow").uncheck();
  await point(0.8, 0.85);
  assert.strictEqual(await drawn(page), near_cube);
});

test("kept settings stand under the picture, and come back", async (page) => {
  const hashes = [];
  for (const stop of ["1.4", "4", "11"]) {
    await set_number(page, "f-number-part", stop);
    hashes.push(await drawn(page));
    await page.locator("#keep-settings").click();
  }
  assert.strictEqual(await page.locator("#kept li").count(), 3);
  assert.ok(await picture_in_sight(page));
  await page.locator("#kept li button").first().click();
  await page.waitForFunction(() => document.getElementById("f-number").value === "1.4");
  assert.strictEqual(await drawn(page), hashes[0]);
  await page.locator("#kept .away").first().click();
  assert.strictEqual(await page.locator("#kept li").count(), 2);
}, { viewport: { width: 1440, height: 900 } });

/** axe-core's text, or null where it is not installed. */
const axe = (() => {
  try {
    return fs.readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
  } catch {
    return null;
  }
})();

/** What axe-core finds, one line each. Also by rules that it leaves out unless they are asked for. */
async function findings(page) {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const rules = Object.fromEntries(["target-size", "label-content-name-mismatch", "css-orientation-lock",
                                      "focus-order-semantics"].map((id) => [id, { enabled: true }]));
    const { violations } = await globalThis.axe.run(document, { resultTypes: ["violations"], rules });
    return violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => (
        `${id}: ${target} ${failureSummary.split("\n").slice(1, 3).join(" ")}`)));
  });
}

/** Goes through the page's states. */
async function no_findings(page, has_keys) {
  const found = new Map();  // by what, in which state first
  const check = async (state) => {
    for (const line of await findings(page)) if (!found.has(line)) found.set(line, state);
  };
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await check(colorScheme);
  }
  for (const tab of await page.locator("[role=tab]:not([hidden])").all()) {
    await tab.click();
    await check(await tab.textContent());
  }
  await page.locator("#tab-lens").click();
  await page.locator("#photo").check();
  await page.locator("#lock").check();
  await page.locator("#compare").check();
  await page.locator("#focal-length").fill("0");
  await drawn(page);
  await check("photographer’s mode, two settings, an unusable number");
  await page.locator("#focal-length").blur();
  await page.locator("#compare").uncheck();
  await page.locator("#keep-settings").click();
  await check("kept settings");
  await page.locator("#coc-map").evaluate((choice) => choice.click());
  await drawn(page);
  await check("a map with its legend");
  await page.locator("#coc-map").press("m");
  await page.locator("#focus-part button.why").click();
  await check("a tip");
  await page.locator("#method").selectOption("accumulation");
  await drawn(page);
  await check("points of the lens");
  await page.locator("#scene").selectOption("random");
  await drawn(page);
  await check("a random scene");
  await page.locator("#tab-methods").click();
  await page.locator("#method").selectOption("two-pass");
  await page.locator("#radii").fill("4");
  await page.locator("#measure").click();
  await page.waitForFunction(() => / measured$/.test(document.getElementById("measure-state").textContent),
                             null, { timeout: 4 * kFrameMs });
  await check("measured methods");
  await page.locator("#tab-gpu").click();
  await gpu_does(page, "gpu-draw", { id: "gpu-differences", words: "Frame: " });
  await gpu_does(page, "gpu-probe", { id: "gpu-profile", words: "subpixel_bits" });
  await check("the GPU’s picture and profile");
  await page.locator("#gpu-crosscheck").click();
  await page.waitForSelector("#gpu-cases tbody tr", { timeout: kFrameMs });
  await check("the GPU’s cases");
  await page.locator("#gpu-crosscheck").click();
  await page.locator("#tab-hashes").click();
  await page.locator("#selftest").click();
  await check("golden hashes");
  await page.locator("#selftest").click();
  await page.locator("#tab-cases").click();
  await page.locator("#cases button").nth(2).click();
  await opened(page, "open");
  await drawn(page);
  await check("a failure case");
  await page.locator("#files").setInputFiles([text_file("broken.obj", "v x\n")]);
  await error_line(page);
  await check("an error");
  execFileSync(program, ["render", "figures", "--size", "96x64", "--show", "pinhole", "-o", "axe.png",
                         "--depth-output", "axe_depth.png"], { cwd: work, stdio: "ignore" });
  await page.locator("#files").setInputFiles(["axe.png", "axe_depth.png"].map((name) => path.join(work, name)));
  await page.waitForSelector("#depth-part:not([hidden])");
  await drawn(page);
  await check("a picture");
  if (has_keys) await page.locator("#picture").press("q");
  else await page.locator("#quit").click();
  await check("paused");
  assert.deepStrictEqual([...found].map(([line, state]) => `${state}: ${line}`), []);
}
if (axe) {
  test("axe-core finds nothing in any state", (page) => no_findings(page, true));
  test("axe-core finds nothing on a phone", (page) => no_findings(page, false),
       { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
}

test("the truth comes nearer, and the methods get their errors", async (page) => {
  await page.locator("#tab-methods").click();
  await page.locator("#truth-on").check();
  await page.waitForFunction(() => /\d/.test(document.getElementById("truth-state").textContent),
                             null, { timeout: kFrameMs });
  await page.locator("input[name=show][value=error]").check({ force: true });
  await page.waitForFunction(() => /FLIP/.test(document.getElementById("truth-state").textContent),
                             null, { timeout: kFrameMs });
  assert.ok(await page.locator("#error").isHidden());
});

/** Waits for another shader than `before` to be the method, and for its picture. Its hash. */
async function shader_drawn(page, before) {
  await page.waitForFunction((old) => {
    const { value } = document.getElementById("method");
    return value.startsWith("shader-") && value !== old;
  }, before, { timeout: kFrameMs });
  return drawn(page);
}

const hash_by_pipeline = (file) => JSON.parse(execFileSync(program, [
  "render", "figures", "--size", "512x512", "--multisample", "1", "--method",
  path.join(__dirname, "../../../scenes/pipelines", file), "--json", "-o", path.join(work, "own.npy"),
], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] })).picture_hash;

if (fs.existsSync(path.join(folder, "softfocus-compiler.wasm"))) {
  test("a shader of one's own is compiled, measured, told by its line, and in the link", async (page, { context, address }) => {
    await page.locator("#method").selectOption("two-pass");
    const two_pass = await drawn(page);
    await page.locator("#tab-shader").click();
    assert.strictEqual(await shader_drawn(page, ""), hash_by_pipeline("lesson/gather.toml"));
    await page.waitForFunction(() => /views.*FLIP/.test(document.getElementById("shader-truth").textContent),
                               null, { timeout: kFrameMs });
    const gather = await page.locator("#method").inputValue();
    const text = await page.locator("#shader-text").inputValue();
    await page.locator("#shader-text").fill(text.replace("vec3 sum", "vec3 some"));
    await page.waitForSelector("#shader-fault:not([hidden])");
    assert.match(await text_of(page, "shader-fault"), /^mine\.frag:23: 'sum': undeclared identifier/);
    await page.locator("#shader-run").click();
    await page.waitForFunction(() => {
      const box = document.getElementById("shader-text");
      return box.value.slice(box.selectionStart, box.selectionEnd).trim().startsWith("sum += ");
    });
    assert.strictEqual(await page.locator("#method").inputValue(), gather);

    await page.locator("#shader-example").selectOption("two_pass");
    assert.strictEqual(await shader_drawn(page, gather), two_pass);
    assert.ok(await page.locator("#shader-fault").isHidden());
    await page.waitForFunction(() => location.hash.includes("shader="), null, { timeout: 5000 });
    const other = await context.newPage();
    await other.goto(address + await page.evaluate(() => location.hash));
    assert.strictEqual(await shader_drawn(other, ""), two_pass);
    assert.strictEqual(await other.locator("#shader-text").inputValue(),
                       await page.locator("#shader-text").inputValue());
    assert.ok(await other.locator("#shader-panel").isVisible());
    await other.close();
  });

  test("a shader of one's own stands beside the GPU's picture of it", async (page) => {
    await page.locator("#tab-shader").click();
    await shader_drawn(page, "");
    const gather = await page.locator("#method").inputValue();
    await page.locator("#shader-example").selectOption("two_pass");
    await shader_drawn(page, gather);
    await page.locator("#shader-gpu").click();
    await page.waitForFunction(() => /values/.test(document.getElementById("shader-differences").textContent),
                               null, { timeout: kFrameMs });
    assert.match(await text_of(page, "shader-differences"),
                 /Your shader, of the GPU’s sharp picture: all 1048576 values are equal/);
    for (const id of ["shader-emulated", "shader-on-gpu", "shader-where"]) {
      await page.waitForSelector(`#${id}:not([hidden])`, { timeout: kFrameMs });
    }
  });
}

test("a failure case is a scene", async (page) => {
  const first = await drawn(page);
  await page.locator("#tab-cases").click();
  await page.locator("#cases button").nth(2).click();
  assert.notStrictEqual(await drawn(page), first);
});

require("./lessons_walk.js")({ test, drawn, set_number, text_of, folder, single_file });

test("all golden hashes are the native table's", async (page) => {
  await page.locator("#tab-hashes").click();
  await page.locator("#selftest").click();
  await page.waitForFunction(() => /^All|differ\.$/.test(document.getElementById("selftest-state").textContent),
                             null, { timeout: 300000 });
  assert.match(await text_of(page, "selftest-state"), /^All/);
});

test("a phone's screen holds the page, and a tap sets the focus", async (page) => {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 360, `the page is ${wide} px wide`);
  const first = await drawn(page);
  await page.locator("#picture").tap({ position: { x: 80, y: 240 } });
  assert.notStrictEqual(await drawn(page), first);
}, { viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true });

test("memory that is full is a line; nothing is lost, and the next frame is drawn", async (page) => {
  const first = await drawn(page);
  const worker = page.workers().find((one) => one.url().endsWith("worker.js"));
  await worker.evaluate(() => {
    WebAssembly.Memory.prototype.grow = () => { throw new RangeError("no memory is left"); };
  });
  await page.evaluate(() => { location.hash = "scene=figures&size=4096x4096"; });
  assert.match(await error_line(page), /not enough memory.*; what was open before is here again/);
  assert.strictEqual(await drawn(page), first);
  assert.notStrictEqual(await press(page, "b"), first);
  assert.strictEqual(await press(page, "b"), first);
});

test("a picture larger than any is a line, and the next frame is drawn", async (page) => {
  const first = await drawn(page);
  await page.evaluate(() => { location.hash = "scene=figures&size=16384x16384"; });
  assert.match(await error_line(page), /not enough memory/);
  assert.strictEqual(await drawn(page), first);
});

const kGpuMs = 240000;

/** Clicks a button of the panel; what the panel says when it is done. */
async function gpu_does(page, button, done) {
  await page.locator(`#${button}`).click();
  await page.waitForFunction(({ id, words }) => new RegExp(words).test(
      document.getElementById(id).textContent), done, { timeout: kGpuMs });
}

test("the GPU draws and filters the frame, and says what differs", async (page) => {
  await page.locator("#method").selectOption("two-pass");
  await drawn(page);
  await page.locator("#tab-gpu").click();
  assert.match(await text_of(page, "gpu-support"), /WebGL2 and EXT_color_buffer_float are here/);
  await gpu_does(page, "gpu-draw", { id: "gpu-differences", words: "Frame: " });
  assert.match(await text_of(page, "gpu-support"), /SwiftShader/);
  const said = await text_of(page, "gpu-differences");
  assert.match(said, /Profile swiftshader/);
  assert.match(said, /Draw: \d+ of 1048576 values differ/);
  assert.match(said, /Filter, of the GPU’s sharp picture: all 1048576 values are equal/);
  assert.match(await text_of(page, "gpu-table"), /Draw.*\d.*Filter.*\d/s);
  await page.waitForSelector("#gpu-picture:not([hidden])");
  // The two pictures are alike: what differs are pixels on edges.
  const means = await page.evaluate(() => ["picture", "gpu-picture"].map((id) => {
    const place = document.getElementById(id);
    const canvas = place.matches("canvas") ? place : place.querySelector("canvas");
    const copy = document.createElement("canvas");
    copy.width = copy.height = 8;
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0, 8, 8);
    return [...context.getImageData(0, 0, 8, 8).data];
  }));
  means[0].forEach((value, i) => assert.ok(Math.abs(value - means[1][i]) <= 8, `part ${i}`));
});

test("the GPU's profile is found, is swiftshader's, and the program takes it", async (page) => {
  await page.locator("#tab-gpu").click();
  await gpu_does(page, "gpu-probe", { id: "gpu-profile", words: "subpixel_bits" });
  const [download] = await Promise.all([page.waitForEvent("download"),
                                        page.locator("#gpu-download").click()]);
  const file = path.join(work, "my-gpu.toml");
  await download.saveAs(file);
  const hash_under = (profile) => JSON.parse(execFileSync(program, [
    "render", "cube-room", "--size", "96x64", "--profile", profile, "--json", "-o",
    path.join(work, "picture.npy")], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }))
      .picture_hash;
  assert.strictEqual(hash_under(file), hash_under("swiftshader"));
  const keys = Object.fromEntries([...fs.readFileSync(file, "utf8").matchAll(/^(\w+) = "?([^"#\s]+)/gm)]
      .map((match) => match.slice(1)));
  for (const [key, value] of Object.entries({
    half_store: "swiftshader", unorm_store: "nearest-even", denormals: "flush",
    texture_unit: "swiftshader", lerp: "unfused", viewport: "unfused", clipping: "plain",
    coverage: "edge-functions", fill_rule: "upper-left", attributes: "exact-barycentric",
    subpixel_bits: "4", guard_band: "4" })) {
    assert.strictEqual(keys[key], value, key);
  }
});

/** Starts a worker beside the page's own. */
async function start_worker(page) {
  await page.evaluate(() => new Promise((done, fail) => {
    const worker = new Worker("worker.js");
    globalThis.ask_worker = (request) => new Promise((answered) => {
      worker.onmessage = ({ data }) => answered(data.reply);
      worker.postMessage({ id: 1, request });
    });
    worker.onmessage = ({ data }) => (data.ready ? done() : fail(new Error(data.failed)));
  }));
  return (request) => page.evaluate((asked) => globalThis.ask_worker(asked), request);
}

test("the GPU's stores, textures and filters give the module's bits in every quick case", async (page) => {
  const ask = await start_worker(page);
  const { cases } = await ask({ do: "gl_crosscheck" });
  assert.ok(cases.length > 200);
  for (const { name, quick } of cases) {
    if (!quick || !/^(store|bilinear|mipmap\/[tn]|two-pass|one-pass)/.test(name)) continue;
    const reply = await ask({ do: "gl_crosscheck", case: name });
    assert.strictEqual(reply.error, undefined, name);
    assert.strictEqual(reply.differing, 0, name);
    assert.ok(reply.values > 0, name);
  }
});

/** What a browser that lacks something runs and is told; the picture's bits are the same. */
function lacks(claim, script, build, said) {
  if (!fs.existsSync(path.join(folder, `softfocus-${build}.wasm`))) return;
  test(claim, async (page) => {
    const text = await text_of(page, "build");
    assert.ok(text.startsWith(`Build: ${build}. Not here: `), text);
    assert.match(text, said);
    await equals_program(page);
  }, { script });
}
lacks("without shared memory it runs in one thread, and says so",
      () => { Object.defineProperty(globalThis, "crossOriginIsolated", { value: false }); },
      "simd", /threads/);
lacks("without SIMD it runs, and says so", () => {
  const validate = WebAssembly.validate;
  WebAssembly.validate = (bytes) => bytes.length !== 43 && validate(bytes);
}, "plain", /SIMD/);
lacks("without WebAssembly's exceptions it runs, and says so", () => {
  const validate = WebAssembly.validate;
  WebAssembly.validate = (bytes) => bytes.length !== 28 && validate(bytes);
}, "plain", /exceptions/);
lacks("without WebAssembly's atomics it runs, and says so", () => {
  const validate = WebAssembly.validate;
  WebAssembly.validate = (bytes) => bytes.length !== 36 && validate(bytes);
}, "plain", /atomics/);

test("without WebGL2 the GPU's panel says so, and the rest works", async (page) => {
  await page.locator("#tab-gpu").click();
  assert.match(await text_of(page, "gpu-support"), /This browser has no WebGL2/);
  for (const id of ["gpu-draw", "gpu-probe", "gpu-crosscheck"]) {
    assert.ok(await page.locator(`#${id}`).isDisabled(), id);
  }
  const ask = await start_worker(page);
  assert.match((await ask({ do: "gl_open" })).error, /^no WebGL2 here: /);
  await equals_program(page);
}, { no_gpu: true });

/** Scripts that a test puts before the worker's. */
async function prepend_to_worker(context, script) {
  await context.route("**/worker.js", async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, body: `(${script})();\n${await response.text()}` });
  });
}

function serve() {
  const server = spawn("node", [path.join(__dirname, "../../../tools/page/serve.js"), folder, "0"]);
  return new Promise((done, fail) => {
    server.on("exit", () => fail(new Error("serve.js ended")));
    server.stdout.on("data", (line) => {
      const found = /http:\S+/.exec(line);
      if (found) done({ server, address: found[0] });
    });
  });
}

async function run_one(browsers, address, { claim, run, options }) {
  const { script, no_gpu, at = "#scene=figures", ...of_context } = options;
  const browser = await (no_gpu ? browsers.without_gpu() : browsers.with_gpu());
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, ...of_context });
  const faults = [];
  try {
    if (script) await prepend_to_worker(context, script);
    const page = await context.newPage();
    page.on("pageerror", (error) => faults.push(error.message));
    await page.goto(`${address}${at}`);
    await drawn(page);
    const why_not = await run(page, { context, address });
    assert.deepStrictEqual(faults, []);
    console.log(why_not ? `skipped: ${claim}: ${why_not}` : `pass: ${claim}`);
    return true;
  } catch (error) {
    console.log(`FAIL: ${claim}\n  ${String(error.stack ?? error).replaceAll("\n", "\n  ")}`);
    return false;
  } finally {
    await context.close();
  }
}

const kOfOneFile = [
  ["one file, opened from disk, has the program's bits and at most 3 MB", async (page) => {
    await equals_program(page);
    const { size } = fs.statSync(single_file);
    assert.ok(size <= kMostBytesOfOneFile, `${size} bytes`);
  }],
  ["in one file too whatever the visitor does ends a slow frame", slow_frame_gives_way],
];

async function main() {
  const started = [];
  const started_with = (...words) => {
    let browser = null;
    return async () => {
      if (browser) return browser;
      browser = await chromium.launch({
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: ["--no-sandbox", ...words],
      });
      started.push(browser);
      return browser;
    };
  };
  const browsers = {
    with_gpu: started_with("--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    without_gpu: started_with("--disable-gpu", "--disable-3d-apis", "--disable-software-rasterizer"),
  };
  const { server, address } = await serve();
  let failed = 0;
  try {
    const wanted = process.env.ONLY;
    for (const one of tests) {
      if (wanted && !one.claim.includes(wanted)) continue;
      if (!await run_one(browsers, address, one)) ++failed;
    }
    for (const [claim, run] of single_file ? kOfOneFile : []) {
      if (wanted && !claim.includes(wanted)) continue;
      const place = pathToFileURL(path.resolve(single_file)).href;
      if (!await run_one(browsers, place, { claim, run, options: {} })) ++failed;
    }
  } finally {
    server.removeAllListeners("exit");
    server.kill();
    for (const browser of started) await browser.close();
    fs.rmSync(work, { recursive: true });
  }
  process.exit(failed > 0 ? 1 : 0);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
