// The page: starts everything and joins it. The state (state.js) is the one truth; controls,
// pointer and link change it, and everything shown follows from it and from the last frame.

import { make_cases } from "./panels/cases.js";
import { turned_light } from "./camera.js";
import { start_compare_view } from "./panels/compare_view.js";
import { make_controls } from "./controls.js";
import { announce, by_id, copy_text, element, show_error } from "./dom.js";
import { kAsked, start_engine } from "./engine.js";
import { make_frames, picture_key } from "./frames.js";
import { start_gpu } from "./panels/gpu.js";
import { show_hash, start_hashes } from "./panels/hashes.js";
import { start_keys } from "./keys.js";
import { start_kept } from "./panels/kept.js";
import { lens_numbers, start_lens_view } from "./lens/lens_view.js";
import { start_lessons } from "./lessons/lessons.js";
import { link_of, read_link, shader_of, state_to_open, take_shader, with_link } from "./link.js";
import { make_methods_table } from "./panels/methods_table.js";
import { start_own_files } from "./panels/own_files.js";
import { advice_here, kNoScene, make_picture, picture_request } from "./panels/picture.js";
import { locked_fov_degrees } from "./lens/photographer.js";
import { start_pointer } from "./pointer.js";
import { save_report, shown_ms } from "./panels/report.js";
import { start_shader } from "./panels/shader.js";
import { first_state, kFirstScene, kMaps, kThesisScenes, make_store, parameters, set_parameters, with_picture, with_scene } from "./state.js";
import { start_tabs } from "./tabs.js";
import { start_theme } from "./theme.js";
import { start_tips } from "./tips.js";
import { make_truth } from "./panels/truth.js";
import { limit_text, metres_text, ms_text, three_digits } from "./units.js";

const kFrameMs = 1000 / 30;  // of the animation, at least
const kMostSeed = 2n ** 64n - 1n;
const kRestartMs = 20000;    // a module that stops twice in this time is not started a third time

const store = make_store(first_state());
const known_focus_m = [1, 1];     // of each side, as whole frames told it
const known_max_coc = [16, 16];
let opened = null;   // the reply of the last open
let last_reply = null;
let build = "";
let listing = { scenes: [], cases: [], methods: [], encodings: [], readings: [] };
let playing = false;
let quit = false;
/** The visitor's scenes and pictures, by their path: {what, read}; `read` reads the files once more. */
const own = new Map();
let own_link = null;   // {path, words, wanted}: a link to a file that is not here
let shown = null;      // the last state of which there was a frame
let on_trial = null;   // what was opened and has had no frame yet: {what, words, before}

const engine = start_engine({
  on_ready: start,
  on_failed: (line) => {
    by_id("over").textContent = line;
    by_id("over").hidden = false;
    show_error(line);
  },
  on_restarted: reopen,
});

const camera = () => (opened && !store.get().failure && !store.get().picture
    ? store.get().camera ?? opened.camera : null);
const focus_m = () => store.side().focus.m ?? known_focus_m[store.get().editing];
const max_coc = () => store.side().max_coc_px ?? known_max_coc[store.get().editing];
const object_m = () => store.get().object_m ?? 1.5 * focus_m();
const move = (next) => store.change({ camera: next });

const view = start_compare_view(store);
const lens_view = start_lens_view(store);
const scene_look = () => (opened && !store.get().failure && !store.get().picture
    ? opened.look ?? null : null);
const controls = make_controls({ store, camera, move, focus_m, max_coc, object_m, scene_look });

/** Turns the light, if dragging is to move it. A point's light goes around what the camera sees. */
function turn_light(right, up) {
  const has = scene_look();
  if (!by_id("light-drag").checked || !has?.light) return false;
  const middle = has.light_kind === "point" ? camera().target_m : [0, 0, 0];
  const light = store.get().look.light ?? has.light;
  controls.change_look({ light: turned_light(light, middle, right, up) });
  return true;
}

