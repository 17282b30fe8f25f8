// The frame's hash, the command and the file that give the same bits, and all golden hashes
// against the table that every machine must match.

import { announce, by_id, copy_text, element, save_text, show_error } from "../dom.js";
import { kBackground } from "../engine.js";
import { lens_keys, parameters, seldom_set } from "../state.js";
import { depth_words, kCircles } from "./picture.js";

const kSlice = 8;  // golden hashes a request

/** Whether only a scene's file can say what the command line cannot: a camera, a model of one's own. */
function needs_file(state) {
  if (state.picture) return false;
  return Boolean(state.camera) || state.scene.startsWith("/own/");
}

function lens_words({ picture: { size } }, side) {
  const pixel = side.focus.at?.map((part, axis) => Math.min(
      size[axis] - 1, Math.floor(part * size[axis])));
  const others = lens_keys().filter((key) => key !== "focus_m");
  return [pixel ? `--focus-at ${pixel.join(",")}` : `--focus ${side.focus.m}`,
          ...[...others, "coc_scale"].map((key) => `--${parameters[key].name} ${side[key]}`)];
}

/** Of the aperture what the method has; of highlights both numbers. */
function seldom_words(side, { methods }) {
  const of_method = methods.find(({ name }) => name === side.method);
  const set = seldom_set(side);
  const aperture = of_method?.stretch ? set.filter((key) => !key.startsWith("highlight")) : [];
  const gain = set.includes("highlight_gain")
      ? [`--highlights ${side.highlight_gain},${side.highlight_threshold}`] : [];
  return [...aperture.map((key) => `--${parameters[key].name} ${side[key]}`), ...gain];
}

const name_of = (path) => {
  const name = path.replace(/^.*\//, "");
  return /^[\w.+-]+$/.test(name) ? name : `'${name.replaceAll("'", "'\\''")}'`;
};

/**
 * The command for a picture whose --json tells the same picture_hash, or null if there is none.
 * `listing` is the `scenes` reply.
 */
export function refocus_command(state, side, listing) {
  const { picture } = state;
  if (!side.dof) return null;
  const show = state.show === "coc" || state.show === "depth" ? [`--show ${state.show}`] : [];
  const has_circles = picture.encoding === kCircles;
  const depth = picture.depth ? [name_of(picture.depth)] : [];
  const files = has_circles ? [`--circles ${name_of(picture.depth ?? state.scene)}`] : depth;
  return ["softfocus refocus", name_of(state.scene), ...files,
          "-o picture.png --json", ...depth_words(picture, listing), ...show,
          `--method ${side.method}`, ...seldom_words(side, listing), ...(has_circles ? [] : lens_words(state, side)),
          ...(side.max_coc_px === null ? [] : [`--max-coc ${side.max_coc_px}`])].join(" ");
}

function command_note(state, command) {
  if (state.picture) {
    return command ? "This command’s picture_hash is the same, beside your own files."
                   : "Without depth of field it is the file itself.";
  }
  if (state.failure) return "No command draws a case alone; softfocus stress draws them all.";
  if (!command) return "No command has the moved camera of a random scene.";
  if (!needs_file(state)) return "This command’s picture_hash is the same.";
  return "This command’s picture_hash is the same, with the scene’s file that is saved here" +
         (state.scene.startsWith("/own/") ? ", beside your own files." : ".");
}

export function show_hash(reply, state, side, listing) {
  const has_lens = !state.picture || reply.focus_m;
  const found = state.picture ? refocus_command(state, side, listing) : reply.command;
  const command = reply.hash && has_lens ? found : null;
  by_id("hash").textContent = reply.hash ?? "–";
  by_id("hash-full").textContent = reply.hash ?? "–";
  by_id("command").textContent = command ?? "";
  by_id("command-note").textContent = reply.hash ? command_note(state, command)
                                                 : "A moving or coarse picture has no hash.";
  by_id("copy-command").disabled = !command;
  by_id("save-scene").disabled = Boolean(state.failure) || Boolean(state.picture) || state.scene.startsWith("random:");
}

async function save_scene(engine) {
  const { reply } = await engine.ask({ do: "file", name: "scene.toml" });
  if (reply.error) show_error(reply.error);
  else save_text("scene.toml", reply.text, "application/toml");
}

export function start_hashes({ engine }) {
  const button = by_id("selftest");
  const progress = by_id("selftest-progress");
  const state = by_id("selftest-state");
  const table = by_id("selftest-table");
  let running = false;

  function row_of({ name, hash, wanted_end }) {
    return element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, hash ?? "none"),
                   element("td", {}, wanted_end ? `…${wanted_end}` : "none"));
  }

  async function compare() {
    running = true;
    button.textContent = "Stop";
    progress.hidden = false;
    table.parentElement.hidden = true;
    const body = element("tbody");
    const head = ["Hash of", "here", "wanted"].map((word) => element("th", { scope: "col" }, word));
    table.replaceChildren(element("thead", {}, element("tr", {}, ...head)), body);
    let first = 0;
    let total = 1;
    let differing = 0;
    while (running && first < total) {
      const { reply } = await engine.ask({ do: "selftest", first, count: kSlice }, kBackground);
      if (reply.cancelled) continue;
      if (reply.error) {
        state.textContent = reply.error;
        break;
      }
      if (reply.results.length === 0) break;
      total = reply.total;
      first += reply.results.length;
      for (const result of reply.results) {
        if (result.equal) continue;
        differing++;
        table.parentElement.hidden = false;
        body.append(row_of(result));
      }
      progress.value = first / total;
      state.textContent = `${first} of ${total}, ${differing === 0 ? "all equal so far"
                                                                  : `${differing} differ`}`;
    }
    if (running && first === total) {
      state.textContent = differing === 0 ? `All ${total} hashes are equal to the native ones.`
                                          : `${differing} of ${total} hashes differ.`;
    }
    announce(state.textContent);
    running = false;
    progress.hidden = true;
    button.textContent = "Compare all golden hashes";
  }

  by_id("save-scene").addEventListener("click", () => save_scene(engine));
  button.addEventListener("click", () => {
    if (running) running = false;
    else compare();
  });
  by_id("copy-command").addEventListener("click", async () => {
    const copied = await copy_text(by_id("command").textContent);
    announce(copied ? "The command is copied." : "The browser does not allow copying.");
    if (copied) {
      const word = by_id("copy-command");
      word.textContent = "Copied";
      setTimeout(() => { word.textContent = "Command"; }, 1500);
    }
  });
}
