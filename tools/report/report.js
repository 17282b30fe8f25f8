// Draws a report: the JSON that tools/report/report.h describes. Every text is set as text, so that
// no name can become markup.
"use strict";

const svg_space = "http://www.w3.org/2000/svg";

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value !== undefined && value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((child) => child === "" || Boolean(child)));
  return element;
}
const html = (tag, attributes, ...children) => filled(document.createElement(tag), attributes, children);
const drawn = (tag, attributes, ...children) =>
  filled(document.createElementNS(svg_space, tag), attributes, children);
const paragraphs = (texts) => (texts ?? []).map((text) => html("p", {}, text));
const to_place = (id) => "#" + encodeURIComponent(id);

// --- numbers ---

/** At most four digits, as on an axis. */
const short = (value) => (value === null ? "no number" : String(Number(value.toPrecision(4))));

/** `places`: decimal ones; "ms": as many as tell milliseconds apart; none: four digits. */
function number_text(value, places) {
  if (places === "ms") return value.toFixed(value < 10 ? 2 : value < 100 ? 1 : 0);
  return places === undefined ? short(value) : value.toFixed(places);
}

// --- tables ---

function grade_of(value, grades) {
  const at = value === null ? -1 : grades.findIndex((grade) => value <= grade.up_to);
  return at < 0 ? grades.length - 1 : at;
}

function table_cell(cell, column, table) {
  const { text, to, value, about } = cell !== null && typeof cell === "object" ? cell : { value: cell };
  const is_word = typeof value === "string" || column.word;
  const shown = text ?? (typeof value === "number" ? number_text(value, column.places) : value ?? "–");
  const graded = table.grades && value !== undefined && typeof value !== "string" && cell !== null;
  const classes = [is_word && "word", column.group && column.starts && "first",
                   graded && `grade${grade_of(value, table.grades)}`].filter(Boolean).join(" ");
  const made = html("td", { class: classes || undefined, title: about },
                    to === undefined ? shown : html("a", { href: to_place(to) }, shown));
  made.order = is_word ? value ?? text : value;
  return made;
}

/** Words in the order of the alphabet, numbers by size, what has none last. */
function sort_rows(heading, body, column) {
  const up = heading.getAttribute("aria-sort") !== "ascending";
  heading.closest("thead").querySelectorAll("th").forEach((other) => other.removeAttribute("aria-sort"));
  heading.setAttribute("aria-sort", up ? "ascending" : "descending");
  const order_of = (row) => row.cells[column].order ?? null;
  const compared = (a, b) => {
    if (a === null || b === null) return (a === null) - (b === null);
    const rising = typeof a === "string" ? a.localeCompare(b, undefined, { numeric: true }) : a - b;
    return up ? rising : -rising;
  };
  body.append(...[...body.rows].sort((a, b) => compared(order_of(a), order_of(b))));
}

function table_of(table) {
  const { columns } = table;
  columns.forEach((column, i) => { column.starts = column.group !== columns[i - 1]?.group; });
  const body = html("tbody", {}, table.rows.map((row) => html("tr", { class: row.best && "best" },
    row.cells.map((cell, i) => table_cell(cell, columns[i], table)))));
  const names = columns.map((column, i) => {
    const button = html("button", { type: "button" }, html("span", {}, column.name));
    const classes = [column.word && "word", column.group && column.starts && "first"];
    const heading = html("th", { scope: "col", class: classes.filter(Boolean).join(" ") }, button);
    button.addEventListener("click", () => sort_rows(heading, body, i));
    return heading;
  });
  const starts = columns.flatMap((column, i) => (i === 0 || column.starts ? [i] : []));
  const groups = starts.map((start, i) => html("th",
    { class: columns[start].group && "group", colspan: (starts[i + 1] ?? columns.length) - start },
    columns[start].group));
  const head = html("thead", {}, groups.length > 1 && html("tr", {}, groups), html("tr", {}, names));
  const key = table.grades && html("p", { class: "key" }, table.key ?? "",
    table.grades.map((grade, i) => html("span", { class: `grade${i}` }, grade.text)));
  return [key, html("div", { class: "scroll" },
                    html("table", { class: table.grades && "graded" }, head, body))].filter(Boolean);
}

