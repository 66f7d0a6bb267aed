// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "rt/telemetry/view/embedded.h"
#include "rt/telemetry/view/view_hello.h"
#include "rt/telemetry/view/view_pack.h"
#include "rt/telemetry/view/view_tiles.h"

namespace sandrunner {
namespace {

constexpr std::size_t kLongestStride = kPolicyHz / 25;
constexpr std::size_t kMostTiles = 1024;

// A frame that is left out leaves its extremes, and its share in the means, to the next one.
// `weight`: of the frames that `from` stands for.
void hand_on(const ViewFrame& from, std::size_t weight, ViewFrame& to) {
  for (std::size_t j = 0; j < kNumJoints; ++j) {
    if (std::abs(from.peak_torque_nm[j]) > std::abs(to.peak_torque_nm[j])) {
      to.peak_torque_nm[j] = from.peak_torque_nm[j];
    }
  }
  const auto n = static_cast<float>(weight);
  to.power_w = (n * from.power_w + to.power_w) / (n + 1.0f);
  to.torque_squared_nm2 = (n * from.torque_squared_nm2 + to.torque_squared_nm2) / (n + 1.0f);
  to.late_us = std::max(from.late_us, to.late_us);
  to.control_us = std::max(from.control_us, to.control_us);
  to.tick_us = std::max(from.tick_us, to.tick_us);
}

void replace(std::string& text, std::string_view what, std::string_view by) {
  text.replace(text.find(what), what.size(), by);
}

std::string data(std::string_view id, std::string_view content) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, content);
}

}  // namespace

ViewPage::ViewPage(RunScene scene, const RobotDescription& robot, const ViewPageLimits& limits)
    : scene_(std::move(scene)), robot_(robot), limits_(limits), maker_(robot) {}

void ViewPage::add(const TickRecord& tick) {
  if (const std::optional<ViewFrame> frame = maker_.add(tick)) add_frame(*frame);
  for (const ViewFootprint& print : maker_.take_footprints()) footprints_.push_back(print);
}

void ViewPage::add_frame(ViewFrame frame) {
  if (left_out_) hand_on(*left_out_, since_kept_, frame);
  left_out_.reset();
  if (++since_kept_ < stride_) {
    left_out_ = frame;
    return;
  }
  since_kept_ = 0;
  frames_.push_back(frame);
  if (frames_.size() >= limits_.frames) keep_less();
}

void ViewPage::keep_less() {
  if (stride_ < kLongestStride) {
    const std::size_t pairs = frames_.size() / 2;
    for (std::size_t i = 0; i < pairs; ++i) {
      hand_on(frames_[2 * i], 1, frames_[2 * i + 1]);
      frames_[i] = frames_[2 * i + 1];
    }
    frames_.resize(pairs);
    stride_ *= 2;
    return;
  }
  begins_later_ = true;
  frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(frames_.size() / 4));
  std::erase_if(footprints_, [&](const ViewFootprint& p) { return p.t_s < frames_.front().t_s; });
}

std::string ViewPage::note() const {
  if (frames_.empty()) return "Not one frame was seen of this run.";
  std::string text;
  if (stride_ > 1) {
    text = fmt::format("A long run: shown at {} frames a second. ", kPolicyHz / stride_);
  }
  if (begins_later_) {
    text += fmt::format("Only its end, from {:.1f} s on, is in this page. ", frames_.front().t_s);
  }
  if ((frames_.back().flags & kViewHasTruth) == 0) {
    text += "This robot does not tell what really is: all that is shown is measured or estimated. ";
  }
  return text.substr(0, text.empty() ? 0 : text.size() - 1);
}

std::string ViewPage::html(std::string_view curve) {
  if (const std::optional<ViewFrame> frame = maker_.take_last()) add_frame(*frame);
  while (true) {
    std::string page = page_of_all(curve);
    if (page.size() <= limits_.bytes || frames_.size() < 8) return page;
    keep_less();
  }
}

std::string ViewPage::page_of_all(std::string_view curve) const {
  const std::vector<ViewTile> tiles = view_tiles(scene_, frames_, kMostTiles);
  std::string page(embedded_page_file("page.html"));
  replace(page, "<link rel=\"stylesheet\" href=\"page.css\">",
          fmt::format("<style>\n{}</style>", embedded_page_file("page.css")));
  const int rate_hz = kPolicyHz / static_cast<int>(stride_);
  replace(page, "<script src=\"page.js\"></script>",
          data("hello", view_hello(scene_, robot_, rate_hz, note())) +
              data("frames", pack_rows(view_frame_fields(), frames_)) +
              data("footprints", pack_rows(view_footprint_fields(), footprints_)) +
              data("tiles", pack_rows(view_tile_fields(), tiles)) +
              (curve.empty() ? "" : data("curve-data", base64(gzip(curve)))) +
              data("program", base64(embedded_page_file("page.js.gz"))) +
              fmt::format("<script>\n{}</script>", embedded_page_file("unpack.js")));
  return page;
}

}  // namespace sandrunner
