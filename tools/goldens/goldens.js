// Draws what a check of goldens found: the JSON in the page.
"use strict";

const results = JSON.parse(document.getElementById("results").textContent);
const list = document.getElementById("goldens");
const which = document.getElementById("which");
const search = document.getElementById("name");

function element(tag, text, parent, attributes = {}) {
  const made = document.createElement(tag);
  if (text) made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  parent.append(made);
  return made;
}

// Small pictures are enlarged by a whole number, so that their pixels can be told apart.
function enlarge(image) {
  image.addEventListener("load", () => {
    const times = Math.max(1, Math.floor(320 / image.naturalWidth));
    image.width = image.naturalWidth * times;
  });
}

function picture(png, what, parent) {
  const image = element("img", "", parent, { src: "data:image/png;base64," + png, alt: what });
  enlarge(image);
  return image;
}

function figure(png, what, parent) {
  const made = element("figure", "", parent);
  picture(png, what, made);
  element("figcaption", what, made);
}

function wipe(golden, parent) {
  const made = element("figure", "", parent);
  const both = element("div", "", made, { class: "wipe" });
  picture(golden.expected, "expected", both);
  picture(golden.got, "got", both);
  const caption = element("figcaption", "", made);
  const label = element("label", "expected on the left, got on the right", caption);
  const slider = element("input", "", label, { type: "range", min: 0, max: 100, value: 50 });
  slider.addEventListener("input", () => both.style.setProperty("--at", slider.value + "%"));
}

function draw_golden(golden) {
  const article = element("article", "", list, { class: golden.verdict });
  element("h2", golden.name, article, { "data-verdict": golden.verdict });
  if (golden.why) element("p", golden.why, article);
  const made = element("p", "made by ", article);
  element("code", golden.made_by + (golden.options ? " " + golden.options : ""), made);
  if (golden.verdict === "passes") return;
  if (golden.got && golden.expected) wipe(golden, article);
  if (golden.expected) figure(golden.expected, "expected", article);
  if (golden.got) figure(golden.got, "got", article);
  if (golden.difference) {
    figure(golden.difference, "difference: FLIP, black 0 to pale yellow 1", article);
  }
  const hashes = [["got", golden.hash], ["expected", golden.expected_hash]]
    .concat(golden.was.map((hash) => ["before", hash])).filter((pair) => pair[1]);
  if (hashes.length > 0) {
    const line = element("p", "hash: ", article);
    line.append(hashes.map((pair) => pair.join(" ")).join(", "));
    if (golden.was.includes(golden.hash)) line.append(" (it was expected before)");
  }
  if (golden.verdict === "breaks") return;
  const accept = element("p", "", article);
  element("code", `${results.accept} ${golden.name}`, accept);
  accept.append(" takes the new picture");
}

function draw() {
  list.replaceChildren();
  const shown = results.goldens.filter((golden) =>
    (which.value === "all" || golden.verdict !== "passes") && golden.name.includes(search.value));
  shown.forEach(draw_golden);
  if (shown.length === 0) element("p", "Nothing to show.", list);
}

const counts = ["passes", "fails", "new", "breaks"].filter((verdict) => results[verdict] > 0)
  .map((verdict) => `${results[verdict]} ${{ passes: "pass", fails: "fail", new: "new", breaks: "break" }[verdict]}`);
document.getElementById("summary").textContent =
  `${results.folder}: ${counts.join(", ")}, of ${results.goldens.length}, in ${results.seconds.toFixed(1)} s`;
which.addEventListener("change", draw);
search.addEventListener("input", draw);
draw();
