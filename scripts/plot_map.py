#!/usr/bin/python3
"""Draws conformal maps that `shapebench info MESH --map -o FILE.h5` wrote, a row each: the surface under a
checkerboard of its parameters, under the quadtree's cells with the nodes in them, and the plane of parameters.

The board goes on across seams, but not from one cylinder of a surface with two handles or holes to another. Its
squares are square on the surface where the map keeps angles; how large they are there, and the colours of cells, say
what the conformal factor L is.

Needs Debian's python3-h5py and python3-matplotlib (scripts/setup). Exit codes: 0 drawn; 2 wrong usage; 3 not a
map, or damaged, or a package is missing; 4 cannot be written."""

import pathlib

from plots import drawing, fail, opened, parse, write

import numpy  # after plots, which says what is missing

ARRAYS = {  # dataset: kind of its numbers and its shape, whose letters stand for the same number everywhere
    "seams/shift": ("f", "s2"), "seams/turned": ("u", "s"),
    "surface/points": ("f", "v3"), "surface/triangles": ("i", "t3"), "surface/parameters": ("f", "t32"),
    "surface/factor": ("f", "v"), "cells/low": ("f", "c2"), "cells/high": ("f", "c2"), "cells/factor": ("f", "c"),
    "nodes/parameters": ("f", "n2"), "nodes/points": ("f", "n3"),
}
CYLINDERS = {  # of a surface with two handles or holes and more
    "cylinders/low": ("f", "k2"), "cylinders/high": ("f", "k2"), "joints/from": ("i", "j"), "joints/to": ("i", "j"),
    "joints/up": ("u", "j"), "joints/begin": ("f", "j"), "joints/end": ("f", "j"), "joints/shift": ("f", "j2"),
}
PIXELS, FINER = 360, 2  # of a panel, and how many times finer it is drawn
SIGHT = numpy.array([[0.87, 0.0, -0.5], [-0.14, 0.96, -0.25], [0.48, 0.29, 0.83]])  # rows: right, up, towards us
LIGHT = numpy.array([-0.35, 0.6, 0.72])
BOARD = numpy.array([[0.96, 0.96, 0.94], [0.25, 0.45, 0.70]])


def fits(array, kind, shape, sizes):
    """Whether a dataset has this kind and shape, and numbers that are finite; `sizes` keeps what letters stand for."""
    wanted = [int(size) if size.isdigit() else sizes.setdefault(size, n) for size, n in zip(shape, array.shape)]
    return (array.dtype.kind == kind and array.ndim == len(shape) and list(array.shape) == wanted
            and (kind != "f" or numpy.isfinite(array).all()))


def inside(x, bounds, margin):
    """Whether places are in the bounds, or outside by no more than so many of their longest side."""
    return (abs(x - bounds.mean(0)) <= (0.5 + margin) * numpy.ptp(bounds, axis=0).max()).all()


def check(held):
    """Raises ValueError where numbers are none that a map has."""
    sizes = {}
    arrays = ARRAYS | (CYLINDERS if "cylinders/low" in held else {})
    wrong = [name for name, (kind, shape) in arrays.items() if not fits(held[name], kind, shape, sizes)]
    if wrong or not all(sizes[letter] for letter in "vtcn"):
        raise ValueError(f"{', '.join(wrong) or 'arrays without a row'}: not those of a map")
    low, side, points = held["low"], held["high"] - held["low"], held["surface/points"]
    box = numpy.stack([points.min(0), points.max(0)])
    extent, factor = numpy.ptp(box, axis=0).max(), held["cells/factor"]
    rectangle = numpy.stack([low, held["high"]])
    right = {
        "low, high": side.shape == (2,) and numpy.isfinite(rectangle).all() and (side > 0).all(),
        "angle_error": numpy.shape(held["angle"]) == (2,) and numpy.isfinite(held["angle"]).all(),
        "surface/points": 0 < extent < 1e100,
        "surface/triangles": 0 <= held["surface/triangles"].min() and held["surface/triangles"].max() < len(points),
        "surface/parameters": inside(held["surface/parameters"], rectangle, 2),
        "seams/shift": inside(held["seams/shift"], rectangle - low, 3),
        "cells": (held["cells/high"] - held["cells/low"] > 1e-9 * side).all()
                 and inside(held["cells/low"], rectangle, 0.001) and inside(held["cells/high"], rectangle, 0.001),
        "cells/factor": 0 < factor.min() and factor.max() < 1e200 * factor.min(),
        "nodes": inside(held["nodes/points"], box, 0.02) and inside(held["nodes/parameters"], rectangle, 0.001),
    }
    if "cylinders/low" in held:
        first, last, own = held["cylinders/low"], held["cylinders/high"], len(held["cylinders/low"])
        numbers = numpy.stack([held["joints/from"], held["joints/to"]])
        right["cylinders"] = (own > 0 and (last - first > 1e-9 * side).all() and (first[1:, 0] > last[:-1, 0]).all()
                              and inside(first, rectangle, 0.001) and inside(last, rectangle, 0.001))
        right["joints"] = ((numbers >= 0) & (numbers < own)).all() and inside(held["joints/shift"], rectangle - low, 3)
    wrong = [name for name, whole in right.items() if not whole]
    if wrong:
        raise ValueError(f"{', '.join(wrong)}: not those of a map")


