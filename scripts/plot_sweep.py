#!/usr/bin/python3
"""Figure of a sweep file (`shapebench sweep -o FILE.h5`): cost, deviation and stiffness over w and epsilon, and
the front of cost against deviation.

Needs Debian's python3-h5py and python3-matplotlib, which scripts/setup installs. Exit codes: 0 drawn; 2 wrong
usage; 3 not a sweep file, or nothing in it to draw, or a package is missing; 4 cannot be written."""

from plots import LATTICE, OCTREE, drawing, parse, read, write

import numpy  # after plots, which says what is missing


def table(point, values, ws, epsilons):
    """[w][lattice, epsilons...]; NaN where there is none."""
    cells = numpy.full((len(ws), 1 + len(epsilons)), numpy.nan)
    for i, engine in enumerate(point["engine"]):
        column = 0 if engine == LATTICE else 1 + numpy.searchsorted(epsilons, point["epsilon"][i])
        cells[numpy.searchsorted(ws, point["w"][i]), column] = values[i]
    return cells


def short(value):
    """Two significant digits, at most."""
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def heat_map(axes, point, values, title, logarithmic):
    tree = point["engine"] == OCTREE
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
        for (row, column), value in numpy.ndenumerate(cells):
            if cells.size <= 200 and numpy.isfinite(value):
                dark = image.norm(value) < 0.6
                axes.text(column, row, short(value), ha="center", va="center", fontsize=6,
                          color="white" if dark else "black")
    names = (["lattice"] if has_lattice else []) + [f"{e:g}" for e in epsilons]
    every = max(1, len(names) // 14)
    axes.set_xticks(range(len(names))[::every], names[::every], fontsize=7)
    axes.set_yticks(range(len(ws)), [f"{w:g}" for w in ws], fontsize=7)
    if has_lattice:
        axes.axvline(0.5, color="white", linewidth=2)
    axes.set_xlabel("epsilon")
    axes.set_ylabel("w")
    axes.set_title(title, fontsize=9)


def front(axes, plan, point):
    cost, off = point["total_ms"], 100 * point["path_rms"]
    shown = numpy.isfinite(cost) & numpy.isfinite(off)
    axes.set_title("cost against deviation; rings: the front", fontsize=9)
    axes.set_xlabel("ms a step")
    axes.set_ylabel("path off, % rms")
    if not shown.any():
        axes.text(0.5, 0.5, "no valid point has both", ha="center", transform=axes.transAxes)
        return
    for engine, marker in ((LATTICE, "s"), (OCTREE, "o")):
        some = shown & (point["engine"] == engine)
        if some.any():
            dots = axes.scatter(cost[some], off[some], c=point["w"][some], marker=marker, s=18, cmap="plasma",
                                vmin=point["w"].min(), vmax=point["w"].max(), label=engine)
    best = numpy.flatnonzero(shown & (point["front"] != 0))
    best = best[numpy.lexsort((off[best], cost[best]))]
    axes.scatter(cost[best], off[best], marker="o", s=46, facecolors="none", edgecolors="0.3", linewidth=0.7)
    best = best[off[best] <= numpy.minimum.accumulate(off[best])]  # others cost the same but for noise
    axes.step(cost[best], off[best], where="post", color="0.3", linewidth=1, zorder=0)
    for n, i in enumerate(best[:: max(1, len(best) // 5)]):
        name = f"w {point['w'][i]:g}" + (f", {point['epsilon'][i]:g}" if point["engine"][i] == OCTREE else "")
        axes.annotate(name, (cost[i], off[i]), xytext=(6, 6 + 9 * (n % 3)), textcoords="offset points",
                      fontsize=6, arrowprops={"arrowstyle": "-", "linewidth": 0.4})
    axes.set_xscale("log")
    axes.set_ylim(bottom=-0.03 * max(off[shown].max(), 1e-6))
    axes.legend(fontsize=7)
    axes.figure.colorbar(dots, ax=axes, pad=0.02, label="w")


def main():
    arguments = parse(__doc__, "of shapebench sweep", "svg")
    source = read(arguments.file, "sweep")
    plan, point = source.plan, source.point
    figure, axes = drawing().subplots(2, 2, figsize=(11, 8), layout="constrained")
    maps = ((axes[0][0], point["total_ms"], "ms a step", True),
            (axes[0][1], 100 * point["path_rms"], "path off: surface from full resolution, % of size, rms", False),
            (axes[1][0], point["frequency"], "first frequency of the regular beam, Hz", True))
    for place, values, title, logarithmic in maps:
        heat_map(place, point, values, title, logarithmic)
    front(axes[1][1], plan, point)
    figure.suptitle(f"{plan['scene']}: {len(point['w'])} of {plan['points']} points; an octree's w in {plan['width']}, "
                    "a lattice's in cells", fontsize=10)
    write(figure, arguments.output)


if __name__ == "__main__":
    main()
