// The performance report: a text file, as the thesis's simulator writes one.

import { save_text } from "../dom.js";
import { link_of } from "../link.js";
import { ms_text } from "../units.js";

function statistics(values) {
  const sorted = values.slice().sort((a, b) => a - b);
  const at = (part) => sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];
  return { median: at(0.5), least: sorted[0], most: sorted[sorted.length - 1] };
}

/** Milliseconds until a whole frame is shown: the report's and the header's. NaN: none was. */
export const shown_ms = (timings) => (
    timings.length === 0 ? NaN : statistics(timings.map(({ wall_ms }) => wall_ms)).median);

function timing_lines(timings) {
  if (timings.length === 0) return ["no whole frame was drawn yet"];
  const lines = ["Milliseconds           median    least     most"];
  const rows = { Drawing: (t) => t.draw_ms, Filtering: (t) => t.filter_ms,
                 "Until it is shown": (t) => t.wall_ms };
  for (const [name, of] of Object.entries(rows)) {
    const { median, least, most } = statistics(timings.map(of));
    lines.push(name.padEnd(20) + [median, least, most].map((x) => ms_text(x).padStart(9)).join(""));
  }
  lines.push("", `Frames per second   ${(1000 / shown_ms(timings)).toFixed(1)} (${timings.length} whole frames)`);
  return lines;
}

/** `own` is the module's report of the last frame. */
export function report_text({ state, timings, build, own, address }) {
  return [
    own.trimEnd(),
    `Module              ${build}`,
    `Browser             ${navigator.userAgent}`,
    `Cores               ${navigator.hardwareConcurrency ?? "unknown"}`,
    `Link                ${address}#${link_of(state)}`,
    "",
    ...timing_lines(timings),
    "",
  ].join("\n");
}

export function save_report(parts) {
  save_text("softfocus-report.txt", report_text(parts));
}
