# SPDX-License-Identifier: BSD-3-Clause
"""Tables and pieces of the page, and the page maker's refusals.
tests/tools/study/study_program_test.cpp has the page as a whole."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import claims
import markup
import controls
import tables
import verdicts
from controllers import COMMANDS
from evidence import Evidence
from made_up import everything, on_the_beach, straight_runs

PAGE = pathlib.Path(tables.__file__).parent


def model(controller, seed, settings=()):
    return {"controller": controller, "seed": seed, "hash": "0123", "length": 60e6,
            "provenance": {"config": "", "seed": "7", "processor": "a <chip>"},
            "settings": [{"key": key, "value": value, "usual": usual} for key, value, usual in settings]}


class Tables(unittest.TestCase):
    def test_each_setting_is_there_once_with_its_seeds(self):
        rigid = [("ground.rigid_envs", "64.0", "16.0"), ("ground.of_old", "3.0", "")]
        models = {"ours-1": model("ours", 1), "env-rigid-1": model("env-rigid", 1, rigid),
                  "env-rigid-2": model("env-rigid", 2, rigid[:1])}
        html = tables.settings_table(models)
        self.assertIn("<td>Ours</td><td>none</td><td></td><td></td><td>1</td>", html)
        self.assertIn("<td>Env-Rigid</td><td>ground.rigid_envs</td><td>64.0</td><td>16.0</td><td>1, 2</td>", html)
        self.assertIn("<td>ground.of_old</td><td>3.0</td><td>no such setting</td><td>1</td>", html)
        html = tables.origin_table(models)
        self.assertIn("<td>env-rigid-2</td><td>60</td><td>7</td>", html)
        self.assertIn("a &lt;chip&gt;", html)

    def test_table_1_has_the_papers_numbers_and_ours_or_not_run(self):
        html = tables.beach_table(on_the_beach({"ours": {"successes": 15, "top_mps": 3.1}}))
        self.assertIn("Ours</td><td>1, 2</td><td>100.0</td><td>93.8 [93.8, 93.8] (88 to 97)</td>"
                      "<td>93.8 [93.8, 93.8]</td><td>2.427</td><td>4.000 [4.000, 4.000]</td>", html)
        self.assertIn("<td>3.028</td><td>3.104 [3.104, 3.104]</td>", html)
        self.assertIn(f"Env-Rigid</td><td>{markup.NOT_RUN}</td><td>50.0</td><td>{markup.NOT_RUN}</td>", html)
        self.assertIn("not printed", html)
        self.assertNotIn("Authors", html)

    def test_the_reward_of_the_grid_is_told_by_the_terms_that_matter(self):
        html = tables.reward_terms_table(everything(failing=["tcn"]))
        self.assertIn("<td>reward</td><td>velocity</td><td>4.50</td>", html)
        self.assertIn("<td>0.50</td>", html)
        self.assertIn("<td>penalty</td><td>fall</td><td>-0.75</td>", html)
        self.assertNotIn("torque", html)
        self.assertIn("<td>given back by the floor of the penalties</td><td>0.25</td>", html)
        self.assertIn("<td>all</td><td>4.00</td>", html)

    def test_the_published_network_has_a_row_without_seeds_and_no_part_in_verdicts(self):
        without = on_the_beach({"ours": {}})
        both = on_the_beach({"ours": {}})
        both.measured["E1"]["published"] = {0: straight_runs("beach", COMMANDS)}
        self.assertIn("Authors' network</td><td></td><td></td><td>100.0 (97 to 100)</td><td>100.0</td>", tables.beach_table(both))
        self.assertEqual(*(claims.claims_csv(claims.judge_all(e)) for e in (without, both)))

    def test_verdicts_are_counted_with_their_reasons(self):
        html = verdicts.verdict_counts(claims.judge_all(Evidence()))
        self.assertIn("can't tell</span></td><td>68, 68 of them not run</td>", html)
        self.assertIn("<td>5, 11, 30</td>", html)
        self.assertIn("not testable in simulation</span></td><td>3</td>", html)

    def test_fairness_says_who_is_not_competent(self):
        html = tables.fairness_table(on_the_beach({"ours": {}, "tcn": {"alive_at_home": 14}}))
        self.assertIn("Ours</td><td>1, 2</td><td>100 [100, 100]</td>", html)
        self.assertIn("TCN</td><td>1, 2</td><td>88 [88, 88]</td><td>88 [88, 88]</td><td>88 [88, 88]</td>"
                      '<td><span class="contradicts">no</span></td>', html)


class Verdicts(unittest.TestCase):
    def test_a_control_is_judged_as_ours_and_keeps_the_rule_that_it_met(self):
        evidence = everything(("ours", "env-rigid"))
        evidence.measured["E1"]["published"] = {0: straight_runs("beach", COMMANDS, successes=14, top_mps=3.0)}
        results = {"models": {"published-0": {"hash": "0123", "provenance": {"name": "theirs"}}}, "build": "0.1.0 abc",
                   "command": "sandrunner-study"}
        made = controls.made_of(evidence, results)
        self.assertEqual(made["rules"]["1"], ["about 3.028", "agrees", "3.00 m/s"])
        self.assertEqual(made["rules"]["8"][1], "contradicts")
        self.assertEqual(made["rules"]["18"][1:], ["can't tell", "3.00 against 3.00 [3.00, 3.00] m/s: +0.0 %"])
        # Not measured, of the grid, not of Ours.
        self.assertEqual(set(made["rules"]) & {"31", "55", "23"}, set())
        control, judged = controls.Control(**made), claims.judge_all(evidence)
        self.assertEqual(controls.failed_rules(control, judged, alone=True), ["8"])
        words = verdicts.control_words({"authors": control}, judged)
        self.assertIn("does not meet: 8. There the rule is stricter than the paper", words)
        claim = next(claim for claim, _ in judged if claim.id == "8")
        cell = verdicts.control_cell(claim, {"authors": control})
        self.assertEqual(cell, "theirs: 87.5 % (strict: 87.5 %); <b>contradicts</b>")
        control.rules["8"][0] = "at least 90 %"
        self.assertEqual(verdicts.control_cell(claim, {"authors": control}), "theirs: measured under another rule")

    def test_no_control_is_made_without_a_published_network(self):
        self.assertIsNone(controls.made_of(everything(), {}))

    def test_the_stored_controls_have_figures_of_the_rules_and_no_weights(self):
        stored = controls.read_all()
        self.assertEqual(list(stored), ["authors", "shipped"])
        judged = claims.judge_all(Evidence())
        for control in stored.values():
            found = [control.judgement(claim) for claim, _ in judged if claim.id in control.rules]
            self.assertGreater(len(found), 20)
            self.assertNotIn(None, found)

    def test_five_sentences_lead(self):
        evidence = everything(("env-rigid",))
        models = {"ours-1": model("ours", 1), "env-rigid-1": model("env-rigid", 1)}
        html = verdicts.sentences(evidence, claims.judge_all(evidence), controls.read_all(), models)
        self.assertEqual(html.count("<p>"), 5)
        self.assertIn("Ours succeeds in 100.0 [100.0, 100.0] % (strict: 100.0 [100.0, 100.0] %) of its runs", html)
        self.assertIn("Env-Rigid in 0, Env-Quasistatic in 100", html)
        self.assertIn("94.2 (89 to 97) % of its runs and reaches 2.999 m/s, where", html)
        self.assertIn("1 to 1 trainings each, of 60 to 60 million", html)

    def test_each_repair_is_of_a_claim_and_has_the_verdict_of_the_old_rule(self):
        repairs = claims.read_repairs(claims.CLAIMS_FILE.read_text())
        self.assertGreater(len(repairs), 10)
        for claim_id, _, _, before in repairs:
            self.assertIn(claim_id, claims.RULES)
            self.assertTrue(before.startswith(claims.VERDICTS), before)

    def test_a_contradicted_claim_has_its_reason_or_is_left_open(self):
        known = claims.read_explanations(claims.CLAIMS_FILE.read_text())
        self.assertLessEqual(set(known), set(claims.RULES))
        evidence = on_the_beach({"ours": {"top_mps": 2.0}})
        html = verdicts.contradiction_table(claims.judge_all(evidence))
        self.assertRegex(html, "<td>1</td>.*left open")

    def test_verdicts_that_hang_on_a_tolerance_are_shown(self):
        evidence = on_the_beach({"ours": {"top_mps": 2.7}})  # 11 % less than the paper
        html = verdicts.sensitivity_table(evidence, claims.judge_all(evidence))
        self.assertIn("<tr><td>1</td><td>can't tell</td><td>agrees</td><td>agrees</td></tr>", html)


class Markup(unittest.TestCase):
    def test_text_is_escaped_and_code_is_marked(self):
        self.assertEqual(markup.from_markdown('a < "b" & `c > d`\'s'),
                         "a &lt; &quot;b&quot; &amp; <code>c &gt; d</code>'s")


class PageMaker(unittest.TestCase):
    def refusal(self, before, out):
        code = (f"import runpy, sys; {before}; sys.argv[1:] = [{out!r}]; "
                f"runpy.run_path({str(PAGE)!r}, run_name='__main__')")
        done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
        return done.stderr

    def test_refuses_a_folder_without_results(self):
        self.assertIn("found no results.json", self.refusal("pass", "/nowhere"))

    def test_refuses_another_file(self):
        with tempfile.TemporaryDirectory() as folder:
            for text in ("", "{}", "[]"):
                (pathlib.Path(folder) / "results.json").write_text(text)
                self.assertIn("results.json: found something else", self.refusal("pass", folder))

    def test_says_what_to_install_and_keeps_the_results(self):
        with tempfile.TemporaryDirectory() as folder:
            results = pathlib.Path(folder) / "results.json"
            results.write_text("{}")
            for module in ("numpy", "scipy", "sklearn", "matplotlib"):
                text = self.refusal(f"sys.modules[{module!r}] = None", folder)
                self.assertIn(f"no Python module {module}", text)
                self.assertIn("python3-sklearn", text)
            self.assertEqual(results.read_text(), "{}")


if __name__ == "__main__":
    unittest.main()
