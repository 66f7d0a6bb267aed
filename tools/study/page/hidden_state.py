# SPDX-License-Identifier: BSD-3-Clause
"""E4: what the nearest neighbours of a hidden state in other runs tell of it, and a picture of the
states."""
import base64
from functools import cache

import numpy as np
from scipy.spatial.distance import cdist

from evidence import NAN, Value

NEIGHBOURS = 10
BITS = (1 << 64) - 1


def states_of(group, name):
    """The numbers that were packed as float32, a row for each state."""
    return np.frombuffer(base64.b64decode(group.packed[name]), "<f4").reshape(len(group.lists["run"]), -1).astype(float)


def neighbours_in_other_runs(points, run, count=NEIGHBOURS):
    """Indices of the nearest states of other runs, the nearest first; a row for each state."""
    distance = cdist(points, points, "sqeuclidean")
    distance[run[:, None] == run[None, :]] = np.inf
    return np.argsort(distance, axis=1, kind="stable")[:, :count]


def share_told(neighbours, ground):
    """Share of the states whose neighbours tell the ground by majority, the nearest one's if it is
    a tie. `ground`: of each state."""
    of_neighbours = ground[neighbours]
    votes = (of_neighbours[:, :, None] == of_neighbours[:, None, :]).sum(2)
    told = of_neighbours[np.arange(len(ground)), votes.argmax(1)]
    return np.mean(told == ground)


def mix_bits(z):
    """The finaliser of SplitMix64."""
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & BITS
    z = (z ^ z >> 27) * 0x94D049BB133111EB & BITS
    return z ^ z >> 31


def random_uniform(stream, counter):
    """In [0, 1): that of sim/lanes/random.h with seed 1, so that a verdict depends on no library's
    generator."""
    golden = 0x9E3779B97F4A7C15
    key = (mix_bits((golden + 0x632BE59BD9B4E019) & BITS) ^
           mix_bits((stream * 0xD1B54A32D192ED03 + 0x8CB92BA72F3D8DD7) & BITS))
    return (mix_bits(mix_bits((key + counter * golden) & BITS) ^ key) >> 11) * 2.0**-53


def shuffled_share_told(neighbours, run, ground_of_run):
    """95th percentile of the share with the grounds shuffled over the runs, 100 times."""
    shares, ground = [], ground_of_run.copy()
    for time in range(100):
        for i in range(len(ground), 1, -1):
            j = int(i * random_uniform(31, 1000 * time + i))
            ground[i - 1], ground[j] = ground[j], ground[i - 1]
        shares.append(share_told(neighbours, ground[run]))
    return np.quantile(shares, 0.95)


def phase_told(neighbours, phase):
    """Length of the mean of exp(i error), the error being that of the phase that the neighbours
    tell."""
    on_circle = np.exp(2j * np.pi * phase)
    told = on_circle[neighbours].sum(1)
    length = np.abs(told)
    return np.abs(np.sum(np.where(length > 0, told / length, 0) * on_circle.conj())) / len(phase)


def figures_of(group):
    """By name; nan of a controller that left too few states to look at."""
    if group.lists["states"][0] < 10 * NEIGHBOURS:
        return dict.fromkeys(("told", "told_shuffled", "phase_told", "told_by_estimate"), NAN)
    run, ground_of_run = group.lists["run"].astype(int), group.lists["ground_of_run"]
    near = neighbours_in_other_runs(states_of(group, "hidden"), run)
    estimate = states_of(group, "estimate")
    spread = estimate.std(0)  # the estimate's parts have different units
    near_estimate = neighbours_in_other_runs(estimate / np.where(spread > 0, spread, 1.0), run)
    return {"told": share_told(near, ground_of_run[run]),
            "told_shuffled": shuffled_share_told(near, run, ground_of_run),
            "phase_told": phase_told(near, group.lists["phase"]),
            "told_by_estimate": share_told(near_estimate, ground_of_run[run])}


@cache
def all_figures(evidence):
    return {seed: figures_of(groups[0]) for seed, groups in evidence.seeds("E4", "ours").items()}


def figure(evidence, name):
    """{seed: Value} of Ours: "told", "told_shuffled", "phase_told" or "told_by_estimate"."""
    return {seed: Value(figures[name]) for seed, figures in all_figures(evidence).items()}


def embedded(group):
    """The states in the plane, two columns."""
    from sklearn.manifold import TSNE  # takes a second to load
    return TSNE(perplexity=30, init="pca", learning_rate="auto", random_state=0, n_jobs=1).fit_transform(
        states_of(group, "hidden"))