const counted = (number) => number.toLocaleString("en");
function show_shadow_counts({ shadows }) {
  by_id("shadow-counts").textContent = shadows
    ? `${counted(shadows.triangles)} triangles, ${counted(shadows.casters)} casters, ` +
      `${counted(shadows.receivers)} receivers, ${counted(shadows.projected)} projected triangles, ` +
      `${counted(shadows.volumes)} casters of volumes; ${ms_text(shadows.ms)} ms for lights that moved`
    : "";
}
const frames = make_frames({
  engine, store,
  moving: () => playing,
  paint: (side, reply, pixels, { show }, preview) => {
    by_id("over").hidden = true;
    view.paint(side, show, reply, pixels, preview);
  },
  on_frame,
  on_error: (line) => {
    if (line && on_trial) go_back(advice_here(line));
    else show_error(advice_here(line), "frame");
  },
  on_settled: (settled) => {
    by_id("picture").setAttribute("aria-busy", String(!settled));
    if (settled) settling.splice(0).forEach((done) => done());
  },
});
const settling = [];  // told when no frame is wanted any more

/** The whole picture, filtered, which is what methods are measured by; false if there is none. */
async function picture_shown() {
  if (hindrance()) {
    store.change({ show: "image" });
    store.change_side({ dof: true });
    await null;  // the store has told of it
  }
  if (!frames.settled()) await new Promise((done) => settling.push(done));
  return frames.settled();
}

/** Why what is shown has no truth, or null. */
function hindrance() {
  const { show } = store.get();
  if (kMaps.includes(show)) return "waits for the picture: choose Picture under it";
  return show === "image" && !store.side().dof ? "waits for depth of field, which is off" : null;
}

const truth = make_truth({
  engine, hindrance,
  settled: () => frames.settled() && !hindrance(),
  shown: () => {
    const { show } = store.get();
    return show === "truth" || show === "error" ? show : null;
  },
  paint: (kind, reply, pixels) => view.paint_over(store.get(), kind, reply, pixels),
  on_done: show_answer,
  on_error: show_error,
});

/** A failure case's known answer, beside its picture. */
async function show_answer(done) {
  const has_answer = Boolean(done && store.get().failure);
  const answer = has_answer ? await engine.ask({ do: "truth", show: "truth" }, kAsked) : null;
  const is_here = answer?.pixels && frames.settled() && truth.numbers() === done;
  cases.show_answer(is_here ? answer : null);
}
let methods_table = { renew() {} };
let cases = { show() {}, show_answer() {} };
let picture = { show() {} };
const gpu = start_gpu({ engine, store, settled: frames.settled });
const shader = start_shader({
  engine, store, settled: frames.settled, want_truth: () => truth.want(true),
});
const tabs = start_tabs(document.querySelector("[role=tablist]"), (id) => {
  if (id === "tab-lens") show_lens();
  if (id === "tab-shader") shader.open();
});

function shown_lens() {
  const state = store.get();
  const size = state.picture?.size ?? state.size;
  const fov = last_reply?.fov_y_degrees ?? camera()?.fov_y_degrees ?? opened?.camera?.fov_y_degrees;
  return lens_numbers({ ...state, size }, { ...store.side(), max_coc_px: max_coc() }, focus_m(), object_m(),
                      fov ?? 40);
}

const show_lens = () => lens_view.show(shown_lens());

start_lessons({
  world: () => ({ state: store.get(), side: store.side(), lens: shown_lens(), frame: last_reply,
                  truth: truth.numbers(), settled: frames.settled() }),
  set_up: open_link,
  want_truth: () => truth.want(true),
  tabs,
});

function show_cross() {
  const { at } = store.side().focus;
  const cross = by_id("cross");
  cross.toggleAttribute("hidden", !at || !opened);
  if (!at) return;
  cross.style.left = `${100 * at[0]}%`;
  cross.style.top = `${100 * at[1]}%`;
}

// A locked field of view follows the focal length, the focus, the sensor and the shape.
function keep_locked_fov() {
  const now = camera();
  const wanted = locked_fov_degrees(store.get(), { ...store.side(), focus_m: focus_m() });
  if (!now || wanted === null) return;
  const { least, most } = parameters.fov_y_degrees;
  const degrees = Math.min(most, Math.max(least, wanted));
  if (Math.abs(now.fov_y_degrees - degrees) > 1e-4 * degrees) move({ ...now, fov_y_degrees: degrees });
}

let link_timer = 0;
function keep_link() {
  clearTimeout(link_timer);
  link_timer = setTimeout(() => {
    try {
      if (opened && !own_link) history.replaceState(null, "", `#${link_of(store.get())}`);
    } catch {
      // Browsers allow a number of these a minute; the next change tries again.
    }
  }, 400);
}

