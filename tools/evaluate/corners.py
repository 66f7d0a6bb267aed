#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tools/evaluate/corners.py POLICY: tests a policy's own envelope for falls. Each run steps from one corner of the
envelope to another and back, through the whole controller (sandrunner). The grounds are six presets and sand of 1/0.15
MN/m^3; the robot starts in the nominal pose, disturbed, or by standing up. Prints runs and falls for each ground and
corner, and for each fall how it happened and how to repeat it. Exit code 1: a run fell. The envelope is that of the
policy file (sandrunner-policy envelope)."""

import argparse
import collections
import concurrent.futures
import itertools
import json
import os
import pathlib
import random
import shlex
import shutil
import subprocess
import sys
import tempfile

TREE = pathlib.Path(__file__).resolve().parents[2]
SOFT = ['--set', 'terrain.sigma_flat_npm3=1e6', '--set', 'terrain.sigma_cone_npm3=0.15e6']
PRESETS = ['dry-sand', 'wet-sand', 'grass', 'athletic-track', 'vinyl', 'rigid']
GROUNDS = {name: ['--terrain', name] for name in PRESETS} | {'1/0.15': SOFT}
STARTS = {'nominal': ['--start', 'walk'], 'disturbed': ['--start', 'walk', '--seed', '1'], 'lying': []}


def envelope(policy):
    """Largest vx, -vx, |vy|, |yaw rate| and |yaw rate| times speed that the policy file allows."""
    with policy.open('rb') as file:
        header = json.loads(file.read(int.from_bytes(file.read(8), 'little')))  # safetensors
    found = [header['__metadata__'].get(f'sandrunner.{key}')
             for key in ('envelope.forward_mps', 'envelope.backward_mps', 'envelope.lateral_mps', 'envelope.yaw_radps',
                         'yaw_command_clip_mps2')]
    if None in found:
        sys.exit(f'corners.py: {policy}: found no envelope, expected one (sandrunner-policy envelope)')
    return [float(value) for value in found]


def corners(forward, back, lateral, yaw, centripetal):
    """Name -> command; diagonal ones on the ellipse within which the controller holds vx and vy."""
    d = 0.5 ** 0.5
    found = {'forward': (forward, 0, 0), 'back': (-back, 0, 0), 'left': (0, lateral, 0), 'right': (0, -lateral, 0),
            'ccw': (0, 0, yaw), 'cw': (0, 0, -yaw), 'forward left': (d * forward, d * lateral, 0),
            'forward right': (d * forward, -d * lateral, 0), 'back left': (-d * back, d * lateral, 0),
            'back right': (-d * back, -d * lateral, 0), 'forward ccw': (forward, 0, yaw),
            'forward left cw': (d * forward, d * lateral, -yaw), 'back ccw': (-back, 0, yaw),
            'left cw': (0, lateral, -yaw)}
    if forward * yaw > centripetal:  # where the controller begins to turn more slowly
        found['fast ccw'] = (centripetal / yaw, 0, yaw)
    return found


def command_file(first, second):
    """Name of the file with these commands, which have blanks in their own names."""
    return f'{first}--{second}.csv'.replace(' ', '-')


def run(programs, policy, robot, job, commands, folder):
    """Exit code of one run, how it ended, and how to repeat it."""
    ground, start, first, second = job
    a, b, zero = commands[first], commands[second], (0, 0, 0)
    rows = [(0.0, zero), (0.5, zero), (0.5, a), (3, a), (3, b), (5.5, b), (5.5, a), (7, a), (7, zero)]
    file = folder / command_file(first, second)
    if not file.exists():
        # Two rows at one time are a step; the controller makes of it what the envelope's
        # accelerations allow.
        lines = [f'{t + 1e-6 * i:.6f},{v[0]:g},{v[1]:g},{v[2]:g}\n' for i, (t, v) in enumerate(rows)]
        part = file.with_suffix(f'.{start}-{ground.replace("/", "-")}')
        part.write_text('t_s,vx,vy,wz\n' + ''.join(lines))
        part.replace(file)
    words = [str(programs / 'sandrunner'), '--policy', str(policy), '--command', str(file), '--duration', '8',
             *GROUNDS[ground], *STARTS[start], *(['--robot', str(robot)] if robot else [])]
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.returncode, done.stdout.partition('\n')[0], shlex.join(words)


def main():
    parser = argparse.ArgumentParser(prog='tools/evaluate/corners.py', description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('policy', type=pathlib.Path)
    parser.add_argument('--robot', help='raibo, go2 or a robot file (default: raibo)')
    parser.add_argument('--bin', type=pathlib.Path, default=TREE / 'build/release/bin', help='folder of the programs')
    parser.add_argument('--runs', type=int, help='number of runs, drawn at random (default: all, 3,822 or 4,410)')
    options = parser.parse_args()
    commands = corners(*envelope(options.policy))
    jobs = [(ground, start, first, second) for ground in GROUNDS for start in STARTS
            for first, second in itertools.permutations(commands, 2)]
    if options.runs is not None:
        jobs = random.Random(1).sample(jobs, min(options.runs, len(jobs)))
    runs, falls = collections.Counter(), collections.Counter()
    folder = pathlib.Path(tempfile.mkdtemp(prefix='corners-'))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        done = pool.map(lambda job: (job, *run(options.bin, options.policy, options.robot, job, commands, folder)),
                        jobs)
        for job, code, end, words in done:
            if code not in (0, 1):
                sys.exit(f'corners.py: exit {code}: {words}')
            for what in (job[0], f'from {job[2]}', f'to {job[3]}'):
                runs[what] += 1
                falls[what] += code
            if code:
                print(f'({", ".join(job)}): {end}: {words}', flush=True)
    fallen = sum(falls[ground] for ground in GROUNDS)
    for what in [*GROUNDS, *sorted(set(runs) - set(GROUNDS))]:
        print(f'{what:22}{runs[what]:6} runs{falls[what]:5} falls')
    print(f'{len(jobs)} runs, {fallen} falls')
    if not fallen:
        shutil.rmtree(folder)
    return 1 if fallen else 0


if __name__ == '__main__':
    sys.exit(main())
