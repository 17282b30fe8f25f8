// Writes the page as one HTML file that needs no server:
//
//   node single_file.js FOLDER FILE
//
// Browsers load neither modules nor workers from files. So the page's modules become functions of
// one script, the worker a blob, and the WebAssembly module text in base64, compressed: browsers that have
// no DecompressionStream (Firefox before 113) are told so.
"use strict";

const fs = require("fs");
const path = require("path");
const zlib = require("zlib");

const [folder, target] = process.argv.slice(2);
const read = (name) => fs.readFileSync(path.join(folder, name), "utf8");
const fail = (message) => { throw new Error(message); };

/** Where an import points, as a name in the folder. */
function resolved(from, to) {
  return path.posix.normalize(path.posix.join(path.posix.dirname(from), to));
}

// What our modules use, one statement a line: import { a, b as c } from "./x.js";
// import * as a from "./x.js"; import "./x.js"; export function, class, const; export { a, b };
// An import takes the value of the moment, so what is exported must never be assigned again: no let.
const kImport = /^import\s+(?:(\{[^}]*\}|\*\s+as\s+\w+)\s+from\s+)?"([^"]+)";/gm;
const kExport = /^export\s+(?:async\s+)?(?:function\*?|class|const)\s+(\w+)/gm;
const kExportList = /^export\s*\{([^}]*)\};/gm;

/** "{a, b as c}" as a pattern that takes an object apart: "{a, b: c}". */
function pattern_of(names) {
  return names.startsWith("*") ? names.replace(/^\*\s+as\s+/, "")
                               : names.replace(/\s+as\s+/g, ": ");
}

/** A module as a function that returns what it exports. */
function function_of(name, text) {
  const exported = [...text.matchAll(kExport)].map((match) => match[1]);
  for (const [, list] of text.matchAll(kExportList)) {
    for (const item of list.split(",").map((word) => word.trim()).filter(Boolean)) {
      const [inner, outer] = item.split(/\s+as\s+/);
      exported.push(outer ? `${outer}: ${inner}` : inner);
    }
  }
  const body = text
      .replace(kImport, (_, names, from) => {
        const call = `import_of(${JSON.stringify(resolved(name, from))})`;
        return names ? `const ${pattern_of(names)} = ${call};` : `${call};`;
      })
      .replace(kExportList, "")
      .replace(/^export\s+(?=async|function|class|const)/gm, "");
  if (/^(import|export)\b/m.test(body)) fail(`${name}: an import or export that is not understood`);
  if (/\bimport\.meta\b|\bimport\(|^\s*await\b/m.test(body.replace(/async[\s\S]*/, ""))) {
    fail(`${name}: import.meta, import() and await at the top need a real module`);
  }
  return `${JSON.stringify(name)}() {\n${body}\nreturn {${exported.join(", ")}};\n}`;
}

/** A module and all that it imports, each once. */
function modules_from(name, found = new Map()) {
  if (found.has(name)) return found;
  const text = read(name);
  found.set(name, text);
  for (const [, , from] of text.matchAll(kImport)) modules_from(resolved(name, from), found);
  return found;
}

function bundle(entry) {
  const functions = [...modules_from(entry)].map(([name, text]) => function_of(name, text));
  return `(() => {\n"use strict";\nconst made = {};\n` +
      `const import_of = (name) => (made[name] ??= modules[name]());\n` +
      `const modules = {\n${functions.join(",\n")}\n};\nimport_of(${JSON.stringify(entry)});\n})();`;
}

// The HTML parser ends a script at these, wherever they stand; in JavaScript's texts and patterns the
// backslash changes nothing.
const harmless = (script) => script.replace(/<\/(script)/gi, "<\\/$1").replace(/<!--/g, "<\\!--");

/** Emscripten's script without the comments and the indents, which are a third of it. */
const lean = (script) => script.replace(/^\s*\/\*[\s\S]*?\*\/\s*$/gm, "").replace(/^\s*\/\/.*$/gm, "")
    .replace(/^\s+/gm, "");

/** A worker from the texts of the page: the module's script is run when it is asked for. */
function worker_parts() {
  const wasm = zlib.deflateSync(fs.readFileSync(path.join(folder, "softfocus-simd.wasm")), { level: 9 })
      .toString("base64");
  return `<script type="text/plain" id="softfocus-wasm">${wasm}</script>
<script type="text/plain" id="softfocus-script">${harmless(lean(read("softfocus-simd.js")))}</script>
<script type="text/plain" id="softfocus-worker">${harmless(read("worker.js"))}</script>
<script>
(() => {
  const text_of = (id) => {
    const part = document.getElementById(id);
    part.remove();
    return part.textContent;
  };
  const wasm = text_of("softfocus-wasm");
  const script = text_of("softfocus-script");
  // atob() and a loop: fetch() of a data: address is not allowed everywhere.
  const parts = "self.softfocus_parts = {script() { " + script +
      "\\nself.createSoftfocus = createSoftfocus; }, async wasm() { const text = atob(\\"" + wasm +
      "\\"); const bytes = new Uint8Array(text.length);" +
      " for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);" +
      " if (typeof DecompressionStream === \\"undefined\\") throw new Error(" +
      "\\"this file needs a browser from 2023 or later; the page on a server does without\\");" +
      " const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(\\"deflate\\"));" +
      " return new Response(stream).arrayBuffer(); }};\\n";
  const blob = new Blob([parts, text_of("softfocus-worker")], { type: "text/javascript" });
  globalThis.softfocus_worker = URL.createObjectURL(blob);
})();
</script>`;
}

function page() {
  let html = read("index.html");
  html = html.replace(/<link\s[^>]*rel="stylesheet"[^>]*href="([^"]+)"[^>]*>/g,
                      (_, name) => `<style>\n${read(name)}</style>`);
  html = html.replace(/<link\s[^>]*rel="(?:modulepreload|preload)"[^>]*>\s*/g, "");
  html = html.replace(/<link\s([^>]*)rel="icon"([^>]*)href="(?!data:)([^"]+)"([^>]*)>/g,
                      (_, a, b, name, c) => `<link ${a}rel="icon"${b}href="data:image/svg+xml;base64,` +
                          `${Buffer.from(read(name)).toString("base64")}"${c}>`);
  let entry = null;
  html = html.replace(/<script\s([^>]*)src="([^"]+)"([^>]*)><\/script>/g, (_, before, name, after) => {
    if (name === "isolation.js") return "";
    if (!`${before}${after}`.includes('type="module"')) {
      return `<script>\n${harmless(read(name))}\n</script>`;
    }
    if (entry) fail("index.html: more than one module");
    entry = name.replace(/^\.\//, "");
    return "";
  });
  if (!entry) fail("index.html: no script of type module");
  const lessons = `<script type="text/plain" id="softfocus-lessons">${harmless(read("lesson/teaching.md"))}</script>`;
  // A module runs when the page has been read: so does this script, at its end.
  const scripts = `${lessons}\n${worker_parts()}\n<script>\n${harmless(bundle(entry))}\n</script>\n`;
  const end = html.lastIndexOf("</body>");
  html = end < 0 ? html + scripts : html.slice(0, end) + scripts + html.slice(end);
  const left = html.replace(/<script[\s\S]*?<\/script>/g, "").match(/(?:src|href)="(?!#|data:|https?:)[^"]*"/);
  if (left) fail(`index.html: ${left[0]} would have to be loaded`);
  return html;
}

try {
  fs.writeFileSync(target, page());
} catch (error) {
  console.error(`single_file.js: ${error.message}`);
  process.exit(1);
}
