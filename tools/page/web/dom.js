// Short words for the document.

export function by_id(id) {
  return document.getElementById(id);
}

/** An element with attributes and children; text becomes text nodes. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

export function svg_element(tag, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

let error_source = "";

/**
 * One line in the page that must be seen, read out at once. An empty one takes it away; that of a
 * `source` takes away only what came from there.
 */
export function show_error(line, source = "") {
  if (!line && source && source !== error_source) return;
  error_source = source;
  by_id("error").hidden = !line;
  if (by_id("error-text").textContent !== line) by_id("error-text").textContent = line;
}

/** One line that is read out and not seen. */
export function announce(line) {
  by_id("notice").textContent = line;
}

/** Puts RGBA8 rows into a canvas. */
export function paint_pixels(canvas, width, height, pixels) {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const rows = new Uint8ClampedArray(pixels, 0, width * height * 4);
  canvas.getContext("2d").putImageData(new ImageData(rows, width, height), 0, 0);
}

/** A picture of the module's in a figure, with its caption; no pixels hide it. */
export function paint_figure(id, words, { reply, pixels }) {
  const figure = by_id(id);
  figure.hidden = !pixels;
  if (!pixels) return;
  figure.querySelector("figcaption").textContent = words;
  paint_pixels(figure.querySelector("canvas"), reply.width, reply.height, pixels);
}

/** Saves text as a file of the visitor's. */
export function save_text(name, text, type = "text/plain") {
  save_file(name, text, `${type};charset=utf-8`);
}

/** Likewise a text or an ArrayBuffer, of that type. */
export function save_file(name, content, type = "application/octet-stream") {
  const url = URL.createObjectURL(new Blob([content], { type }));
  const link = element("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Copies text; the reply tells whether the browser allowed it. */
export async function copy_text(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}
