#include "data/page/html.hpp"

namespace palpate::data {

/// Figures keep the inks of data/plot (Okabe & Ito), lighter on a dark page; on paper the page is
/// light, and the watermark stands on every sheet.
std::string_view page_style() {
    return R"css(
:root {
  --page: #ffffff; --text: #1a1a1a; --quiet: #5a5a5a; --rule: #d6d6d6; --tint: #f4f4f1; --link: #00558c;
  --cell: 0 114 178; --deep: .85; --mark: #b00020; --sans: system-ui, "Segoe UI", "DejaVu Sans", Verdana, Arial, sans-serif;
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body {
  margin: 0 auto; padding: 1.5rem 1.1rem 4rem; max-width: 57rem; background: var(--page); color: var(--text);
  font: 1.0625rem/1.55 Charter, "Bitstream Charter", "Source Serif 4", Georgia, "DejaVu Serif", serif;
}
h1, h2, h3, nav, table, .kicker, .sources, .flow, .facts, .from, figcaption, .warning, footer, .matrix { font-family: var(--sans); }
h1 { font-size: 1.75rem; line-height: 1.2; margin: .1rem 0 .8rem; }
h2 { font-size: 1.25rem; margin: 3rem 0 .6rem; padding-top: .7rem; border-top: 2px solid var(--text); }
h3 { font-size: 1rem; margin: 1.8rem 0 .5rem; }
p { margin: .5rem 0 .9rem; max-width: 44rem; overflow-wrap: anywhere; }
a { color: var(--link); }
code { font-size: .86em; }
.kicker { color: var(--quiet); font-size: .85rem; margin: 0; }
.warning { border: 2px solid var(--mark); border-left-width: .6rem; padding: .55rem .8rem; font-size: .95rem; }
nav { font-size: .88rem; border-top: 1px solid var(--rule); border-bottom: 1px solid var(--rule); padding: .6rem 0; }
nav ol { margin: 0; padding: 0; list-style: none; display: flex; flex-wrap: wrap; gap: .25rem 1.1rem; }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.6rem, 1fr)); gap: .6rem; margin: 1rem 0; }
.facts div { background: var(--tint); padding: .6rem .8rem; border-radius: .3rem; }
.facts dt { font-size: .8rem; color: var(--quiet); }
.facts dd { margin: 0; font-size: 1.05rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.facts dd small { display: block; font-weight: 400; font-size: .78rem; color: var(--quiet); }
figure, .table { margin: 0 0 2rem; }
figcaption { font-size: .86rem; line-height: 1.45; color: var(--quiet); margin: .3rem 0 .6rem; max-width: 44rem; }
.panels {
  display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, var(--w)), 1fr)); gap: .4rem .8rem; align-items: start;
}
.panels svg {
  display: block; width: 100%; max-width: calc(1.2 * var(--w)); height: auto; min-width: 0;
  font-family: "DejaVu Sans", Verdana, Arial, sans-serif;
}
svg text { fill: var(--text); }
svg .mark { fill: var(--mark); }
.scroll { overflow: auto; margin: .4rem 0; }
.sources .scroll, .trials .scroll { max-height: 32rem; }
.scroll:focus-visible { outline: 2px solid var(--link); }
table { border-collapse: collapse; font-size: .76rem; line-height: 1.35; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--quiet); padding: .2rem 0; max-width: calc(100vw - 2.6rem); }
th, td { text-align: left; padding: .18rem .42rem; border-bottom: 1px solid var(--rule); font-weight: 400; vertical-align: top; }
thead th { font-weight: 600; border-bottom: 1.5px solid var(--text); vertical-align: bottom; position: sticky; top: 0; background: var(--page); }
tbody th { min-width: 3rem; }
td.n { text-align: right; white-space: nowrap; }
th.n { text-align: right; }
.trials { display: flex; flex-wrap: wrap; gap: .1rem 1.3rem; font-family: var(--sans); font-size: .85rem; }
.trials details[open], .more[open] { flex-basis: 100%; min-width: 0; }
.trials td { white-space: nowrap; }
.more { font-family: var(--sans); font-size: .85rem; }
.hash { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: .72rem; overflow-wrap: anywhere; min-width: 12rem; }
.sources { display: flex; flex-wrap: wrap; gap: .2rem 1rem; font-size: .82rem; align-items: baseline; }
.sources details[open] { flex-basis: 100%; min-width: 0; }
summary { cursor: pointer; color: var(--link); }
pre { background: var(--tint); padding: .7rem; overflow: auto; max-height: 26rem; font-size: .78rem; line-height: 1.4; }
.from { font-size: .8rem; color: var(--quiet); margin: .2rem 0 .6rem; max-width: none; }
.flow { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 19rem), 1fr)); gap: 1.2rem; font-size: .9rem; }
.flow h4 { margin: .2rem 0 .5rem; font-size: .9rem; }
.flow ol { list-style: none; margin: 0; padding: 0; }
.flow li { border: 1px solid var(--rule); border-radius: .3rem; padding: .5rem .7rem; margin: 0 0 1.5rem; position: relative; background: var(--tint); }
.flow li:not(:last-child)::after { content: "\2193"; position: absolute; left: 1rem; bottom: -1.45rem; color: var(--quiet); }
.flow b { font-variant-numeric: tabular-nums; }
.flow .gone { display: block; color: var(--quiet); font-size: .82rem; padding-left: .7rem; border-left: 2px solid var(--rule); margin-top: .3rem; }
.matrices { display: flex; flex-wrap: wrap; gap: 1rem 2rem; }
.matrices .scroll { flex: 1 1 23rem; max-width: 34rem; }
.matrix { table-layout: fixed; width: 100%; min-width: 21rem; }
.matrix td { text-align: center; padding: .3rem .15rem; border: 1px solid var(--page); background: rgb(var(--cell) / calc(var(--a) * var(--deep))); }
.matrix td small { display: block; font-size: .68rem; }
.matrix td.right { box-shadow: inset 0 0 0 2px var(--text); }
.matrix thead th { text-align: center; border: 0; font-size: .66rem; font-weight: 400; position: static; padding: .1rem .15rem; }
.matrix thead td, .matrix tbody th { width: 5.1rem; background: none; }
.matrix th { border: 0; padding-left: 0; vertical-align: middle; }
.bar { display: inline-block; width: 5rem; height: .7rem; vertical-align: -.05rem; border: 1px solid var(--rule);
  background: linear-gradient(90deg, #0072b2 var(--a), #e69f00 var(--a) var(--b), #56b4e9 var(--b)); }
footer { margin-top: 3rem; border-top: 1px solid var(--rule); font-size: .8rem; color: var(--quiet); }
body::after {
  position: fixed; left: 50%; top: 50%; transform: translate(-50%, -50%) rotate(-28deg); pointer-events: none; z-index: 9;
  font: 700 min(15vw, 9rem)/1 var(--sans); letter-spacing: .06em; color: var(--mark); opacity: .07;
}
@media (max-width: 30rem) {
  body { font-size: 1rem; padding: 1rem .8rem 3rem; }
  h1 { font-size: 1.4rem; }
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --page: #16181b; --text: #e8e6e1; --quiet: #a9a7a1; --rule: #3b3e43; --tint: #212429; --link: #7cc0f0;
    --cell: 70 150 215; --deep: .6; --mark: #ff8a95;
  }
  svg [stroke="#444444"] { stroke: #9a9a9a; }
  svg rect[fill="#ffffff"] { fill: #16181b; }
  svg [stroke="#e4e4e4"] { stroke: #33363b; }
  svg [fill="#777777"] { fill: #a4a4a4; }
  svg [stroke="#777777"] { stroke: #a4a4a4; }
  svg [fill="#000000"] { fill: #f2f2f2; }
  svg [stroke="#000000"] { stroke: #f2f2f2; }
  svg [fill="#0072b2"] { fill: #4fb0ea; }
  svg [stroke="#0072b2"] { stroke: #4fb0ea; }
  svg [fill="#d55e00"] { fill: #ff8b3d; }
  svg [stroke="#d55e00"] { stroke: #ff8b3d; }
  svg [fill="#009e73"] { fill: #2fd0a2; }
  svg [stroke="#009e73"] { stroke: #2fd0a2; }
  svg [fill="#aa4499"] { fill: #e08ad2; }
  svg [stroke="#aa4499"] { stroke: #e08ad2; }
  body::after { opacity: .12; }
}
@media print {
  @page { margin: 16mm 14mm; }
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  h2, h3 { break-after: avoid; }
  figure .panels, figure > .matrices, .flow, .facts, li, tr, svg { break-inside: avoid; }
  details, nav, .csv, .from a { display: none; }
  .panels { grid-template-columns: repeat(auto-fill, minmax(min(100%, calc(.77 * var(--w))), 1fr)); }
  .scroll, .sources .scroll { overflow: visible; max-height: none; }
  table { font-size: .6rem; }
  th, td { padding: .15rem .2rem; }
  tbody th { min-width: 0; }
  .hash { min-width: 0; }
  .matrices { display: grid; grid-template-columns: 1fr 1fr; }
  .matrix { min-width: 0; }
  thead th { position: static; }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  body::after { opacity: .1; }
}
)css";
}

}  // namespace palpate::data