store.listen((state, before) => {
  keep_locked_fov();
  show_speed();
  controls.update();
  view.update(state);
  show_cross();
  if (!by_id("lens-panel").hidden) show_lens();
  by_id("time").value = String(state.time);
  show_scene_choice(state);
  by_id("seed-part").hidden = !state.scene?.startsWith("random:");
  cases.show(state.failure);
  picture.show(state.picture, opened?.picture);
  keep_link();
  const changed = picture_key(state) !== picture_key(before) || state.editing !== before.editing;
  if (changed || state.show !== before.show) {
    frames.want(state.time === before.time && state.show === before.show);
    if (changed) {
      truth.renew();
      methods_table.renew();
    }
  }
  // After the frame, for the one before may be a map, which has no truth.
  const measured = state.show === "truth" || state.show === "error" ||
                   (state.failure && state.failure !== before.failure);
  if (measured && !truth.wanted()) truth.want(true);
});

function keep_known({ focus_m: focus, max_coc_px: radius }, side) {
  if (focus === known_focus_m[side] && radius === known_max_coc[side]) return;
  known_focus_m[side] = focus;
  known_max_coc[side] = radius;
  keep_locked_fov();
  controls.update();
  if (!by_id("lens-panel").hidden) show_lens();
}

/** Of whole frames of the present setting, as the report has it. */
function show_speed() {
  const ms = shown_ms(frames.timings());
  const text = `${three_digits(1000 / ms)} fps · ${Number.isNaN(ms) ? "–" : ms_text(ms)} ms`;
  by_id("speed").textContent = text;
  if (!quit) document.title = `${text} · softfocus`;
}

function on_frame(reply, coarse, state, wall_ms) {
  last_reply = { ...last_reply, ...reply };
  shown = state;
  on_trial = null;
  show_speed();
  by_id("speed").title = `draw ${ms_text(reply.draw_ms)} ms, filter ${ms_text(reply.filter_ms)} ms` +
                         `${coarse ? ", coarse" : ""}`;
  if (reply.focus_m && !coarse) keep_known(reply, state.editing);
  show_hash(reply, state, state.sides[state.editing], listing);
  show_shadow_counts(reply);
  if (playing) {
    setTimeout(() => { if (playing) step(); }, Math.max(0, kFrameMs - wall_ms));
  } else if (!coarse && reply.hash === null) {
    frames.want(false);  // it was asked for while the animation played
  } else if (!coarse) {
    truth.show();
    truth.go();
  }
}

function show_scene_choice({ scene, failure }) {
  const select = by_id("scene");
  select.options[0].textContent = failure ? `Case ${failure.name}` : "Failure case";
  select.value = failure ? "" : scene?.startsWith("random:") ? "random" : scene ?? "";
}

function open_request(what) {
  if (what.picture) {
    return picture_request(what.scene, what.picture, listing, opened?.picture?.believed);
  }
  return what.failure ? { do: "open", case: what.failure.name, value: what.failure.value }
                      : { do: "open", scene: what.scene };
}

// In a new module, what was open is opened again, with its files. What stops the module twice is
// left alone.
let restarted_at = -Infinity;
async function reopen() {
  const soon = performance.now() - restarted_at < kRestartMs;
  restarted_at = performance.now();
  if (!opened) return;
  frames.set_open(false);
  if (soon) {
    show_error("the module stopped again; reset the settings or choose another scene");
    return;
  }
  await shader.again();
  const state = store.get();
  const files = await files_of(own.get(state.scene)?.read);
  const { reply } = await engine.ask(open_request(state), kAsked, files ?? []);
  if (reply.error) show_error(`${reply.error}; choose another scene`);
  frames.set_open(!reply.error);
  frames.want(false);
  truth.renew();
}

/** The files that `read` gives, none without one, or null, and a line that says what to do. */
async function files_of(read) {
  try {
    return read ? await read() : [];
  } catch (error) {
    show_error(`${error.message}; drop the files once more, a folder as a whole`);
    return null;
  }
}

