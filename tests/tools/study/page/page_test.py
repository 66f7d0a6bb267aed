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
import tables
from controllers import COMMANDS
from evidence import Evidence
from made_up import on_the_beach, straight_runs

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
        self.assertIn("Ours</td><td>1, 2</td><td>100.0</td><td>93.8 [93.8, 93.8]</td><td>2.427</td>"
                      "<td>4.000 [4.000, 4.000]</td>", html)
        self.assertIn("<td>3.028</td><td>3.104 [3.104, 3.104]</td>", html)
        self.assertIn(f"Env-Rigid</td><td>{markup.NOT_RUN}</td><td>50.0</td><td>{markup.NOT_RUN}</td>", html)
        self.assertIn("not printed", html)
        self.assertNotIn("Authors", html)

    def test_the_published_network_has_a_row_without_seeds_and_no_part_in_verdicts(self):
        without = on_the_beach({"ours": {}})
        both = on_the_beach({"ours": {}})
        both.measured["E1"]["published"] = {0: straight_runs("beach", COMMANDS)}
        self.assertIn("Authors' network</td><td></td><td></td><td>100.0</td>", tables.beach_table(both))
        self.assertEqual(*(claims.claims_csv(claims.judge_all(e)) for e in (without, both)))

    def test_verdicts_are_counted_with_their_reasons(self):
        html = tables.verdict_counts(claims.judge_all(Evidence()))
        self.assertIn("can't tell</span></td><td>68, 68 of them not run</td>", html)
        self.assertIn("not testable in simulation</span></td><td>3</td>", html)

    def test_fairness_says_who_is_not_competent(self):
        html = tables.fairness_table(on_the_beach({"ours": {}, "tcn": {"alive_at_home": 14}}))
        self.assertIn("Ours</td><td>1, 2</td><td>100 [100, 100]</td>", html)
        self.assertIn("TCN</td><td>1, 2</td><td>88 [88, 88]</td><td>88 [88, 88]</td><td>88 [88, 88]</td>"
                      '<td><span class="contradicts">no</span></td>', html)


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
