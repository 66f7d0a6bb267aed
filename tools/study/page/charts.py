# SPDX-License-Identifier: BSD-3-Clause
"""How every picture of the page is drawn: charts side by side under one title and one legend."""
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402: after the choice of what draws
import numpy as np  # noqa: E402

from evidence import NAN  # noqa: E402
from files import write_whole  # noqa: E402

WIDTH_IN, DOTS_PER_IN = 12.4, 100
INK, FAINT = "#21262e", "#6b737f"
GREY, BLUE, ORANGE = (0.45, 0.45, 0.48), (0.05, 0.32, 0.70), (0.84, 0.37, 0.00)
GREEN, RED, DARK = (0.10, 0.55, 0.20), (0.75, 0.20, 0.20), (0.35, 0.35, 0.38)
plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9.5, "text.color": INK, "axes.edgecolor": "#9aa1aa",
    "axes.labelcolor": FAINT, "axes.titlesize": 10.5, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.grid": True, "axes.axisbelow": True, "grid.color": "#e3e6ea", "xtick.color": INK, "ytick.color": INK,
    "xtick.major.size": 0, "ytick.major.size": 0, "lines.linewidth": 1.6, "lines.scale_dashes": False,
    "savefig.dpi": DOTS_PER_IN})


class Sheet:
    """`axes`: those of its charts, row by row. The legend has each label once."""

    def __init__(self, title, charts, columns=2, height_in=3.3):
        columns = max(columns, 1)
        rows = max(math.ceil(charts / columns), 1)
        self.title, self.height_in = title, height_in * rows
        self.figure, axes = plt.subplots(rows, columns, squeeze=False)
        self.axes = list(axes.flat)
        for ax in self.axes[charts:]:
            ax.set_visible(False)

    def save(self, path):
        """Writes the PNG; no other drawing after it."""
        entries = {}
        for ax in self.axes:
            for handle, label in zip(*ax.get_legend_handles_labels()):
                entries.setdefault(label, handle)
            if not ax.has_data() and not ax.texts:
                ax.text(0.5, 0.5, "not run", transform=ax.transAxes, ha="center", color=FAINT)
                ax.grid(False)
        lines = self.legend_lines(list(entries))
        head_in = 0.48 + 0.24 * len(lines)
        height_in = self.height_in + head_in
        self.figure.set_size_inches(WIDTH_IN, height_in)
        self.figure.set_layout_engine("constrained", rect=(0.005, 0.0, 0.99, 1.0 - head_in / height_in),
                                      wspace=0.03, hspace=0.04)
        self.figure.text(0.011, 1.0 - 0.30 / height_in, self.title, fontsize=13, fontweight="bold")
        for i, labels in enumerate(lines):
            self.figure.legend([entries[label] for label in labels], labels, loc="upper left", frameon=False,
                               bbox_to_anchor=(0.011, 1.0 - (0.44 + 0.24 * i) / height_in), ncol=len(labels),
                               borderpad=0.0, borderaxespad=0.0, handlelength=3.0, columnspacing=1.6)
        picture = io.BytesIO()
        self.figure.savefig(picture, metadata={"Software": None})
        write_whole(path, picture.getvalue())
        plt.close(self.figure)

    @staticmethod
    def legend_lines(labels, most=130):
        """The labels in lines of about as many letters, samples counted in."""
        lines, length = [], most
        for label in labels:
            length += len(label) + 8
            if length > most:
                lines.append([])
                length = len(label) + 8
            lines[-1].append(label)
        return lines


def name_axes(ax, title="", x_label="", y_label="", y_from_zero=False):
    """To be called after the drawing, which the ends of the axes depend on."""
    ax.set_title(title)
    ax.set_xlabel(x_label)
    ax.set_ylabel(y_label)
    if y_from_zero:
        top = ax.get_ylim()[1]
        ax.set_ylim(0.0, 1.04 * top if top > 0.0 else 1.0)


def look(controller):
    """The colour and dashes of a controller's line."""
    return {"color": controller.color, "linestyle": (0, controller.dashes) if controller.dashes else "-"}


def line(ax, x, y, label, color, linestyle="-", dots=True):
    """A line with a dot at each point; nan is a gap."""
    ax.plot(x, y, label=label, color=color, linestyle=linestyle, marker="o" if dots else "", markersize=5)


def caps(ax, x, low, high, color):
    """Ranges at x."""
    x, low, high = (np.asarray(values, float)[np.isfinite(np.asarray(low, float))] for values in (x, low, high))
    ax.errorbar(x, (low + high) / 2, yerr=(high - low) / 2, fmt="none", ecolor=color, elinewidth=1.0, capsize=3)


def bars(ax, categories, series):
    """Bars next to each other. `series`: label, colour, heights, and least and greatest of each or
    None."""
    width = 0.8 / max(len(series), 1)
    for i, (label, color, heights, ends) in enumerate(series):
        x = np.arange(len(categories)) + (i - 0.5 * (len(series) - 1)) * width
        ax.bar(x, heights, 0.92 * width, label=label, color=color)
        if ends is not None:
            caps(ax, x, *ends, INK)
    ax.set_xticks(range(len(categories)), categories)
    ax.set_xlim(-0.5, len(categories) - 0.5)
    ax.grid(False, axis="x")


def least_and_greatest(values):
    """Of those that are not nan; nan without any."""
    return np.fmin.reduce(values, initial=NAN), np.fmax.reduce(values, initial=NAN)