def read(path):
    """What the file holds, by name."""
    with opened(path) as file:
        if file.attrs.get("kind") not in (b"shapebench map", "shapebench map"):
            fail(f"{path}: not what `shapebench info --map` writes", 3)
        held = {name: file[name][()] for name in ARRAYS}
        if "cylinders" in file:
            held.update({name: file[name][()] for name in CYLINDERS})
        held.update(low=file.attrs["low"], high=file.attrs["high"], angle=file.attrs["angle_error"])
        check(held)
        return held


def rectangles(held):
    """Low and high corners of the plane's parts."""
    if "cylinders/low" in held:
        return held["cylinders/low"], held["cylinders/high"]
    return held["low"][None], held["high"][None]


def entered(held, theta, inside):
    """Places, which are near others that are inside of cylinders, moved into these, and which cylinders they are in."""
    low, high = rectangles(held)
    cylinder = (numpy.searchsorted(low[:, 0], inside[:, 0], side="right") - 1).clip(0)
    width, theta = (high - low)[:, 0], theta.copy()
    beyond = (theta[:, 1] > high[cylinder, 1]) * 1 - (theta[:, 1] < low[cylinder, 1])
    there, home = theta.copy(), cylinder.copy()
    for n, start in enumerate(held["joints/from"]):
        on = (theta[:, 0] - held["joints/begin"][n]) % width[start]
        across = (home == start) & (beyond == (1 if held["joints/up"][n] else -1))
        across &= on <= held["joints/end"][n] - held["joints/begin"][n]
        there[across] = numpy.stack([held["joints/begin"][n] + on, theta[:, 1]], 1)[across] + held["joints/shift"][n]
        cylinder[across] = held["joints/to"][n]
    there[:, 0] = low[cylinder, 0] + (there[:, 0] - low[cylinder, 0]) % width[cylinder]
    return there, cylinder


