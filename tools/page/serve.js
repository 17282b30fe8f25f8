// Serves a folder on this machine alone, with the headers that threads in a page need:
//
//   node serve.js FOLDER PORT
"use strict";

const fs = require("fs");
const http = require("http");
const path = require("path");

const kTypes = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".wasm": "application/wasm",
  ".svg": "image/svg+xml",
  ".png": "image/png",
};

const [folder, port] = [path.resolve(process.argv[2]), Number(process.argv[3])];

function answer(request, response) {
  const asked = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
  const file = path.join(folder, asked.endsWith("/") ? `${asked}index.html` : asked);
  response.setHeader("Cross-Origin-Opener-Policy", "same-origin");
  response.setHeader("Cross-Origin-Embedder-Policy", "require-corp");
  response.setHeader("Cross-Origin-Resource-Policy", "same-origin");
  response.setHeader("Cache-Control", "no-cache");
  const bytes = file.startsWith(folder + path.sep) && fs.existsSync(file) &&
      fs.statSync(file).isFile() ? fs.readFileSync(file) : null;
  response.statusCode = bytes ? 200 : 404;
  response.setHeader("Content-Type", kTypes[path.extname(file)] ?? "application/octet-stream");
  response.end(bytes ?? "there is no such file\n");
}

const server = http.createServer((request, response) => {
  try {
    answer(request, response);
  } catch {
    response.statusCode = 400;
    response.end("this cannot be read\n");
  }
});
server.on("error", (error) => {
  console.error(error.code === "EADDRINUSE"
      ? `port ${port} is taken; --port gives another` : error.message);
  process.exit(1);
});
server.listen(port, "127.0.0.1", () => {
  console.log(`The simulator: http://localhost:${server.address().port}/   (end with Ctrl+C)`);
});
