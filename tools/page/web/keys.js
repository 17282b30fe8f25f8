// Single keys for everything. Letters can be kept to the picture, for voice control and screen
// readers type letters of their own.

import { by_id, element } from "./dom.js";

const kTyping = "input:not([type=range], [type=checkbox], [type=radio], [type=file]), textarea, select";
const kPressed = "button, summary, a, input, select, textarea";

/**
 * `commands`: [{keys: ["b"], words, run(shifted)}]; a command for "l" gets Shift+L as well, with
 * `shifted`. `camera_key(event, on_picture)` is asked first. `others`: rows for the table alone.
 */
export function start_keys({ commands, camera_key, others }) {
  const picture = by_id("picture");
  const table = by_id("keys-table");
  const body = element("tbody");
  for (const { shown, keys, words } of [...commands, ...others]) {
    const names = (shown ?? keys).map((key) => element("kbd", {}, key.toUpperCase()));
    const cell = element("td");
    names.forEach((name, index) => cell.append(index ? " " : "", name));
    body.append(element("tr", {}, cell, element("td", {}, words)));
  }
  table.replaceChildren(body);

  document.addEventListener("keydown", (event) => {
    const target = event.target;
    const on_picture = target === picture;
    if (event.isComposing || target.matches?.(kTyping)) return;
    if (!on_picture && !by_id("keys-everywhere").checked) return;
    // A slider has its own use for arrows, a button for the space bar.
    const taken = target.matches?.(kPressed) &&
                  (event.key === " " || event.key === "Enter" || event.key.length > 1 ||
                   (target.type === "range" && "+-".includes(event.key)));
    if (taken) return;
    if (camera_key(event, on_picture)) {
      event.preventDefault();
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    const command = commands.find(({ keys }) => keys.includes(key));
    if (!command || (event.repeat && !command.repeats)) return;
    event.preventDefault();
    command.run(event.shiftKey);
  });
}
