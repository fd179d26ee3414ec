// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/page.h"

#include <fmt/format.h>

#include "sgs/report/html.h"
#include "sgs/report/report_script.h"
#include "sgs/report/surface_script.h"

namespace sgs::report {
namespace {

constexpr std::string_view kPageCss = R"css(
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--ink);font:15px/1.5 system-ui,-apple-system,"Segoe UI",
Roboto,"Helvetica Neue",sans-serif;counter-reset:figure}
main{max-width:1100px;margin:0 auto;padding:30px 18px 60px}
h1{font-size:1.8rem;margin:0;letter-spacing:-.015em;overflow-wrap:anywhere}
h2{font-size:1.15rem;margin:0 0 10px}
h3{font-size:.78rem;margin:0 0 4px;color:var(--soft);text-transform:uppercase;letter-spacing:.05em}
.sub,.lead,.notes{color:var(--soft);margin:4px 0 12px;overflow-wrap:anywhere}
.notes{font-size:.85rem;padding-left:18px}
.warn{border-left:4px solid var(--c1);padding:6px 12px;margin:12px 0;background:var(--card)}
.tags>span{display:inline-block;border:1px solid var(--line);background:var(--card);border-radius:99px;
padding:2px 11px;margin:0 6px 6px 0;font-size:.85rem;overflow-wrap:anywhere}
.tags b{color:var(--soft);font-weight:500}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(135px,1fr));gap:12px;margin:18px 0}
.tile,section{background:var(--card);border:1px solid var(--line);border-radius:12px}
.tile{padding:12px 16px}.tile b{display:block;font-size:1.4rem;font-weight:650;white-space:nowrap}
.tile span{color:var(--soft);font-size:.85rem}
section{padding:20px;margin:16px 0}
.groups{display:grid;grid-template-columns:repeat(auto-fit,minmax(270px,1fr));gap:18px 30px}
table{border-collapse:collapse;width:100%;font-size:.9rem}
td,th{padding:3px 0;border-bottom:1px solid var(--line);text-align:left;font-weight:400}
td.v,th.v{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap;padding-left:14px}
th.v{font-weight:600}td.best{font-weight:700}td.best::before{content:"★ ";color:var(--c4)}
tr.group td{border:0;padding-top:12px}
td code{font-size:.85em;overflow-wrap:anywhere}
.key{display:inline-block;width:14px;height:3px;background:currentColor;vertical-align:middle;
margin-right:6px}
.scroll{overflow-x:auto}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,400px),1fr));gap:14px 22px}
figure{margin:0 0 18px;min-width:0}figure:last-child{margin-bottom:0}
figcaption{font-size:.86rem;color:var(--soft);margin-top:4px;max-width:82ch}
figcaption::before{counter-increment:figure;content:"Figure " counter(figure) ". ";
color:var(--ink);font-weight:600}
svg{display:block;width:100%;height:auto}svg.time{cursor:crosshair}
.cursor{stroke:var(--ink);stroke-width:1;opacity:.6;pointer-events:none}
.slide{position:relative;--x:50%;border-radius:8px;overflow:hidden;line-height:0}
.slide img{width:100%;display:block}
.slide .over{position:absolute;inset:0;clip-path:inset(0 0 0 var(--x))}
.slide .bar-line{position:absolute;top:0;bottom:0;left:var(--x);width:2px;margin-left:-1px;
background:#fff;box-shadow:0 0 3px #000}
.slide .tip{position:absolute;bottom:8px;line-height:1;font-size:.75rem;background:#000a;color:#fff;
padding:4px 8px;border-radius:99px;pointer-events:none}
.slide .tip.l{left:8px}.slide .tip.r{right:8px}
.slide input{position:absolute;inset:0;width:100%;height:100%;margin:0;opacity:0;cursor:ew-resize}
.slide:focus-within{outline:3px solid var(--accent);outline-offset:2px}
.slide .err{position:absolute;inset:0;display:none;pointer-events:none}
.shot:has(label input:checked) .err{display:block}
.shot label{float:right;font-size:.86rem;color:var(--soft);margin-top:4px}
.scene canvas{width:100%;aspect-ratio:16/9;min-height:300px;display:block;border-radius:8px;
touch-action:pan-y;cursor:grab;background:var(--bg)}
.scene canvas:focus-visible{outline:3px solid var(--accent)}
.tools{display:flex;flex-wrap:wrap;gap:6px 16px;align-items:center;font-size:.86rem;
color:var(--soft);margin:8px 0}
.tools button,.tools select{font:inherit;color:var(--ink);background:var(--bg);
border:1px solid var(--line);border-radius:6px;padding:2px 10px;cursor:pointer}
.tools input[type=range]{flex:1;min-width:140px;accent-color:var(--accent)}
.tools output{font-variant-numeric:tabular-nums;min-width:24ch}
details{margin-top:12px}section>details{margin-top:0}section>.scroll+details{margin-top:12px}details summary{cursor:pointer;font-weight:600}
pre{overflow-x:auto;font:12.5px/1.45 ui-monospace,Menlo,Consolas,monospace;margin:12px 0 0}
@media print{section{break-inside:avoid}.tools{display:none}}
)css";

