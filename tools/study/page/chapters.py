# SPDX-License-Identifier: BSD-3-Clause
"""What the page says around its tables and figures."""

TITLES = {
    "fairness": "Fairness: each controller on the ground of its own training",
    "E1": "Dry sand (Table 1, Fig. 2 C to F)",
    "E2": "Recovery and transition (Fig. 2 A, B, movie S1)",
    "E3": "Vinyl, track and grass; turns (Fig. 3 D, E)",
    "E4": "Hidden state (Fig. 3 F)",
    "E5": "Air mattress (Fig. 3 G, H)",
    "E6": "Memory foam (fig. S8)",
    "E7": "Grid of stiffnesses (Fig. 4 A to D, table S1, fig. S10)",
    "E8": "Attribution (Fig. 4 E to G, figs. S9, S11)",
}

DOCUMENT = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>The paper's experiments in simulation</title>
<style>{style}</style></head><body>
<nav><ol>
{contents}</ol></nav>
<main><h1>The paper's experiments in simulation</h1>
{top}{body}</main></body></html>
"""

STYLE = """
body { font: 15px/1.45 "DejaVu Sans", Verdana, sans-serif; color: #20262d; margin: 0; display: flex; }
nav { position: sticky; top: 0; flex: 0 0 210px; height: 100vh; overflow-y: auto; font-size: 13px;
  background: #eef0f3; }
nav ol { list-style: none; margin: 0; padding: 16px; } nav li { margin: 5px 0; }
main { flex: 1; min-width: 0; max-width: 1240px; padding: 16px 24px; }
p, li { max-width: 75ch; }
h1 { font-size: 26px; } h2 { font-size: 20px; border-top: 2px solid #20262d; padding-top: 10px;
  margin-top: 40px; } h3 { font-size: 16px; }
img { width: 100%; max-width: 1240px; display: block; margin: 10px 0 4px; }
.table, .picture { overflow-x: auto; }
table { border-collapse: collapse; margin: 10px 0; font-size: 13px; }
th, td { border: 1px solid #c9ced4; padding: 3px 7px; text-align: left; vertical-align: top; }
th { background: #eef0f3; }
summary { font-weight: bold; margin: 10px 0; cursor: pointer; }
code { overflow-wrap: anywhere; }
p.note { font-size: 13px; color: #4a525b; margin: 2px 0; }
.key { display: inline-block; width: 11px; height: 11px; margin-right: 6px; }
.size { color: #8a5a00; font-weight: bold; } .faint { color: #6b737c; } .agrees { color: #0a6b35; font-weight: bold; }
.contradicts { color: #b01c1c; font-weight: bold; } .unknown, .untestable { color: #6b737c; }
.claims td:nth-child(2) { width: 24%; } .claims td:nth-child(3) { width: 20%; }
@media (max-width: 900px) { body { display: block; }
  nav { position: static; height: auto; } main { padding: 8px; } .picture img { min-width: 760px; }
  .claims table { min-width: 760px; } }
@media print { body { font-size: 10px; display: block; } nav { display: none; } main { max-width: none; }
  table { font-size: 9px; } tr, img { break-inside: avoid; } h2, h3 { break-after: avoid; } }
"""

INTRODUCTION = """
<p>The experiments of Choi et al., "Learning quadrupedal locomotion on deformable terrain",
Science Robotics 8 (2023), repeated in simulation with controllers that were trained by this
project. Each claim of the paper has a rule that was written down before any other controller than
Ours was evaluated, or that was repaired in the open, and a verdict that follows from it. A negative
result is a result.</p>
"""

CONTROLS = """
<p>Two policies that were not trained for this study run in E1 to E6 as if they were Ours. They have
no part in a verdict. The authors published a network of their controller; whether it is the one
that ran on their beach is not known. What it does on our sand tells whether our sand is right. It
sees its inputs in scales of its own, so it can't run in the grid. The shipped policy is this
project's, of a longer training on more kinds of ground. <code>tools/study/controls</code> has their
figures, and no weights of the authors.</p>
"""

VERDICTS = """
<p>A table for each section of the paper; click its name. CLAIMS.md has the rules.</p>
"""

SURE = """
<p>The verdicts are judged all at once, and nothing is corrected for their number. An interval of 95
% lets one comparison in 40 pass by chance, so one or two of those that agree may be chance. The
unit that counts is the training: a verdict on one seed says so. All controllers and commands share
the starts 0, 1, 2 ... and the beaches of these runs. So comparisons of two controllers are of pairs,
but 128 runs at eight commands are not 128 independent ones, and the intervals of success are rather
too narrow. The table has the verdicts that change if each tolerance of a term ("about", "share",
"excess", "above by m") is half or twice as large. Thresholds that a row states itself are not
varied.</p>
"""

REPAIRS = """
<p>Rules that broke down where a controller has no successful run, or that measured something else
than their row says, were repaired after the first comparison had been seen. No repair makes a rule
easier in order to agree. The verdicts of the old rules are those of the first models, trained at
f1d1f19 and 90f56e4.</p>
"""

FAIRNESS = """
<p>A comparison with a controller that cannot walk says nothing. Each controller runs on level
ground of the kind on which it was trained: hard ground, springs of 10 kN/m with a damping ratio
of 0.5, dry sand without inertia, or dry sand. With fewer than 15 of 16 runs alive, claims about
it are not judged. Oracles and teachers see the ground, so they run in the training's environments
instead, with its sensor noise and targets 5 ms late.</p>
"""

BEACH = """
<p>Commands of 0.5 to 4.0 m/s over 5 m after 1 m, as in the paper, which has five runs each. A
deterministic simulator would answer that all runs succeed or none, so each run has a beach of its
own, the same for all controllers. Average and top are the greatest of runs 0 to 4, as many as the
paper has, over all commands, of successful runs: no contact of base or thigh and no joint beyond
its limit for as long as a policy step of 10 ms, so that a log of the drives would show it. As in
the paper, a run that fails before the start line does not count. Strict: all runs, and no joint
beyond its limit in any tick of 0.25 ms. With several seeds: median [least, greatest]. In round
brackets: the 95 % interval of the runs of the first seed.</p>
"""

NO_RECOVERY = """
<p>In none of 16 starts did the left front foot alone of the front feet meet the loose strip, so there is no run to
show.</p>
"""

GRID = """
<p>Soils with sigma_flat of 1 to 10 and sigma_cone of 0.15 to 0.6 MN/m³, all else as usual, in
the environments of our training, at 2 kHz, with the nominal robot and without sensor noise, delay
or pushes. Each robot runs for 4 s with the same start and command in every cell and for every
controller. Half of the commands are forward, up to 3 m/s. The others go any way, slower.</p>
"""

GRID_TABLE = (
    "Table S1 is not printed. Softest and stiffest quarter of the cells by the depth of a foot under a quarter of the "
    "robot. A slope is the mean over the robots, each fitted over the cells in which it does not fall; in brackets the "
    "95 % interval over the robots of the first seed.")

ATTRIBUTION = """
<p>The two oracles in the environments of their training, as in the paper ("4 s in 10,800
randomized environments"): random commands, soils, robots, pushes and noise, the curricula open,
actions without noise, 2 kHz. No robot stands on hard ground or on patches, whose parameters would
shift the mean input; the paper does not say what its robots stood on. Every 20 steps the actor's
input is a state, of which up to 8,192 count, evenly. The reference is their mean (the paper: "An
averaged input was used for the reference", "we took only the magnitudes"). An ablation sets inputs
to the reference. An integrated gradient is the mean slope at 64 points on the way to it, times the
way. Over all inputs integrated gradients should add up to the change of the action; the first
table says by how much they miss it.</p>
"""

GROUND = """
<p>The contact model against experiments that others published; the paper has no such chapter. The
beads' density and packing are those of the experiment. One number is fitted, the stress per
depth, which is the depth-proportional part of the force that Katsuragi and Durian found (1,040
N/m per kg of their ball); inertia and the dependence on speed, size and density are prediction.
Plates and drag use the preset <code>dry-sand</code> as it is. The values that the sources give as
laws were computed from them; the area of the dragged plate, which only enters its last digit, is
taken as 16 mm times the depth. Mud has the constants of Skempton's law, which is compared with the
later one of API, and a dependence on speed that was chosen before the row on pulling out was
found. Its strength and the distance at which a foot breaks off have no public number.</p>
"""

GROUND_RESULT = """
<p>The depths of the ball agree within 17 %. Its stopping times are 28 to 34 % long but fall with
the speed as measured. Its size and the height of the drop have the measured exponents within 5 %.
The density of the ball has not: our depth grows about as the density, theirs as its square root.
Under a plate our dry sand lies between loose and close poppy seeds. At depth it is half as stiff
as Bekker's dry sand, which was measured with larger plates.</p>
"""

METHODS = """
<p>{runs} runs for each ground and command; sensor noise of the training; targets 5 ms late; torque-speed line of the
drives; 4 kHz. E7 and E8 run in the environments of the training, at 2 kHz.</p>
"""

TRAININGS = """
<p>All trainings have the usual settings of the trainer, but for the differences in the second
table. <code>train.sh</code> gives them the same length; a student learns for two thirds of it
after its teacher, so it rests on more transitions than Ours. Each controller is the best by the
battery of its own training: runs on the grounds of that training, not on those of the
experiments. Seeds are 1, 2 and 3, whatever they give.</p>
"""

LIMITS = """<ul>
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
longest training has {longest:.0f} million. Differences that need long training may not have appeared: see
the learning curves.</li>
</ul>
"""
