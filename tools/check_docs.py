#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the documents of the tree. Prints one line for each finding; exit code 1 if there is one.

tools/check_docs.py [TREE]          links, file names, length of lines and sentences, words
tools/check_docs.py --run BIN       also runs the command blocks that are marked as tested, with
                                    the programs in BIN, and checks the words of their --help
tools/check_docs.py --commits BASE  also checks the messages of the commits since BASE

A command block is marked as tested by ```sh tested. It runs in the root of the tree, with an empty
folder in place of HOME and /tmp. A comment `# prints TEXT`: the output of the block has TEXT, where
any white space counts as one space.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

COLUMNS = 100
WORDS_IN_SENTENCE = 30
SUBJECT = 72
LINES_WITHOUT_WHY = 20  # of a commit that needs no body

# What style has other words for. Each is plain in one sense and private in another, so only forms
# that a pattern can tell apart are here.
WORDS = [
    (r'prices?|priced|debts?', 'penalty, cost or floor'),
    (r'whoever|somebody|someone', 'the name of the program or person'),
    (r'(?:is|are|was|were) told', 'receives, or is commanded'),
    (r'(?:is|are) to be had', 'is available'),
    (r'lets? go', 'releases'),
    (r'taken at (?:its|your) word', 'trusted'),
    (r'of then|today\'s|the one of before|that which ships', 'the shipped, the previous'),
    (r'in turn', 'alternately, or one after the other'),
    (r'so long(?! as| that)|so many(?! that)', 'this long, N'),
]


def git(tree, *words):
    done = subprocess.run(['git', *words], cwd=tree, capture_output=True, text=True)
    if done.returncode:
        print(f'skipped: {done.stderr.strip()}')
        sys.exit(77)  # for ctest: skipped
    return done.stdout


def tracked(tree, *patterns):
    """Files of the tree under version control, or about to be."""
    names = git(tree, 'ls-files', '-z', '--cached', '--others', '--exclude-standard', '--', *patterns)
    files = {tree / name for name in names.split('\0') if name}
    return sorted(file for file in files if file.exists())


class Document:
    """A Markdown file, split into prose, tables and code; without what follows `<!-- generated`."""

    def __init__(self, path):
        self.path = path
        self.text = path.read_text()
        self.prose = []  # (line number, line)
        self.tables = []
        self.blocks = []  # (line number, info string, lines)
        block, generated = None, False
        for number, line in enumerate(self.text.splitlines(), 1):
            fence = re.match(r'\s*```(.*)', line)
            generated = generated or line.startswith('<!-- generated')
            if generated:
                continue
            if fence and block is None:
                block = (number, fence[1].strip(), [])
                self.blocks.append(block)
            elif fence:
                block = None
            elif block is not None:
                block[2].append(line)
            elif line.lstrip().startswith('|'):
                self.tables.append((number, line))
            else:
                self.prose.append((number, line))

    def anchors(self):
        """What GitHub makes of the headings."""
        headings = re.findall(r'(?m)^#+ (.*)$', self.text)
        return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-') for heading in headings}

    def outside_code(self):
        return self.prose + self.tables


def links(documents):
    """Relative links resolve, and so do their anchors."""
    for document in documents:
        for number, line in document.outside_code():
            for target in re.findall(r'\]\(([^)\s]+)\)', re.sub(r'`[^`]*`', '', line)):
                if re.match(r'\w+:', target):
                    continue
                name, _, anchor = target.partition('#')
                file = document.path.parent / name if name else document.path
                if not file.exists():
                    yield document.path, number, f'found a link to {name}, which is not there'
                elif anchor and anchor not in Document(file).anchors():
                    yield document.path, number, f'found a link to {target}, which has no such heading'


def file_names(tree, documents):
    """Paths in back quotes are files of the tree."""
    top = {path.relative_to(tree).parts[0] for path in tracked(tree)}
    for document in documents:
        for number, line in document.outside_code():
            for name in re.findall(r'`((?:[\w.-]+/)+(?:[\w.-]+\.\w+)?)`', line):
                if name.split('/')[0] not in top or 'NAME' in name:
                    continue
                if not (tree / name).exists() and not (document.path.parent / name).exists():
                    yield document.path, number, f'found {name}, expected a file of the tree'


def paragraphs(document):
    """(line number, text) of each paragraph and item of a list."""
    start, lines = 0, []
    for number, line in [*document.prose, (0, '')]:
        item = re.match(r'\s*(?:[-*]|\d+\.)\s', line)
        ends = not line.strip() or line.startswith(('#', '    ')) or item or number != start + len(lines)
        if ends and lines:
            yield start, ' '.join(lines)
            lines = []
        if line.strip() and not line.startswith(('#', '    ')):
            if not lines:
                start = number
            lines.append(line.strip())


def sentences(documents):
    """No line of prose is too wide, and no sentence too long."""
    for document in documents:
        for number, line in document.prose:
            if len(line) > COLUMNS and not line.startswith('    ') and not line.startswith('!['):
                yield document.path, number, f'found {len(line)} columns, expected at most {COLUMNS}'
        for number, text in paragraphs(document):
            text = re.sub(r'`[^`]*`', 'code', text)
            text = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', text)
            for sentence in re.split(r'(?<=[.!?])[)*"]*\s+', text):
                words = len(re.findall(r'[A-Za-z]\S*', sentence))
                if words > WORDS_IN_SENTENCE:
                    yield (document.path, number, f'found a sentence of {words} words, expected at '
                           f'most {WORDS_IN_SENTENCE}: {sentence[:60]}...')