// --- plots ---

const inks = ["var(--text)", "#d62728", "#2a7fc4", "#2ca02c", "#f08010", "#9467bd", "#a5695c", "#e377c2",
              "#17b3c4", "#a9aa1d", "#5b6fd8", "#b03a64", "#00a087", "#dd9d00", "#8a8a8a", "#7fae00"];
const shapes = [  // about the origin, of radius 4.5
  "M4 0A4 4 0 1 1-4 0A4 4 0 1 1 4 0Z", "M-3.7-3.7H3.7V3.7H-3.7Z", "M0-5L4.7 3.4H-4.7Z",
  "M0-5.2L5.2 0L0 5.2L-5.2 0Z",
  "M0 5L4.7-3.4H-4.7Z", "M-1.6-4.6H1.6V-1.6H4.6V1.6H1.6V4.6H-1.6V1.6H-4.6V-1.6H-1.6Z",
  "M0-5L1.5-1.8L5-1.5L2.3.8L3.1 4.4L0 2.5L-3.1 4.4L-2.3.8L-5-1.5L-1.5-1.8Z"];
const ring = "M7 0A7 7 0 1 1-7 0A7 7 0 1 1 7 0Z";

/** Kinds with a colour of their own; the others' colours are the style sheet's. */
const is_inked = (series) => ["line", "ring", "dots"].includes(series.kind);

/** A colour and a shape for each name, the same in all panels. */
function styles_of(panels) {
  const styles = new Map();
  for (const panel of panels) {
    for (const series of panel.series.filter(is_inked)) {
      if (styles.has(series.name)) continue;
      const i = styles.size;
      styles.set(series.name, { ink: series.kind === "ring" ? inks[0] : inks[i % inks.length],
                                shape: series.kind === "ring" ? ring : shapes[i % shapes.length] });
    }
  }
  return styles;
}

/** What a logarithmic axis is marked with, by how many powers of ten it spans. */
const log_digits = [{ powers_most: 0.5, digits: [1, 1.1, 1.2, 1.3, 1.5, 1.7, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8, 9] },
                    { powers_most: 1.1, digits: [1, 1.5, 2, 3, 4, 5, 7] },
                    { powers_most: 3.2, digits: [1, 2, 5] }, { powers_most: Infinity, digits: [1] }];

/** From values to 0..1, and where the axis is marked. */
function scale_of(axis, values) {
  if (axis.names) {
    const count = axis.names.length;
    return { place: (i) => (i + 0.5) / count, ticks: axis.names.map((text, at) => ({ at, text })), minor: [] };
  }
  const finite = values.filter((value) => typeof value === "number" && (!axis.log || value > 0));
  let least = axis.least ?? Math.min(...finite), most = axis.most ?? Math.max(...finite);
  const on = axis.log ? Math.log : (value) => value;
  if (axis.least === undefined) least = axis.log ? least / 1.3 : least - (most - least) * 0.04;
  if (axis.most === undefined) most = axis.log ? most * 1.3 : most + (most - least) * 0.04;
  if (!(most > least)) [least, most] = axis.log ? [least / 2, least * 2] : [least - 1, least + 1];
  const bounded = (value) => Math.min(Math.max(value ?? most, least), most);
  const place = (value) => (on(bounded(value)) - on(least)) / (on(most) - on(least));
  const inside = (value) => value >= least * (1 - 1e-9) && value <= most * (1 + 1e-9);
  const marks = (list) => list.filter(inside).map((at) => ({ at, text: short(at) }));
  if (axis.ticks) return { place, ticks: marks(axis.ticks), minor: [] };
  if (!axis.log) {
    const power = 10 ** Math.floor(Math.log10((most - least) / 5));
    const step = [1, 2, 5, 10].map((of) => of * power).find((of) => (most - least) / of <= 7);
    const first = Math.ceil(least / step);
    const steps = Array.from({ length: 9 }, (_, i) => Number(((first + i) * step).toPrecision(9)));
    return { place, ticks: marks(steps), minor: [] };
  }
  const powers = Array.from({ length: 31 }, (_, i) => i - 15);
  const with_digits = (digits) =>
    powers.flatMap((power) => digits.map((digit) => Number(`${digit}e${power}`)));
  const { digits } = log_digits.find(({ powers_most }) => Math.log10(most / least) <= powers_most);
  return { place, ticks: marks(with_digits(digits)), minor: with_digits([2, 3, 4, 5, 6, 7, 8, 9]).filter(inside) };
}

