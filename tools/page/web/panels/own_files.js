// The visitor's own scenes: dropped on the page or chosen. They go to the worker and no farther.

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
  return of(".toml") ?? of(".obj");
}

/**
 * `open(path, read)` opens /own/path after writing the files that `read()` resolves to, and
 * resolves to its warnings, or to null.
 */
export function start_own_files({ open, on_error }) {
  const messages = by_id("own-messages");
  const drop = by_id("drop");

  async function take(chosen) {
    on_error("");
    const first = scene_among(chosen.map(({ path }) => path));
    if (chosen.length === 0) return;
    if (!first) {
      on_error("none of these files is a scene: give an .obj or a .toml, with what it needs");
      return;
    }
    const total = chosen.reduce((sum, { file }) => sum + file.size, 0);
    if (total > kLargestBytes) {
      on_error(`${Math.round(total / 1e6)} MB are too much: give at most 512 MB`);
      return;
    }
    const read = () => Promise.all(
        chosen.map(async ({ path, file }) => ({ path, bytes: await file.arrayBuffer() })));
    try {
      const warnings = await open(first, read);
      if (!warnings) return;
      messages.replaceChildren(
          element("li", {}, `${first} is open.`),
          ...warnings.map((warning) => element("li", { class: "warning" }, warning)));
    } catch (error) {
      on_error(`${first} cannot be read: ${error.message}`);
    }
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
