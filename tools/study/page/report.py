# SPDX-License-Identifier: BSD-3-Clause
"""report.html, chapter by chapter."""
import subprocess
from pathlib import Path

import chapters
import figures
import figures_simulated
import pictures
import controls
import tables
import verdicts
from controllers import CONTROLLERS
from markup import escaped, picture

FIG_2A_S = (0.0, 0.27, 0.37, 0.62, 0.78)  # the paper's, from the touchdown


class Page:
    """The page as it grows, and the folder of its pictures."""

    def __init__(self, folder, results, evidence):
        self.folder, self.results, self.evidence, self.html = folder, results, evidence, ""
        self.contents, self.not_run = [], []

    def add(self, html):
        self.html += html

    def fold(self, title, html):
        self.add(f"<details><summary>{escaped(title)}</summary>\n{html}</details>\n")

    def section(self, title, short=""):
        """`short`: its name in the list of contents; without one, the title up to a colon."""
        self.contents.append(short or title.partition(":")[0])
        self.add(f'<h2 id="s{len(self.contents)}">{escaped(title)}</h2>\n')

    def figure(self, figure):
        figure.sheet.save(self.folder / f"{figure.name}.png")
        self.add(picture(self.folder / f"{figure.name}.png", figure.sheet.title))
        self.notes(figure.paper, figure.note)

    def notes(self, paper, note):
        """What the paper prints of the figure above, if anything is known, and what differs."""
        if paper:
            self.add(f'<p class="note">The paper: {escaped(paper)}.</p>\n')
        self.add(f'<p class="note">{escaped(note)}</p>\n')

    def figures(self, found):
        for figure in found:
            self.figure(figure)

    def experiment(self, key, runs=""):
        """A section with what the experiment rests on, if it was run; whether it was. `runs`: how many."""
        ran, missing = [], []
        for controller in self.results["takes_part"][key]:
            name, seeds = CONTROLLERS[controller].name, len(self.evidence.seeds(key, controller))
            if controller == "published":
                ran += [name] * bool(seeds)
            elif seeds:
                ran.append(f"{name} ({seeds} seed{'' if seeds == 1 else 's'})")
            else:
                missing.append(name)
        if not ran:
            self.not_run.append(f"{key} ({chapters.TITLES[key].partition(' (')[0]})")
            return False
        self.section(f"{key}: {chapters.TITLES[key]}", f"{key}: {chapters.TITLES[key].partition(' (')[0]}")
        runs = runs or f"{self.results['runs']} runs each, unless it says otherwise"
        self.add(f'<p class="note">Run: {", ".join(ran)}. Not run: {", ".join(missing) or "none"}. {runs}.</p>\n')
        return True


def add_recovery(page):
    page.add(tables.recovery_table(page.evidence))
    run = page.results["recovery_run"]
    if run is None:
        page.add(chapters.NO_RECOVERY)
        return
    title, csv = "Recovery from loose sand, seen from the right", page.folder.parent / "recovery.csv"
    recorded, touchdown_s = pictures.Table(csv), run["touchdown_s"]
    rows = [abs(recorded["t_s"] - touchdown_s - t).argmin() for t in FIG_2A_S]
    pictures.side_views(recorded, rows, 3, title, page.folder / "fig2a.png", touchdown_s)
    page.add(picture(page.folder / "fig2a.png", title))
    page.add(f'<p class="note">Start {run["start"]} of seed {run["seed"]}: the left front foot touches down on loose '
             "sand at 0 s (Fig. 2 A, B; the paper's times). The whole run in 3D: <a href=\"recovery.html\">"
             "recovery.html</a>.</p>\n")
    page.figure(figures_simulated.recovery_figure(run))


def add_grid(page):
    results = page.results
    if not page.experiment("E7", f"{results['grid_runs']} robots in each of {results['grid_cells'] ** 2} cells"):
        return
    page.add(chapters.GRID)
    page.figure(figures_simulated.grid_maps(page.evidence))
    page.figure(figures_simulated.grid_lines(page.evidence))
    page.fold("Numbers of the grid", tables.grid_table(page.evidence))
    page.notes("", chapters.GRID_TABLE)
    by_term = tables.reward_terms_table(page.evidence)
    if by_term:
        page.fold("Reward of the grid by term", by_term)


