// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "rt/telemetry/view/embedded.h"
#include "rt/telemetry/view/view_hello.h"
#include "rt/telemetry/view/view_pack.h"
#include "rt/telemetry/view/view_tiles.h"

namespace sandrunner {
namespace {

constexpr std::size_t kMostTiles = 1024;

/// Appends what is before `line` in `html`, and takes both away from it. Throws std::logic_error if
/// page.html has no such line.
void append_until(std::string& page, std::string_view& html, std::string_view line) {
  const std::size_t at = html.find(line);
  if (at == std::string_view::npos) {
    throw std::logic_error(fmt::format("page.html: found no line '{}'", line));
  }
  page += html.substr(0, at);
  html.remove_prefix(at + line.size());
}

std::string note_of(const RunRecord& record) {
  if (record.rows.empty()) return "Not one frame was seen of this run.";
  std::string text;
  if (record.periods_per_row > 1) {
    text =
        fmt::format("A long run: shown at {} frames a second.",
                    static_cast<double>(kPolicyHz) / static_cast<double>(record.periods_per_row));
  }
  if (!record.has_truth()) {
    if (!text.empty()) text += ' ';
    text += kNoTruthNote;
  }
  return text;
}

std::string page_of(const RunRecord& record, std::string_view curve) {
  std::vector<Footprint> footprints;
  std::ranges::copy_if(record.footprints, std::back_inserter(footprints), &Footprint::shows);
  std::vector<PageData> data = {{"hello", view_hello(record.scene, note_of(record))},
                                {"frames", {}},
                                {"footprints", {}},
                                {"tiles", {}}};
  append_rows(data[1].text, page_fields(), record.rows);
  append_rows(data[2].text, kFootprintFields, footprints);
  append_rows(data[3].text, kViewTileFields, view_tiles(record.scene, record.rows, kMostTiles));
  if (!curve.empty()) append_gzip(data.emplace_back(PageData{"curve-data"}).text, curve);
  return page_with(data);
}

}  // namespace

std::string page_with(std::span<const PageData> data) {
  std::string page;
  std::string_view html = embedded_page_file("page.html");
  append_until(page, html, "<link rel=\"stylesheet\" href=\"page.css\">");
  page += fmt::format("<style>\n{}</style>", embedded_page_file("page.css"));
  append_until(page, html, "<script src=\"page.js\"></script>");
  const auto add = [&](std::string_view id, std::string_view text) {
    page += fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, text);
  };
  for (const PageData& element : data) add(element.id, element.text);
  std::string program;
  append_base64(program, embedded_page_file("page.js.gz"));
  add("program", program);
  page += fmt::format("<script>\n{}</script>", embedded_page_file("unpack.js"));
  page += html;
  return page;
}

std::string run_page(const RunRecord& record, std::size_t most_bytes, std::string_view curve) {
  std::string page = page_of(record, curve);
  const auto fits = [&](const RunRecord& r) {
    return page.size() <= most_bytes || r.rows.size() < 8;
  };
  if (fits(record)) return page;
  RunRecord thinned = record;
  do {
    page = {};
    thinned.thin();
    page = page_of(thinned, curve);
  } while (!fits(thinned));
  return page;
}

}  // namespace sandrunner
