#pragma once
// The page's style sheet, and the script that sorts its tables.

#include <string_view>

namespace softfocus {

inline constexpr std::string_view kPageStyle = R"(
:root { color-scheme: light dark; --back: #ffffff; --text: #1c1c1e; --faint: #5c5c63;
  --line: #d4d4d8; --band: #f3f3f5; --link: #0b57a8; --best: #fdf3d0; }
@media (prefers-color-scheme: dark) { :root { --back: #17171a; --text: #ececf0; --faint: #a9a9b2;
  --line: #3c3c43; --band: #222227; --link: #8ec1ff; --best: #3d3513; } }
body { margin: 0 auto; max-width: 1560px; padding: clamp(.6rem, 3vw, 1.5rem); background: var(--back);
  color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
h1, h2, h3 { line-height: 1.2; }
h2 { margin-top: 2.5rem; border-top: 1px solid var(--line); padding-top: 1.5rem; }
h3 { margin: 0 0 .3rem; font-size: 1.05rem; }
p { max-width: 50rem; }
a { color: var(--link); }
img { display: block; max-width: 100%; }
.scroll { overflow-x: auto; }
.chart { background: #ffffff; border: 1px solid var(--line); min-width: 60rem; width: 100%;
  max-width: 1560px; box-sizing: border-box; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .6rem; border-bottom: 1px solid var(--line); text-align: right;
  white-space: nowrap; }
thead th { background: var(--band); vertical-align: bottom; }
th button { all: unset; cursor: pointer; text-decoration: underline dotted; }
th button:focus-visible { outline: 2px solid var(--link); }
.word { text-align: left; }
td.group { border-left: 2px solid var(--line); }
td:first-child { white-space: normal; min-width: 7rem; }
tr.best td { background: var(--best); }
.points { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(440px, 100%), 1fr)); gap: 1rem; }
.point { border: 1px solid var(--line); padding: .8rem; }
.point:target { outline: 3px solid var(--link); }
.point p { margin: 0 0 .5rem; color: var(--faint); font-size: .875rem; }
.row { display: flex; flex-wrap: wrap; gap: .5rem; margin-bottom: .5rem; }
figure { margin: 0; width: min-content; }
figcaption { color: var(--faint); font-size: .8rem; }
.overview, .crop { max-width: none; }
.overview { width: 205px; }
.crop { image-rendering: pixelated; width: 132px; height: 132px; }
)";

/// A click on a heading sorts by its column, and again the other way round. A cell that has a
/// number keeps it in data-n; cells without one come last.
inline constexpr std::string_view kPageScript = R"(
document.querySelectorAll('table').forEach(table => {
  const body = table.tBodies[0];
  table.querySelectorAll('th button').forEach((button, column) => {
    button.addEventListener('click', () => {
      const heading = button.parentElement;
      const up = heading.getAttribute('aria-sort') !== 'ascending';
      table.querySelectorAll('th').forEach(other => other.removeAttribute('aria-sort'));
      heading.setAttribute('aria-sort', up ? 'ascending' : 'descending');
      const value = row => {
        const cell = row.cells[column];
        if (heading.classList.contains('word')) return cell.textContent;
        return 'n' in cell.dataset ? Number(cell.dataset.n) : NaN;
      };
      const order = (a, b) => {
        if (typeof a === 'string') return up ? a.localeCompare(b) : b.localeCompare(a);
        if (isNaN(a) || isNaN(b)) return isNaN(a) - isNaN(b);
        return up ? a - b : b - a;
      };
      [...body.rows].sort((a, b) => order(value(a), value(b))).forEach(row => body.append(row));
    });
  });
});
)";

}  // namespace softfocus
