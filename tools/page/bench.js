// Times the page's frames in headless Chromium beside the program's and WebGL2's, in turn:
//
//   node bench.js FOLDER PROGRAM [ROUNDS]
//
// FOLDER is what tools/simulator builds, PROGRAM build/softfocus. Needs playwright-core (NODE_PATH)
// and Chromium (CHROMIUM, else `chromium`). The frame is drawing and two-pass, radius 16. Each
// round takes the median of each side; the ratios are of the rounds.
"use strict";

const { execFileSync, spawn } = require("child_process");
const path = require("path");
const { chromium } = require("playwright-core");

const [folder, program, rounds = "7"] = process.argv.slice(2);
const kScenes = ["figures", "cube-room", "sphere-world"];
const kMaxCoc = 16;
const kPageFrames = 20;
const kGlFrames = 3;

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

function of_rounds(values) {
  const text = (value) => value.toFixed(value < 10 ? 2 : 1);
  return `${text(median(values))} (${text(Math.min(...values))}-${text(Math.max(...values))})`;
}

async function serve() {
  const server = spawn(process.execPath, [path.join(__dirname, "serve.js"), folder, "0"]);
  const said = await new Promise((done, fail) => {
    server.stdout.once("data", (bytes) => done(String(bytes)));
    server.once("exit", () => fail(new Error("serve.js ended")));
  });
  return { server, address: said.match(/http:\S+/)[0] };
}

/** A worker in a page of its own: a function that answers a request, and the build it runs. */
async function start_worker(browser, address, threads) {
  const context = await browser.newContext();
  await context.route("**/bench.html", (route) => route.fulfill({
    contentType: "text/html", body: "<!doctype html><title>bench</title>",
    headers: { "Cross-Origin-Opener-Policy": "same-origin",
               "Cross-Origin-Embedder-Policy": "require-corp" },
  }));
  if (threads === 1) {
    await context.route("**/worker.js", async (route) => {
      const response = await route.fetch();
      const alone = "Object.defineProperty(globalThis, 'crossOriginIsolated', { value: false });\n";
      await route.fulfill({ response, body: alone + await response.text() });
    });
  }
  const page = await context.newPage();
  await page.goto(`${address}bench.html`);
  const build = await page.evaluate(() => new Promise((done, fail) => {
    const worker = new Worker("worker.js");
    globalThis.ask_worker = (request) => new Promise((answered) => {
      const begin = performance.now();
      worker.onmessage = ({ data }) => answered({ ...data.reply, ms: performance.now() - begin });
      worker.postMessage({ id: 1, request });
    });
    worker.onmessage = ({ data }) => (data.ready ? done(data.build) : fail(new Error(data.failed)));
  }));
  const ask = async (request) => {
    const reply = await page.evaluate((asked) => globalThis.ask_worker(asked), request);
    if (reply.error) throw new Error(reply.error);
    return reply;
  };
  return { ask, build };
}

let frames = 0;

/** Each at a time of its own, though they look alike: the module keeps what it has drawn. */
function frame_request(side) {
  return { do: "frame", size: [side, side], method: "two-pass", max_coc_px: kMaxCoc,
           time: 1e-6 * ++frames, hash: false };
}

async function page_ms(ask, side) {
  const work = [], shown = [];
  for (let i = 0; i < kPageFrames; ++i) {
    const reply = await ask(frame_request(side));
    work.push(reply.draw_ms + reply.filter_ms);
    shown.push(reply.ms);
  }
  return { work: median(work), shown: median(shown) };
}

async function gl_ms(ask, side) {
  const times = [];
  for (let i = 0; i < kGlFrames; ++i) {
    const request = { ...frame_request(side), do: "gl_frame", gl_show: "difference" };
    const reply = await ask(request);
    times.push(reply.draw_ms + reply.filter_ms);
  }
  return median(times);
}

function native_ms(scene, side, threads) {
  const said = execFileSync(program, [
    "bench", scene, "--size", `${side}x${side}`, "--max-coc", String(kMaxCoc), "--isa", "baseline",
    "--threads", String(threads), "--runs", "15", "--json"], { encoding: "utf8" });
  return JSON.parse(said).stages.find(({ name }) => name === "frame").median_ms;
}

async function measure(workers, scene, side, threads) {
  const { ask } = workers[threads];
  await ask({ do: "open", scene });
  await page_ms(ask, side);
  const gl = side === 512 && threads > 1;
  if (gl) await ask({ do: "gl_open" });
  const rows = [];
  for (let round = 0; round < Number(rounds); ++round) {
    const page = await page_ms(ask, side);
    rows.push({ ...page, native: native_ms(scene, side, threads), gl: gl ? await gl_ms(ask, side) : NaN });
  }
  const of = (figure) => of_rounds(rows.map(figure));
  console.log([
    `${scene} ${side}x${side}`.padEnd(24), String(threads).padEnd(8),
    of((row) => row.work).padEnd(18), of((row) => row.native).padEnd(18),
    of((row) => row.work / row.native).padEnd(18), of((row) => 1000 / row.shown).padEnd(18),
    gl ? of((row) => row.gl / row.work) : ""].join(" ").trimEnd());
}

async function main() {
  const { server, address } = await serve();
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  try {
    const many = await start_worker(browser, address, 0);
    const about = await many.ask({ do: "about" });
    const workers = { 1: await start_worker(browser, address, 1), [about.threads]: many };
    console.log(`Drawing and two-pass, radius ${kMaxCoc}; medians of ${rounds} rounds (least-largest)`);
    console.log(["frame".padEnd(24), "threads".padEnd(8), "page, ms".padEnd(18),
                 "native, ms".padEnd(18), "page / native".padEnd(18),
                 "shown a second".padEnd(18), "WebGL2 / page"].join(" "));
    for (const side of [512, 1024]) {
      for (const threads of Object.keys(workers).map(Number)) {
        for (const scene of kScenes) await measure(workers, scene, side, threads);
      }
    }
  } finally {
    server.removeAllListeners("exit");
    server.kill();
    await browser.close();
  }
}

main().catch((error) => {
  console.error(String(error.message ?? error));
  process.exit(1);
});
