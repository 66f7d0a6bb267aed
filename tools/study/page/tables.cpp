// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/page/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "tools/evaluate/statistics.h"
#include "tools/study/claims/paper.h"
#include "tools/study/evidence/grid_evidence.h"
#include "tools/study/experiments/anchors.h"
#include "tools/study/experiments/lab.h"
#include "tools/study/page/html.h"

namespace sandrunner::study {
namespace {

std::string name_cell(const Controller& controller) {
  const plot::Color& c = controller.style.color;
  return fmt::format("<span class=\"key\" style=\"background:rgb({:.0f},{:.0f},{:.0f})\"></span>{}",
                     255 * c.red, 255 * c.green, 255 * c.blue, controller.name);
}

std::string number(double value, double scale, int digits, const char* unit = "") {
  if (std::isnan(value)) return "not printed";
  return fmt::format("{:.{}f}{}", scale * value, digits, unit);
}

std::string csv_field(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string(2, c) : std::string(1, c);
  return out + "\"";
}

const char* verdict_class(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgrees:
      return "agrees";
    case Verdict::kContradicts:
      return "contradicts";
    case Verdict::kCannotTell:
      return "unknown";
    case Verdict::kNotTestable:
      return "untestable";
  }
  return "";
}

// A figure of all groups of a ground and scenario of an experiment.
Figure figure_of(const Evidence& evidence, const char* experiment, const char* controller,
                 const std::string& ground, const std::string& scenario, double command,
                 const char* name) {
  return evidence.figure(experiment, controller, [&](const Measured& m) {
    return mean_value(between(m.select(ground, scenario), command, command), name);
  });
}

// The greatest of the means over all successful runs at a command.
Figure mean_at_best(const Evidence& evidence, const char* controller, const char* name) {
  return evidence.figure("E1", controller, [&](const Measured& m) {
    SeedValue best{paper::kNotPrinted};
    for (const RunGroup* group : m.select("beach")) {
      best.value = std::fmax(best.value, mean_of_successes({group}, name).value);
    }
    return best;
  });
}

// Success, average and top speed of a controller on the beach, ours: columns 3, 5, 6, 8, 9.
void add_beach_figures(const Evidence& evidence, const char* controller,
                       std::vector<std::string>& row) {
  const auto greatest = [&](const char* name) {
    return evidence.figure("E1", controller, [&](const Measured& m) {
      return greatest_of_first_five(m.select("beach"), name);
    });
  };
  const Figure success = evidence.figure(
      "E1", controller, [](const Measured& m) { return mean_value(m.select("beach"), "success"); });
  row[3] = printed(success, 100.0, 1);
  row[5] = printed(greatest("speed_mps"), 1.0, 3);
  row[6] = printed(mean_at_best(evidence, controller, "speed_mps"), 1.0, 3);
  row[8] = printed(greatest("end_speed_mps"), 1.0, 3);
  row[9] = printed(mean_at_best(evidence, controller, "end_speed_mps"), 1.0, 3);
}

}  // namespace

std::string range_of_seeds(const std::map<int, Measured>& seeds) {
  std::vector<int> numbers;
  for (const auto& [seed, measured] : seeds) numbers.push_back(seed);
  return fmt::format("{}", fmt::join(numbers, ", "));
}

std::vector<JudgedClaim> judge_all(const Evidence& evidence) {
  std::vector<JudgedClaim> judged;
  for (const Claim& claim : claims()) judged.push_back({claim, judge(claim, evidence)});
  return judged;
}

std::string verdict_counts(const std::vector<JudgedClaim>& judged) {
  HtmlTable table{{"verdict", "claims"}, {}};
  for (const Verdict verdict :
       {Verdict::kAgrees, Verdict::kContradicts, Verdict::kCannotTell, Verdict::kNotTestable}) {
    std::map<std::string, int> reasons;
    int count = 0;
    for (const JudgedClaim& j : judged) {
      if (j.judgement.verdict != verdict) continue;
      ++count;
      if (!j.judgement.reason.empty()) ++reasons[j.judgement.reason];
    }
    std::string text = std::to_string(count);
    for (const auto& [reason, n] : reasons) text += fmt::format(", {} of them {}", n, reason);
    table.rows.push_back(
        {fmt::format("<span class=\"{}\">{}</span>", verdict_class(verdict), verdict_name(verdict)),
         text});
  }
  return table.html();
}

std::string verdict_tables(const std::vector<JudgedClaim>& judged) {
  std::string out;
  for (std::size_t i = 0; i < judged.size();) {
    const std::string section = judged[i].claim.section;
    HtmlTable table{
        {"id", "the paper", "our figure", "agrees if", "contradicts if", "ours", "verdict"}, {}};
    for (; i < judged.size() && judged[i].claim.section == section; ++i) {
      const auto& [claim, judgement] = judged[i];
      table.rows.push_back(
          {claim.id, from_markdown(claim.quote), from_markdown(claim.figure),
           from_markdown(claim.agrees_if), from_markdown(claim.contradicts_if),
           escaped(judgement.ours),
           fmt::format("<span class=\"{}\">{}</span>", verdict_class(judgement.verdict),
                       escaped(judgement_text(judgement)))});
    }
    out +=
        fmt::format("<h3>{}</h3>\n<div class=\"claims\">{}</div>", escaped(section), table.html());
  }
  return out;
}

