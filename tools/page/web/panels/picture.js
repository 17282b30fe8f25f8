// A picture of the visitor's and its depth map: what the map's numbers mean, and the result's file.

import { by_id, element, save_file, show_error } from "../dom.js";
import { kAsked } from "../engine.js";
import { parameters } from "../state.js";

export const kNoScene = "a picture has no scene to draw: choose a scene for this";

/** A line of `refocus` in the page's words: it advises options, and here are controls and files. */
export function advice_here(line) {
  if (line.includes("softfocus ")) return line;  // a command to type
  return line.replace(/,? or (say )?--depth-layer/, "")
      .replace("a --depth-layer of", "a file that has one of these alone:")
      .replace("give a --depth-encoding", "choose under Depth map what its numbers are")
      .replace("another --depth-encoding would do", "choose under Depth map what its numbers are")
      .replace(/--(?=[a-z])/g, "");
}

const words_of = ({ needs, takes }) => `${needs} ${takes}`.split(" ").filter(Boolean);

/** The encoding that is none: radii of circles, which need no lens. */
export const kCircles = "circles";

/**
 * `open`'s request. Numbers that the encoding makes no use of are kept, but not sent. `encodings`
 * and `readings` are those of the `scenes` reply.
 */
export function picture_request(path, { depth, encoding, numbers, choices }, { encodings }, believed) {
  const request = { do: "open", picture: path, depth, encoding, ...choices };
  const known = encodings.find(({ name }) => name === (encoding ?? believed));
  for (const word of known ? words_of(known) : []) {
    const { key } = parameters[word];
    if (Number.isFinite(numbers[key])) request[key] = numbers[key];
  }
  return request;
}

/** The same as options of `softfocus refocus`, but for the circles' file. */
export function depth_words({ encoding, numbers, choices }, { encodings, readings }) {
  const known = encodings.find(({ name }) => name === encoding);
  const chosen = readings.filter(({ key }) => choices[key])
      .map(({ name, key }) => `--${name} ${choices[key]}`);
  if (!known || encoding === kCircles) return chosen;
  return [`--depth-encoding ${encoding}`,
          ...words_of(known).filter((word) => Number.isFinite(numbers[parameters[word].key]))
              .map((word) => `--${word} ${numbers[parameters[word].key]}`), ...chosen];
}

/**
 * The controls of the depth map. `change({encoding, numbers, choices})` reads it anew and resolves
 * when that is done. `listing` is the `scenes` reply.
 */
export function make_picture({ engine, listing: { encodings, readings }, change, stem }) {
  const choice = by_id("encoding");
  const numbers_part = by_id("encoding-numbers");
  let state = null;   // the picture of the state
  let opened = null;  // and of the reply
  let reading = { encoding: null, numbers: {}, choices: {} };  // as last chosen, which the state may not be yet
  let changes = 0;    // under way

  const believed_option = element("option", { value: "" }, "");
  choice.replaceChildren(believed_option, ...encodings.map(
      ({ name, summary }) => element("option", { value: name, title: summary }, name)));
  async function read(patch) {
    reading = { ...reading, ...patch };
    changes++;
    await change(reading);
    changes--;
    if (changes === 0) show(state, opened);
  }
  choice.addEventListener("change", () => read({ encoding: choice.value || null }));

  function choice_field({ name, key, text, values, preset }) {
    const field = element("select", { id: `reading-${name}`, title: text },
                          ...(preset ? [] : [element("option", { value: "" }, "as it is")]),
                          ...values.map((value) => element("option", { value }, value)));
    field.addEventListener("change", () => (
        read({ choices: { ...reading.choices, [key]: field.value || null } })));
    return element("div", { class: "line" }, element("label", { for: `reading-${name}` }, name), field);
  }
  by_id("depth-readings").replaceChildren(...readings.map(choice_field));

  function number_field(word) {
    const { key, unit, text, least, most } = parameters[word];
    const field = element("input", { type: "number", step: "any", id: `encoding-${word}`, title: text,
                                     min: least, max: most });
    field.value = reading.numbers[key] ?? "";
    field.addEventListener("change", () => {
      const value = field.value === "" ? undefined : field.valueAsNumber;
      read({ numbers: { ...reading.numbers, [key]: value } });
    });
    return element("div", { class: "line" },
                   element("label", { for: `encoding-${word}` }, word),
                   element("span", { class: "field" }, field, element("span", { class: "unit" }, unit)));
  }

  by_id("save-picture").addEventListener("click", async () => {
    const format = by_id("save-format").value;
    const { reply, file } = await engine.ask({ do: "save", format }, kAsked);
    if (reply.error) show_error(reply.error);
    else save_file(`${stem()}-refocused.${format.replace("-16", "")}`, file);
  });

  function show(of_state, of_reply) {
    state = of_state;
    opened = of_reply;
    by_id("depth-part").hidden = !state;
    by_id("no-scene").hidden = !state;
    for (const part of document.querySelectorAll("[data-scene]")) part.inert = Boolean(state);
    for (const part of document.querySelectorAll("[data-lens]")) {
      part.inert = state?.encoding === kCircles;
    }
    if (!state || changes > 0) return;
    reading = { encoding: state.encoding, numbers: state.numbers, choices: state.choices };
    for (const { name, key, preset } of readings) {
      by_id(`reading-${name}`).value = state.choices[key] ?? preset ?? "";
    }
    believed_option.textContent = opened.believed ? `by its numbers: ${opened.believed}` : "choose…";
    choice.value = state.encoding ?? "";
    const used = encodings.find(({ name }) => name === opened.encoding);
    by_id("encoding-why").textContent = opened.lacks ||
        (state.encoding ? used?.summary : opened.why) || "";
    const range = `${opened.type}, ${opened.least} to ${opened.largest}`;
    by_id("depth-seen").textContent = opened.line ? `${range}; ${opened.line}` : range;
    by_id("save-picture").disabled = Boolean(opened.lacks);
    const words = used ? words_of(used) : [];
    const there = [...numbers_part.querySelectorAll("input")].map(({ id }) => id.slice(9));
    if (words.join() !== there.join()) numbers_part.replaceChildren(...words.map(number_field));
  }

  /** Shows the picture of the state and of the `open` reply, or hides everything for null. */
  return { show };
}
