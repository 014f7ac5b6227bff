"""Calibrations of a report: what was found, the laws, the moduli of the scene's beam, and figures of modulus,
agreement and law. How they are drawn is scripts/plot_calibration.py's matter."""
import numpy as np

from drawing import Figure, canvas, number
from tables import ALIKE, Table, where

import plot_calibration

SETTINGS = ("engine", "w", "epsilon", "across", "aspect", "spacing", "h")


def name_of(source, what):
    return f"calibration-{source.plan['scene']}-{what}"


def pascals(value):
    return "–" if value != value else f"{value:.3g}"


def megapascals(value):
    return number(1e-6 * float(value))


def summary(source):
    """What the program wrote about the figures of this file, three sentences."""
    return " ".join(source.found)


def estimate(values):
    return f"{number(float(values[0]))} ({number(float(values[1]))} to {number(float(values[2]))})"


def law_table(source):
    table = Table("What Young's modulus follows from",
                  ["engine", "specimens", "c", "d", "off by, %"],
                  f"Of {source.name}, with 95% confidence intervals: E = rho (spacing/h)^2 w (w+1) "
                  "(c + d w (w+1) (spacing/thickness)^2 / (1 + 3 w spacing/length)).")
    law = source.law
    for i, engine in enumerate(law["engine"]):
        table.add([engine, int(law["specimens"][i]), estimate(law["c"][i]), estimate(law["d"][i]),
                   number(100 * float(law["scatter"][i]))])
    return table


def grid_table(source):
    plan, specimen = source.plan, source.specimen
    by = plot_calibration.best(plan, specimen)
    table = Table(f"Young's modulus on the scene's beam, MPa at {plan['density']:g} kg/m³",
                  ["engine", "E", "by the sag", "by f1", "by f2", "by f3", "apart, %", "Timoshenko, sag",
                   "Euler-Bernoulli, sag", "f1, Hz", "check"],
                  f"Of {source.name}. By the " + ("meshless reference" if plan["meshless"] else "theory of Timoshenko's beam")
                  + " unless another is named. E: geometric mean of sag and first frequency.")
    for i in np.flatnonzero(specimen["set"] == "grid"):
        good = specimen["valid"][i] != 0
        table.add([where(specimen, i), megapascals(specimen["young"][i])] + [megapascals(value) for value in by[i]]
                  + [number(100 * float(specimen["spread"][i])), megapascals(specimen["young_timoshenko"][i][0]),
                     megapascals(specimen["young_euler"][i][0]), number(float(specimen["frequency"][i][0])),
                     "VALID" if good else "INVALID: " + specimen["reason"][i]], "" if good else "invalid")
    return table.fold(ALIKE)


def listed(specimen, chosen, *columns):
    """Lines of settings and further columns, for the figure's data."""
    return [[specimen[name][i].item() for name in SETTINGS] + [float(column[i]) for column in columns]
            for i in np.flatnonzero(chosen)]


def modulus(source):
    plan, specimen = source.plan, source.specimen
    figure, axes = canvas(5.2)
    plot_calibration.modulus(axes, plan, specimen, source.law)
    grid = plot_calibration.valid_grid(specimen)
    parts = []
    for engine in np.unique(specimen["engine"][grid]):
        some = np.flatnonzero(grid & (specimen["engine"] == engine))
        least, most = some[np.argmin(specimen["young"][some])], some[np.argmax(specimen["young"][some])]
        parts.append(f"{engine}: from {pascals(specimen['young'][least])} Pa at w {specimen['w'][least]:g} to "
                     f"{pascals(specimen['young'][most])} Pa at {where(specimen, most)}")
    return Figure(name_of(source, "modulus"), f"{plan['scene']}: Young's modulus of the elastic body that behaves alike",
                  "A line an epsilon; dotted: the two-term law at the first epsilon; grey: regions are wider than the beam "
                  "is thick.", "Young's modulus rises with w. " + "; ".join(parts) + ".", [*SETTINGS, "young", "spread"],
                  listed(specimen, grid, specimen["young"], specimen["spread"])).draw(figure)


def agreement(source):
    plan, specimen = source.plan, source.specimen
    figure, axes = canvas(5.2)
    plot_calibration.agreement(axes, plan, specimen)
    valid = specimen["valid"] != 0
    young = plot_calibration.best(plan, specimen)
    off = 100 * (young[:, 1:] / young[:, :1] - 1)
    words = "; ".join(f"by the {tone} frequency from {number(float(off[valid, k].min()))}% to "
                      f"{number(float(off[valid, k].max()))}%" for k, tone in enumerate(plot_calibration.TONES))
    return Figure(name_of(source, "agreement"), f"{plan['scene']}: do the frequencies say the same as the sag?",
                  "Every beam, spacing and time step, at the first epsilon; an elastic body is at 0. Left of the dashed line "
                  "regions fit into the beam.", f"Moduli over that by the static sag, all specimens: {words}.",
                  [*SETTINGS, "off_1", "off_2", "off_3"], listed(specimen, valid, *off.T)).draw(figure)


def collapse(source):
    plan, specimen = source.plan, source.specimen
    figure, axes = canvas(5.2)
    plot_calibration.collapse(axes, plan, specimen, source.law)
    valid = specimen["valid"] != 0
    law = source.law
    words = "; ".join(f"{engine}: c {number(float(law['c'][i][0]))}, d {number(float(law['d'][i][0]))}, off by "
                      f"{number(100 * float(law['scatter'][i]))}% rms" for i, engine in enumerate(law["engine"]))
    return Figure(name_of(source, "law"), f"{plan['scene']}: one law for all spacings, lengths and time steps",
                  "Young's modulus without its powers of spacing, step and w, against what direction adds; lines: the "
                  "two-term law.", f"Points lie on a line c + d x an engine: {words or 'no law could be fitted'}.",
                  [*SETTINGS, "young"], listed(specimen, valid, specimen["young"])).draw(figure)


def figures(source):
    shown = plot_calibration.valid_grid(source.specimen).any()
    return [modulus(source), agreement(source), collapse(source)] if shown else []