constexpr std::string_view kPolicy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

}  // namespace

std::string section_html(std::string_view title, std::string_view lead, std::string_view content) {
  if (content.empty()) return {};
  return fmt::format("<section><h2>{}</h2>{}{}</section>\n", title,
                     lead.empty() ? "" : fmt::format("<p class='lead'>{}</p>", lead), content);
}

std::string figure_html(const Drawing& drawing) {
  if (drawing.empty()) return {};
  return fmt::format("<figure id='{}'>{}<figcaption>{}</figcaption></figure>\n", drawing.name,
                     drawing.svg, drawing.caption);
}

std::string figures_html(const std::vector<Drawing>& drawings, bool side_by_side) {
  std::string html;
  for (const Drawing& drawing : drawings) html += figure_html(drawing);
  return side_by_side && !html.empty() ? "<div class='pair'>" + html + "</div>" : html;
}

std::string slider_html(const eval::FramePictures& p) {
  return fmt::format(
      "<div class='shot'><div class='slide'><img alt='camera, frame {0}' "
      "src='{1}'><div class='over'><img alt='rendering, frame {0}' src='{2}'></div>"
      "<div class='bar-line'></div><span class='tip l'>camera</span><span class='tip r'>rendering"
      "</span><input type='range' min='0' max='100' value='50' aria-label='camera to the left, "
      "rendering to the right, frame {0}'><img class='err' alt='error, frame {0}' "
      "src='{3}'></div><label><input type='checkbox'> error</label><p class='sub'>Frame {0}{4} · "
      "{5:.2f} dB</p></div>\n",
      p.index, jpeg_data_uri(p.truth), jpeg_data_uri(p.rendering), jpeg_data_uri(p.error),
      p.heldout ? " (held out)" : "", p.psnr_full_db);
}

std::string page_html(std::string_view title, std::string_view body) {
  std::string html =
      "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
      "content='width=device-width,initial-scale=1'><meta http-equiv='Content-Security-Policy' "
      "content=\"";
  html += kPolicy;
  html += "\"><link rel='icon' href='data:,'><title>" + html_escaped(title) +
          " · Spectral GS-SLAM</title><style>";
  html += palette_css();
  html += svg_css();
  html += kPageCss;
  html += "</style></head><body><main>";
  html += body;
  html += "</main>";
  // A page without anything to move needs no script.
  if (body.find("<svg") != std::string_view::npos ||
      body.find("class='slide'") != std::string_view::npos) {
    html += "<script>";
    html += report_surface_script();
    html += report_script();
    html += "</script>";
  }
  return html + "</body></html>\n";
}

}  // namespace sgs::report
