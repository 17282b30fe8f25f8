// The lessons' text, docs/teaching.md, as chapters and steps, and what of Markdown it uses as HTML.

import { element } from "../dom.js";

const kStep = /^### ([0-9]+\.[0-9]+) (.*)$/;

/** Of each chapter ("## ..."): {title, lines, steps: [{key: "1.2", title, lines}]}. */
export function read_lessons(text) {
  const chapters = [];
  let into = [];  // the head of the file is the reader's of the file
  for (const line of text.split("\n")) {
    const step = kStep.exec(line);
    if (line.startsWith("## ")) {
      const chapter = { title: line.slice(3), lines: [], steps: [] };
      chapters.push(chapter);
      into = chapter.lines;
    } else if (step) {
      const [, key, title] = step;
      into = [];
      chapters[chapters.length - 1].steps.push({ key, title, lines: into });
    } else {
      into.push(line);
    }
  }
  return chapters;
}

/** Bold, emphasis, code and links. Of a link to a file beside the text its words are left. */
export function inline_nodes(text) {
  const nodes = [];
  let end = 0;
  for (const found of text.matchAll(/\*\*(.+?)\*\*|\*([^*]+)\*|`([^`]+)`|\[([^\]]+)\]\(([^)]+)\)/g)) {
    const [all, bold, emphasis, code, words, target] = found;
    nodes.push(text.slice(end, found.index));
    if (bold) nodes.push(element("b", {}, ...inline_nodes(bold)));
    else if (emphasis) nodes.push(element("em", {}, ...inline_nodes(emphasis)));
    else if (code) nodes.push(element("code", {}, code));
    else if (/^https?:/.test(target)) nodes.push(element("a", { href: target }, words));
    else nodes.push(...inline_nodes(words));
    end = found.index + all.length;
  }
  return [...nodes, text.slice(end)].filter((node) => node !== "");
}

function table_of(lines) {
  const rows = lines.map((line) => line.replace(/^\||\|$/g, "").split("|").map((cell) => cell.trim()));
  const row = (tag, cells) => element(
      "tr", {}, ...cells.map((cell) => element(tag, { class: "words" }, ...inline_nodes(cell))));
  const body = element("tbody", {}, ...rows.slice(2).map((cells) => row("td", cells)));
  const box = element("div", { class: "scroll", role: "region", "aria-label": rows[0].join(", "), tabindex: 0 });
  box.append(element("table", {}, element("thead", {}, row("th", rows[0])), body));
  return box;
}

function list_of(lines, tag) {
  const items = [];
  for (const line of lines) {
    const first = line.replace(/^(?:- |[0-9]+\. )/, "");
    if (first !== line) items.push(first);
    else items[items.length - 1] += ` ${line.trim()}`;
  }
  const start = Number(/^[0-9]+/.exec(lines[0])?.[0] ?? 1);
  return element(tag, start > 1 ? { start } : {}, ...items.map((item) => element("li", {}, ...inline_nodes(item))));
}

function block_of(lines) {
  const first = lines[0];
  if (first.startsWith("|")) return table_of(lines);
  if (first.startsWith("- ")) return list_of(lines, "ul");
  if (/^[0-9]+\. /.test(first)) return list_of(lines, "ol");
  if (first.startsWith("    ")) {
    return element("pre", { class: "code", tabindex: 0 }, lines.map((line) => line.slice(4)).join("\n"));
  }
  return element("p", {}, ...inline_nodes(lines.join(" ")));
}

/** The lines as elements. An answer is folded, as GitHub folds it. */
export function blocks_of(lines) {
  const blocks = [];
  let details = null;
  let open = [];
  const close = () => {
    if (open.length > 0) (details ?? { append: (node) => blocks.push(node) }).append(block_of(open));
    open = [];
  };
  for (const line of [...lines, ""]) {
    const summary = /^<details><summary>(.*)<\/summary>$/.exec(line);
    if (summary || line === "</details>" || line.trim() === "") close();
    if (summary) {
      details = element("details", {}, element("summary", {}, summary[1]));
      blocks.push(details);
    } else if (line === "</details>") {
      details = null;
    } else if (line.trim() !== "") {
      open.push(line);
    }
  }
  return blocks;
}
