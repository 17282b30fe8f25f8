// Goes through the lessons as a student does, in the browser: each step is set up, is not found yet,
// and is found once what it asks for is done. browser_test.js runs it.
"use strict";

const assert = require("assert");
const { spawn } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");
const { pathToFileURL } = require("url");

const kFoundMs = 120000;
const kLesson = path.join(__dirname, "../../../scenes/pipelines/lesson");
const kPast = "if (texel.a > depth_m) theirs = depth_m < focus_m ? own : min(theirs, own);";

/** Another address of this machine than localhost, if it has one. */
const of_network = Object.values(os.networkInterfaces()).flat()
    .find(({ family, internal }) => !internal && family === "IPv4")?.address;

/** Serves the folder to the network. */
function serve(folder) {
  const server = spawn("node", [path.join(__dirname, "../../../tools/page/serve.js"), folder, "0", of_network]);
  return new Promise((done, fail) => {
    server.on("exit", () => fail(new Error("serve.js ended")));
    server.stdout.on("data", (line) => {
      const found = /http:\S+/.exec(line);
      if (found) done({ server, address: found[0] });
    });
  });
}

/** `of` has browser_test.js's helpers. */
module.exports = ({ test, drawn, set_number, folder, single_file, ...of }) => {
  const has = (name) => fs.existsSync(path.join(folder, name));
  const show = (page, kind) => page.locator(`input[name=show][value=${kind}]`).check({ force: true });
  const tab = (page, name) => page.locator(`#tab-${name}`).click();
  const method = (name) => (page) => page.locator("#method").selectOption(name);
  const answer = (value) => (page) => page.locator("#step-answer").fill(String(value));
  const points = (count) => (page) => set_number(page, "samples-part", count);
  const click = async (page, x, y) => {
    const box = await page.locator("#picture").boundingBox();
    await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
  };
  const write = async (page, text) => {
    await tab(page, "shader");
    await page.locator("#shader-text").fill(text);
  };
  const shader = (name) => fs.readFileSync(path.join(kLesson, `${name}.frag`), "utf8");

  const not_found = async (page) => {
    await page.waitForTimeout(700);  // twice the time between two looks
    assert.strictEqual(await of.text_of(page, "step-state"), "Not found yet.");
  };

  /** What the student does in each step, by its number. */
  const kDeeds = {
    1.1: (page) => click(page, 0.28, 0.36),
    1.2: (page) => set_number(page, "focus-part", 0.84),
    1.3: answer("0,32"),
    1.4: async (page) => {
      await tab(page, "lens");
      await page.locator("#object-handle").focus();
      for (let i = 0; i < 4; ++i) await page.keyboard.press("PageDown");
      await set_number(page, "object-part", 1);
    },
    1.5: (page) => set_number(page, "f-number-part", 4),
    1.6: async (page) => {
      await set_number(page, "focal-length-part", 100);
      await set_number(page, "f-number-part", 4);
    },
    1.7: (page) => set_number(page, "focus-part", 4.6),
    1.8: async (page) => {
      await page.locator("#sensor").selectOption("phone");
      await not_found(page);
      await set_number(page, "focal-length-part", 15.8);
    },
    2.1: async (page) => {
      await page.locator("#dof").uncheck();
      await show(page, "depth");
    },
    2.2: (page) => set_number(page, "max-coc-part", 57),
    2.3: method("one-pass"),
    2.4: async (page) => {
      await method("pinhole")(page);
      await page.waitForFunction(() => document.getElementById("step-watch").textContent === "FLIP 0");
      await not_found(page);
      await method("disc-layers")(page);
    },
    2.5: method("layers"),
    2.6: method("accumulation"),
    3.1: points(64),
    3.2: (page) => show(page, "truth"),
    3.3: answer(3.2),
    3.4: points(7),
    3.5: points(2),
    4.1: null,  // there is nothing to do: it is found by setting it up
    4.2: (page) => set_number(page, "focus-part", 1.0001),
    4.3: (page) => page.locator("#half-value").fill("2049"),
    4.4: (page) => page.locator("#half-value").fill("2051"),
    4.5: answer(77),
    4.6: async (page) => {
      await tab(page, "gpu");
      await page.locator("#gpu-draw").click();
    },
    5.1: async (page) => {
      await tab(page, "shader");
      await page.waitForFunction(() => document.getElementById("method").value.startsWith("shader-"));
      await show(page, "error");
    },
    5.2: (page) => write(page, shader("weights")),
    5.3: async (page) => {
      await tab(page, "shader");
      const mine = await page.locator("#shader-text").inputValue();
      assert.strictEqual(await page.locator("#shader-example").inputValue(), "own");
      await page.locator("#shader-example").selectOption("gather");
      await page.waitForFunction((text) => document.getElementById("shader-text").value !== text, mine);
      await page.locator("#shader-example").selectOption("own");
      assert.strictEqual(await page.locator("#shader-text").inputValue(), mine);
      await page.locator("#shader-example").selectOption("gather");
    },
    5.4: async (page) => {
      await write(page, shader("weights").replace(/if \(texel\.a > depth_m\).*/, kPast));
      await page.waitForFunction(() => /^0\.0[0-9]/.test(/FLIP (\S+),/.exec(
          document.getElementById("strip-watch").textContent)?.[1]), null, { timeout: kFoundMs });
      assert.match(await of.text_of(page, "strip-state"), /Not found/);
      await page.waitForFunction(() => Number(/FLIP \S+, (\d+)/.exec(
          document.getElementById("strip-watch").textContent)?.[1]) >= 64, null, { timeout: kFoundMs });
      await page.locator("#scene").selectOption("figures");
    },
    5.5: async (page) => {
      await tab(page, "shader");
      await page.locator("#shader-gpu").click();
    },
  };

  const state_is = (page, words) => page.waitForFunction(
      (wanted) => document.getElementById("step-state").textContent === wanted, words, { timeout: kFoundMs });

  async function walk(page, number) {
    await tab(page, "lessons");
    await page.waitForSelector("#lesson-step:not([hidden])");
    await page.locator("#lesson").selectOption(`${number}.1`);
    const keys = Object.keys(kDeeds).filter((key) => key.startsWith(`${number}.`));
    for (const key of keys) {
      assert.ok((await of.text_of(page, "step-title")).startsWith(key), key);
      assert.doesNotMatch(await of.text_of(page, "lesson-step"), /\*\*|\]\(|<\/?details|`/, `${key}: Markdown`);
      if (kDeeds[key]) assert.strictEqual(await of.text_of(page, "step-state"), "Not found yet.", key);
      if (await page.locator("#step-set").isVisible()) {
        await page.locator("#step-set").click();
        await page.waitForSelector("#step-set:not([aria-disabled])");
        await drawn(page);
      }
      if (kDeeds[key]) {
        await not_found(page).catch((error) => { throw new Error(`${key}: set up: ${error.message}`); });
        await kDeeds[key](page);
      }
      await state_is(page, "✓ Found.").catch(() => { throw new Error(`${key} is never found`); });
      if (await page.locator("#strip-back").isVisible()) await page.locator("#strip-back").click();
      if (key !== "5.5") await page.locator("#step-next").click();
    }
    const [words] = await page.locator("#lesson option:checked").allTextContents();
    if (number === 5) assert.match(words, /\(5 of 5\)/);
  }

  for (const number of has("softfocus-compiler.wasm") ? [1, 2, 3, 4, 5] : [1, 2, 3, 4]) {
    test(`lesson ${number} can be gone through, and each step knows when it is found`, (page) => walk(page, number));
  }

  test("what another scene shows does not find a step", async (page) => {
    await set_number(page, "max-coc-part", 21);  // cuts no circle of Figures, and is less than a pixel too large
    await drawn(page);
    await tab(page, "lessons");
    await page.waitForSelector("#lesson-step:not([hidden])");
    await page.locator("#lesson").selectOption("2.1");
    await page.locator("#step-list button").nth(1).click();
    await page.waitForFunction(() => document.getElementById("step-watch").textContent === "no circle is cut");
    await not_found(page);
  });

  if (single_file) {
    test("the page in one file has the lessons", async (page) => {
      await page.goto(pathToFileURL(single_file).href);
      await drawn(page);
      await tab(page, "lessons");
      await page.waitForSelector("#lesson-step:not([hidden])");
      await page.locator("#step-set").click();
      await page.waitForSelector("#step-set:not([aria-disabled])");
      await drawn(page);
      await kDeeds["1.1"](page);
      await state_is(page, "✓ Found.");
    });
  }

  if (of_network && has("softfocus-simd.wasm")) {
    test("served to the network the page has one thread, and the same bits", async (page) => {
      const hash = await drawn(page);
      const { server, address } = await serve(folder);
      try {
        assert.ok(address.includes(of_network), address);
        await page.goto(`${address}#scene=figures`);
        assert.strictEqual(await drawn(page), hash);
        assert.match(await of.text_of(page, "version"), /one thread/);
      } finally {
        server.removeAllListeners("exit");
        server.kill();
      }
    });
  }

  test("the keyboard alone reaches the lessons and goes through them", async (page) => {
    await page.locator("#tab-lens").focus();
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("ArrowLeft");
    await page.waitForSelector("#lesson-step:not([hidden])");
    const press_on = async (id) => {
      for (let i = 0; i < 40; ++i) {
        if (await page.evaluate(() => document.activeElement.id) === id) return page.keyboard.press("Enter");
        await page.keyboard.press("Tab");
      }
      throw new Error(`Tab does not come to ${id}`);
    };
    await press_on("step-set");
    await drawn(page);
    await press_on("step-next");
    const focused = await page.evaluate(() => document.activeElement.textContent);
    assert.ok(focused.startsWith("1.2"), focused);
  });

  test("on a phone the step goes along while its text is out of sight", async (page) => {
    await tab(page, "lessons");
    await page.waitForSelector("#lesson-step:not([hidden])");
    await page.locator("#step-set").tap();
    await page.locator("#focus-part").scrollIntoViewIfNeeded();
    await page.waitForSelector("#lesson-strip:not([hidden])");
    assert.match(await of.text_of(page, "strip-title"), /^1\.1/);
    await page.locator("#strip-back").click();
    await page.waitForSelector("#lesson-strip", { state: "hidden" });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 390));
  }, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });

  test("a link opens a lesson; what was found is kept, and can be forgotten", async (page, { context, address }) => {
    const other = await context.newPage();
    await other.goto(`${address}#lesson=4.3`);
    await other.waitForSelector("#lesson-step:not([hidden])");
    assert.ok((await of.text_of(other, "step-title")).startsWith("4.3"));
    await drawn(other);
    await other.locator("#half-value").fill("2049");
    await state_is(other, "✓ Found.");
    await other.close();
    await tab(page, "lessons");
    await page.locator("#lesson").selectOption("4.1");
    await page.locator("#step-set").click();
    await state_is(page, "✓ Found.");
    assert.match(await page.locator("#lesson option:checked").textContent(), /\(2 of 6\)/);
    await page.locator("#step-list button").nth(2).click();
    assert.strictEqual(await of.text_of(page, "step-state"), "✓ Found.");
    await page.locator("#lessons-anew").click();
    assert.match(await page.locator("#lesson option:checked").textContent(), /\(0 of 8\)/);
  });
};
