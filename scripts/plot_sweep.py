#!/usr/bin/python3
"""Figure of a sweep file (`shapebench sweep -o FILE.h5`): cost, deviation and stiffness over w and epsilon, and
what a stiffness costs, with the front.

Needs Debian's python3-h5py and python3-matplotlib, which scripts/setup installs. Exit codes: 0 drawn; 2 wrong
usage; 3 not a sweep file, or nothing in it to draw, or a package is missing; 4 cannot be written."""

from plots import drawing, engines, parse, read, write

import numpy  # after plots, which says what is missing


def table(point, values, ws, epsilons):
    """[w][lattice, epsilons...]; NaN where there is none."""
    cells = numpy.full((len(ws), 1 + len(epsilons)), numpy.nan)
    for i, sampled in enumerate(point["sampled"]):
        column = 1 + numpy.searchsorted(epsilons, point["epsilon"][i]) if sampled else 0
        cells[numpy.searchsorted(ws, point["w"][i]), column] = values[i]
    return cells


def short(value):
    """Two significant digits, at most."""
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def unit_of_w(plan):
    """A lattice's cells are alike: of it both are cells."""
    return "w, edges of each node's cell" if plan["width"] == "edges" else "w, finest cells"


def heat_map(axes, plan, point, values, title, logarithmic):
    tree = point["sampled"]
    ws, epsilons = numpy.unique(point["w"]), numpy.unique(point["epsilon"][tree])
    has_lattice = not tree.all()
    cells = table(point, values, ws, epsilons)
    if not has_lattice:
        cells = cells[:, 1:]
    known = cells[numpy.isfinite(cells) & ((cells > 0) | (not logarithmic))]
    axes.set_facecolor("0.85")
    if known.size:
        from matplotlib.colors import LogNorm

        norm = LogNorm(known.min(), max(known.max(), 1.001 * known.min())) if logarithmic else None
        image = axes.imshow(cells, origin="lower", aspect="auto", cmap="viridis", norm=norm)
        axes.figure.colorbar(image, ax=axes, pad=0.02)
        size = min(9, 24 * axes.bbox.width / axes.figure.dpi / cells.shape[1])  # three fit in a cell
        for (row, column), value in numpy.ndenumerate(cells):
            if cells.size <= 200 and numpy.isfinite(value):
                dark = image.norm(value) < 0.6
                axes.text(column, row, short(value), ha="center", va="center", fontsize=size,
                          color="white" if dark else "black")
    names = (["lattice"] if has_lattice else []) + [f"{e:g}" for e in epsilons]
    every = max(1, len(names) // 14)
    axes.set_xticks(range(len(names))[::every], names[::every])
    axes.set_yticks(range(len(ws)), [f"{w:g}" for w in ws])
    if has_lattice:
        axes.axvline(0.5, color="white", linewidth=2)
    axes.set_xlabel("epsilon")
    axes.set_ylabel(unit_of_w(plan))
    axes.set_title(title, fontsize=9)


def front(axes, point):
    stiff, cost, off = point["frequency"], point["total_ms"], 100 * point["path_rms"]
    shown = numpy.isfinite(stiff) & numpy.isfinite(cost) & numpy.isfinite(off)
    axes.set_title("what a stiffness costs; rings: the front; digits: w", fontsize=9)
    axes.set_xlabel("first frequency of the regular beam, Hz")
    axes.set_ylabel("milliseconds a step")
    if not shown.any():
        axes.text(0.5, 0.5, "no valid point has all three", ha="center", transform=axes.transAxes)
        return
    for sampled, engine in engines(point):
        some = shown & (point["engine"] == engine)
        if some.any():
            mark = "o" if sampled else "s"
            dots = axes.scatter(stiff[some], cost[some], c=off[some], marker=mark, s=18, cmap="plasma", vmin=0,
                                vmax=max(off[shown].max(), 1e-6))
            axes.scatter([], [], color="0.4", marker=mark, s=18, label=engine)
    best = numpy.flatnonzero(shown & (point["front"] != 0))
    axes.scatter(stiff[best], cost[best], marker="o", s=46, facecolors="none", edgecolors="0.3", linewidth=0.7)
    named = {}  # of each engine and w the softest of the front
    for i in best[numpy.argsort(stiff[best], kind="stable")]:
        named.setdefault((point["engine"][i], point["w"][i]), i)
    for (_, w), i in named.items():
        axes.annotate(f"{w:g}", (stiff[i], cost[i]), (0, 5), textcoords="offset points", ha="center", fontsize=8)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(y=0.1)
    axes.legend()
    axes.figure.colorbar(dots, ax=axes, pad=0.02, label="path off, percent of the body's size")


def main():
    arguments = parse(__doc__, "of shapebench sweep", "svg")
    source = read(arguments.file, "sweep")
    plan, point = source.plan, source.point
    pyplot = drawing()
    import ticks

    figure, axes = pyplot.subplots(2, 2, figsize=(11, 8), layout="constrained")
    maps = ((axes[0][0], point["total_ms"], "ms a step", True),
            (axes[0][1], 100 * point["path_rms"], "path off: surface from full resolution, % of size, rms", False),
            (axes[1][0], point["frequency"], "first frequency of the regular beam, Hz", True))
    for place, values, title, logarithmic in maps:
        heat_map(place, plan, point, values, title, logarithmic)
    front(axes[1][1], point)
    ticks.label_logarithms(figure)
    figure.suptitle(f"{plan['scene']}: {len(point['w'])} of {plan['points']} points", fontsize=10)
    write(figure, arguments.output, arguments.overwrite)


if __name__ == "__main__":
    main()