class View:
    """The surface as pixels: those that it is in, and in each what is in front: its triangle, place in the plane and
    shade."""

    def __init__(self, held):
        points = held["surface/points"]
        self.middle = (points.min(0) + points.max(0)) / 2
        turned = (points - self.middle) @ SIGHT.T
        self.scale = 0.94 * PIXELS * FINER / max(2 * abs(turned[:, :2]).max(), 1e-300)
        corner = self.on_screen(points)[held["surface/triangles"]]
        self.depth = numpy.full(PIXELS * FINER * PIXELS * FINER, -numpy.inf)
        self.triangle = numpy.full(self.depth.shape, -1)
        theta = numpy.zeros((*self.depth.shape, 2))
        normal = numpy.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        facing = normal / numpy.maximum(numpy.linalg.norm(normal, axis=1), 1e-300)[:, None]
        shade = 0.45 + 0.55 * abs(facing @ LIGHT / numpy.linalg.norm(LIGHT))
        edges = corner[:, :, :2] - numpy.roll(corner[:, :, :2], 1, 1)
        steps = numpy.ceil(1.5 * abs(edges).max((1, 2)).clip(1, 4 * PIXELS * FINER)).astype(int)
        for count in numpy.unique(steps):  # triangles of one size together, so many at once as memory bears
            which = numpy.flatnonzero(steps == count)
            i, j = numpy.nonzero(numpy.tri(count + 1)[::-1])
            share = numpy.stack([i, j, count - i - j], 1) / count
            for some in numpy.array_split(which, 1 + len(which) * len(share) // 2000000):
                self.put(some, share, corner, held["surface/parameters"], theta)
        self.drawn = numpy.flatnonzero(self.triangle >= 0)
        triangle = self.triangle[self.drawn]
        self.theta, self.shade = theta[self.drawn], shade[triangle]
        self.cylinder = numpy.zeros(len(self.drawn), int)
        if "cylinders/low" in held:
            self.theta, self.cylinder = entered(held, self.theta, held["surface/parameters"].mean(1)[triangle])

    def on_screen(self, points):
        """Pixels to the right, up and towards us."""
        return (points - self.middle) @ SIGHT.T * self.scale + PIXELS * FINER / 2

    def put(self, which, share, corner, flat, theta):
        x = numpy.einsum("kc,tcd->tkd", share, corner[which]).reshape(-1, 3)
        pixel = numpy.floor(x[:, 1]).astype(int) * PIXELS * FINER + numpy.floor(x[:, 0]).astype(int)
        nearer = numpy.flatnonzero(x[:, 2] > self.depth[pixel])
        order = nearer[numpy.argsort(x[nearer, 2])]
        self.depth[pixel[order]] = x[order, 2]  # where several are, the last one stays: the nearest
        first = order[x[order, 2] == self.depth[pixel[order]]]
        self.triangle[pixel[first]] = which[first // len(share)]
        theta[pixel[first]] = (share[first % len(share), :, None] * flat[which[first // len(share)]]).sum(1)

    def sees(self, points):
        """Of points on the surface, those in front, and where on the panel they are."""
        x = self.on_screen(points)
        pixel = numpy.floor(x[:, 1]).astype(int) * PIXELS * FINER + numpy.floor(x[:, 0]).astype(int)
        return x[x[:, 2] > self.depth[pixel] - 0.02 * PIXELS * FINER, :2] / FINER

    def picture(self, colours):
        """Colours of pixels, shaded, on white."""
        drawn = numpy.ones((len(self.depth), 3))
        drawn[self.drawn] = colours * self.shade[:, None]
        return drawn.reshape(PIXELS, FINER, PIXELS, FINER, 3).mean((1, 3)).clip(0, 1)


def board(held):
    """Where a board's squares begin in the plane, and the linear map from there that makes them of side 1: all but a
    similarity, so that what is the same place of the surface, beyond seams, has the same colour."""
    shift, turned = held["seams/shift"], held["seams/turned"].astype(bool)
    extent = numpy.ptp(held["surface/points"], axis=0).max()
    side = 0.04 * extent / numpy.median(held["cells/factor"])  # cells are about as large as each other on the surface
    origin = shift[turned][0] / 2 if turned.any() else held["low"]
    moves = list(shift[~turned]) + [2 * (one / 2 - origin) for one in shift[turned]]
    moves = [move for move in moves if numpy.linalg.norm(move) > 1e-9 * numpy.linalg.norm(held["high"] - held["low"])]
    along = min((move for move in moves if move[1] == 0), key=numpy.linalg.norm, default=None)
    up = min((move for move in moves if move[1] != 0), key=numpy.linalg.norm, default=None)
    board = numpy.eye(2) / side
    if along is not None:
        board[0, 0] = board[1, 1] = 2 * max(round(abs(along[0]) / side / 2), 1) / abs(along[0])
    if up is not None:
        rows = 2 * max(round(abs(board[1, 1] * up[1]) / 2), 1)
        columns = 2 * round(board[0, 0] * up[0] / 2)
        board[1, 1] = rows / abs(up[1])
        board[0, 1] = (columns - board[0, 0] * up[0]) / up[1]
    return origin, board


def checkers(held, theta, cylinder):
    origin, squares = board(held)
    place = (theta - origin) @ squares.T
    if "cylinders/low" in held:  # as many squares around each as go there, and an even number
        low, high = rectangles(held)
        width = (high - low)[:, 0]
        place = (theta - low[cylinder]) * ((2 * numpy.round(width * squares[0, 0] / 2)).clip(2) / width)[cylinder, None]
    return BOARD[numpy.floor(place).sum(1).astype(int) % 2]


def cells_in(held, theta, own, low, high):
    """The cell of a rectangle at each place, -1 where there is none, and how near its edge the place is, by its own
    side. `own` are the rectangle's."""
    cell_low, cell_high = held["cells/low"], held["cells/high"]
    found, edge = numpy.full(len(theta), -1), numpy.zeros(len(theta))
    order = numpy.round(numpy.log2((cell_high - cell_low)[own, 0] / (high - low)[0]) * 8).astype(int)
    for shift, turned in [(0, 0), *zip(held["seams/shift"], held["seams/turned"])]:
        for level in numpy.unique(order):
            left = numpy.flatnonzero(found < 0)
            alike, place = own[order == level], shift + (-theta[left] if turned else theta[left])
            size = (cell_high - cell_low)[alike[0]]
            columns = round((high - low)[0] / size[0])
            key = ((cell_low[alike] - low) / size).round().astype(numpy.int64) @ [1, columns]
            whole = numpy.floor((place - low) / size).astype(numpy.int64)
            at = numpy.searchsorted(key, whole @ [1, columns], sorter=numpy.argsort(key)).clip(0, len(alike) - 1)
            cell = alike[numpy.argsort(key)[at]]
            hit = (place >= cell_low[cell]).all(1) & (place <= cell_high[cell]).all(1)
            found[left[hit]] = cell[hit]
            edge[left[hit]] = (numpy.minimum(place - cell_low[cell], cell_high[cell] - place).min(1) / size.min())[hit]
    return found, edge


def cells_at(held, theta, cylinder):
    """The same over all rectangles, of each place that of its cylinder."""
    low, high = rectangles(held)
    found, edge = numpy.full(len(theta), -1), numpy.zeros(len(theta))
    middle = (held["cells/low"] + held["cells/high"])[:, 0] / 2
    home = (numpy.searchsorted(low[:, 0], middle, side="right") - 1).clip(0)
    for which in range(len(low)):
        there, own = numpy.flatnonzero(cylinder == which), numpy.flatnonzero(home == which)
        if len(there) and len(own):
            found[there], edge[there] = cells_in(held, theta[there], own, low[which], high[which])
    return found, edge


def draw(files, pyplot):
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LogNorm

    figure, axes = pyplot.subplots(len(files), 3, figsize=(10.6, 3.5 * len(files)), squeeze=False,
                                   constrained_layout=True)
    for (left, middle, right), (path, held) in zip(axes, files):
        view = View(held)
        factor = held["cells/factor"]
        norm, colours = LogNorm(factor.min(), max(factor.max(), 1.01 * factor.min())), pyplot.get_cmap("viridis")
        found, near = cells_at(held, view.theta, view.cylinder)
        tint = 0.45 + 0.55 * colours(norm(factor))[found][:, :3]
        dark = numpy.where(near < 0.06, 0.55, 1.0)[:, None]
        for panel, shown in ((left, checkers(held, view.theta, view.cylinder)), (middle, tint * dark)):
            panel.imshow(view.picture(shown), origin="lower", extent=(0, PIXELS, 0, PIXELS))
            panel.axis("off")
        nodes = view.sees(held["nodes/points"])
        middle.plot(*nodes.T, ".", color="black", markersize=2.5)
        low, high = held["cells/low"], held["cells/high"]
        boxes = numpy.stack([low, high * [1, 0] + low * [0, 1], high, low * [1, 0] + high * [0, 1]], 1)
        plane = right.add_collection(PolyCollection(boxes, array=factor, norm=norm, cmap=colours, edgecolors="0.25",
                                                    linewidths=0.3, alpha=0.8))
        right.plot(*held["nodes/parameters"].T, ".", color="black", markersize=1.2)
        right.set(xlim=(held["low"][0], held["high"][0]), ylim=(held["low"][1], held["high"][1]), aspect="equal",
                  xticks=[], yticks=[])
        figure.colorbar(plane, ax=right, label="L", shrink=0.8)
        name = pathlib.PurePath(path).stem
        left.set_title(f"{name}: angles off by {held['angle'][0]:.2g}° (median)", fontsize=9)
        middle.set_title(f"{len(nodes)} of {len(held['nodes/points'])} nodes, cells on the surface", fontsize=9)
        right.set_title("parameters", fontsize=9)
    return figure


def main():
    options = parse(__doc__, "HDF5 files of maps", "png", several=True)
    files = [(path, read(path)) for path in options.files]
    write(draw(files, drawing()), options.output, options.overwrite, dpi=80, bbox_inches="tight")


if __name__ == "__main__":
    main()
