// The visitor's own scenes and pictures: dropped on the page or chosen. They go to the worker and
// no farther.

import { by_id, element } from "../dom.js";

const kLargestBytes = 512 * 1024 * 1024;

/** Every file below a dropped folder: [{path, file}]. */
async function files_below(entry, folder) {
  const path = folder + entry.name;
  if (entry.isFile) {
    return [{ path, file: await new Promise((done, fail) => entry.file(done, fail)) }];
  }
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    // A reader gives at most a hundred entries a time.
    const some = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (some.length === 0) return found;
    for (const child of some) found.push(...await files_below(child, `${path}/`));
  }
}

async function files_of_drop(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.length === 0) return [...transfer.files].map((file) => ({ path: file.name, file }));
  const found = [];
  for (const entry of entries) found.push(...await files_below(entry, ""));
  return found;
}

/** The file to open: a scene before a model, the one least deep before others. */
export function scene_among(paths) {
  const depth = (path) => path.split("/").length;
  const of = (ending) => paths.filter((path) => path.toLowerCase().endsWith(ending))
      .sort((a, b) => depth(a) - depth(b) || (a < b ? -1 : 1))[0];
  return of(".toml") ?? of(".glb") ?? of(".gltf") ?? of(".obj") ?? of(".ply") ?? of(".stl");
}

// The module reads a part of them, and says of the others what converts them.
const kPicture = /\.(png|jpe?g|hdr|pfm|npy|exr|tiff?|hei[cf]|avif|webp|gif|bmp|psd|dpx|p[gp]m)$/i;
const kDepthName = /depth|disp|(^|[^a-z])(z|dist|range|mist)([^a-z]|$)/i;

/**
 * The picture and its depth map: that with depth in its name, or the second of two. `depth` is null
 * if there is one file alone. Undefined if there is none, or more than two.
 */
export function picture_among(paths) {
  const files = paths.filter((path) => kPicture.test(path));
  if (files.length < 1 || files.length > 2) return undefined;
  if (files.length === 1) return { picture: files[0], depth: null };
  const says_depth = (path) => kDepthName.test(path.replace(/^.*\//, ""));
  const [first, second] = files;
  return says_depth(first) && !says_depth(second) ? { picture: second, depth: first }
                                                  : { picture: first, depth: second };
}

/**
 * `open(path, read)` opens /own/path after writing the files that `read()` resolves to, and
 * resolves to its warnings, or to null; `open_picture({picture, depth}, read)` likewise.
 */
export function start_own_files({ open, open_picture, on_error }) {
  const messages = by_id("own-messages");
  const drop = by_id("drop");

  async function take(chosen) {
    on_error("");
    if (chosen.length === 0) {
      on_error("there is no file in this: drop a scene, a model, or a picture and its depth");
      return;
    }
    const paths = chosen.map(({ path }) => path);
    const scene = scene_among(paths);
    const found = scene ? null : picture_among(paths);
    const first = scene ?? found?.picture;
    if (!first) {
      on_error("these files are no scene and no picture: give a .glb, .gltf, .obj, .ply, .stl or .toml with what " +
               "it needs, or a picture and its depth map");
      return;
    }
    const total = chosen.reduce((sum, { file }) => sum + file.size, 0);
    if (total > kLargestBytes) {
      on_error(`${Math.round(total / 1e6)} MB are too much: give at most 512 MB`);
      return;
    }
    const read = () => Promise.all(chosen.map(async ({ path, file }) => {
      const bytes = await file.arrayBuffer().catch(({ message }) => {
        throw new Error(`${path} cannot be read: ${message}`);
      });
      return { path, bytes };
    }));
    const warnings = await (scene ? open(scene, read) : open_picture(found, read));
    if (!warnings) return;
    messages.replaceChildren(
        element("li", {}, `${first} is open.`),
        ...warnings.map((warning) => element("li", { class: "warning" }, warning)));
  }

  by_id("files").addEventListener("change", (event) => {
    take([...event.target.files].map((file) => ({ path: file.webkitRelativePath || file.name,
                                                  file })));
    event.target.value = "";
  });
  by_id("open-file").addEventListener("click", () => by_id("files").click());

  let inside = 0;
  const has_files = (event) => event.dataTransfer?.types.includes("Files");
  document.addEventListener("dragenter", (event) => {
    if (!has_files(event)) return;
    inside++;
    drop.hidden = false;
  });
  document.addEventListener("dragleave", (event) => {
    if (has_files(event) && --inside <= 0) drop.hidden = true;
  });
  document.addEventListener("dragover", (event) => {
    if (has_files(event)) event.preventDefault();
  });
  document.addEventListener("drop", async (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    inside = 0;
    drop.hidden = true;
    try {
      take(await files_of_drop(event.dataTransfer));
    } catch (error) {
      on_error(`the dropped files cannot be read: ${error.message}`);
    }
  });
}
