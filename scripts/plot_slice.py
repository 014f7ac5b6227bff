#!/usr/bin/python3
"""Draws the signed distance on a plane that `shapebench info POINTS --slice z=0.5 -o FILE.h5` wrote:
blue inside, red outside, the surface (zero) black.

Needs Debian's python3-h5py and python3-matplotlib (scripts/setup)."""

import pathlib

from plots import drawing, fail, parse, write

import h5py  # after plots, which says what is missing
import numpy

FACTS = ("source", "axis", "at", "low", "high", "points")


def read(path):
    """Attributes by name, and the distances [rows][columns]."""
    try:
        with h5py.File(path) as file:
            facts = {name: value.decode() if isinstance(value, bytes) else value for name, value in file.attrs.items()}
            if facts.get("kind") != "shapebench slice":
                fail(f"{path}: not what `shapebench info --slice` writes", 3)
            return {name: facts[name] for name in FACTS}, file["distance"][:]
    except (OSError, KeyError) as error:
        fail(f"{path}: cannot be read: {error}", 3)


def draw(facts, distance, pyplot):
    from matplotlib.colors import TwoSlopeNorm

    normal, across, along = (("x", "z", "y"), ("y", "x", "z"), ("z", "x", "y"))[facts["axis"]]
    low, high = facts["low"], facts["high"]
    at = facts["at"] if abs(facts["at"]) > 1e-4 * max(high - low) else 0
    most = numpy.abs(distance).max()
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
    write(draw(facts, distance, drawing()), options.output, dpi=90, bbox_inches="tight")


if __name__ == "__main__":
    main()
