// Serves a folder, with the headers that threads in a page need:
//
//   node serve.js FOLDER PORT [ADDRESS]
//
// ADDRESS is one of this machine's; 0.0.0.0 stands for all. Without it this machine alone is served.
"use strict";

const fs = require("fs");
const http = require("http");
const os = require("os");
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
const host = process.argv[4] ?? "127.0.0.1";

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
      ? `port ${port} is taken; --port gives another`
      : error.code === "EADDRNOTAVAIL" ? `${host} is no address of this machine` : error.message);
  process.exit(1);
});

/** What others type: of all addresses those that reach this machine from the network. */
function addresses() {
  if (host !== "0.0.0.0" && host !== "::") return [host];
  const found = Object.values(os.networkInterfaces()).flat()
      .filter(({ family, internal }) => !internal && (family === "IPv4" || family === 4));
  return found.map(({ address }) => address);
}

server.listen(port, host, () => {
  const at = (address) => `http://${address.includes(":") ? `[${address}]` : address}:${server.address().port}/`;
  const is_local = /^(127\.|::1$|localhost$)/.test(host);
  console.log(`The simulator: ${at(is_local ? "localhost" : addresses()[0] ?? host)}   (end with Ctrl+C)`);
  if (is_local) return;
  for (const address of addresses().slice(1)) console.log(`           or: ${at(address)}`);
  console.log("Everybody in this network can open the page. They send nothing: it runs in their browsers.\n" +
              "Without HTTPS these give it one thread.");
});
