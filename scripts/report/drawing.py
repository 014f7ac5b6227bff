"""Figures of a report: how all of them look, and what each must bring along."""
import csv
import io
import math
import os
import re
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

from ticks import label_logarithms  # noqa: E402

# Scripts that draw a file by themselves, and what they draw with, are a folder above.
sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))

COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#999999"]  # Okabe and Ito
MARKS = ["o", "s", "^", "D", "v", "P", "X"]
PAPER = "#777777"
WIDTH = 12  # inches, of every figure: a page's width at 1,400 pixels then shows 10 points as 16 pixels
STATUS_MARKS = {"ours": "~", "damaged": "?", "second-hand": "*"}  # how a paper's value came to us (results/README.md)

matplotlib.rcParams.update({
    "font.size": 10, "axes.titlesize": 10, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.7, "axes.axisbelow": True,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS), "legend.frameon": False, "legend.fontsize": 10,
    # texts stay texts: small, and found by search; in these fonts, which are as wide, or the reader's own
    "svg.fonttype": "none", "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],
    "svg.hashsalt": "shapebench", "figure.facecolor": "white", "savefig.facecolor": "white",
})


def lighter(svg):
    """The same picture in half the bytes: hundredths of a point, the font named once, no comments, no turns by nothing, no
    names that nothing uses."""
    text = re.sub(r"<!--.*?-->|<metadata>.*?</metadata>", "", svg.decode(), flags=re.DOTALL)
    text = re.sub(r' transform="rotate\(-0 [^"]*\)"', "", text)
    text = re.sub(r"font: ([\d.]+px) 'DejaVu Sans', 'Verdana', sans-serif", r"font-size: \1", text)
    text = text.replace("<svg ", '<svg font-family="DejaVu Sans, Verdana, sans-serif" ', 1)
    used = set(re.findall(r"#([\w-]+)", text))

    def tag(match):
        words = re.sub(r' id="([^"]+)"', lambda id: id[0] if id[1] in used else "", match[0])
        return re.sub(r"-?\d+\.\d{3,}", lambda value: f"{float(value[0]):.2f}".rstrip("0").rstrip("."), words)

    return re.sub(r"\s*\n\s*", "\n", re.sub(r"<[^>]*>", tag, text)).encode()


class Figure:
    """A picture with its caption, a text that says the same in words, and its data."""

    def __init__(self, name, title, caption, alternative, columns, data):
        self.name, self.title, self.caption, self.alternative = name, title, caption, alternative
        self.columns, self.data = columns, data
        self.svg = self.png = None

    def draw(self, figure):
        """Keeps both forms of a matplotlib figure and closes it."""
        pictures = {}
        label_logarithms(figure)
        for form, options in (("svg", {"metadata": {"Date": None}}), ("png", {"dpi": 120})):
            room = io.BytesIO()
            figure.savefig(room, format=form, **options)
            pictures[form] = room.getvalue()
        pyplot.close(figure)
        self.svg, self.png = lighter(pictures["svg"]), pictures["png"]
        return self

    def csv(self):
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(map(cell, self.columns))
        writer.writerows(map(cell, row) for row in self.data)
        return text.getvalue()


def cell(value):
    """Of CSV. Text that a spreadsheet would take for a formula gets an apostrophe before it; numbers are rounded here
    and in number(), and nowhere before, for twice is once too often."""
    if value is None or value != value:
        return ""
    if isinstance(value, float):
        return f"{value:.9g}"
    return f"'{value}" if isinstance(value, str) and value[:1] in tuple("=+-@\t\r") else value


def canvas(height=3.9):
    """A figure as wide as the page, and its axes."""
    return pyplot.subplots(figsize=(WIDTH, height), layout="constrained")


def legend_above(axes, *what, columns=5):
    """Begins at the left, which narrow windows show first."""
    axes.legend(*what, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, columnspacing=1.5, borderaxespad=0.2)


def number(value, digits=3):
    """A number for people: digits that count, no exponents where they are not needed."""
    if value is None or value != value:
        return "–"
    if value == 0:
        return "0"
    if abs(value) >= 10 ** digits or abs(value) >= 1000:
        return f"{value:,.0f}" if abs(value) < 1e9 else f"{value:.2e}"
    if isinstance(value, int) or abs(value) < 1e-5:
        return f"{value:g}"
    return f"{value:.{max(0, digits - 1 - int(math.floor(math.log10(abs(value)))))}f}"
