# SPDX-License-Identifier: BSD-3-Clause
"""The terms of CLAIMS.md: what "above", "about", "share" and "excess" mean. A figure is {seed:
Value}."""
import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from evidence import NAN, Value, median

LEAST_PAIRS = 8  # of runs, that a comparison may rest on


def values_of(figure):
    return [v.value for v in figure.values()]


def printed(figure, scale=1.0, digits=2):
    """ "1.23 [1.10, 1.30]", or "1.23" for one seed, times `scale`; "not defined" for nan."""
    middle = median(figure)
    if math.isnan(middle):
        return "not defined"
    text = f"{scale * middle:.{digits}f}"
    if len(figure) > 1:
        text += f" [{scale * min(values_of(figure)):.{digits}f}, {scale * max(values_of(figure)):.{digits}f}]"
    return text


def percent(figure):
    return printed(figure, 100.0, 1) + " %"


def mean_interval(values):
    """Number of values that are not nan, and Student's 95 % interval of their mean."""
    values = np.asarray(values)[~np.isnan(values)]
    n = len(values)
    if n == 0:
        return 0, NAN, NAN
    half = stats.t.ppf(0.975, n - 1) * np.sqrt(np.var(values, ddof=1) / n) if n > 1 else NAN
    return n, values.mean() - half, values.mean() + half


@dataclass
class Comparison:
    holds: bool = False
    pairs: int = 0  # of runs of the first common seed in which both have the figure


def compare(a, b, exceeds):
    """Whether each seed's a exceeds each seed's b, and the paired difference of the runs of the
    first common seed is no chance."""
    common = [seed for seed in sorted(a) if seed in b]
    if not common:
        return Comparison()
    x, y = a[common[0]].runs, b[common[0]].runs
    least = min(len(x), len(y))
    pairs, low, _ = mean_interval(x[:least] - y[:least])
    every = all(exceeds(p, q) for p in values_of(a) for q in values_of(b))
    return Comparison(bool(pairs >= LEAST_PAIRS and low > 0.0 and every), pairs)


def above(a, b, margin=0.0):
    return compare(a, b, lambda x, y: x - y > margin)


def above_by_share(a, b, share):
    return compare(a, b, lambda x, y: x - y > share * abs(y))


def below_by_share(a, b, share):
    return compare(b, a, lambda x, y: x - y > share * abs(x))


def is_about(figure, x, share=0.15):
    return abs(median(figure) - x) <= share * x


def is_far_from(figure, x, share=0.15):
    """Every seed is off by more than twice that share."""
    return bool(figure) and all(abs(v - x) > 2.0 * share * x for v in values_of(figure))


def is_share(figure, x):
    return abs(median(figure) - x) <= 0.15


def is_far_from_share(figure, x):
    return bool(figure) and all(abs(v - x) > 0.30 for v in values_of(figure))


def ratio(a, b):
    return {seed: Value(np.float64(v.value) / b[seed].value) for seed, v in a.items()}


def excess(a, b):
    return median(a) / median(b) - 1.0


def kendall_tau(a, b):
    """Kendall's tau-a: 1 for the same order, -1 for the reverse. A pair with a nan counts as
    neither."""
    signs = [np.sign((a[i] - a[j]) * (b[i] - b[j])) for i in range(len(a)) for j in range(i + 1, len(a))]
    return np.nansum(signs) / len(signs)
