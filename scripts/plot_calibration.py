#!/usr/bin/python3
"""Figure of a calibration file (`shapebench calibrate -o FILE.h5`): Young's modulus over w, and how far what the
frequencies say is from what the sag says.

Needs Debian's python3-h5py and python3-matplotlib, which scripts/setup installs. Exit codes: 0 drawn; 2 wrong
usage; 3 not a calibration file, or nothing in it to draw, or a package is missing; 4 cannot be written."""

from plots import drawing, engines, fail, parse, read, write

import numpy  # after plots, which says what is missing

COLOURS = {False: "#0072b2", True: "#d55e00"}  # has the engine an epsilon?
TONES = ("first", "second", "third")


def legend_below(axes, columns):
    """Under the axis' name: inside it would hide points."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=columns, frameon=False)


def valid_grid(specimen):
    """Which specimens are valid and of the scene's beam."""
    return (specimen["set"] == "grid") & (specimen["valid"] != 0)


def best(plan, specimen):
    """[specimens][by sag, by each frequency]: moduli by the reference, or without one by theory."""
    return specimen["young_meshless" if plan["meshless"] else "young_timoshenko"]


def first_epsilon(specimen):
    """Which specimens have no epsilon, or the least."""
    tree = specimen["sampled"]
    return ~tree | (specimen["epsilon"] == specimen["epsilon"][tree].min()) if tree.any() else ~tree


def direction(w, across, aspect):
    """What d of the law is multiplied by: w (w + 1) (spacing / thickness)^2 / (1 + 3 w spacing / length)."""
    return w * (w + 1) * across ** 2 / (1 + 3 * w * across / aspect)


def two_terms(plan, law, engine, w):
    """The law of an engine on the scene's beam and step, or None."""
    rows = numpy.flatnonzero(law["engine"] == engine)
    if not len(rows):
        return None
    c, d = law["c"][rows[0]][0], law["d"][rows[0]][0]
    spacing = plan["thickness"] / plan["across"]
    return (plan["density"] * (spacing / plan["h"]) ** 2 * w * (w + 1)
            * (c + d * direction(w, 1 / plan["across"], plan["aspect"])))


def modulus(axes, plan, specimen, law):
    """Young's modulus over w on the scene's beam: a line an epsilon, the law dashed."""
    grid = valid_grid(specimen)
    for sampled, engine in engines(specimen):
        its = grid & (specimen["engine"] == engine)
        epsilons = numpy.unique(specimen["epsilon"][its])
        for epsilon in epsilons:
            some = its & (specimen["epsilon"] == epsilon)
            share = 0.35 + 0.65 * (epsilon - epsilons[0]) / max(numpy.ptp(epsilons), 1e-9) if sampled else 1
            axes.plot(specimen["w"][some], specimen["young"][some], color=COLOURS[sampled], alpha=share, markersize=4,
                      marker="o" if sampled else "s", linewidth=1.2,
                      label=f"{engine}, epsilon {epsilon:g}" if sampled else engine)
    w = numpy.geomspace(specimen["w"][grid].min(), specimen["w"][grid].max(), 50)
    for sampled, engine in engines(specimen):
        curve = two_terms(plan, law, engine, w)
        if curve is not None:
            axes.plot(w, curve, color=COLOURS[sampled], linestyle=":", linewidth=1.5, zorder=0,
                      label=f"law of {engine}")
    wide = grid & (specimen["wide"] != 0)
    if wide.any() and not (specimen["wide"][grid] != 0).all():
        axes.axvspan(specimen["w"][wide].min() - 0.5, w[-1] + 0.5, color="0.93", zorder=-1)
        axes.text(0.98, 0.02, "grey: regions wider than the beam is thick", ha="right", va="bottom", fontsize=9,
                  color="0.35", transform=axes.transAxes)
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = numpy.unique(specimen["w"][grid])
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_xlim(max(0.5, w[0] - 0.2), w[-1] + 0.5)
    axes.set_xlabel("w, cells")
    axes.set_ylabel(f"Young's modulus, Pa (at {plan['density']:g} kg/m³)")
    legend_below(axes, 3)


