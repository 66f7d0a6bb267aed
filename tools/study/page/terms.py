# SPDX-License-Identifier: BSD-3-Clause
"""The terms of CLAIMS.md: what "above", "about", "share" and "excess" mean. A figure is {seed:
Value}."""
import contextlib
import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from evidence import NAN, Value, median

LEAST_PAIRS = 8  # of runs, that a comparison may rest on
NO_SUCCESS = "no successful run"
_width = 1.0


@contextlib.contextmanager
def tolerances(width):
    """The tolerances of all terms times this, to see which verdicts hang on them."""
    global _width
    _width = width
    try:
        yield
    finally:
        _width = 1.0


def values_of(figure):
    return [v.value for v in figure.values()]


def printed(figure, scale=1.0, digits=2):
    """ "1.23 [1.10, 1.30]", or "1.23" for one seed, times `scale`; "not defined" for nan."""
    middle = median(figure)
    if not any(v.succeeded for v in figure.values()):
        return NO_SUCCESS if figure else "not defined"
    if math.isnan(middle):
        return "not defined"
    text = number(middle, scale, digits)
    if len(figure) > 1:
        text += f" [{', '.join(number(end(values_of(figure)), scale, digits) for end in (min, max))}]"
    return text


def number(value, scale=1.0, digits=2):
    return "none" if math.isinf(value) else "not defined" if math.isnan(value) else f"{scale * value:.{digits}f}"


def percent(figure):
    text = printed(figure, 100.0, 1)
    return text if text[-1].isalpha() else text + " %"


def mean_interval(values):
    """Number of values that are not nan, and Student's 95 % interval of their mean."""
    values = np.asarray(values)[~np.isnan(values)]
    n = len(values)
    if n == 0:
        return 0, NAN, NAN
    half = stats.t.ppf(0.975, n - 1) * np.sqrt(np.var(values, ddof=1) / n) if n > 1 else NAN
    return n, values.mean() - half, values.mean() + half


def rate_interval(runs):
    """Wilson's 95 % interval of the rate of ones among these ones and zeros; nan does not count."""
    runs = np.asarray(runs, float)
    runs = runs[~np.isnan(runs)]
    n, z2 = len(runs), stats.norm.ppf(0.975) ** 2
    if n == 0:
        return NAN, NAN
    middle, half = runs.mean() + z2 / (2 * n), np.sqrt(z2 * (runs.mean() * (1 - runs.mean()) + z2 / (4 * n)) / n)
    return (middle - half) / (1 + z2 / n), (middle + half) / (1 + z2 / n)


@dataclass
class Comparison:
    holds: bool = False
    pairs: int = 0  # of runs of the first common seed in which both have the figure
    none: bool = False  # neither has a successful run


def compare(a, b, exceeds):
    """Whether each seed's a exceeds each seed's b, and the paired difference of the runs of the
    first common seed is no chance. If one of the two has no successful run, there are no pairs and
    the other one needs as many runs."""
    common = [seed for seed in sorted(a) if seed in b]
    if not common:
        return Comparison()
    every = all(exceeds(p, q) or math.isinf(p) and not math.isinf(q) for p in values_of(a) for q in values_of(b))
    first = a[common[0]], b[common[0]]
    if all(value.succeeded for value in first):
        x, y = (value.runs for value in first)
        least = min(len(x), len(y))
        pairs, low, _ = mean_interval(x[:least] - y[:least])
    else:
        pairs, low = max(np.count_nonzero(~np.isnan(value.runs)) for value in first), math.inf
    return Comparison(bool(pairs >= LEAST_PAIRS and low > 0.0 and every), pairs,
                      not any(value.succeeded for value in first))


def above(a, b, margin=0.0):
    return compare(a, b, lambda x, y: x - y > _width * margin)


def above_by_share(a, b, share):
    return compare(a, b, lambda x, y: x - y > _width * share * abs(y))


def below_by_share(a, b, share):
    return compare(b, a, lambda x, y: x - y > _width * share * abs(x))


def is_about(figure, x, share=0.15):
    return abs(median(figure) - x) <= _width * share * x


def is_far_from(figure, x, share=0.15):
    """Every seed is off by more than twice that share."""
    return bool(figure) and all(abs(v - x) > 2.0 * _width * share * x for v in values_of(figure))


def is_share(figure, x):
    return abs(median(figure) - x) <= _width * 0.15


def is_far_from_share(figure, x):
    return bool(figure) and all(abs(v - x) > _width * 0.30 for v in values_of(figure))


def ratio(a, b):
    return {seed: Value(np.float64(v.value) / b[seed].value) for seed, v in a.items()}


def excess(a, b):
    return np.float64(median(a)) / median(b) - 1.0


def is_excess(found, x):
    """From half of x to twice x."""
    factor = 2.0 ** _width
    return x / factor <= found <= x * factor


def kendall_tau(a, b):
    """Kendall's tau-a: 1 for the same order, -1 for the reverse. A pair with a nan counts as
    neither."""
    signs = [np.sign((a[i] - a[j]) * (b[i] - b[j])) for i in range(len(a)) for j in range(i + 1, len(a))]
    return np.nansum(signs) / len(signs)
