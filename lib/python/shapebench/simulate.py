"""A whole simulation in one call."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass
from typing import Any, Callable, List, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import face
from .body import Body, Counts, Doubles, Ints
from .geometry import Mesh, Voxels
from .picture import draw

Pins = Union[ArrayLike, Callable[[Doubles], ArrayLike]]


@dataclass(frozen=True, eq=False)
class Motion:
    """What simulate() has seen, frame by frame; the first is the body at its start."""

    times: Doubles  # [frames], s
    surface: List[Doubles]  # of each frame [vertices, 3]
    triangles: List[Ints]  # of each frame [m, 3]; the same array as long as they are the same
    particles: List[Doubles]  # of each frame [n, 3]
    counts: Counts  # in the end

    def plot(self, frame: int = -1, ax: Any = None) -> Any:
        """A picture of a frame, as Body.plot() makes it."""
        return draw(self.surface[frame], self.triangles[frame], ax)

    def __repr__(self) -> str:
        return f"<Motion: {len(self.times)} frames, {self.times[-1]:g} s, {self.counts.particles} particles>"


def _pinned(body: Body, pins: Pins) -> NDArray[Any]:
    rest = body.rest()
    chosen = np.asarray(pins(rest) if callable(pins) else pins)
    if chosen.dtype == np.bool_:
        if chosen.shape != (len(rest),):
            raise face.UsageError(f"'pins' has the shape {chosen.shape}: one truth value for each of {len(rest)} "
                                  "particles is wanted")
        chosen = np.flatnonzero(chosen)
    if not chosen.size:
        raise face.UsageError("'pins' chooses no particle")
    return chosen


def _frames(count: int, progress: bool) -> Any:
    """The numbers of frames; with `progress`, by tqdm where it is installed, or as a line on the terminal."""
    if not progress:
        return range(count)
    with contextlib.suppress(ImportError):
        from tqdm.auto import tqdm

        return tqdm(range(count), unit="frame")
    return _counted(count)


def _counted(count: int) -> Any:
    for frame in range(count):
        yield frame
        print(f"\rframe {frame + 1} of {count}", end="" if frame + 1 < count else "\n", file=sys.stderr, flush=True)


def simulate(mesh: Union[Mesh, str, "os.PathLike[str]", Any], *, steps: int = 100, every: int = 10,
             pins: Optional[Pins] = None, particles: int = 2000, cell: Optional[float] = None, fill: str = "solid",
             progress: bool = False, **how: Any) -> Motion:
    """Steps a body made of a mesh, and keeps what it is after each `every` steps.

    `mesh` is a Mesh, a file's name, or what Mesh() takes: an object of trimesh, Open3D or meshio. `pins` says which
    particles are held where they rest: their numbers, a truth value for each, or a function that makes either of rest
    positions [n, 3]. `particles`, `cell` and `fill` are those of Voxels; the rest is Body's: engine, w, h or dt,
    gravity, damping, ... `progress` shows a bar."""
    if every < 1 or steps < 0:
        raise face.UsageError(f"'steps' is {steps} and 'every' {every}: 0 or more, and 1 or more are wanted")
    if not isinstance(mesh, Mesh):
        mesh = Mesh.load(mesh) if isinstance(mesh, (str, os.PathLike)) else Mesh(mesh)
    voxels = Voxels(mesh, cell=cell, particles=particles if cell is None else None, fill=fill)
    with Body(voxels, mesh, **how) as body:
        if pins is not None:
            body.hold(_pinned(body, pins))
        times, surface, triangles, places = [0.0], [body.surface()], [body.surface_triangles()], [body.positions()]
        for frame in _frames(-(-steps // every), progress):
            body.step(min(every, steps - frame * every))
            last = body.surface_triangles()
            times.append(body.counts().time)
            surface.append(body.surface())
            triangles.append(triangles[-1] if np.array_equal(last, triangles[-1]) else last)
            places.append(body.positions())
        return Motion(np.array(times), surface, triangles, places, body.counts())
