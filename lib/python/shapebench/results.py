"""Files that the program shapebench writes, as tables and trajectories; results/README.md says what is in them.

    rows = shapebench.results.read("rows.h5")["rows"]
    print(rows["scene"], rows["total_ms"])
    rows.frame().sort_values("total_ms")         # where pandas is installed
"""

from __future__ import annotations

import contextlib
import os
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional, Type, Union

import numpy as np
from numpy.typing import NDArray

from .face import InputError

if TYPE_CHECKING:
    import pandas

Path = Union[str, "os.PathLike[str]"]
RECORDS = ("rows", "claims", "curves")  # groups that hold a group for each record
COLUMNS = ("points", "specimens", "laws", "experiments", "methods")  # groups that hold a dataset for each column
PANDAS = "pandas is not installed: install it (Debian's python3-pandas), or use records()"


class Table:
    """Columns of equal length. A column with several numbers a row has more dimensions; one whose rows differ in shape,
    or that some rows lack, is of objects, None where there is nothing."""

    def __init__(self, columns: Dict[str, NDArray[Any]]) -> None:
        self.columns = columns

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        """Rows as dictionaries."""
        return ({name: column[i] for name, column in self.columns.items()} for i in range(len(self)))

    def records(self) -> NDArray[Any]:
        """All of it as one structured array."""
        kind = [(name, column.dtype, column.shape[1:]) for name, column in self.columns.items()]
        made = np.empty(len(self), kind)
        for name, column in self.columns.items():
            made[name] = column
        return made

    def frame(self) -> "pandas.DataFrame":
        """All of it as a pandas DataFrame; ImportError where pandas is not installed."""
        try:
            import pandas
        except ImportError:
            raise ImportError(PANDAS) from None
        return pandas.DataFrame({name: column if column.ndim == 1 else list(column)
                                 for name, column in self.columns.items()})


@dataclass
class Results:
    """A file of measurements, a sweep, a calibration, claims or a map."""

    path: str
    kind: str  # "shapebench results", "shapebench sweep", ...
    schema: int
    values: Dict[str, Any]  # the file's own attributes and arrays
    groups: Dict[str, Dict[str, Any]]  # what is no table: "machine", "plan", "columns" (what each attribute means)
    tables: Dict[str, Table]  # "rows"; "points"; "specimens", "laws"; "claims", "curves", "experiments"; "methods"

    def __getitem__(self, table: str) -> Table:
        return self.tables[table]


def _stored() -> Any:
    try:
        from . import stored
    except ImportError as missing:
        raise ImportError(f"{missing}: install it (Debian's python3-h5py) to read results files") from None
    return stored


def _array(values: Any) -> NDArray[Any]:
    """Of a dataset: its texts as Python's."""
    found: NDArray[Any] = values[()]
    if found.dtype.kind != "S":
        return found
    return np.array([text.decode("utf-8", "replace") for text in found.ravel()], str).reshape(found.shape)


def _everything(group: Any, prefix: str = "") -> Dict[str, Any]:
    """Attributes, arrays, and those of groups within."""
    found = {prefix + name: value for name, value in _stored().attributes(group).items()}
    for name, node in group.items():
        inner = _everything(node, f"{prefix}{name}/") if hasattr(node, "items") else {prefix + name: _array(node)}
        found.update(inner)
    return found


def _column(values: List[Any]) -> NDArray[Any]:
    shapes = {np.shape(value) for value in values}
    if len(shapes) == 1 and not any(value is None for value in values):
        return np.array(values)
    made = np.empty(len(values), object)
    made[:] = values
    return made


def _of_records(group: Any) -> Table:
    rows = [{"name": name, **_everything(group[name])} for name in sorted(group)]
    names = dict.fromkeys(name for row in rows for name in row)
    return Table({name: _column([row.get(name) for row in rows]) for name in names})


