# SPDX-License-Identifier: BSD-3-Clause
"""Attacks the programs with random inputs: settings, robots, grounds, policies, commands, recordings, command lines,
signals, environments, pauses, messages over DDS. Bounded in time and number, seeded: input I of seed S is the same each
time, but for when a signal or a message hits.

Each run is judged:
  ok          0, or 1 for a robot that fell, or a comparison that differs
  refused     2 and one line on stderr that begins with the program's name
  crash       ended by a signal that was not sent
  hang        over the time limit
  misleading  0 or 1 although the input is surely broken; several lines or an empty one; an internal error; another
              exit code; half-written files (*.part) left; a bound of the safety gate that a live robot left
Prints totals, and how each crash, hang and misleading answer is repeated; then ends with 1."""

import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

import inputs

# A run takes 0.02 to 0.5 s on a free machine: one that is hundreds of times as slow has no "hang"
# yet.
LIMIT_S = 300.0
PROGRAMS = ['sandrunner', 'sandrunner-replay', 'sandrunner-policy', 'sandrunner-evaluate', 'sandrunner-study',
            'sandrunner-ctl', 'dds_attacker']
HURT = ['crash', 'hang', 'misleading']
NOBODY = 65534


def good_files(tree, programs, folder):
    """What inputs are made from: files of the tree, and what the programs write."""
    subprocess.run([programs / 'sandrunner', '--start', 'walk', '--duration', '0.05', '--out', '.', '--record', '.'],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL)
    paths = [folder / 'config.toml', folder / 'run.mcap', tree / 'sim/robot/raibo.urdf', tree / 'sim/robot/raibo.toml',
             tree / 'sim/ground/presets/dry-sand.toml', tree / 'policy/trained/raibo.safetensors']
    return {path.name: path.read_bytes() for path in paths}


def reserve_domain(rng):
    """A DDS domain, and the socket by whose name it is ours, as tests of the project have theirs."""
    while True:
        domain = rng.randint(100, 200)
        held = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            held.bind(f'\0sandrunner-test-domain-{domain}'.encode().ljust(108, b'\0'))
            return domain, held
        except OSError:
            held.close()
            time.sleep(0.01)


class Child:
    """A program that runs in the input's folder."""

    def __init__(self, command, one, programs, folder, log):
        self.command, self.sent, self.code = command, set(), None
        self.out, self.err = folder / f'{log}stdout', folder / f'{log}stderr'
        words = [str(programs / command[0]), *(word.replace('\0', '') for word in command[1:])]
        environment = {**os.environ, **one.environment}
        if one.shell:  # what comes before in the same process; the environment is not for bash
            words = ['bash', '-c', one.shell + '; exec "$@"', 'bash', 'env',
                     *(f'{name}={value}' for name, value in one.environment.items()), *words]
            environment = None
        user = NOBODY if one.other_user and os.getuid() == 0 else None
        if user:
            os.chown(folder, user, user)
        with open(self.out, 'wb') as out, open(self.err, 'wb') as err:
            self.process = subprocess.Popen(words, cwd=folder, user=user, stdin=subprocess.DEVNULL, stdout=out,
                                            stderr=err, env=environment)

    def send(self, number):
        self.sent.add(number)
        self.process.send_signal(number)

    def ended(self, limit_s):
        """Whether it ends by itself within this time."""
        try:
            self.code = self.process.wait(limit_s)
        except subprocess.TimeoutExpired:
            return False
        return True

    def end(self):
        """Waits for its end, or kills it."""
        if not self.ended(LIMIT_S):
            self.process.kill()
            self.process.wait()


def run(one, programs, folder):
    """Runs the input. Returns its program, then those beside it, all ended."""
    beside = [Child(command, one, programs, folder, f'{i}-') for i, command in enumerate(one.beside)]
    child = Child(one.command, one, programs, folder, '')
    began = time.monotonic()
    for at_s, number in one.signals:
        if child.ended(max(0.0, began + at_s - time.monotonic())):
            break
        child.send(number)
    if signal.SIGTSTP in child.sent and not child.ended(0.1):
        child.process.send_signal(signal.SIGCONT)
    child.end()
    for other in beside:
        other.send(signal.SIGTERM)
    for other in beside:
        other.end()
    return [child, *beside]


