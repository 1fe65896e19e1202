// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/html_page.h"

#include <fmt/format.h>

namespace limber::program {
namespace {

constexpr const char* before_title = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
)";

constexpr const char* page_style = R"(:root {
  --page: #f6f5f2; --card: #ffffff; --ink: #23282d; --soft: #68707a; --rule: #dfe1e2; --axis: #9aa1a8;
  --first: #1f5f9e; --second: #c4622d; --mark: #c0273f; --halo: #ffffffc0;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #14171a; --card: #1d2125; --ink: #e4e7ea; --soft: #9aa3ac; --rule: #32383e; --axis: #6a727a;
    --first: #6cb0f0; --second: #ee9a62; --mark: #ff6b80; --halo: #000000a0;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0; padding: 40px 20px 60px; background: var(--page); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
}
main { max-width: 1000px; margin: 0 auto; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 10px; letter-spacing: -0.01em; }
h2 { font-size: 17px; margin: 0 0 2px; }
p { margin: 0; max-width: 74ch; }
.soft { color: var(--soft); font-size: 14px; max-width: none; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin: 26px 0 0; }
.tiles div, section { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; }
.tiles div { padding: 14px 18px; }
.tiles b { display: block; font-size: 24px; line-height: 1.3; font-weight: 600; font-variant-numeric: tabular-nums; }
section { margin-top: 20px; padding: 18px 20px 14px; }
section > svg { display: block; width: 100%; height: auto; margin-top: 10px; }
section > .chart { width: calc(100% - 68px); height: 230px; margin: 14px 10px 4px 58px; overflow: visible; }
.chart text, .legend { font-size: 13px; fill: var(--soft); color: var(--soft); }
.chart text { font-variant-numeric: tabular-nums; }
.chart .value, .chart .name { text-anchor: end; }
.chart .frame { text-anchor: middle; }
.legend { display: flex; flex-wrap: wrap; gap: 2px 18px; margin-top: 10px; max-width: none; }
.legend .unit { flex-grow: 1; }
.symbol { margin-right: 6px; }
.chart *, .symbol * { vector-effect: non-scaling-stroke; }
.grid { stroke: var(--rule); }
.axis { stroke: var(--axis); }
.line { fill: none; stroke-width: 1.6; stroke-linejoin: round; }
.first { stroke: var(--first); }
.second { stroke: var(--second); }
.mark { stroke: var(--mark); stroke-width: 1.6; fill: none; }
table { border-collapse: collapse; width: 100%; margin-top: 8px; font-variant-numeric: tabular-nums; font-size: 15px; }
th, td { text-align: left; padding: 7px 0; border-top: 1px solid var(--rule); vertical-align: top; }
tr:first-child > * { border-top: 0; }
th { font-weight: 400; color: var(--soft); width: 34%; max-width: 15em; padding-right: 12px; }
@media (max-width: 640px) {
  body { padding: 24px 12px 40px; }
  h1 { font-size: 26px; }
  section { padding: 14px 14px 12px; }
  .tiles div { padding: 10px 14px; }
}
)";

constexpr const char* after_style = R"(</style>
</head>
<body>
<main>
)";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string page_head(const std::string& title, const std::string& own_style) {
  return before_title + ("<title>" + title + "</title>\n<style>\n") + page_style + own_style + after_style;
}

std::string page_end() { return "</main>\n</body>\n</html>\n"; }

std::string in_html(const std::string& text) {
  std::string html;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_after_digit = i > 0 && is_digit(text[i - 1]);
    if (is_after_digit && text.compare(i, 3, " us") == 0) {
      html += "&nbsp;&micro;s";
      i += 2;
    } else if (is_after_digit && text[i] == ' ' && i + 1 < text.size() && is_digit(text[i + 1])) {
      html += "&nbsp;";
    } else {
      html += text[i];
    }
  }
  return html;
}

std::string page_section(const std::string& id, const std::string& title, const std::string& caption,
                         const std::string& content) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p class=\"soft\">{}</p>\n{}</section>\n", id, title, caption,
                     content);
}

std::string page_tile(const std::string& number, const std::string& name) {
  return fmt::format("<div><b>{}</b><span class=\"soft\">{}</span></div>\n", in_html(number), name);
}

std::string page_rows(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string html = "<table>\n";
  for (const auto& [name, text] : rows) {
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, in_html(text));
  }
  return html + "</table>\n";
}

}  // namespace limber::program
