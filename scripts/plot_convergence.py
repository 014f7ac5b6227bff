#!/usr/bin/python3
"""Figure of how shells and plates converge: what the tests of the obstacle course and of square plates print, over
theory's values, against the number of nodes.

    for test in obstacles plates; do build/test_meshless_$test; done >convergence.txt 2>&1
    scripts/plot_convergence.py convergence.txt

Needs Debian's python3-h5py and python3-matplotlib, which scripts/setup installs. Exit codes: 0 drawn; 2 wrong
usage; 3 no such lines in the file, or a package is missing; 4 cannot be written."""

import re

from plots import drawing, fail, parse, write

LINE = re.compile(r"^(.+), (deflection|frequency): (\d+) nodes, ([\d.]+) of theory's$", re.MULTILINE)


def curves(path):
    """Nodes and shares by what is measured of which body."""
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError) as error:
        fail(f"{path}: cannot be read: {getattr(error, 'strerror', None) or 'not text'}", 3)
    found = {}
    for body, quantity, nodes, share in LINE.findall(text):
        found.setdefault((body, quantity), []).append((int(nodes), float(share)))
    if not found:
        fail(f"{path}: no lines of build/test_meshless_obstacles or build/test_meshless_plates", 3)
    return found


def panel(axes, found, quantity, title, band):
    axes.axhspan(1 - band, 1 + band, color="#e0e0e0", label=f"within {100 * band:.0f}%")
    axes.axhline(1, color="black", linewidth=0.8)
    for mark, body in zip("os^v", sorted({body for body, what in found if what == quantity})):
        axes.plot(*zip(*found[body, quantity]), marker=mark, label=body)
    axes.set_xscale("log")
    ticks = (50, 100, 200, 500, 1000, 2000)
    axes.set_xticks(ticks, [f"{tick}" for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("nodes")
    axes.set_title(title, fontsize=10)
    axes.legend(fontsize=8, frameon=False)


def main():
    arguments = parse(__doc__, "what the tests print", "svg")
    found = curves(arguments.file)
    plates = {key: values for key, values in found.items() if "plate" in key[0]}
    course = {key: values for key, values in found.items() if key not in plates}
    figure, axes = drawing().subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    panel(axes[0], course, "deflection", "obstacle course, quadratic functions: deflection", 0.03)
    panel(axes[1], plates, "deflection", "square plates: deflection of the middle", 0.01)
    panel(axes[2], plates, "frequency", "square plates: lowest frequency", 0.01)
    axes[0].set_ylabel("share of theory's value")
    write(figure, arguments.output, arguments.overwrite)


if __name__ == "__main__":
    main()