const text_width = (text) => 6.1 * text.length;  // about, of .label

/** Labels of points, where they cover least: below a front nothing is, so they try that first. */
function labels_of(points, obstacles, box) {
  const covered = obstacles.map(({ x, y }) => ({ left: x - 5, right: x + 5, top: y - 5, bottom: y + 5, cost: 1 }));
  return points.map(({ x, y, text }) => {
    const width = text_width(text);
    const tries = [[-width - 7, 14], [7, 14], [-width / 2, 19], [-width - 9, 4], [9, 4],
                   [-width - 7, -7], [7, -7], [-width / 2, -10]].map(([dx, dy], i) => {
      const left = x + dx, right = left + width, top = y + dy - 10, bottom = y + dy + 3;
      const outside = left < box.left || right > box.right || bottom > box.bottom || top < box.top;
      const below = covered.filter((of) => of.left < right && of.right > left && of.top < bottom && of.bottom > top);
      const cost = below.reduce((sum, of) => sum + of.cost, i / 10 + (outside ? 8 : 0));
      return { left, right, top, bottom, cost };
    });
    const best = tries.reduce((a, b) => (b.cost < a.cost ? b : a));
    if (best.cost >= 4) return undefined;  // its point has a tip all the same
    covered.push({ ...best, cost: 4 });
    return drawn("text", { class: "label", x: best.left, y: best.bottom - 3 }, text);
  });
}

/** Lines of a grid with texts beside them, in `box`. */
function grid_of(plot, across, upwards, x_of, y_of, box) {
  const apart = (ticks, at_of, room_of) => {
    let before = -Infinity;
    return ticks.filter(({ at, text }) => {
      const fits = Math.abs(at_of(at) - before) >= room_of(text);
      if (fits) before = at_of(at);
      return fits;
    });
  };
  const x_ticks = apart(across.ticks, x_of, (text) => text_width(text) + 12);
  const y_ticks = apart(upwards.ticks, y_of, () => 17);
  const upright = (at) => drawn("line", { class: "grid", x1: x_of(at), x2: x_of(at), y1: box.top, y2: box.bottom });
  const level = (at) => drawn("line", { class: "grid", y1: y_of(at), y2: y_of(at), x1: box.left, x2: box.right });
  const word = (text, anchor, place) => drawn("text", { "text-anchor": anchor, ...place }, text);
  const middle = { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 };
  return [
    x_ticks.map(({ at }) => upright(at)), across.minor.map(upright),
    y_ticks.map(({ at }) => level(at)), upwards.minor.map(level),
    drawn("path", { class: "frame", d: `M${box.left} ${box.top}V${box.bottom}H${box.right}V${box.top}Z` }),
    x_ticks.map(({ at, text }) => word(text, "middle", { x: x_of(at), y: box.bottom + 16 })),
    y_ticks.map(({ at, text }) => word(text, "end", { x: box.left - 7, y: y_of(at) + 4 })),
    word(plot.x.title, "middle", { x: middle.x, y: box.bottom + 38 }),
    plot.y.title && word(plot.y.title, "middle", { transform: `translate(14 ${middle.y}) rotate(-90)` }),
    plot.title && drawn("text", { class: "title", x: box.left, y: 19 }, plot.title)].flat();
}

