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

// Throws std::logic_error if page.html has no such line.
void replace(std::string& text, std::string_view what, std::string_view by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) {
    throw std::logic_error(fmt::format("page.html: found no line '{}'", what));
  }
  text.replace(at, what.size(), by);
}

std::string data(std::string_view id, std::string_view content) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, content);
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
  const std::vector<RunRow> rows(record.rows.begin(), record.rows.end());
  const std::vector<ViewTile> tiles = view_tiles(record.scene, rows, kMostTiles);
  std::vector<Footprint> footprints;
  std::ranges::copy_if(record.footprints, std::back_inserter(footprints), &Footprint::shows);
  std::string page(embedded_page_file("page.html"));
  replace(page, "<link rel=\"stylesheet\" href=\"page.css\">",
          fmt::format("<style>\n{}</style>", embedded_page_file("page.css")));
  replace(page, "<script src=\"page.js\"></script>",
          data("hello", view_hello(record.scene, note_of(record))) +
              data("frames", pack_rows(page_fields(), rows)) +
              data("footprints", pack_rows(kFootprintFields, footprints)) +
              data("tiles", pack_rows(kViewTileFields, tiles)) +
              (curve.empty() ? "" : data("curve-data", base64(gzip(curve)))) +
              data("program", base64(embedded_page_file("page.js.gz"))) +
              fmt::format("<script>\n{}</script>", embedded_page_file("unpack.js")));
  return page;
}

}  // namespace

std::string run_page(const RunRecord& record, std::size_t most_bytes, std::string_view curve) {
  std::string page = page_of(record, curve);
  if (page.size() <= most_bytes || record.rows.size() < 8) return page;
  page = {};
  RunRecord thinned = record;
  thinned.thin();
  return run_page(thinned, most_bytes, curve);
}

}  // namespace sandrunner