def add_experiments(page):
    evidence = page.evidence
    if page.experiment("E1"):
        page.add(chapters.BEACH)
        page.figures(figures.beach_figures(evidence))
        page.add(tables.beach_table(evidence))
    if page.experiment("E2"):
        add_recovery(page)
    if page.experiment("E3"):
        page.figures(figures.ground_figures(evidence))
    if page.experiment("E4"):
        page.figures(figures_simulated.hidden_state_figures(evidence))
        page.add(tables.hidden_state_table(evidence))
    if page.experiment("E5"):
        page.figures(figures.mattress_figures(evidence))
    if page.experiment("E6"):
        page.figures(figures.foam_figures(evidence))
        page.add(tables.foam_table(evidence))
    add_grid(page)
    if page.experiment("E8", "Robots and states: see the table"):
        page.add(chapters.ATTRIBUTION)
        page.figures(figures_simulated.attribution_figures(evidence))
        page.fold("Numbers of the attribution", tables.attribution_tables(evidence))
    if evidence.seeds("E1", "ours"):
        page.section("E9: Estimator (section S4)", "E9: Estimator")
        page.figures(figures.estimator_figures(evidence))
    if evidence.contact is not None:
        page.section("E10: The peer's contact model (fig. S12)", "E10: The peer's contact model")
        page.add(tables.contact_table(evidence.contact))
    else:
        page.not_run.append("E10 (the peer's contact model: --contact)")
    if page.not_run:
        page.add(f'<p class="note" id="not-run">Not run: {escaped(", ".join(page.not_run))}.</p>\n')


def commit_date(build):
    """", of 2026-11-30": the date of the commit, which a copy without its history does not know."""
    words = build.split()
    commit = words[1].partition("-")[0] if len(words) > 1 else ""
    try:
        found = subprocess.run(["git", "-C", str(Path(__file__).parent), "show", "-s", "--format=%cs", commit],
                               capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return f", of {found.stdout.strip()}" if commit and found.returncode == 0 else ""


def report_html(folder, results, evidence, judged):
    """The page; its pictures are written to `folder`."""
    page = Page(folder, results, evidence)
    all_controls = controls.read_all()
    page.section("Dry sand at a glance")
    page.figure(figures.summary_figure(evidence))
    page.add(verdicts.verdict_counts(judged))
    page.section(chapters.TITLES["fairness"])
    page.add(chapters.FAIRNESS + tables.fairness_table(evidence))
    add_experiments(page)
    if all_controls:
        page.section("Controls: the authors' network and the shipped policy", "Controls")
        page.add(chapters.CONTROLS + verdicts.control_table(all_controls) + verdicts.control_words(all_controls, judged))
    page.section("Verdicts")
    page.add(chapters.VERDICTS + verdicts.verdict_tables(judged, all_controls))
    page.fold("Why the contradicted ones are", verdicts.contradiction_table(judged))
    page.section("How sure are the verdicts?")
    page.add(chapters.SURE)
    page.fold("Verdicts with half and with twice the tolerances", verdicts.sensitivity_table(evidence, judged))
    page.section("Repaired rules")
    page.add(chapters.REPAIRS)
    page.fold("Each repair, with the verdict of the old rule", verdicts.repair_table(judged))
    page.section("Is the ground right?")
    page.add(chapters.GROUND)
    page.figure(figures_simulated.ball_figure(results["ground"]["ball"]))
    page.fold("All experiments", tables.anchor_table(results["ground"]["anchors"]))
    page.add(chapters.GROUND_RESULT)
    page.section("Learning curves")
    page.figure(figures_simulated.learning_figure(results["models"]))
    page.section("Methods")
    page.add(chapters.METHODS.format(runs=results["runs"]) + chapters.TRAININGS)
    page.fold("Where each model comes from", tables.origin_table(results["models"]))
    page.fold("Settings that differ from the trainer's", tables.settings_table(results["models"]))
    page.section("What a simulation cannot show")
    longest = max(model["length"] for model in results["models"].values())
    page.add(chapters.LIMITS.format(longest=1e-6 * longest))
    top = (chapters.INTRODUCTION + verdicts.sentences(evidence, judged, all_controls, results["models"]) +
           f'<p class="note">Made by sandrunner-study {escaped(results["build"])}{commit_date(results["build"])}:<br>'
           f'<code>{escaped(results["command"])}</code></p>\n')
    links = "".join(f'<li><a href="#s{i}">{escaped(title)}</a></li>\n' for i, title in enumerate(page.contents, 1))
    return chapters.DOCUMENT.format(style=chapters.STYLE, top=top, contents=links, body=page.html)