/** A series without its marks. */
function line_of(series, at, x_of, box, is_other) {
  const across = ({ py }, left, right) => drawn("line", { class: series.kind, x1: left, x2: right, y1: py, y2: py });
  switch (series.kind) {
    case "ring": case "dots": return [];
    case "level": case "limit": return at.slice(0, 1).map((point) => across(point, box.left, box.right));
    case "span": return at.map((point) => across(point, point.px, x_of(point.to_x)));
    default:
  }
  const corner = series.kind === "stair" ? ({ px, py }) => `H${px}V${py}` : ({ px, py }) => `L${px} ${py}`;
  const path = at.map((point, i) => (i === 0 ? `M${point.px} ${point.py}` : corner(point))).join("");
  return [drawn("path", { class: series.kind + (is_other ? " other" : ""), d: path })];
}

function mark_of(series, point, style, plot) {
  const classes = [series.kind === "ring" ? "ring" : "mark", point.bad && "bad"].filter(Boolean).join(" ");
  const size = point.label ? " scale(1.35)" : "";
  const mark = drawn("path", { class: classes, d: style.shape,
                               transform: `translate(${point.px} ${point.py})${size}` });
  const upwards = plot.y.names ? plot.y.names[point.y] : short(point.y);
  mark.tip = [point.text ?? series.name, `${plot.x.short ?? plot.x.title}: ${short(point.x)}`,
              `${plot.y.short ?? plot.y.title}: ${upwards}`].join("\n");
  return point.to === undefined ? mark : drawn("a", { href: to_place(point.to) }, mark);
}

/** One panel. With `own` only the series of that name is coloured. */
function plot_of(plot, { styles, width = 560, height = 430, own }) {
  const left = plot.y.names ? 22 + Math.max(...plot.y.names.map(text_width)) : 74;
  const box = { left, right: width - 12, top: plot.title ? 32 : 10, bottom: height - 46 };
  const every = plot.series.flatMap((series) => series.points);
  const across = scale_of(plot.x, every.flatMap((point) => [point.x, point.to_x]));
  const upwards = scale_of(plot.y, every.map((point) => point.y));
  const x_of = (value) => box.left + across.place(value) * (box.right - box.left);
  const down = (value) => (plot.y.names ? upwards.place(value) : 1 - upwards.place(value));
  const y_of = (value) => box.top + down(value) * (box.bottom - box.top);

  // What has no colour of its own lies below, then the other methods.
  const below = [], others = [], above = [], marked = [];
  for (const series of plot.series) {
    const style = styles.get(series.name);
    const is_other = own !== undefined && is_inked(series) && series.name !== own;
    const at = series.points.map((point) => ({ ...point, px: x_of(point.x), py: y_of(point.y) }));
    const group = drawn("g", { style: style && `--ink: ${style.ink}` }, line_of(series, at, x_of, box, is_other));
    group.series = series.name;
    (is_other ? others : is_inked(series) ? above : below).push(group);
    if (!style || is_other) continue;
    group.append(...at.map((point) => mark_of(series, point, style, plot)));
    marked.push(...at.map(({ px, py, label }) => ({ x: px, y: py, text: label })));
  }
  return drawn("svg", { class: "plot", viewBox: `0 0 ${width} ${height}`, role: "img",
                        "aria-label": plot.about ?? plot.title },
               grid_of(plot, across, upwards, x_of, y_of, box), below, others, above,
               labels_of(marked.filter(({ text }) => text), marked, box));
}

