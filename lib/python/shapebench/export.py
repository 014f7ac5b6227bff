"""Motion for other programs: OBJ files, one a frame, and PC2 point caches, which Blender's Mesh Cache modifier and
others read.

    python3 -m shapebench.export penguin.vtkhdf FOLDER        # FOLDER/penguin_0000.obj, ...
    python3 -m shapebench.export penguin.vtkhdf penguin.pc2   # beside the OBJ of its first frame
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import os
import struct
import sys
from pathlib import Path
from typing import IO, Iterable, Iterator, List, Union

import numpy as np
from numpy.typing import ArrayLike

from .face import Error, InputError, UsageError
from .results import Trajectory

Place = Union[str, "os.PathLike[str]"]


@contextlib.contextmanager
def _whole(path: Place, overwrite: bool) -> Iterator[IO[bytes]]:
    """A file to write, for `with`, that appears whole or not at all. A link stays one."""
    target = os.path.realpath(path)
    if os.path.exists(target) and not os.path.isfile(target):
        raise OSError(errno.EINVAL, "it is no file", os.fspath(path))
    if os.path.exists(target) and not overwrite:
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), os.fspath(path))
    try:
        with open(target + ".tmp", "wb") as file:
            yield file
        os.replace(target + ".tmp", target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.remove(target + ".tmp")
        raise


def write_obj(path: Place, points: ArrayLike, triangles: ArrayLike, *, overwrite: bool = False) -> None:
    """Points [n, 3] with all their digits, and triangles [m, 3] that number them from 0."""
    x = np.asarray(points)
    form = "v %.9g %.9g %.9g" if x.dtype == np.float32 else "v %.17g %.17g %.17g"
    with _whole(path, overwrite) as file:
        np.savetxt(file, x, form)
        np.savetxt(file, np.asarray(triangles) + 1, "f %d %d %d")


def write_obj_sequence(trajectory: Trajectory, folder: Place, name: str, *, overwrite: bool = False) -> List[Path]:
    """FOLDER/NAME_0000.obj and so on, one for each frame; the paths. FileExistsError unless `overwrite`."""
    place = Path(folder)
    place.mkdir(exist_ok=True)
    digits = max(4, len(str(len(trajectory))))
    paths = [place / f"{name}_{frame:0{digits}}.obj" for frame in range(len(trajectory))]
    for frame, path in enumerate(paths):
        write_obj(path, trajectory.points(frame), trajectory.triangles(frame), overwrite=overwrite)
    return paths


def write_pc2(path: Place, frames: Iterable[ArrayLike], *, start: float = 0, rate: float = 1,
              overwrite: bool = False) -> int:
    """Frames of equally many points [n, 3] as a point cache, float32: `start` is the first one's number, `rate` how many
    numbers lie from one to the next. How many there were."""
    count, points = 0, None
    with _whole(path, overwrite) as file:
        for frame in frames:
            x = np.ascontiguousarray(frame, "<f4")
            if points is None:
                points = len(x)
                file.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, points, start, rate, 0))
            if x.shape != (points, 3):
                raise InputError(f"{os.fspath(path)}: frame {count} has the shape {x.shape}, the first {(points, 3)}: "
                                 "a point cache has the same points all along")
            file.write(x.tobytes())
            count += 1
        if points is None:
            raise UsageError(f"{os.fspath(path)}: there are no frames to write")
        file.seek(28)
        file.write(struct.pack("<i", count))
    return count


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", help="a trajectory of shapebench run")
    parser.add_argument("output", help="a folder for OBJ files, or FILE.pc2")
    parser.add_argument("--overwrite", action="store_true", help="replace files that are there")
    given = parser.parse_args()
    name = Path(given.file).stem
    try:
        with Trajectory(given.file) as motion:
            if given.output.endswith(".pc2"):
                write_pc2(given.output, map(motion.points, range(len(motion))), overwrite=given.overwrite)
                first = str(Path(given.output).with_suffix(".obj"))
                write_obj(first, motion.points(0), motion.triangles(0), overwrite=given.overwrite)
                print(f"wrote {given.output}: {len(motion)} frames, and {first}")
            else:
                paths = write_obj_sequence(motion, given.output, name, overwrite=given.overwrite)
                print(f"wrote {paths[0]} to {paths[-1].name}")
    except FileExistsError as error:
        print(f"{error.filename}: it is there: choose another name, or give --overwrite", file=sys.stderr)
        return 4
    except OSError as error:
        print(f"{error.filename or given.output}: cannot be written: {error.strerror}", file=sys.stderr)
        return 4
    except Error as error:
        print(error, file=sys.stderr)
        return error.code
    return 0


if __name__ == "__main__":
    sys.exit(main())
