// SPDX-License-Identifier: BSD-3-Clause
// The rules of CLAIMS.md for turns, transitions and "Other grounds", and for the peer's benchmark.
#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "rt/base/quantile.h"
#include "tools/study/claims/claim_rules.h"
#include "tools/study/claims/paper.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/lab.h"

namespace sandrunner::study {
namespace {

constexpr double kEnough = 14.0 / 16.0, kFew = 8.0 / 16.0;
const char* const kHarder[] = {"vinyl", "athletic-track", "grass"};

std::string percent(const Figure& share) { return printed(share, 100.0, 1) + " %"; }

/// A figure of one group of E2.
Figure recovery(const Case& c, const char* scenario, double command, const char* name) {
  return c.evidence().figure("E2", "ours", [&](const Measured& m) {
    return mean_value(between(m.select("dry-sand", scenario), command, command), name);
  });
}

// Turning at a rate of about x on each of these grounds, without a fall.
Outcome turns(const Case& c, const std::vector<const char*>& grounds, double x) {
  bool about = true, far = false, no_fall = true;
  std::string text;
  for (const char* ground : grounds) {
    const Figure rate = c.turn("E3", "ours", ground, 1.0, "yaw_rate_radps");
    about = about && is_about(rate, x);
    far = far || is_far_from(rate, x);
    no_fall = no_fall && median(c.turn("E3", "ours", ground, 1.0, "alive")) == 1.0;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", ground, printed(rate, 1.0, 2));
  }
  return {about && no_fall, far, text + " rad/s" + (no_fall ? "" : ", with falls")};
}

Outcome turns_on_sand(Case& c) { return turns(c, {"dry-sand"}, paper::kYawSand_radps); }

Outcome turns_everywhere(Case& c) {
  return turns(c, {"dry-sand", "wet-sand", "grass", "athletic-track", "vinyl"},
               paper::kYawAll_radps);
}

Outcome onto_wet_sand(Case& c) {
  bool alive = true, few = false, similar = true;
  std::string text;
  for (const double command : {2.0, 3.0, 4.0}) {
    const Figure share = recovery(c, "transition", command, "alive");
    const double ratio = median(recovery(c, "transition", command, "speed_after_mps")) /
                         median(recovery(c, "transition", command, "speed_before_mps"));
    alive = alive && median(share) >= kEnough;
    few = few || median(share) < kFew;
    similar = similar && ratio >= 0.9 && ratio <= 1.15;
    text += fmt::format("{}{:.0f} m/s: {} alive, {:.2f}", text.empty() ? "" : "; ", command,
                        percent(share), ratio);
  }
  return {alive && similar, few, text};
}

Outcome stabilises(Case& c) {
  const Figure alive = recovery(c, "half", 2.5, "alive");
  const Figure time_s = c.evidence().figure("E2", "ours", [](const Measured& m) {
    std::vector<double> times = m.select("dry-sand", "half").at(0)->values("recovery_s");
    std::erase_if(times, [](double t) { return std::isnan(t); });
    std::sort(times.begin(), times.end());
    return SeedValue{quantile(times, 0.5)};
  });
  return {median(alive) >= kEnough && median(time_s) <= 1.0,
          median(alive) < kFew || median(time_s) > 2.0,
          fmt::format("{} alive, {} s", percent(alive), printed(time_s, 1.0, 2))};
}

Outcome swings_high(Case& c) {
  const Figure ratio = recovery(c, "half", 2.5, "swing_ratio");
  return {median(ratio) > 1.2, median(ratio) < 1.0, printed(ratio, 1.0, 2)};
}

Outcome top_speed_on(const Case& c, const char* ground, double x) {
  const Figure top = c.top_speed("ours", ground);
  return {is_about(top, x), is_far_from(top, x), printed(top, 1.0, 2) + " m/s"};
}

Outcome top_on_grass(Case& c) { return top_speed_on(c, "grass", paper::kTopGrass_mps); }
Outcome top_on_track(Case& c) { return top_speed_on(c, "athletic-track", paper::kTopTrack_mps); }
Outcome top_on_vinyl(Case& c) { return top_speed_on(c, "vinyl", paper::kTopVinyl_mps); }

Outcome comparable_speeds(Case& c) {
  int compared = 0, apart = 0;
  double worst = 0.0;
  for (const char* ground : kHarder) {
    for (const double v : straight_commands()) {
      if (v > 3.0) continue;
      const double a = median(c.mean("ours", ground, v, v, "speed_mps"));
      const double b = median(c.mean("env-rigid", ground, v, v, "speed_mps"));
      // A controller without a success has no speed, which is not a comparable one.
      const double off = std::isnan(a) || std::isnan(b) ? 1.0 : std::fabs(a / b - 1.0);
      ++compared;
      apart += off > 0.10;
      worst = std::max(worst, off);
    }
  }
  return {worst <= 0.05, 2 * apart >= compared, fmt::format("up to {:.0f} % apart", 100.0 * worst)};
}

Outcome faster_on_track(Case& c) {
  return c.excess(c.top_speed("ours", "athletic-track"), c.top_speed("env-rigid", "athletic-track"),
                  1.0 / (1.0 - paper::kRigidLowerOnTrack) - 1.0);
}

Outcome faster_on_grass(Case& c) {
  return c.excess(c.top_speed("ours", "grass"), c.top_speed("env-rigid", "grass"),
                  1.0 / (1.0 - paper::kRigidLowerOnGrass) - 1.0);
}

Outcome slower_when_commanded_more(Case& c) {
  const Figure slow = c.mean("env-rigid", "grass", 3.0, 3.0, "speed_mps");
  const Figure fast = c.mean("env-rigid", "grass", 3.5, 3.5, "speed_mps");
  const double ratio = median(fast) / median(slow);
  return {ratio < 1.0, ratio >= 1.05,
          fmt::format("{} after {} m/s", printed(fast, 1.0, 2), printed(slow, 1.0, 2))};
}

Outcome fails_on_grass(Case& c) {
  const Figure share = c.success("env-rigid", "grass", 4.0, 4.0);
  return {median(share) <= 0.5, median(share) >= 0.9, percent(share)};
}

Outcome large_clearance(Case& c) {
  const Figure slow = c.mean("env-rigid", "grass", 3.0, 3.0, "iqr_m");
  const Figure fast = c.mean("env-rigid", "grass", 3.5, 3.5, "iqr_m");
  const double ratio = median(fast) / median(slow);
  return {ratio >= 1.2, ratio <= 1.0,
          fmt::format("{} after {} mm", printed(fast, 1e3, 1), printed(slow, 1e3, 1))};
}

Outcome same_on_vinyl(Case& c) {
  const Figure a = c.top_speed("ours", "vinyl"), b = c.top_speed("env-rigid", "vinyl");
  const double off = std::fabs(median(a) / median(b) - 1.0);
  return {off <= 0.03, off > 0.10,
          fmt::format("{} and {} m/s", printed(a, 1.0, 2), printed(b, 1.0, 2))};
}

Outcome comparable_cost(Case& c) {
  int compared = 0, higher = 0;
  double worst = 0.0;
  for (const char* ground : {"beach", "vinyl", "athletic-track", "grass"}) {
    for (const double v : straight_commands()) {
      if (!c.both_succeed("ours", "env-rigid", ground, v)) continue;
      const double ratio = median(c.mean("ours", ground, v, v, "cot")) /
                           median(c.mean("env-rigid", ground, v, v, "cot"));
      ++compared;
      higher += ratio > 1.0;
      worst = std::max(worst, ratio);
    }
  }
  if (compared == 0) c.set_too_few();
  return {compared > 0 && worst <= 1.05, 2 * higher > compared,
          fmt::format("up to {:.2f}; above 1 in {} of {}", worst, higher, compared)};
}

Outcome steep_cost(Case& c) {
  const auto rise = [&](const char* ground) {
    return median(c.mean("ours", ground, 4.0, 4.0, "cot")) /
           median(c.mean("ours", ground, 2.5, 2.5, "cot"));
  };
  const double track = rise("athletic-track") / rise("vinyl");
  const double grass = rise("grass") / rise("vinyl");
  return {track >= 1.25 && grass >= 1.25, track <= 1.0 && grass <= 1.0,
          fmt::format("track {:.2f}, grass {:.2f}", track, grass)};
}

Outcome insensitive_cost(Case& c) {
  const auto spread = [&](const char* controller) {
    std::vector<double> costs;
    for (const char* ground : {"beach", "vinyl", "athletic-track", "grass"}) {
      std::vector<double> at_commands;
      for (const double v : {1.0, 2.0, 3.0}) {
        at_commands.push_back(median(c.mean(controller, ground, v, v, "cot")));
      }
      costs.push_back(mean_of(at_commands));
    }
    return greatest_of(costs) / least_of(costs);
  };
  const double ours = spread("ours"), rigid = spread("env-rigid");
  return {ours<rigid, ours> rigid, fmt::format("{:.2f}; Env-Rigid {:.2f}", ours, rigid)};
}

Figure hidden(const Case& c, const char* name) {
  return c.evidence().figure("E4", "ours", [&](const Measured& m) {
    const auto& lists = m.groups.at(0).lists;
    const auto found = lists.find(name);
    return SeedValue{found == lists.end() ? paper::kNotPrinted : found->second.at(0)};
  });
}

Outcome tells_the_ground(Case& c) {
  const Figure told = hidden(c, "told"), shuffled = hidden(c, "told_shuffled");
  return {median(told) >= 0.75 && median(told) > median(shuffled), median(told) <= median(shuffled),
          fmt::format("{}; shuffled {}", percent(told), percent(shuffled))};
}

Outcome tells_the_phase(Case& c) {
  const Figure told = hidden(c, "phase_told");
  return {median(told) >= 0.8, median(told) < 0.4, printed(told, 1.0, 2)};
}

Outcome mattress_rate(const Case& c, double command, double x) {
  const Figure rate = c.turn("E5", "ours", "air-mattress", command, "yaw_rate_radps");
  return {is_about(rate, x, 0.25), is_far_from(rate, x, 0.25), printed(rate, 1.0, 2) + " rad/s"};
}

Outcome mattress_slow(Case& c) { return mattress_rate(c, 1.0, paper::kYawMattress1_radps); }
Outcome mattress_fast(Case& c) { return mattress_rate(c, 2.0, paper::kYawMattress2_radps); }

// Successes of the first runs each way.
double turned(const Case& c, const char* controller, std::size_t runs_each_way) {
  const Figure count = c.evidence().figure("E5", controller, [&](const Measured& m) {
    double sum = 0.0;
    for (const double way : {1.0, -1.0}) {
      const std::vector<double>& success =
          between(m.select("air-mattress", "turn"), way, way).at(0)->values("success");
      for (std::size_t i = 0; i < std::min(runs_each_way, success.size()); ++i) sum += success[i];
    }
    return SeedValue{sum};
  });
  return median(count);
}

Outcome only_one_that_turns(Case& c) {
  bool other_all = false;
  std::string text = fmt::format("Ours {:.0f}", turned(c, "ours", 5));
  for (const char* other : {"env-rigid", "pl-gm", "pl-rigid"}) {
    other_all = other_all || turned(c, other, 5) == 10.0;
    text += fmt::format(", {} {:.0f}", find_controller(other)->name, turned(c, other, 5));
  }
  const bool ours_all = turned(c, "ours", 5) == 10.0;
  return {ours_all && !other_all, !ours_all && other_all, text + " of 10"};
}

Outcome no_half_turn(Case& c) {
  const double count = turned(c, "pl-rigid", 16);
  return {count == 0.0, count >= 16.0, fmt::format("{:.0f} of 32", count)};
}

Outcome turns_dearly(Case& c) {
  const auto cost = [&](const char* controller) {
    return c.evidence().figure("E5", controller, [&](const Measured& m) {
      return mean_of_successes(between(m.select("air-mattress", "turn"), -1.0, 1.0), "cotu");
    });
  };
  bool all = true, cheaper = true;
  std::string text;
  for (const char* other : {"env-rigid", "pl-gm"}) {
    const double ratio = median(cost(other)) / median(cost("ours"));
    all = all && turned(c, other, 16) >= 1.0 && ratio >= 1.3;
    cheaper = cheaper && ratio < 1.0;
    text +=
        fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", find_controller(other)->name, ratio);
  }
  return {all, cheaper, text + " times that of Ours"};
}

Outcome walks_on_foam(Case& c) {
  const Figure alive = c.evidence().figure(
      "E6", "ours", [](const Measured& m) { return mean_value(m.select("memory-foam"), "alive"); });
  return {median(alive) >= 15.0 / 16.0, median(alive) < kFew, percent(alive) + " alive"};
}

Outcome faster_than_drft(Case& c) {
  const double ratio = c.evidence().contact->ratio;
  return {ratio >= 10.0 && ratio <= 40.0, ratio < 5.0, fmt::format("{:.1f} times", ratio)};
}

Outcome wider_than_drft(Case& c) {
  const ContactBench& b = *c.evidence().contact;
  return {
      b.spread_cone > std::max(b.spread_drft, b.spread_planar),
      b.spread_cone < std::min(b.spread_drft, b.spread_planar),
      fmt::format("{:.2f}; DRFT {:.2f} and {:.2f}", b.spread_cone, b.spread_drft, b.spread_planar)};
}

}  // namespace

const std::vector<ClaimRule>& ground_rules() {
  static const std::vector<ClaimRule> kRules = {
      {"2", {"E3"}, {"ours"}, turns_on_sand},
      {"4", {"E2"}, {"ours"}, onto_wet_sand},
      {"6", {"E2"}, {"ours"}, stabilises},
      {"7", {"E2"}, {"ours"}, swings_high},
      {"31", {"E3"}, {"ours"}, top_on_grass},
      {"32", {"E3"}, {"ours"}, top_on_track},
      {"33", {"E3"}, {"ours"}, top_on_vinyl},
      {"34", {"E3"}, {"ours"}, turns_everywhere},
      {"35", {"E3"}, {"ours", "env-rigid"}, comparable_speeds},
      {"36", {"E3"}, {"ours", "env-rigid"}, faster_on_track},
      {"37", {"E3"}, {"ours", "env-rigid"}, faster_on_grass},
      {"38", {"E3"}, {"env-rigid"}, slower_when_commanded_more},
      {"39", {"E3"}, {"env-rigid"}, fails_on_grass},
      {"39a", {"E3"}, {"env-rigid"}, large_clearance},
      {"40", {"E3"}, {"ours", "env-rigid"}, same_on_vinyl},
      {"41", {"E1", "E3"}, {"ours", "env-rigid"}, comparable_cost},
      {"42", {"E3"}, {"ours"}, steep_cost},
      {"43", {"E1", "E3"}, {"ours", "env-rigid"}, insensitive_cost},
      {"44", {"E4"}, {"ours"}, tells_the_ground},
      {"45", {"E4"}, {"ours"}, tells_the_phase},
      {"46", {"E5"}, {"ours"}, mattress_slow},
      {"47", {"E5"}, {"ours"}, mattress_fast},
      {"48", {"E5"}, mattress_controllers(), only_one_that_turns},
      {"49", {"E5"}, {"pl-rigid"}, no_half_turn},
      {"50", {"E5"}, {"ours", "env-rigid", "pl-gm"}, turns_dearly},
      {"51", {"E6"}, {"ours"}, walks_on_foam},
      {"66", {}, {}, faster_than_drft},
      {"67", {}, {}, wider_than_drft},
  };
  return kRules;
}

}  // namespace sandrunner::study