/** A sample of a series for the key: its line and its mark. */
function sample_of(series, style) {
  const has_line = series.kind !== "dots" && series.kind !== "ring";
  return drawn("g", { style: style && `--ink: ${style.ink}` },
               has_line && drawn("path", { class: series.kind, d: "M2 10H32" }),
               style && drawn("path", { class: series.kind === "ring" ? "ring" : "mark", d: style.shape,
                                        transform: "translate(17 10)" }));
}

function key_entries(panels) {
  const all = panels.flatMap((panel) => panel.series).filter((series) => series.name);
  return [...new Map(all.map((series) => [series.name, series])).values()];
}

/** The panels and the key as one picture, in light colours. */
function picture_of(svgs, panels, styles) {
  const columns = Math.min(svgs.length, 3);
  const [, , width, height] = svgs[0].getAttribute("viewBox").split(" ").map(Number);
  const rows = Math.ceil(svgs.length / columns), entries = key_entries(panels);
  const slot = 54 + Math.max(...entries.map((series) => 7 * series.name.length));
  const in_row = Math.max(1, Math.floor((columns * width) / slot));
  const size = { width: columns * width, height: rows * height + 24 * Math.ceil(entries.length / in_row) + 16 };
  const rules = [...document.styleSheets[0].cssRules]
    .filter((rule) => /^(:root|\.plot)\b/.test(rule.selectorText ?? ""));
  const row_column = (i, in_each) => [Math.floor(i / in_each), i % in_each];
  return drawn("svg", { xmlns: svg_space, class: "plot", viewBox: `0 0 ${size.width} ${size.height}`, ...size },
    drawn("style", {}, rules.map((rule) => rule.cssText).join("\n")),
    drawn("rect", { ...size, fill: "#ffffff" }),
    svgs.map((panel, i) => {
      const [row, column] = row_column(i, columns);
      return filled(panel.cloneNode(true), { x: column * width, y: row * height, width, height }, []);
    }),
    entries.map((series, i) => {
      const [row, column] = row_column(i, in_row);
      return drawn("g", { transform: `translate(${10 + column * slot} ${rows * height + 8 + 24 * row})` },
                   sample_of(series, styles.get(series.name)), drawn("text", { x: 40, y: 14 }, series.name));
    }));
}

function save(name, address) {
  html("a", { download: name, href: address }).click();
}

function save_picture(name, ending, picture) {
  const text = new XMLSerializer().serializeToString(picture);
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  if (ending === "svg") return save(`${name}.svg`, address);
  const image = new Image();
  image.onload = () => {
    const canvas = html("canvas", { width: 2 * image.width, height: 2 * image.height });
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    save(`${name}.png`, canvas.toDataURL("image/png"));
  };
  image.src = address;
}

/** Panels with one key. Pointing at a name or at a mark fades the other series. */
function plots_of({ panels, name, height }) {
  const styles = styles_of(panels), is_one = panels.length === 1;
  const size = { ...(is_one && { width: 1040, height: 560 }), ...(height && { height }) };
  const svgs = panels.map((panel) => plot_of(panel, { styles, ...size }));
  const show_alone = (alone) => svgs.forEach((of) => of.querySelectorAll("g").forEach(({ classList, series }) =>
    classList.toggle("faded", styles.has(alone) && styles.has(series) && series !== alone)));
  const pointed = (element, series_of) => {
    element.addEventListener("pointerover", ({ target }) => show_alone(series_of(target)));
    element.addEventListener("pointerleave", () => show_alone());
  };
  svgs.forEach((of) => pointed(of, (target) => target.tip && target.closest("g").series));
  const keys = key_entries(panels).map((series) => {
    const sample = drawn("svg", { class: "plot", viewBox: "0 0 34 20" }, sample_of(series, styles.get(series.name)));
    const key = html("span", {}, sample, series.name);
    pointed(key, () => series.name);
    return key;
  });
  const buttons = ["svg", "png"].map((ending) => {
    const button = html("button", { type: "button" }, `Save ${ending.toUpperCase()}`);
    button.addEventListener("click", () => save_picture(name, ending, picture_of(svgs, panels, styles)));
    return button;
  });
  return [html("div", { class: is_one ? "plots one" : "plots" }, svgs),
          html("div", { class: "keys" }, keys, buttons)];
}