/** Back to what had a picture, for what is open has none. */
async function go_back(line) {
  const { what, words, before } = on_trial;
  on_trial = null;
  const { scene, failure } = what;
  if (before) await open(before, { state: before, read: own.get(before.scene)?.read });
  else if (words?.size) await open({ scene, failure }, { words: new Map() });
  else if (scene !== kFirstScene) await open({ scene: kFirstScene }, { words: new Map() });
  show_error(before ? `${line}; what was open before is here again` : line);
}

let turn = Promise.resolve();
let newest = 0;

/**
 * Opens a scene or case; what is there stays if it cannot be. `words` are a link's, `read` reads
 * the visitor's files, `state` is all else that is wanted. Resolves to warnings, or to null. Of
 * several that wait the newest alone is opened.
 */
function open(what, options = {}) {
  const mine = ++newest;
  const run = () => (mine === newest ? open_now(what, options) : null);
  turn = turn.then(run, run);
  return turn;
}

async function open_now(what, { words = null, read = null, state = null }) {
  on_trial = null;
  const files = await files_of(read);
  if (!files) {
    show_scene_choice(store.get());
    return null;
  }
  if (quit) set_quit(false);
  frames.set_open(false);
  const { reply } = await engine.ask(open_request(what), kAsked, files);
  if (reply.error) {
    show_error(advice_here(reply.error));
    frames.set_open(Boolean(opened));
    frames.want(false);
    controls.update();
    show_scene_choice(store.get());
    return null;
  }
  show_error("");
  opened = reply;
  own_link = null;
  const again = read ?? own.get(what.scene)?.read;
  if (again) own.set(what.scene, { what: { scene: what.scene, picture: what.picture ?? null }, read: again });
  last_reply = null;
  by_id("over").textContent = "Drawing…";
  on_trial = state ? null : { what, words, before: shown };
  // Another severity of the same case, or another reading of the same depth, keeps the setting.
  const before = words ? { ...first_state(), ...what } : store.get();
  const same = what.failure ? before.failure?.name === what.failure.name
      : what.picture && before.picture && !read;
  let next = { ...before, scene: what.scene ?? null, failure: what.failure ?? null,
               picture: what.picture ?? null };
  if (!same || words) next = with_scene(next, reply);
  if (next.picture) next = with_picture(next, reply.picture, listing.methods);
  if (words) next = with_link(next, words);
  if (state) next = state;
  if (!reply.look?.backdrop_m) next = { ...next, look: { ...next.look, backdrop_m: null } };
  next.sides.forEach((_, index) => { known_focus_m[index] = reply.lens.focus_m; });
  for (const id of ["play", "step", "time"]) by_id(id).disabled = is_still();
  by_id("camera-home").disabled = Boolean(what.failure || what.picture);
  set_playing(false);
  store.set(next);
  await null;  // the store has told of it: one frame is enough
  frames.want(false);
  frames.set_open(true);
  truth.renew();
  announce(`${reply.title ?? "The scene"} is open.`);
  show_own_scene(next.scene);
  const warnings = reply.warnings ?? [];
  if (reply.picture?.lacks) show_error(advice_here(reply.picture.lacks));
  if (warnings.length > 0) show_error(advice_here(warnings.slice(0, 3).join(" · ")));
  return warnings;
}

/** Opens the visitor's files, by a link's words if it has named them. */
function open_own(what, read) {
  if (own_link?.path !== what.scene) return open(what, { read });
  return open({ ...own_link.wanted, ...what }, { words: own_link.words, read });
}

function show_own_scene(scene) {
  const select = by_id("scene");
  if (!scene?.startsWith("/own/")) return;
  if (![...select.options].some(({ value }) => value === scene)) {
    select.append(element("option", { value: scene }, scene.slice(5)));
  }
  select.value = scene;
}

const is_still = () => !opened?.animation_frames;

function set_playing(on) {
  playing = on && !quit && !is_still();
  by_id("play").textContent = playing ? "Pause" : "Play";
  if (playing) step();
  else if (opened && !last_reply?.hash) frames.want(false);
}

function step(count = 1) {
  if (is_still()) return;
  store.change({ time: Math.max(0, store.get().time + count) });
}

function set_quit(on) {
  quit = on;
  set_playing(false);
  frames.pause(on);
  truth.pause(on);
  engine.pause(on);
  by_id("quit").setAttribute("aria-pressed", String(on));
  by_id("over").textContent = "Paused. Press Q to go on.";
  by_id("over").hidden = !on;
  if (on) document.title = "softfocus, paused";
}

