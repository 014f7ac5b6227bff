"""Sweeps of a report: heat maps over w and epsilon, what a stiffness costs, the front's table.
How they are drawn is scripts/plot_sweep.py's matter."""
import numpy as np

from drawing import Figure, canvas, number
from tables import Table, where

import plot_sweep

# dataset, factor, file name, title, unit, logarithmic, caption
MAPS = [
    ("total_ms", 1, "cost", "Milliseconds of a step", "milliseconds", True, "Checked and timed; grey: not measured or INVALID."),
    ("path_rms", 100, "deviation", "Path off, percent of the body's size", "percent", False,
     "How far the surface moves from that of a lattice of all finest cells with regions as wide on average; root mean "
     "square of all frames."),
    ("goal_rms", 1, "goals", "Goals off, finest cells", "cells", False,
     "Root mean square of goal positions from those of epsilon 0 in the same state."),
    ("frequency", 1, "frequency", "First natural frequency of a clamped beam, Hz", "hertz", True,
     "The stiffness that w and epsilon give, on a beam of regular cells."),
    ("sag", 100, "sag", "Sag of a clamped beam's tip, percent of its length", "percent", True, "In the limit of small sags."),
    ("summation_nodes", 1, "summation", "Summation nodes of a region", "nodes", True, "Mean; a lattice has none."),
    ("bytes", 1e-6, "memory", "Memory, megabytes", "megabytes", True, "That making the engine took."),
    ("build_seconds", 1e3, "build", "Set-up, milliseconds", "milliseconds", True, "Engine built from voxels."),
]


def listed(point, values):
    return [[point["engine"][i], float(point["w"][i]), float(point["epsilon"][i]), float(values[i])]
            for i in range(len(values))]


def heat_map(source, name, factor, file_name, title, unit, logarithmic, caption):
    point = source.point
    values = factor * np.array(point[name], dtype=float)
    known = np.flatnonzero(np.isfinite(values))
    if not len(known) or np.ptp(values[known]) == 0:
        return None
    figure, axes = canvas(1.1 + 0.3 * len(np.unique(point["w"])))
    axes.grid(visible=False)
    plot_sweep.heat_map(axes, source.plan, point, values, "", logarithmic)
    figure.axes[-1].set_ylabel(unit)  # of the colours
    least, most = known[np.argmin(values[known])], known[np.argmax(values[known])]
    words = (f"Heat map over w and epsilon of {len(known)} points: from {number(values[least])} at {where(point, least)} "
             f"to {number(values[most])} at {where(point, most)}.")
    return Figure(f"sweep-{source.plan['scene']}-{file_name}", f"{source.plan['scene']}: {title}", caption, words,
                  ["engine", "w", "epsilon", name], listed(point, values)).draw(figure)


def front(source):
    point = source.point
    figure, axes = canvas(4.8)
    plot_sweep.front(axes, point)
    axes.set_title("")
    best = on_front(point)
    words = f"{len(best)} points are on the front" + "".join(
        f"; {name}: {where(point, i)}, {number(point['frequency'][i])} Hz, {number(point['total_ms'][i])} ms"
        for name, i in zip(("softest", "stiffest"), best[[0, -1]] if len(best) else ()))
    return Figure(f"sweep-{source.plan['scene']}-front", f"{source.plan['scene']}: what a stiffness costs",
                  f"Each point is an engine, a {plot_sweep.unit_of_w(source.plan)}, and an epsilon; of one that is ringed "
                  "no other is as stiff within 10%, as near, and cheaper beyond the spread of its repeats.",
                  words + ".", ["engine", "w", "epsilon", "frequency", "total_ms", "path_rms", "front"],
                  [line + [float(point["total_ms"][i]), float(point["path_rms"][i]), int(point["front"][i])]
                   for i, line in enumerate(listed(point, point["frequency"]))]).draw(figure)


def on_front(point):
    best = np.flatnonzero(point["front"])
    return best[np.lexsort((point["total_ms"][best], point["frequency"][best]))]


def front_table(source):
    point = source.point
    table = Table(f"The front of {source.plan['scene']}: what to take for a stiffness",
                  ["point", "frequency, Hz", "sag, %", "ms a step", "path off, %", "most, %", "goals off, cells",
                   "sums/region", "set-up ms", "MB"],
                  f"Of {source.name}. No other valid point is as stiff within 10%, as cheap and as near.")
    for i in on_front(point):
        table.add([where(point, i)] + [number(float(v)) for v in (
            point["frequency"][i], 100 * point["sag"][i], point["total_ms"][i], 100 * point["path_rms"][i],
            100 * point["path_most"][i], point["goal_rms"][i], point["summation_nodes"][i],
            1e3 * point["build_seconds"][i], 1e-6 * point["bytes"][i])])
    return table


def summary(source):
    plan, point = source.plan, source.point
    bad = int((point["valid"] == 0).sum())
    return (f"{plan['scene']} was swept over w and epsilon ({source.name}): {len(point['w'])} of {plan['points']} points, "
            + ("all VALID" if not bad else f"{bad} INVALID") + f", {int(point['front'].sum())} on the front; an octree's w "
            f"counts {plan['width']}, a lattice's cells.")


def figures(source):
    return [front(source)] + [figure for figure in (heat_map(source, *map_) for map_ in MAPS) if figure]
