// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/page/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "rt/base/output_files.h"
#include "tools/study/experiments/experiments.h"
#include "tools/study/experiments/measurements.h"
#include "tools/study/page/figures.h"
#include "tools/study/page/html.h"
#include "tools/study/page/methods.h"
#include "tools/study/page/recovery_run.h"
#include "tools/study/page/tables.h"

namespace sandrunner::study {
namespace {

constexpr std::string_view kStyle = R"(
body { font: 15px/1.45 "DejaVu Sans", Verdana, sans-serif; color: #20262d; margin: 0 auto;
  max-width: 1240px; padding: 16px; }
h1 { font-size: 26px; } h2 { font-size: 20px; border-top: 2px solid #20262d; padding-top: 10px;
  margin-top: 40px; } h3 { font-size: 16px; }
img { width: 100%; max-width: 1240px; display: block; margin: 10px 0 4px; }
table { border-collapse: collapse; margin: 10px 0; font-size: 13px; }
th, td { border: 1px solid #c9ced4; padding: 3px 7px; text-align: left; vertical-align: top; }
th { background: #eef0f3; }
p.note { font-size: 13px; color: #4a525b; margin: 2px 0; }
.key { display: inline-block; width: 11px; height: 11px; margin-right: 6px; }
.faint { color: #6b737c; } .agrees { color: #0a6b35; font-weight: bold; }
.contradicts { color: #b01c1c; font-weight: bold; } .unknown, .untestable { color: #6b737c; }
.claims td:nth-child(2) { width: 24%; } .claims td:nth-child(3) { width: 20%; }
@media print { body { font-size: 10px; max-width: none; } table { font-size: 9px; }
  tr, img { break-inside: avoid; } }
)";

constexpr std::string_view kIntroduction =
    R"(
<p>The experiments of Choi et al., "Learning quadrupedal locomotion on deformable terrain",
Science Robotics 8 (2023), repeated in simulation with controllers that were trained by this
project. Each claim of the paper has a rule that was written down before any other controller than
Ours was evaluated, and a verdict that follows from the rule. A negative result is a result.</p>
)";

constexpr std::string_view kFairness =
    R"(
<p>A comparison with a controller that cannot walk says nothing. Each controller runs on level
ground of the kind on which it was trained: hard ground, springs of 10 kN/m with a damping ratio
of 0.5, dry sand without inertia, or dry sand. With fewer than 15 of 16 runs alive, claims about
it are not judged. Oracles and teachers see the ground, so they run in the training's environments
instead, with its sensor noise and targets 5 ms late.</p>
)";

constexpr std::string_view kBeach =
    R"(
<p>Commands of 0.5 to 4.0 m/s over 5 m after 1 m, as in the paper, which has five runs each. A
deterministic simulator would answer that all runs succeed or none, so each run has a beach of its
own, the same for all controllers. Average and top are the greatest of runs 0 to 4, as many as the
paper has, over all commands, of successful runs: no contact of base or thigh and no joint beyond
its limit. With several seeds: median [least, greatest].</p>
)";

constexpr std::string_view kAttribution =
    R"(
<p>The two oracles in the environments of their training, as in the paper ("4 s in 10,800
randomized environments"): random commands, soils, robots, pushes and noise, the curricula open,
actions without noise, 2 kHz. No robot stands on hard ground or on patches, whose parameters would
shift the mean input; the paper does not say what its robots stood on. Every 20 steps the actor's
input is a state, of which up to 8,192 count, evenly. The reference is their mean (the paper: "An
averaged input was used for the reference", "we took only the magnitudes"). An ablation sets inputs
to the reference. An integrated gradient is the mean slope at 64 points on the way to it, times the
way. Over all inputs integrated gradients should add up to the change of the action; the first
table says by how much they miss it.</p>
)";

constexpr std::string_view kGround =
    R"(
<p>The contact model against experiments that others published; the paper has no such chapter. The
beads' density and packing are those of the experiment. One number is fitted, the stress per
depth, which is the depth-proportional part of the force that Katsuragi and Durian found (1,040
N/m per kg of their ball); inertia and the dependence on speed, size and density are prediction.
Plates and drag use the preset <code>dry-sand</code> as it is. The values that the sources give as
laws were computed from them; the area of the dragged plate, which only enters its last digit, is
taken as 16 mm times the depth.</p>
)";

constexpr std::string_view kGroundResult =
    R"(
<p>The depths of the ball agree within 17 %. Its stopping times are 28 to 34 % long but fall with
the speed as measured. Its size and the height of the drop have the measured exponents within 5 %.
The density of the ball has not: our depth grows about as the density, theirs as its square root.
Under a plate our dry sand lies between loose and close poppy seeds. At depth it is half as stiff
as Bekker's dry sand, which was measured with larger plates.</p>
)";

constexpr std::string_view kTrainings =
    R"(
<p>All trainings have the usual settings of the trainer, but for the differences in the second
table. <code>train.sh</code> gives them the same length; a student learns for two thirds of it
after its teacher, so it rests on more transitions than Ours. Each controller is the best by the
battery of its own training: runs on the grounds of that training, not on those of the
experiments. Seeds are 1, 2 and 3, whatever they give.</p>
)";

constexpr std::string_view kGrid = R"(
<p>Soils with sigma_flat of 1 to 10 and sigma_cone of 0.15 to 0.6 MN/m³, all else as usual, in
the environments of our training, at 2 kHz, with the nominal robot and without sensor noise, delay
or pushes. Each robot runs for 4 s with the same start and command in every cell and for every
controller. Half of the commands are forward, up to 3 m/s. The others go any way, slower.</p>
)";

