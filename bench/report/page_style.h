// The page's style sheet: no font or picture from elsewhere; light and dark; a phone's width; print.
#pragma once

namespace touchstone::report {

inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark; --ink: #1b1b1b; --soft: #5c5c5c; --line: #d9d9d9; --back: #ffffff; --plate: #f5f5f3; --link: #0b57a4; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --soft: #a8a8a8; --line: #3b3b3b; --back: #121212; --plate: #1e1e1e; --link: #8ab8ea; }
  svg { filter: invert(1) hue-rotate(180deg); }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; padding: 1rem; max-width: 76rem; background: var(--back); color: var(--ink);
  font: 1rem/1.5 system-ui, "DejaVu Sans", Verdana, sans-serif; overflow-wrap: anywhere; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: .5rem 0; }
h2 { font-size: 1.3rem; margin: 2.5rem 0 .5rem; padding-top: .6rem; border-top: 1px solid var(--line); }
p, ul { max-width: 48rem; }
a { color: var(--link); }
nav ul { list-style: none; padding: 0; display: flex; flex-wrap: wrap; gap: .25rem 1.2rem; max-width: none; }
figure { margin: 1.5rem 0 2.2rem; }
figcaption { font-weight: 600; margin-bottom: .5rem; max-width: 48rem; }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: 4px; }
.scroll:focus-visible { outline: 2px solid var(--link); }
table { border-collapse: collapse; font-size: .86rem; line-height: 1.35; width: 100%; overflow-wrap: normal; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .6rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); max-width: 22rem; }
thead th { vertical-align: bottom; background: var(--plate); }
tbody th { font-weight: 500; }
tbody tr:last-child > * { border-bottom: 0; }
.number { text-align: right; min-width: 4.5rem; }
.line { white-space: nowrap; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 1rem; }
.panel { margin: 0; max-width: 38rem; }
svg { display: block; width: 100%; height: auto; }
svg g { font-family: "DejaVu Sans", Verdana, sans-serif; }
.files, .notes { font-size: .82rem; color: var(--soft); }
.notes { padding-left: 1.1rem; margin: .5rem 0; }
.files { margin: .25rem 0; max-width: none; }
code { font: .86em/1.4 ui-monospace, "DejaVu Sans Mono", monospace; background: var(--plate); padding: .1em .3em; border-radius: 3px; }
.missing { border-left: 3px solid #c98500; padding-left: .8rem; }
summary { cursor: pointer; font-weight: 600; }
@media print {
  @page { size: A4 landscape; margin: 12mm; }
  :root { color-scheme: light; --ink: #000; --soft: #444; --line: #bbb; --back: #fff; --plate: #f2f2f2; --link: #000; }
  svg { filter: none; }
  body { max-width: none; padding: 0; font-size: 9.5pt; }
  nav { display: none; }
  h2 { break-after: avoid; }
  .scroll { overflow: visible; border: 0; }
  table { font-size: 7pt; }
  thead th, td { overflow-wrap: anywhere; }
  tbody th, td.number { overflow-wrap: normal; }
  th, td { padding: 1pt 2.5pt; max-width: none; }
  .number { min-width: 0; }
  .line { white-space: normal; }
  tr, .panel, figcaption { break-inside: avoid; }
  figcaption { break-after: avoid; }
  .panels { grid-template-columns: 1fr 1fr 1fr; }
}
)css";

}  // namespace touchstone::report
