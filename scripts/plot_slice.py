#!/usr/bin/python3
"""Draws the signed distance on a plane that `shapebench info POINTS --slice z=0.5 -o FILE.h5` wrote:
blue inside, red outside, the surface (zero) black.

Needs Debian's python3-h5py and python3-matplotlib (scripts/setup). Exit codes: 0 drawn; 2 wrong usage; 3 not a
slice, or damaged, or a package is missing; 4 cannot be written."""

import pathlib

from plots import drawing, fail, opened, parse, write

import numpy  # after plots, which says what is missing

FACTS = ("source", "axis", "at", "low", "high", "points")
LEAST, MOST = 2, 10000  # samples along a side


def check(facts, distance):
    """Raises ValueError where numbers are none that a slice has."""
    low, high = facts["low"], facts["high"]
    right = {
        "source": isinstance(facts["source"], str),
        "axis": facts["axis"] in range(3),
        "at": numpy.isfinite(facts["at"]),
        "low, high": low.shape == high.shape == (2,) and numpy.isfinite(high - low).all() and (low < high).all(),
        "points": facts["points"] > 0,
        "distance": distance.ndim == 2 and distance.dtype.kind == "f" and numpy.isfinite(distance).all()
                    and LEAST <= min(distance.shape) and max(distance.shape) <= MOST,
    }
    wrong = [name for name, fits in right.items() if not fits]
    if wrong:
        raise ValueError(f"{', '.join(wrong)}: not those of a slice")


def read(path):
    """Attributes by name, and the distances [rows][columns]."""
    with opened(path) as file:
        facts = {name: value.decode() if isinstance(value, bytes) else value for name, value in file.attrs.items()}
        if facts.get("kind") != "shapebench slice":
            fail(f"{path}: not what `shapebench info --slice` writes", 3)
        facts, distance = {name: facts[name] for name in FACTS}, file["distance"][:]
        check(facts, distance)
        return facts, distance


def draw(facts, distance, pyplot):
    from matplotlib.colors import TwoSlopeNorm

    normal, across, along = (("x", "z", "y"), ("y", "x", "z"), ("z", "x", "y"))[facts["axis"]]
    low, high = facts["low"], facts["high"]
    at = facts["at"] if abs(facts["at"]) > 1e-4 * max(high - low) else 0
    most = numpy.abs(distance).max() or 1  # a slice of zeros has a scale, too
    norm = TwoSlopeNorm(0, -most if distance.min() >= 0 else distance.min(), most if distance.max() <= 0 else distance.max())
    width, height = high - low
    figure, axes = pyplot.subplots(figsize=(5.4, 1.1 + 3.9 * min(max(height / width, 0.3), 2)), constrained_layout=True)
    image = axes.imshow(distance, origin="lower", extent=(low[0], high[0], low[1], high[1]), cmap="RdBu_r", norm=norm)
    figure.colorbar(image, ax=axes, label="signed distance, mesh units", shrink=0.85)
    u = low[0] + (numpy.arange(distance.shape[1]) + 0.5) / distance.shape[1] * width
    v = low[1] + (numpy.arange(distance.shape[0]) + 0.5) / distance.shape[0] * height
    steps = numpy.linspace(distance.min(), distance.max(), 12)
    axes.contour(u, v, distance, levels=steps, colors="0.4", linewidths=0.3)
    if distance.min() < 0 < distance.max():
        axes.contour(u, v, distance, levels=[0], colors="black", linewidths=1.5)
    axes.set_xlabel(across)
    axes.set_ylabel(along)
    source = pathlib.PurePath(facts["source"]).name
    axes.set_title(f"{source}, {facts['points']} points, {normal} = {at:.4g}", fontsize=10)
    return figure


def main():
    options = parse(__doc__, "HDF5 file of a slice", "png")
    facts, distance = read(options.file)
    write(draw(facts, distance, drawing()), options.output, options.overwrite, dpi=90, bbox_inches="tight")


if __name__ == "__main__":
    main()