def _read(path: str, file: Any) -> Results:
    stored = _stored()
    values = stored.attributes(file["/"])
    kind = values.pop("kind", "")
    if not isinstance(kind, str) or not kind.startswith("shapebench "):
        raise stored.Unusable(f"{path}: no file of shapebench's")
    if kind == "shapebench trajectory":
        raise stored.Unusable(f"{path}: a trajectory: open it with shapebench.results.Trajectory()")
    made = Results(path, kind, values.pop("schema"), values, {}, {})
    for name, node in file.items():
        if name in RECORDS:
            made.tables[name] = _of_records(node)
        elif name in COLUMNS:
            made.tables[name] = Table({column: _array(of) for column, of in node.items()})
            made.groups[name] = stored.attributes(node)
        elif hasattr(node, "items"):
            made.groups[name] = _everything(node)
        else:
            made.values[name] = _array(node)
    return made


def read(path: Path) -> Results:
    """Reads a whole results file. InputError: it is not there, cut off, damaged, or none of
    shapebench's. ImportError where h5py is missing."""
    name, stored = os.fspath(path), _stored()
    try:
        with stored.opened(name) as file:
            return _read(name, file)
    except stored.Unusable as error:
        raise InputError(str(error)) from None


class Trajectory:
    """The motion of a surface that `shapebench run` wrote, frame by frame; use it with `with`, or close() it. Only what
    is asked for is read. `file` is h5py's, for what else is in it."""

    def __init__(self, path: Path) -> None:
        self.path, stored = os.fspath(path), _stored()
        try:
            with contextlib.ExitStack() as stack:
                self.file = stack.enter_context(stored.opened(self.path))
                if stored.plain(self.file.attrs.get("kind", "")) != "shapebench trajectory":
                    raise stored.Unusable(f"{self.path}: not a trajectory of shapebench's")
                self._root = self.file["VTKHDF"]
                steps = self._root["Steps"]
                self.times: NDArray[np.float64] = steps["Values"][:]  # s, of all frames
                self._topology, self._point = steps["PartOffsets"][:], steps["PointOffsets"][:]
                self._points = self._root["NumberOfPoints"][:]
                self._offset = steps["ConnectivityIdOffsets"][:].ravel()
                self.fields: List[str] = list(self._root.get("PointData", ()))  # that `run --fields` has stored
                self._opened = stack.pop_all()
        except stored.Unusable as error:
            raise InputError(str(error)) from None

    def __enter__(self) -> "Trajectory":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 where: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        self._opened.close()

    def __len__(self) -> int:
        """How many frames there are."""
        return len(self.times)

    def _read(self, name: str, first: int, count: int) -> NDArray[Any]:
        """Rows of one of the file's datasets."""
        try:
            found: NDArray[Any] = self._root[name][first:first + count]
        except _stored().DAMAGE as error:
            raise InputError(f"{self.path}: cannot be read: {error}") from None
        return found

    def _rows(self, name: str, frame: int) -> NDArray[Any]:
        return self._read(name, int(self._point[frame]), int(self._points[self._topology[frame]]))

    def points(self, frame: int) -> NDArray[Any]:
        """[n, 3], as they are stored: float32, or float64 of a mesh that lies far from the origin."""
        return self._rows("Points", frame)

    def field(self, name: str, frame: int) -> NDArray[np.float32]:
        """[n] or [n, 3]: values at the points. KeyError unless `name` is one of `fields`."""
        if name not in self.fields:
            raise KeyError(name)
        return self._rows(f"PointData/{name}", frame)

    def topology(self, frame: int) -> int:
        """The number of the frame's topology, which changes where a body is cut or refined."""
        return int(self._topology[frame])

    def triangles(self, frame: int = 0) -> NDArray[np.int64]:
        """[m, 3]; none of points that were given without."""
        topology = self.topology(frame)
        count, cells = (int(self._read(name, topology, 1)[0]) for name in ("NumberOfConnectivityIds", "NumberOfCells"))
        corners = self._read("Connectivity", int(self._offset[frame]), count)
        return corners.reshape(-1, 3) if count == 3 * cells else np.empty((0, 3), np.int64)