std::string claims_csv(const std::vector<JudgedClaim>& judged) {
  std::string text = "id,paper,figure,agrees_if,contradicts_if,ours,verdict\n";
  for (const auto& [claim, judgement] : judged) {
    text += claim.id;
    for (const std::string& field :
         {claim.quote, claim.figure, claim.agrees_if, claim.contradicts_if, judgement.ours,
          judgement_text(judgement)}) {
      text += fmt::format(",{}", csv_field(field));
    }
    text += "\n";
  }
  return text;
}

std::string fairness_table(const Evidence& evidence) {
  HtmlTable table{{"controller", "seeds", "alive at 1 m/s, %", "at 2 m/s, %", "at 3 m/s, %",
                   "competently trained"},
                  {}};
  for (const char* key : trained_controllers()) {
    const Controller& controller = *find_controller(key);
    const auto* seeds = evidence.find("fairness", controller.key);
    if (seeds == nullptr) {
      table.rows.push_back({name_cell(controller), kNotRun, "", "", "", ""});
      continue;
    }
    std::vector<std::string> row = {name_cell(controller), range_of_seeds(*seeds)};
    for (const double v : {1.0, 2.0, 3.0}) {
      row.push_back(printed(figure_of(evidence, "fairness", controller.key, "own", "", v, "alive"),
                            100.0, 0));
    }
    row.push_back(is_competent(evidence, controller.key) ? "yes"
                                                         : "<span class=\"contradicts\">no</span>");
    table.rows.push_back(row);
  }
  return table.html();
}

std::string beach_table(const Evidence& evidence) {
  HtmlTable table{
      {"controller", "seeds", "success, %: paper", "ours", "average, m/s: paper", "ours",
       "ours, mean of all runs", "top, m/s: paper", "ours", "ours, mean of all runs"},
      {}};
  for (const paper::BeachRow& paper_row : paper::kBeach) {
    const Controller& controller = *find_controller(paper_row.controller);
    const auto* seeds = evidence.find("E1", controller.key);
    std::vector<std::string> row(10);
    row[0] = name_cell(controller);
    row[2] = number(paper_row.success, 100.0, 1);
    row[4] = number(paper_row.average_mps, 1.0, 3);
    row[7] = number(paper_row.top_mps, 1.0, 3);
    if (seeds == nullptr) {
      row[1] = row[3] = row[5] = row[6] = row[8] = row[9] = kNotRun;
    } else {
      row[1] = range_of_seeds(*seeds);
      add_beach_figures(evidence, controller.key, row);
    }
    table.rows.push_back(row);
  }
  if (evidence.find("E1", "published") != nullptr) {  // the paper's numbers are those of Ours
    std::vector<std::string> row(10);
    row[0] = name_cell(*find_controller("published"));
    add_beach_figures(evidence, "published", row);
    table.rows.push_back(row);
  }
  return table.html();
}

std::string recovery_table(const Evidence& evidence) {
  if (evidence.find("E2", "ours") == nullptr) return fmt::format("<p>{}</p>\n", kNotRun);
  HtmlTable loose{{"stiffness under one stance, 2.5 m/s", "alive, %", "met it, %",
                   "time until 90 % of the speed, s", "next swing over usual"},
                  {}};
  for (const char* scenario : {"half", "quarter"}) {
    const auto figure = [&](const char* name) {
      return figure_of(evidence, "E2", "ours", "dry-sand", scenario, 2.5, name);
    };
    loose.rows.push_back({scenario, printed(figure("alive"), 100.0, 1),
                          printed(figure("met"), 100.0, 1), printed(figure("recovery_s"), 1.0, 2),
                          printed(figure("swing_ratio"), 1.0, 2)});
  }
  HtmlTable wet{
      {"from dry onto wet sand, command, m/s", "alive, %", "speed before, m/s", "speed after, m/s"},
      {}};
  for (const double v : {2.0, 3.0, 4.0}) {
    const auto figure = [&](const char* name) {
      return figure_of(evidence, "E2", "ours", "dry-sand", "transition", v, name);
    };
    wet.rows.push_back({fmt::format("{:.0f}", v), printed(figure("alive"), 100.0, 1),
                        printed(figure("speed_before_mps"), 1.0, 2),
                        printed(figure("speed_after_mps"), 1.0, 2)});
  }
  return loose.html() + wet.html();
}