// --- pictures ---

function figure_of(figure, pictures) {
  const png = pictures[figure.picture];
  const source = png === undefined ? figure.picture : `data:image/png;base64,${png}`;
  return html("figure", {},
    html("img", { class: figure.crop && "crop", loading: "lazy", alt: figure.about, src: source }),
    html("figcaption", {}, figure.caption));
}
const figures_of = (rows, pictures) => (rows ?? []).map((row) =>
  html("div", { class: "figures" }, row.map((figure) => figure_of(figure, pictures))));

/** Its plot is drawn when it comes into sight: a page may have a thousand. */
function card_of(card, part, report) {
  const curve = card.own === undefined ? undefined : html("div", { class: "curve" });
  if (curve) {
    const [plot] = part.plots.panels;
    when_seen(curve, () => curve.append(plot_of({ ...plot, title: undefined },
      { styles: styles_of([plot]), width: 430, height: 250, own: card.own })));
  }
  return html("section", { class: "card", id: card.id }, html("h4", {}, card.title), paragraphs(card.text), curve,
              figures_of(card.figures, report.pictures));
}

const waiting = new Map();
const watcher = new IntersectionObserver((entries) => entries.forEach(({ isIntersecting, target }) => {
  if (!isIntersecting) return;
  watcher.unobserve(target);
  waiting.get(target)();
  waiting.delete(target);
}), { rootMargin: "600px" });
function when_seen(place, draw) {
  waiting.set(place, draw);
  watcher.observe(place);
}

// --- the page ---

function part_of(part, report) {
  return html("section", {}, html(part.below ? "h3" : "h2", { id: part.id }, part.title), paragraphs(part.text),
              part.plots && plots_of(part.plots), part.table && table_of(part.table),
              figures_of(part.figures, report.pictures),
              html("div", { class: "cards" }, (part.cards ?? []).map((card) => card_of(card, part, report))));
}

function show_report(report) {
  document.title = report.title;
  const headings = report.parts.filter((part) => !part.below);
  document.querySelector("main").replaceChildren(
    html("h1", {}, report.title), ...paragraphs(report.text),
    html("div", { class: "made" }, report.machine, html("code", {}, report.command)),
    html("nav", {}, headings.map((part) => html("a", { href: to_place(part.id) }, part.title))),
    ...report.parts.map((part) => part_of(part, report)));
  document.getElementById(decodeURIComponent(location.hash.slice(1)))?.scrollIntoView();
}

// --- what --json prints ---

const is_list = (value) => Array.isArray(value) && value.some((of) => of !== null && typeof of === "object");

/** Members in members as "ratio frame"; a list of records as it is. */
function flat(json, before = "") {
  return Object.entries(json).flatMap(([key, value]) => {
    const name = before + key.replaceAll("_", " ");
    const has_members = value !== null && typeof value === "object" && !Array.isArray(value);
    return has_members ? flat(value, `${name} `) : [[name, value]];
  });
}

/** Rows that are alike but for their names: a column for each name that any of them has. */
function table_of_rows(rows) {
  const names = [...new Set(rows.flatMap((row) => Object.keys(row)))];
  const cell = (value) => (Array.isArray(value) || typeof value === "boolean" ? JSON.stringify(value) : value ?? null);
  const is_word = (name) => rows.every((row) => typeof (row[name] ?? "") !== "number");
  return { columns: names.map((name) => ({ name, word: is_word(name) })),
           rows: rows.map((row) => ({ cells: names.map((name) => cell(row[name])) })) };
}

