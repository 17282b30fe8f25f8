// Threads share memory, which browsers allow to isolated pages alone: those that come with two
// headers. Where the host sends none, service-worker.js adds them from the second load on. The page
// works without, in one thread.
"use strict";

(() => {
  const kTried = "softfocus-isolation-tried";
  if (self.crossOriginIsolated) {
    sessionStorage.removeItem(kTried);
    return;
  }
  const can = self.isSecureContext && "serviceWorker" in navigator &&
      location.protocol.startsWith("http");
  if (!can || sessionStorage.getItem(kTried)) return;
  navigator.serviceWorker.register("service-worker.js").then(() => navigator.serviceWorker.ready)
      .then(() => {
        sessionStorage.setItem(kTried, "1");  // a browser that isolates nothing is not asked again
        location.reload();
      })
      .catch(() => {});
})();