def judge(child, one, folder):
    """The class of what came of a program, and why."""
    code = child.code
    if code is None:
        return 'hang', f'not done after {LIMIT_S:g} s'
    # A start does not stop: it ends.
    stopped_start = code == -signal.SIGINT and signal.SIGTSTP in child.sent
    if code < 0 and -code not in child.sent and not stopped_start:
        return 'crash', signal.Signals(-code).name
    stderr = child.err.read_text(errors='replace')
    said = stderr + child.out.read_text(errors='replace')
    for word in ['internal error', 'terminate called', 'Assertion', 'Sanitizer', 'runtime error']:
        if word in said:
            return 'misleading', stderr.strip()[:300]
    if code < 0:
        return 'ok', ''
    if list(folder.glob('**/*.part')):
        return 'misleading', f'exit {code}, left ' + ' '.join(p.name for p in folder.glob('**/*.part'))
    if code == 3 and stderr.endswith(': standard output cannot be written\n') and stderr.count('\n') == 1:
        return 'refused', stderr.strip()
    if code > 2:
        return 'misleading', f'exit {code}: {stderr.strip()[:300]}'
    name = child.command[0]
    if code == 2 or (code == 1 and name == 'sandrunner-ctl'):
        # Of a run that had begun, warnings come before, and what the DDS library says of packets.
        lines = [line for line in stderr.split('\n')[:-1] if not line.startswith('DDS: ')]
        begun = '--clock' in child.command or child.out.stat().st_size > 0
        proper = len(lines) == 1 or (begun and len(lines) > 1)
        longest = 1000 + sum(len(word) for word in child.command)
        if not proper or not all(line.startswith(name + ': ') and len(line) < longest for line in lines):
            return 'misleading', f'{len(lines)} lines: {stderr.strip()[:300]!r}'
        return 'refused', lines[-1]
    if one.broken and code == 0:
        return 'misleading', f'exit 0 although the input is broken: {stderr.strip()[:300]}'
    return 'ok', ''


def attack(index, seed, maker, programs, out):
    """Input `index`: its kind, class, reason. Its folder stays if it hurt."""
    folder = out / str(index)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    rng = random.Random(f'{seed}:{index}')
    one = maker.draw(rng, folder)
    held = None
    if one.beside:
        domain, held = reserve_domain(rng)
        for command in [one.command, *one.beside]:
            command[:] = [word.replace(inputs.DOMAIN, str(domain)) for word in command]
    children = run(one, programs, folder)
    if held:
        held.close()
    verdicts = [(*judge(child, one, folder), child) for child in children]
    verdict, why, child = next((v for v in verdicts if v[0] in HURT), verdicts[0])
    if verdict in HURT:
        extra = ' '.join(f'{signal.Signals(n).name}@{t:.3f}s' for t, n in one.signals)
        why += f'\n    {shlex.join(child.command)[:400]} {one.shell} {str(one.environment or "")[:80]} {extra}'.rstrip()
    else:
        shutil.rmtree(folder, ignore_errors=True)
    return index, one.kind, verdict, why


def scratch_folder():
    """A new folder: in memory, where there is room for what the workers write."""
    memory = pathlib.Path('/dev/shm')
    roomy = os.access(memory, os.W_OK) and shutil.disk_usage(memory).free > 2**30
    return pathlib.Path(tempfile.mkdtemp(prefix='attack-', dir=memory if roomy else None))


def main():
    parser = argparse.ArgumentParser(prog='tools/attack.sh', description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--bin', type=pathlib.Path, required=True, help='folder of the programs')
    parser.add_argument('--minutes', type=float, default=5.0)
    parser.add_argument('--inputs', type=int, default=10**9)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--only', type=int, help='repeat this input alone, and keep its files')
    parser.add_argument('--out', type=pathlib.Path, help='folder for the files of what hurt (default: a temporary one)')
    options = parser.parse_args()
    out = options.out or scratch_folder()
    out.mkdir(parents=True, exist_ok=True)
    out = out.resolve()
    out.chmod(0o755)
    programs = out / 'bin'  # where other users find them
    programs.mkdir(exist_ok=True)
    for name in PROGRAMS:
        shutil.copy(options.bin / name, programs / name)
    good = out / 'good'
    good.mkdir(exist_ok=True)
    maker = inputs.Inputs(good_files(pathlib.Path(__file__).resolve().parents[2], programs, good))

    totals, kinds, found = collections.Counter(), collections.Counter(), []
    began = time.monotonic()
    until = began + 60.0 * options.minutes
    indices = iter([options.only] if options.only is not None else range(options.inputs))
    workers = 4 * len(os.sched_getaffinity(0))  # most of them sleep
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        running = set()
        while True:
            while len(running) < workers and time.monotonic() < until and (index := next(indices, None)) is not None:
                running.add(pool.submit(attack, index, options.seed, maker, programs, out))
            if not running:
                break
            done, running = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in done:
                index, kind, verdict, why = future.result()
                totals[verdict] += 1
                kinds[kind, verdict] += 1
                if verdict in HURT:
                    found.append(index)
                    print(f'{verdict} ({kind}): {why}\n    tools/attack.sh --seed {options.seed} --only {index}',
                          flush=True)
                elif options.only is not None:
                    print(f'{verdict} ({kind}): {why}')
    wall_s = time.monotonic() - began
    for kind in sorted({kind for kind, _ in kinds}):
        print(f'{kind:13}' + ''.join(f'{kinds[kind, v]:7} {v}' for v in ['ok', 'refused', *HURT]))
    count = sum(totals.values())
    print(f'{count} inputs of seed {options.seed} in {wall_s:.0f} s ({count / wall_s:.1f} a second): '
          + ', '.join(f'{totals[v]} {v}' for v in ['ok', 'refused', *HURT]))
    if found:
        print(f'files: {out}')
    elif options.out is None:
        shutil.rmtree(out)
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