constexpr std::string_view kGridPaper =
    "\"tested 360 times with a randomly sampled velocity command for 4 s\"; rewards, clearances "
    "and table S1 are not printed";

constexpr std::string_view kGridNote =
    "The reward is that of our training with all penalties at their final weight, the mean of a "
    "step; a fall costs its penalty and all later reward. The paper's reward is eq. S17, which its "
    "main text does not print. Clearance is the mean height of the feet above the mean of the "
    "deepest points of their stances, of the robots that do not fall. Black cells: at most 10 % "
    "succeed, as in the paper. With several seeds a cell is their median.";

constexpr std::string_view kGridTableNote =
    "Table S1 is not printed. Softest and stiffest quarter of the cells by the depth of a foot "
    "under "
    "a quarter of the robot. A slope is the mean over the robots, each fitted over the cells in "
    "which it does not fall; in brackets the 95 % interval over the robots of the first seed.";

constexpr std::string_view kLimits = R"(<ul>
<li>The test sand is of the family on which Ours was trained, and Env-Rigid and Env-Linear are
judged on the trainer's ground. The paper's beach was one that no controller had seen. Ours
winning here shows that training on a ground helps on that ground, which is weaker than the
paper's claim.</li>
<li>Sand piles in front of a dragged foot are not in the model, so the bell of Fig. 2 D can't be
expected.</li>
<li>The inertia of our sand hardly matters to a runner, and the training of Ours draws it between
none and 1.3 times the usual. So a failure of Env-Quasistatic can't be expected either.</li>
<li>Grass is a soil here, the track is a spring, mattress and foam are springs with the right
features. No such ground was measured.</li>
<li>The motor constant, the reward (eq. S17), the randomisation (table S3), the student's encoder,
the ranges of Env-Linear and the lengths of the other trainings are not in the paper's main text;
ours are choices.</li>
<li>Slopes, pits, several points of contact, damage, heat, the rope and oscillations of the
hardware are not simulated.</li>
<li>The paper trains for about 50 hours, some 3.9 billion transitions by our estimate; here the
longest training has {:.0f} million. Differences that need long training may not have appeared: see
the learning curves.</li>
</ul>
)";

/// The page as it grows, and the folder of its pictures.
class Page {
 public:
  Page(const Options& options, const Evidence& evidence)
      : folder_(options.out + "/figures"), runs_(options.lab.runs), evidence_(evidence) {}

  void add(std::string_view html) { html_ += html; }
  void section(std::string_view title) { html_ += fmt::format("<h2>{}</h2>\n", escaped(title)); }
  void figure(const StudyFigure& figure) {
    const std::string path = fmt::format("{}/{}.png", folder_, figure.name);
    plot::draw_charts(figure.page, path);
    html_ += picture_html(path, figure.page.title);
    notes(figure.paper, figure.note);
  }
  /// What the paper prints of the figure above, if anything is known, and what differs.
  void notes(std::string_view paper, std::string_view note) {
    if (!paper.empty()) {
      html_ += fmt::format("<p class=\"note\">The paper: {}.</p>\n", escaped(paper));
    }
    html_ += fmt::format("<p class=\"note\">{}</p>\n", escaped(note));
  }
  void figures(const std::vector<StudyFigure>& all) {
    for (const StudyFigure& one : all) figure(one);
  }
  void picture(const std::string& name, const std::string& alternative) {
    html_ += picture_html(fmt::format("{}/{}.png", folder_, name), alternative);
  }
  /// A section with what the experiment rests on; "not run" if it was not. `runs`: how many.
  bool experiment(const char* key, std::string runs = "") {
    if (runs.empty()) runs = fmt::format("{} runs each, unless it says otherwise", runs_);
    const Experiment& experiment = *find_experiment(key);
    section(fmt::format("{}: {}", experiment.key, experiment.title));
    std::string run, missing;
    for (const char* controller : experiment.controllers) {
      const auto* seeds = evidence_.find(key, controller);
      const Controller& found = *find_controller(controller);
      if (found.kind == ModelKind::kPublished && seeds == nullptr) continue;
      std::string& list = seeds != nullptr ? run : missing;
      list += fmt::format("{}{}", list.empty() ? "" : ", ", found.name);
      if (seeds != nullptr && found.kind != ModelKind::kPublished) {
        list += fmt::format(" ({} seed{})", seeds->size(), seeds->size() == 1 ? "" : "s");
      }
    }
    html_ += fmt::format("<p class=\"note\">Run: {}. Not run: {}. {}.</p>\n",
                         run.empty() ? "none" : run, missing.empty() ? "none" : missing, runs);
    return !run.empty();
  }
  const std::string& html() const { return html_; }

