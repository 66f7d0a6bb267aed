#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/tools/check_docs_test.py SCRIPT: check_docs.py on small trees."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = sys.argv.pop(1)


def findings(files, *options, subject="docs: say more"):
    """What check_docs.py prints about a tree of `files`, path -> text, in one commit."""
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            file = pathlib.Path(root, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        git = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org", "-C", root]
        subprocess.run([*git, "init", "-q"], check=True)
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "base"], check=True)
        subprocess.run([*git, "add", "."], check=True)
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", subject], check=True)
        options = [option.replace("ROOT", root) for option in options]
        run = subprocess.run([sys.executable, SCRIPT, root, *options], capture_output=True, text=True, check=False)
        assert run.returncode == (1 if run.stdout else 0), run
        return run.stdout


class CheckDocsTest(unittest.TestCase):
    def test_a_plain_document_is_fine(self):
        text = "# A\nSee [B](b/README.md#how-to) and `b/README.md`.\n\n```\n" + 120 * "x" + "\n```\n"
        self.assertEqual(findings({"README.md": text, "b/README.md": "# B\n## How to\n"}), "")

    def test_a_link_to_nothing_is_named(self):
        self.assertIn("README.md:2: found a link to b.md", findings({"README.md": "\n[B](b.md)\n"}))

    def test_a_link_to_no_heading_is_named(self):
        self.assertIn("no such heading", findings({"README.md": "# A\n[B](#b)\n"}))

    def test_a_file_in_back_quotes_has_to_be_there(self):
        self.assertIn("found a/c.h", findings({"README.md": "`a/c.h`\n", "a/b.h": ""}))

    def test_prose_and_comments_wrap(self):
        wide = "word " * 21
        comments = f"# {wide}\nb = 1  # {wide}\n"
        said = findings({"README.md": wide + "\n", "a.toml": comments, "c.sh": wide})
        self.assertEqual([line.split(" ")[0] for line in said.splitlines()], ["README.md:1:", "a.toml:1:", "a.toml:2:"])

    def test_a_sentence_of_31_words_is_too_long(self):
        text = "\n".join(["a b c d e f g h i j"] * 3)
        self.assertEqual(findings({"README.md": text + ".\nShort.\n"}), "")
        self.assertIn("a sentence of 31 words", findings({"README.md": text + " k.\n"}))
        self.assertIn("a sentence of 31 words", findings({"README.md": text.replace("j", "j;") + " k.\n"}))

    def test_words_that_have_a_plainer_one_are_named(self):
        said = findings({"README.md": "The price.\n`price`\n", "rt/core/a.h": "int somebody = 0;  // somebody\n"})
        self.assertEqual([line.split(":")[0] for line in said.splitlines()], ["README.md", "rt/core/a.h"])

    def test_words_in_the_help_of_a_program_are_named(self):
        program = "#!/bin/sh\necho 'whoever asks'\n"
        with tempfile.TemporaryDirectory() as bin_:
            file = pathlib.Path(bin_, "sandrunner")
            file.write_text(program)
            file.chmod(0o755)
            self.assertIn('sandrunner --help: found "whoever"', findings({}, "--run", bin_))

    def test_a_block_marked_as_tested_runs_in_a_folder_of_its_own(self):
        def run(command):
            return findings({"README.md": f"```sh tested\n{command}\n```\n"}, "--run", ".")

        self.assertEqual(run("echo a  b > /tmp/x; cat /tmp/x  # prints a b"), "")
        self.assertIn("exit code 3", run("exit 3"))
        self.assertIn('without "b"', run("echo a  # prints b"))

    def test_a_block_runs_the_programs_of_the_folder_that_is_given(self):
        block = "```sh tested\nbuild/release/bin/sandrunner  # prints walks\n```\n"
        with tempfile.TemporaryDirectory(dir="/tmp") as bin_:
            file = pathlib.Path(bin_, "sandrunner")
            file.write_text("#!/bin/sh\necho walks\n")
            file.chmod(0o755)
            self.assertEqual(findings({"README.md": block}, "--run", bin_), "")

    def test_a_subject_of_more_than_72_characters_is_too_long(self):
        self.assertEqual(findings({}, "--commits", "HEAD^", subject="a" * 72), "")
        self.assertIn("73 characters", findings({}, "--commits", "HEAD^", subject="a" * 73))

    def test_a_commit_of_many_lines_says_why(self):
        files = {"a.txt": "a\n" * 21}
        self.assertIn("found 21 new lines without a body", findings(files, "--commits", "HEAD^"))
        self.assertEqual(findings(files, "--commits", "HEAD^", subject="docs: say more\n\nUsers asked."), "")
        self.assertEqual(findings({"a.txt": "a\n" * 20}, "--commits", "HEAD^"), "")


if __name__ == "__main__":
    unittest.main()