def agreement(axes, plan, specimen):
    """What each frequency says over what the sag says, against how wide regions are."""
    valid = (specimen["valid"] != 0) & first_epsilon(specimen)
    young = best(plan, specimen)
    width = (2 * specimen["w"] + 1) * specimen["spacing"] / plan["thickness"]
    marks = ("o", "^", "D")
    for k, tone in enumerate(TONES):
        for sampled, engine in engines(specimen):
            some = valid & (specimen["engine"] == engine)
            if some.any():
                axes.scatter(width[some], 100 * (young[some, k + 1] / young[some, 0] - 1), s=16, marker=marks[k],
                             color=COLOURS[sampled], alpha=0.75, linewidths=0,
                             label=f"{engine}, {tone} frequency")
    axes.axhline(0, color="0.4", linewidth=0.8, zorder=0)
    axes.axvline(1, color="0.4", linewidth=0.8, linestyle="--", zorder=0)
    axes.set_xscale("log")
    wide = [tick for tick in (0.25, 0.5, 1, 2, 4, 8, 16) if width[valid].min() / 1.5 < tick < width[valid].max() * 1.5]
    axes.set_xticks(wide, [f"{tick:g}" for tick in wide])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.set_xlabel("width of a region, 2 w + 1 cells, over the beam's thickness")
    axes.set_ylabel("modulus by a frequency, over that by the sag, %")
    legend_below(axes, 3)


def collapse(axes, plan, specimen, law):
    """All specimens of the law: what is left of the modulus without rho (a / h)^2 w (w + 1)."""
    valid = (specimen["valid"] != 0) & first_epsilon(specimen)
    steps = specimen["w"] * (specimen["w"] + 1.0)
    x = direction(specimen["w"], specimen["spacing"] / plan["thickness"], specimen["aspect"])
    y = specimen["young"] / (plan["density"] * (specimen["spacing"] / specimen["h"]) ** 2 * steps)
    marks = {"grid": "o", "spacing": "s", "aspect": "D", "step": "x"}
    for sampled, engine in engines(specimen):
        for kind, mark in marks.items():
            some = valid & (specimen["engine"] == engine) & (specimen["set"] == kind)
            if some.any():
                axes.scatter(x[some], y[some], s=18, marker=mark, color=COLOURS[sampled], alpha=0.8,
                             label=f"{engine}, " + ("the scene's beam" if kind == "grid" else f"another {kind}"))
        rows = numpy.flatnonzero(law["engine"] == engine)
        if len(rows):
            at = numpy.geomspace(x[valid].min(), x[valid].max(), 60)
            axes.plot(at, law["c"][rows[0]][0] + law["d"][rows[0]][0] * at, color=COLOURS[sampled], linewidth=1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    ticks = [tick for tick in (0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10) if low < tick < high]
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("w (w + 1) (spacing / thickness)² / (1 + 3 w spacing / length)")
    axes.set_ylabel("Young's modulus / (density (spacing / step)² w (w + 1))")
    legend_below(axes, 2)


def main():
    arguments = parse(__doc__, "of shapebench calibrate", "svg")
    source = read(arguments.file, "calibration")
    plan, specimen, law = source.plan, source.specimen, source.law
    if not valid_grid(specimen).any():
        fail(f"{arguments.file}: no specimen of the scene's beam is valid", 3)
    figure, axes = drawing().subplots(1, 2, figsize=(15, 6), layout="constrained")
    modulus(axes[0], plan, specimen, law)
    agreement(axes[1], plan, specimen)
    axes[0].set_title("the elastic body that behaves alike; dotted: the two-term law", fontsize=9)
    axes[1].set_title("do the frequencies say the same as the sag? all beams, at the first epsilon", fontsize=9)
    import ticks

    ticks.label_logarithms(figure)
    figure.suptitle(f"{plan['scene']}: {len(specimen['w'])} of {plan['specimens']} specimens, {plan['across']} cells "
                    f"thick, {plan['aspect']} times as long, step {plan['h']:g} s", fontsize=10)
    write(figure, arguments.output, arguments.overwrite)


if __name__ == "__main__":
    main()