/** A panel for each setting that rows sweep, a line for each scene: wrong pixels, where they are counted. */
function sweeps_of(rows, title) {
  const settings = [...new Set(rows.map((row) => row.setting).filter(Boolean))];
  const panels = settings.map((setting) => {
    const swept = rows.filter((row) => row.setting === setting);
    const line = (scene, key, kind, name) => ({ name, kind,
      points: swept.filter((row) => row.scene === scene).map((row) => ({ x: row.value, y: Math.max(row[key], 1) })) });
    const scenes = [...new Set(swept.map((row) => row.scene))];
    const values = [...new Set(swept.map((row) => row.value))];
    return { title: setting, about: `wrong pixels by ${setting}`, y: { title: "wrong pixels", log: true },
             x: { title: setting, ticks: values, log: Math.min(...values) > 0 && Math.max(...values) > 8 },
             series: scenes.flatMap((scene) => [line(scene, "wrong", "line", scene ?? title),
                                                line(scene, "peter panning", "thin", "of these peter-panning")]) };
  });
  return panels.length > 0 ? { name: title, panels } : undefined;
}

/** What several runs printed, as a report: a row a run, and lists of one name as one table. */
function report_of(runs) {
  const report = runs.find((run) => run.parts);
  if (report) return report;
  const lists = new Map(), heads = [];
  for (const run of runs) {
    const members = Array.isArray(run) ? [["results", run]] : flat(run);
    const head = Object.fromEntries(members.filter(([, value]) => !is_list(value)));
    heads.push(head);
    for (const [name, list] of members.filter(([, value]) => is_list(value))) {
      const rows = list.map((row) => Object.fromEntries(flat(row)));
      const own = runs.length > 1 || rows.some((row) => row.setting) ? { scene: head.scene } : {};
      lists.set(name, [...(lists.get(name) ?? []), ...rows.map((row) => ({ ...own, ...row }))]);
    }
  }
  const head_table = runs.length > 1 ? table_of_rows(heads)
    : table_of_rows(Object.entries(heads[0]).map(([name, value]) => ({ name, value })));
  return { title: heads[0].scene ?? "Results", text: [], pictures: {},
           parts: [...(Object.keys(heads[0]).length > 0 ? [{ id: "run", title: "Run", table: head_table }] : []),
                   ...[...lists].map(([name, rows]) => ({ id: name, title: name, table: table_of_rows(rows),
                                                          plots: sweeps_of(rows, name) }))] };
}

/** Where the page has no results: draws those of a report's page, or of what --json printed. */
function ask_for_report() {
  const input = html("input", { type: "file", accept: ".html,.json", multiple: true });
  input.addEventListener("change", async () => {
    const texts = await Promise.all([...input.files].map((file) => file.text()));
    show_report(report_of(texts.map((text) => {
      const page = new DOMParser().parseFromString(text, "text/html").getElementById("results");
      return JSON.parse(page === null ? text : page.textContent);
    })));
  });
  document.querySelector("main").append(html("h1", {}, "Report"), html("p", {},
    "This page has no results of its own. Choose a page that has, such as chart/index.html, or files of what " +
    "--json printed: ", input));
}

const tip = html("div", { class: "tip", hidden: true });
document.body.append(tip);
document.addEventListener("pointerover", ({ target }) => {
  tip.hidden = target.tip === undefined;
  if (tip.hidden) return;
  tip.textContent = target.tip;
  const { left, top, width } = target.getBoundingClientRect(), room = innerWidth - tip.offsetWidth - 8;
  tip.style.left = `${Math.max(8, Math.min(left + width / 2 - tip.offsetWidth / 2, room))}px`;
  tip.style.top = `${top > tip.offsetHeight + 16 ? top - tip.offsetHeight - 8 : top + 20}px`;
});

const results = JSON.parse(document.getElementById("results").textContent);
if (results === null) ask_for_report();
else show_report(report_of([results]));