 private:
  std::string folder_, html_;
  int runs_;
  const Evidence& evidence_;
};

void add_recovery(const Options& options, const std::vector<Model>& models, Page& page,
                  const Evidence& evidence) {
  page.add(recovery_table(evidence));
  const auto ours = std::find_if(models.begin(), models.end(), [](const Model& m) {
    return std::string_view(m.controller->key) == "ours";
  });
  std::optional<RecoveryRun> run = find_recovery_run(Lab(options.lab), *ours);
  if (!run) {
    page.add(
        "<p>In none of 16 starts did the left front foot alone of the front feet meet the loose "
        "strip, so there is no run to show.</p>\n");
    return;
  }
  draw_recovery(*run, options.out + "/figures/fig2a.png");
  page.picture("fig2a", "Recovery from loose sand, seen from the right");
  page.add(
      fmt::format("<p class=\"note\">Start {} of seed {}: the left front foot touches down on "
                  "loose sand at 0 s (Fig. 2 A, B; the paper's times). The whole run in 3D: <a "
                  "href=\"recovery.html\">recovery.html</a>.</p>\n",
                  run->seed, ours->seed));
  page.figure(recovery_curves(*run));
  write_file(options.out + "/recovery.html", recovery_page(std::move(*run)));
}

void add_grid(const Options& options, const Evidence& evidence, Page& page) {
  const LabSettings& lab = options.lab;
  if (!page.experiment("E7", fmt::format("{} robots in each of {} cells", lab.grid_runs,
                                         lab.grid_cells * lab.grid_cells))) {
    return;
  }
  page.add(kGrid);
  draw_grid_maps(evidence, options.out + "/figures/fig4ad.png");
  page.picture("fig4ad", "Reward and foot clearance over the grid of stiffnesses");
  page.notes(kGridPaper, kGridNote);
  page.figures(grid_figures(evidence));
  page.add(grid_table(evidence));
  page.notes("", kGridTableNote);
}

void add_experiments(const Options& options, const std::vector<Model>& models,
                     const Evidence& evidence, Page& page) {
  if (page.experiment("E2")) add_recovery(options, models, page, evidence);
  if (page.experiment("E3")) page.figures(ground_figures(evidence));
  if (page.experiment("E4")) {
    page.figures(hidden_state_figures(evidence));
    page.add(hidden_state_table(evidence));
  }
  if (page.experiment("E5")) page.figures(mattress_figures(evidence));
  if (page.experiment("E6")) {
    page.figures(foam_figures(evidence));
    page.add(foam_table(evidence));
  }
  add_grid(options, evidence, page);
  if (page.experiment("E8", "Robots and states: see the table")) {
    page.add(kAttribution);
    page.figures(attribution_figures(evidence));
    page.add(attribution_tables(evidence));
  }
  page.section("E9: Estimator (section S4)");
  page.figures(estimator_figures(evidence));
  page.section("E10: The peer's contact model (fig. S12)");
  page.add(contact_table(evidence));
}

}  // namespace

void write_report(const Options& options, const std::vector<Model>& models,
                  const Evidence& evidence) {
  prepare_folder(options.out + "/figures", "--out");
  const std::vector<JudgedClaim> judged = judge_all(evidence);
  Page page(options, evidence);
  page.add("<h1>The paper's experiments in simulation</h1>\n");
  page.add(kIntroduction);
  page.figure(summary_figure(evidence));
  page.section("Verdicts");
  page.add(verdict_counts(judged));
  page.add(verdict_tables(judged));
  page.section(find_experiment("fairness")->title);
  page.add(kFairness);
  page.add(fairness_table(evidence));
  const bool has_beach = page.experiment("E1");
  page.add(kBeach);
  page.add(beach_table(evidence));
  if (has_beach) page.figures(beach_figures(evidence));
  add_experiments(options, models, evidence, page);
  page.section("Is the ground right?");
  page.add(kGround);
  page.figures(anchor_figures());
  page.add(anchor_table());
  page.add(kGroundResult);
  page.section("Learning curves");
  std::vector<std::string> names;
  for (const Model& model : models) names.push_back(model_name(model));
  page.figures(learning_figures(options.from, names));
  page.section("Methods");
  page.add(
      fmt::format("<p>{} runs for each ground and command; sensor noise of the training; targets "
                  "5 ms late; torque-speed line of the drives; 4 kHz. E7 and E8 run in the "
                  "environments of the training, at 2 kHz.</p>\n",
                  options.lab.runs));
  page.add(kTrainings);
  page.add(methods_tables(models, sim::load_raibo()));
  page.section("What a simulation cannot show");
  page.add(fmt::format(kLimits, 1e-6 * longest_training(models)));
  write_file(options.out + "/results.json", results_json(options, models, evidence));
  write_file(options.out + "/claims.csv", claims_csv(judged));
  write_file(options.out + "/report.html",
             fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
                         "<title>The paper's experiments in simulation</title>\n"
                         "<style>{}</style></head><body>\n"
                         "{}</body></html>\n",
                         kStyle, page.html()));
}

}  // namespace sandrunner::study