function reset() {
  if (!opened) return;
  const fresh = { ...first_state(), scene: store.get().scene, failure: store.get().failure,
                  picture: store.get().picture, shader: store.get().shader };
  store.set(with_scene(fresh, opened));
  if (performance.now() - restarted_at < kRestartMs) {
    restarted_at = -Infinity;
    reopen();
  }
  announce("All settings are the scene’s again.");
}

function toggle_show(kind) {
  if (store.get().picture && (kind === "truth" || kind === "error")) {
    show_error(kNoScene);
    return;
  }
  store.change({ show: store.get().show === kind ? "image" : kind });
}

async function report() {
  const { reply } = await engine.ask({ do: "file", name: "report.txt" }, kAsked);
  if (reply.error) {
    show_error(reply.error);
    return;
  }
  save_report({ state: store.get(), timings: frames.timings(), build, own: reply.text,
                address: location.href.replace(/#.*/, "") });
}

async function copy_link() {
  const address = `${location.href.replace(/#.*/, "")}#${link_of(store.get())}`;
  const copied = await copy_text(address);
  by_id("copy-link").firstChild.textContent = copied ? "Copied " : "See the address ";
  setTimeout(() => { by_id("copy-link").firstChild.textContent = "Copy link "; }, 1500);
  announce(copied ? "The link is copied." : "The link is in the address bar.");
}

let asking_pixel = false;
async function point_at(place) {
  if (!place) by_id("pixel").textContent = "\u00a0";
  if (place && by_id("focus-follow").checked) focus_at(place);
  if (!place || asking_pixel || !frames.settled() || playing) return;
  asking_pixel = true;
  const [width, height] = [last_reply.width, last_reply.height];
  const x = Math.min(width - 1, Math.floor(place[0] * width));
  const y = Math.min(height - 1, Math.floor(place[1] * height));
  const { reply } = await engine.ask({ do: "pixel", x, y }, kAsked);
  asking_pixel = false;
  if (reply.error) return;
  const metres = reply.depth_m === null ? "∞" : metres_text(reply.depth_m);
  const depth = reply.has_depth ? ` · depth ${metres}` : "";
  const circle = reply.coc_radius_px === null || reply.coc_radius_px === undefined
      ? "" : ` · circle’s radius ${three_digits(Math.abs(reply.coc_radius_px))} px, ` +
             `${reply.coc_radius_px < 0 ? "before" : "behind"} the focus`;
  by_id("pixel").textContent =
      `${x}, ${y}${depth}${circle} · light ${reply.colour_linear.map(three_digits).join(" ")}`;
}

const focus_at = (at) => store.change_side({ focus: { at: at.map((part) => Number(part.toFixed(4))) } });
const pointer = start_pointer(by_id("picture"), {
  camera, move, turn_light, point_at, focus_at,
  focus_place: () => store.side().focus.at ?? null,
});

const nudge = (name) => (shifted) => controls.nudge(name, shifted ? -1 : 1);
const pair = (key) => [key, `Shift+${key}`];
start_keys({
  camera_key: pointer.key,
  commands: [
    { keys: ["b"], words: "Depth of field on and off", run: () => store.change_side({ dof: !store.side().dof }) },
    { keys: ["m"], words: "Map of the circles: black is sharp, orange before the focus, blue behind", run: () => toggle_show("coc") },
    { keys: ["/"], words: "Wireframe", run: () => { if (scene_look()) toggle_show("wireframe"); } },
    { keys: ["j"], words: "Next kind of shadows", run: () => controls.next_shadows() },
    { keys: ["i"], words: "Dragging and the arrows move the light, or the camera", run: () => by_id("light-drag").click() },
    { keys: ["y"], words: "Textures on and off", run: () => by_id("textures").click() },
    { keys: ["z"], words: "Map of the depth", run: () => toggle_show("depth") },
    { keys: ["r"], words: "Next resolution", run: () => controls.next_size() },
    { keys: ["l"], shown: pair("L"), words: "Focal length up, down", repeats: true, run: nudge("focal-length") },
    { keys: ["n"], shown: pair("N"), words: "f-number up, down", repeats: true, run: nudge("f-number") },
    { keys: ["f"], shown: pair("F"), words: "Focus farther, nearer", repeats: true, run: nudge("focus") },
    { keys: ["c"], words: "Focus at the centre", run: () => store.change_side({ focus: { at: [0.5, 0.5] } }) },
    { keys: ["x"], shown: pair("X"), words: "Filter size up, down", repeats: true, run: nudge("max-coc") },
    { keys: ["k"], shown: pair("K"), words: "Scale of the circles up, down", repeats: true, run: nudge("coc-scale") },
    { keys: ["v"], words: "Two settings side by side", run: () => controls.compare(store.get().sides.length < 2) },
    { keys: ["t"], words: "The truth", run: () => toggle_show("truth") },
    { keys: ["e"], words: "Map of the error against the truth", run: () => toggle_show("error") },
    { keys: ["g"], words: "Draw on your GPU", run: () => { tabs.choose("tab-gpu"); gpu.draw(); } },
    { keys: [" "], shown: ["Space"], words: "Play and pause the animation", run: () => set_playing(!playing) },
    { keys: ["."], words: "One frame on", repeats: true, run: () => step() },
    { keys: [","], words: "One frame back", repeats: true, run: () => step(-1) },
    { keys: ["h"], words: "The scene’s own camera", run: () => store.change({ camera: null }) },
    { keys: ["p"], words: "Save the performance report", run: report },
    { keys: ["u"], words: "Copy the link", run: copy_link },
    { keys: ["o"], words: "Open a file", run: () => by_id("files").click() },
    { keys: ["0"], words: "Reset all settings", run: reset },
    { keys: ["q"], words: "Quit: pause everything, and go on", run: () => set_quit(!quit) },
    { keys: ["?"], words: "This table", run: () => tabs.choose("tab-keys") },
  ],
  others: [
    { shown: ["W", "A", "S", "D"], words: "Walk; with the picture focused also Page Up and Page Down" },
    { shown: ["+", "-"], words: "Come nearer, go back; also the wheel, or two fingers" },
    { shown: ["←", "→", "↑", "↓"], words: "In the picture: turn around the target; also by dragging" },
    { shown: ["Shift+←", "…"], words: "In the picture: move the place of focus; also a click" },
    { shown: ["Shift+drag"], words: "Shift the picture; also the right button, or two fingers" },
  ],
});

by_id("play").addEventListener("click", () => set_playing(!playing));
by_id("step").addEventListener("click", () => step());
by_id("time").addEventListener("change", (event) => {
  const time = event.target.valueAsNumber;
  const { least, most } = parameters.time;
  if (time >= least && time <= most) return store.change({ time });
  event.target.value = String(store.get().time);
  return show_error(`frame of the animation: give ${limit_text(least)} to ${limit_text(most)}`);
});
by_id("camera-home").addEventListener("click", () => store.change({ camera: null }));
by_id("reset").addEventListener("click", reset);
by_id("quit").addEventListener("click", () => set_quit(!quit));
by_id("report").addEventListener("click", report);
by_id("copy-link").addEventListener("click", copy_link);
by_id("help").addEventListener("click", () => tabs.choose("tab-keys"));
by_id("error-close").addEventListener("click", () => show_error(""));
by_id("truth-on").addEventListener("change", (event) => truth.want(event.target.checked));
by_id("scene").addEventListener("change", ({ target }) => {
  const { what, read } = own.get(target.value) ?? {};
  if (what) open(what, { read });
  else open({ scene: target.value === "random" ? `random:${by_id("seed").value}` : target.value });
});
by_id("seed").addEventListener("change", ({ target }) => {
  if (/^[0-9]+$/.test(target.value) && BigInt(target.value) <= kMostSeed) {
    open({ scene: `random:${target.value}` });
    return;
  }
  target.value = store.get().scene?.split(":")[1] ?? "1";
  show_error(`seed: give a whole number from 0 to ${kMostSeed}`);
});
by_id("seed-next").addEventListener("click", () => {
  const next = BigInt.asUintN(64, BigInt(by_id("seed").value || 0) + 1n);
  by_id("seed").value = String(next);
  open({ scene: `random:${next}` });
});
window.addEventListener("hashchange", () => open_link(location.hash));
document.addEventListener("visibilitychange", () => {
  if (document.hidden) set_playing(false);
  engine.pause(document.hidden || quit);
});
setInterval(() => { by_id("busy").hidden = frames.busy_for_ms() < 400; }, 200);
start_kept({
  link: () => link_of(store.get()),
  words: () => [store.side().dof ? store.side().method : "sharp",
                `f/${three_digits(store.side().f_number)}, ${metres_text(focus_m())}`],
  canvas: () => by_id(store.get().editing === 1 ? "canvas-b" : "canvas-a"),
  open: (link) => open_link(link),
});
start_tips();
start_theme();
start_hashes({ engine });
start_own_files({
  on_error: show_error,
  open: (path, read) => open_own({ scene: `/own/${path}` }, read),
  open_picture: (found, read) => open_own({
    scene: `/own/${found.picture}`,
    picture: { depth: found.depth && `/own/${found.depth}`, encoding: null, numbers: {}, choices: {} },
  }, read),
});

async function open_link(fragment) {
  const words = read_link(fragment);
  const carried = shader_of(words);
  const method = carried && await shader.restore(carried);
  take_shader(words, method);
  const path = words.has("own") ? `/own/${words.get("own")}` : null;
  const { what, read } = own.get(path) ?? {};
  const wanted = { ...state_to_open(words), shader: method ? { ...carried, method } : null, ...what };
  const seed = /^random:([0-9]{1,20})$/.exec(wanted.scene ?? "");
  if (seed) by_id("seed").value = seed[1];
  if (!path || what) {
    const done = await open(wanted, { words, read });
    if (done || opened) return;
  }
  let line = by_id("error-text").textContent;
  if (!opened) await open({ scene: kFirstScene }, { words: new Map() });
  if (path && !what) {
    own_link = { path, words, wanted };
    line = `the link is of your own file ${words.get("own")}, which is not here: drop it on the page again, ` +
           "with what it needs, or choose it by Open…; then the link’s settings come back";
  }
  show_error(line);
}

async function start(ready) {
  build = ready.build ?? "";
  const compiler = shader.find_compiler();
  const asked = [engine.ask({ do: "about" }), engine.ask({ do: "scenes" })];
  const about = (await asked[0]).reply;
  listing = (await asked[1]).reply;
  if (about.error || listing.error) {
    show_error(about.error ?? listing.error);
    return;
  }
  set_parameters(about.parameters, about.sensors);
  controls.start();
  by_id("time").min = parameters.time.least;
  by_id("time").max = parameters.time.most;
  const lacks = ready.missing?.length ? ` Not here: ${ready.missing.join(", ")}.` : "";
  by_id("version").textContent = `softfocus ${about.version}, ${about.isa}, ` +
                                 `${about.threads === 1 ? "one thread" : `${about.threads} threads`}.`;
  by_id("build").textContent = `Build: ${build}.${lacks}`;
  const group = (label, scenes) => element("optgroup", { label }, ...scenes.map(
      ({ name, title }) => element("option", { value: name }, title ?? name)));
  const of_thesis = kThesisScenes.map((name) => listing.scenes.find((scene) => scene.name === name)).filter(Boolean);
  by_id("scene").replaceChildren(element("option", { value: "", hidden: "" }, "Failure case"),
                                 group("The thesis’s scenes", of_thesis),
                                 group("Other scenes", listing.scenes.filter((scene) => !of_thesis.includes(scene))),
                                 element("option", { value: "random" }, "Random…"));
  by_id("scene").disabled = false;
  controls.set_methods(listing.methods);
  controls.set_effects(listing.effects ?? []);
  cases = make_cases({ cases: listing.cases, open: (name, value) => open({ failure: { name, value } }) });
  picture = make_picture({
    engine, listing,
    change: (reading) => {
      const { scene, picture: now } = store.get();
      return open({ scene, picture: { ...now, ...reading } });
    },
    stem: () => store.get().scene.replace(/^.*\//, "").replace(/\.[^.]*$/, ""),
  });
  methods_table = make_methods_table({
    engine, truth, picture_shown,
    methods: listing.methods.filter(({ kind }) => kind === "filter"),
    choose: (method, radius) => store.change_side({ method, max_coc_px: radius }),
  });
  if (shader_of(read_link(location.hash))) await compiler;
  await open_link(location.hash);
  await compiler;
  if (store.get().shader) tabs.choose("tab-shader");
}