std::string hidden_state_table(const Evidence& evidence) {
  if (evidence.find("E4", "ours") == nullptr) return fmt::format("<p>{}</p>\n", kNotRun);
  HtmlTable table{{"ten nearest neighbours in other runs", "value"}, {}};
  const auto add = [&](const char* text, const char* name, double scale, int digits) {
    const Figure figure = evidence.figure("E4", "ours", [&](const Measured& m) {
      const auto& lists = m.groups.at(0).lists;
      const auto found = lists.find(name);
      return SeedValue{found == lists.end() ? paper::kNotPrinted : found->second.at(0)};
    });
    table.rows.push_back({text, printed(figure, scale, digits)});
  };
  add("share of hidden states whose ground they tell, % (chance: 25)", "told", 100.0, 1);
  add("the same with grounds shuffled over runs, 95th percentile, %", "told_shuffled", 100.0, 1);
  add("share of estimates whose ground they tell, %", "told_by_estimate", 100.0, 1);
  add("phase of the gait: length of the mean of exp(i error)", "phase_told", 1.0, 3);
  return table.html();
}

std::string foam_table(const Evidence& evidence) {
  HtmlTable table{{"controller", "alive, %", "speed before, m/s", "speed after, m/s"}, {}};
  for (const char* key : {"ours", "env-rigid"}) {
    const Controller& controller = *find_controller(key);
    if (evidence.find("E6", key) == nullptr) {
      table.rows.push_back({name_cell(controller), kNotRun, "", ""});
      continue;
    }
    const auto figure = [&](const char* name) {
      return figure_of(evidence, "E6", key, "memory-foam", "", 0.5, name);
    };
    table.rows.push_back({name_cell(controller), printed(figure("alive"), 100.0, 1),
                          printed(figure("speed_before_mps"), 1.0, 2),
                          printed(figure("speed_after_mps"), 1.0, 2)});
  }
  return table.html();
}

std::string grid_table(const Evidence& evidence) {
  HtmlTable table{{"controller", "seeds", "mean reward", "worst cell", "softest quarter",
                   "stiffest quarter", "success, %", "worst cell, %", "clearance, mm",
                   "mm a decade of sigma_flat", "mm a decade of sigma_cone"},
                  {}};
  for (const char* key : grid_controllers()) {
    const Controller& controller = *find_controller(key);
    const auto* seeds = evidence.find("E7", key);
    if (seeds == nullptr) {
      table.rows.push_back({name_cell(controller), kNotRun});
      table.rows.back().resize(table.heads.size());
      continue;
    }
    const auto cells = [&](const std::function<double(const Measured&)>& of) {
      return evidence.figure("E7", key, [&](const Measured& m) { return SeedValue{of(m)}; });
    };
    const auto slope = [&](const char* name) {
      const Figure figure = grid_figure(evidence, key, name);
      const evaluate::Estimate first = evaluate::mean_interval(figure.begin()->second.runs);
      return fmt::format("{} ({:.1f} to {:.1f})", printed(figure, 1e3, 1), 1e3 * first.low,
                         1e3 * first.high);
    };
    const auto least = [](const char* name) {
      return [=](const Measured& m) { return least_of(grid_list(m, name)); };
    };
    table.rows.push_back(
        {name_cell(controller), range_of_seeds(*seeds),
         printed(grid_figure(evidence, key, "reward"), 1.0, 2),
         printed(cells(least("reward")), 1.0, 2),
         printed(cells([](const Measured& m) { return soft_and_stiff(m, "reward").soft; }), 1.0, 2),
         printed(cells([](const Measured& m) { return soft_and_stiff(m, "reward").stiff; }), 1.0,
                 2),
         printed(grid_figure(evidence, key, "success"), 100.0, 1),
         printed(cells(least("success")), 100.0, 0),
         printed(cells([](const Measured& m) { return mean_of(grid_list(m, "clearance_m")); }), 1e3,
                 1),
         slope("slope_flat_m"), slope("slope_cone_m")});
  }
  return table.html();
}

std::string contact_table(const Evidence& evidence) {
  if (!evidence.contact) {
    return fmt::format(
        "<p>{}: <code>--contact FILE</code> reads what <code>sandrunner-bench contact --json "
        "FILE</code> wrote.</p>\n",
        kNotRun);
  }
  const ContactBench& bench = *evidence.contact;
  HtmlTable table{{"figure", "paper", "ours"}, {}};
  table.rows = {
      {"time of DRFT over that of the cone model", "about 20", fmt::format("{:.1f}", bench.ratio)},
      {"final depths, cone model, mm", "not printed", escaped(bench.cone_mm)},
      {"final depths, DRFT in space, mm", "not printed", escaped(bench.drft_mm)},
      {"final depths, DRFT in a plane, mm", "not printed", escaped(bench.planar_mm)},
      {"processor", "", escaped(bench.processor)}};
  return table.html();
}

std::string anchor_table() {
  HtmlTable table{{"experiment", "source", "quantity", "published", "ours", "deviation"}, {}};
  for (const Anchor& a : ground_anchors()) {
    table.rows.push_back({escaped(a.experiment), escaped(a.source), escaped(a.quantity),
                          fmt::format("{:.{}f}", a.published, a.digits),
                          fmt::format("{:.{}f}", a.ours, a.digits),
                          fmt::format("{:+.1f} %", 100.0 * a.deviation())});
  }
  return table.html();
}

}  // namespace sandrunner::study