def comments(tree):
    """No comment is too wide. C++ is wrapped by clang-format, except for what it cannot break."""
    files = tracked(tree, '*.h', '*.cpp', '*.py', '*.sh', '*.toml', '*.cmake', '*CMakeLists.txt',
                    '*.conf', '*.rules', '*.service', '*.sysusers', '.ci/run')
    for file in files:
        mark = '//' if file.suffix in ('.h', '.cpp') else '#'
        for number, line in enumerate(file.read_text().splitlines(), 1):
            comment = re.search(rf'(?:^|\s){mark}/?<? ', line)
            if len(line) > COLUMNS and comment and '|' not in line and ' ' in line[comment.end():].strip():
                yield file, number, f'found {len(line)} columns, expected at most {COLUMNS}'


def words(texts):
    """Words that have a plainer one; `texts`: (path, line number, line)."""
    for path, number, line in texts:
        plain = re.sub(r'`[^`]*`', '', line)
        for pattern, instead in WORDS:
            found = re.search(rf'(?i)\b(?:{pattern})\b', plain)
            if found:
                yield path, number, f'found "{found[0]}", expected {instead}'


def lines_of_prose(tree, documents):
    for document in documents:
        for number, line in document.outside_code():
            yield document.path, number, line
    for file in tracked(tree, '*.h', '*.cpp', '*.py', '*.js', '*.mjs', '*.sh'):
        if 'check_docs' in file.name:
            continue
        for number, line in enumerate(file.read_text().splitlines(), 1):
            comment = re.search(r'(?://|#|^\s*/?\*|""")(.*)', line)
            if comment:
                yield file, number, comment[1]


def help_lines(programs):
    """The --help of every program and of its subcommands."""
    for program in sorted(programs.glob('sandrunner*')):
        calls = [[]]
        for call in calls:
            text = subprocess.run([program, *call, '--help'], capture_output=True, text=True).stdout
            if not call:
                calls += [[name] for name in re.findall(r'(?m)^  ([a-z-]+) ',
                                                        text.partition('Subcommands:')[2])
                          if not name.startswith('sandrunner')]
            for line in text.splitlines():
                yield ' '.join([program.name, *call, '--help']), 0, line


def run_blocks(tree, documents, programs):
    """Runs the command blocks that are marked as tested."""
    for document in documents:
        for number, info, lines in document.blocks:
            if info.split()[1:] != ['tested']:
                continue
            with tempfile.TemporaryDirectory() as home:
                # In this order: the programs may lie in /tmp themselves.
                script = '\n'.join(lines).replace('/tmp/', home + '/')
                script = script.replace('build/release/bin', str(programs))
                try:
                    done = subprocess.run(['bash', '-euo', 'pipefail', '-c', script], cwd=tree,
                                          env={**os.environ, 'HOME': home}, timeout=120,
                                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                          stderr=subprocess.STDOUT, text=True)
                except subprocess.TimeoutExpired:
                    yield document.path, number, 'found a block that runs longer than 120 s'
                    continue
            if done.returncode:
                last = (done.stdout.strip().splitlines() or [''])[-1]
                yield document.path, number, f'found exit code {done.returncode}: {last}'
            for text in re.findall(r'# prints (.*)', '\n'.join(lines)):
                if ' '.join(text.split()) not in ' '.join(done.stdout.split()):
                    yield document.path, number, f'found output without "{text}"'


def messages(tree, base):
    for commit in git(tree, 'rev-list', '--no-merges', f'{base}..HEAD').split():
        subject, _, body = git(tree, 'show', '-s', '--format=%B', commit).partition('\n')
        place = f'commit {commit[:8]}'
        if len(subject) > SUBJECT:
            yield place, 0, f'found a subject of {len(subject)} characters, expected at most {SUBJECT}: {subject}'
        changed = git(tree, 'show', '--format=', '--numstat', commit)
        lines = sum(int(number) for number in re.findall(r'^(\d+)\t', changed, re.M))
        if not body.strip() and lines > LINES_WITHOUT_WHY:
            yield place, 0, f'found {lines} new lines without a body, expected one that says why: {subject}'


def main():
    parser = argparse.ArgumentParser(formatter_class=argparse.RawDescriptionHelpFormatter,
                                     description=__doc__)
    parser.add_argument('tree', metavar='TREE', nargs='?', type=pathlib.Path,
                        default=pathlib.Path(__file__).parents[1])
    parser.add_argument('--run', metavar='BIN', type=pathlib.Path)
    parser.add_argument('--commits', metavar='BASE')
    options = parser.parse_args()
    tree = options.tree.resolve()
    documents = [Document(path) for path in tracked(tree, '*.md')]
    findings = [*links(documents), *file_names(tree, documents), *sentences(documents),
                *comments(tree), *words(lines_of_prose(tree, documents))]
    if options.run:
        programs = options.run.resolve()
        findings += [*words(help_lines(programs)), *run_blocks(tree, documents, programs)]
    if options.commits:
        findings += messages(tree, options.commits)
    for path, number, text in findings:
        place = path.relative_to(tree) if isinstance(path, pathlib.Path) else path
        print(f'{place}:{number}: {text}' if number else f'{place}: {text}')
    sys.exit(1 if findings else 0)


if __name__ == '__main__':
    main()
