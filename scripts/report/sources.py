"""Result files, read for a report. Nothing here knows how they will look.

Layouts are those of results/README.md: measurements ("shapebench results"), claims ("shapebench claims")
sweeps ("shapebench sweep") and calibrations ("shapebench calibration")."""
import math
import os
import re

import h5py
import numpy as np

import stored
from stored import Unusable

SCHEMAS = {"shapebench results": 4, "shapebench claims": 2, "shapebench sweep": 1,
           "shapebench calibration": 1}
TEXTS = ("paper", "scene", "engine", "precision", "reason", "stages")
NUMBERS = ("valid", "particles", "regions", "w", "threads", "total_ms", "total_low_ms", "total_high_ms",
           "ns_per_particle_step", "summation_nodes", "damping", "paper_total_ms") + tuple(
    "change." + name for name in ("frames", "changed", "first_nodes", "most_nodes", "most_added", "first_ms", "last_ms",
                                  "change_ms", "change_most_ms", "follow_ms", "surface_ms", "first_triangles",
                                  "last_triangles", "pieces", "open_edges", "left"))

CLAIM_KINDS = ("method", "machine", "by construction")
CLAIM_TEXTS = ("kind", "paper", "name", "place", "unit", "statement", "status", "test", "verdict", "words", "evidence",
               "over", "unset_evidence")

CLAIM_VALUES = ("paper_value", "measured", "low", "high")

SWEEP_COLUMNS = ("engine", "w", "epsilon", "valid", "total_ms", "build_seconds", "bytes", "summation_nodes", "goal_rms",
                 "relaxation", "sag", "frequency", "path_rms", "path_most", "front")

TEXT_COLUMNS = ("engine", "set", "reason", "kind")

SPECIMEN_COLUMNS = ("engine", "w", "epsilon", "across", "aspect", "spacing", "h", "set", "wide", "valid", "reason",
                    "frequency", "young", "spread", "young_euler", "young_timoshenko", "young_meshless")
SPECIMEN_WIDE = {"frequency": 3, "young_euler": 4, "young_timoshenko": 4, "young_meshless": 4}
LAW_COLUMNS = ("engine", "kind", "specimens", "scatter", "c", "spacing", "width", "aspect", "step", "d")
LAW_WIDE = {name: 3 for name in ("c", "spacing", "width", "aspect", "step", "d")}

MACHINE_TEXTS = ("cpu", "git_commit", "utc")

def plain(value):
    """An attribute as Python has it: text, number, or array."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, np.ndarray):
        return value
    return value.item() if hasattr(value, "item") else value


def attributes(node):
    """By number: a signal in h5py's own loop over names, which HDF5 calls back, ends as a SystemError."""
    names = [h5py.h5a.open(node.id, index=n).name.decode() for n in range(h5py.h5a.get_num_attrs(node.id))]
    return {name: plain(node.attrs[name]) for name in names}


class Source:
    """A file: its kind, the machine that wrote it, and what its kind holds."""

    def __init__(self, path, kind, machine):
        self.path, self.kind, self.machine = path, kind, machine
        self.name = os.path.basename(path)
        self.rows, self.claims, self.curves, self.meanings = [], [], {}, {}
        self.plan, self.point = None, None
        self.specimen, self.law, self.found = None, None, []

    @property
    def commit(self):
        commit = self.machine.get("git_commit", "unknown")[:10]
        return commit + ("+" if self.machine.get("git_dirty") else "")


def demand(row, names, kinds):
    """All of these attributes, each of one of the kinds; arrays are lists of numbers."""
    for name in names:
        value = row.get(name)
        if not isinstance(value, kinds) or kinds is np.ndarray and (value.ndim != 1 or value.dtype.kind not in "iuf"):
            raise ValueError(f"'{name}'")


STATUSES = ("paper_total_status", "paper_rate_status", "paper_stage_status")


def read_statuses(row):
    """How the paper's values came to us; empty where the file does not say, and of a total that follows from a
    rate, how the rate did."""
    given = {name: row.get(name, "") for name in STATUSES}
    demand(given, STATUSES, str)
    row["paper_status"] = given["paper_total_status"]
    if row["paper_status"] == "derived":
        row["paper_status"] = given["paper_rate_status"]
    row["paper_stage_statuses"] = given["paper_stage_status"].split() or [""] * len(row["stage_ms"])


def read_paper(row):
    """The paper's time of a particle and step, and its stages' percents; NaN where the file does not say."""
    row["paper_ns"] = 1e6 * row["paper_total_ms"] / (row.get("paper_particles") or math.nan)
    row.setdefault("paper_stage_percent", np.full(len(row["stage_ms"]), math.nan))
    demand(row, ("paper_stage_percent",), np.ndarray)


def read_row(group):
    row = attributes(group)
    demand(row, TEXTS, str)
    demand(row, NUMBERS, (int, float))
    demand(row, ("stage_ms", "paper_stage_ms"), np.ndarray)
    read_statuses(row)
    read_paper(row)
    if not (len(row["stages"].split()) == len(row["stage_ms"]) == len(row["paper_stage_ms"])
            == len(row["paper_stage_statuses"]) == len(row["paper_stage_percent"])):
        raise ValueError("the number of stages")
    for name in ("total", "stage", "frames"):
        if name in group:
            row[name + "_samples"] = group[name][:]
    if "elastic" in group:
        row["elastic"] = attributes(group["elastic"])
        demand(row["elastic"], ("nodes", "modes", "matrix_seconds", "mode_seconds"), (int, float))
    row["stage_names"] = row["stages"].split()
    if "elastic" in row:  # files of before give a meshless body's stages the names of shape matching's
        older = {"shape_matching": "motion", "other": "skin"}
        row["stage_names"] = [older.get(name, name) for name in row["stage_names"]]
    return row


def read_meanings(file):
    """What each attribute of a row is, and its unit, as the file says; older files do not."""
    said = attributes(file["columns"]) if "columns" in file else {}
    if "columns" in file:
        said |= {f"elastic/{name}": text for name, text in attributes(file["columns/elastic"]).items()}
    demand(said, said, str)
    return {name: re.fullmatch(r"(.*?)(?: \[([^][]*)\])?", text, re.DOTALL).groups("") for name, text in said.items()}


def read_rows(source, file):
    source.meanings = read_meanings(file)
    source.rows = [read_row(file["rows"][name]) for name in sorted(file["rows"])]


def read_claim(group):
    claim = attributes(group)
    demand(claim, CLAIM_TEXTS, str)
    demand(claim, ("values", "count"), int)
    demand(claim, (*CLAIM_VALUES, "ratio"), np.ndarray)
    demand(claim, ("unset",), float)
    if not 0 <= max(claim["values"], claim["count"]) <= min(len(claim[name]) for name in CLAIM_VALUES):
        raise ValueError("the number of values of a claim")
    if claim["kind"] not in CLAIM_KINDS:
        raise ValueError(f"the kind {claim['kind']!r} of a claim")
    return claim


def read_curve(group):
    curve = attributes(group)
    demand(curve, ("x_name", "y_name"), str)
    demand(curve, ("valid", "exponent", "exponent_low", "exponent_high"), (int, float))
    for name in ("x", "y", "low", "high"):
        curve[name] = group[name][:] if name in group else np.empty(0)
        demand(curve, (name,), np.ndarray)
        if curve[name].shape != curve["x"].shape:
            raise ValueError(f"the number of values of '{name}'")
    return curve


def read_claims(source, file):
    """Rows measured for claims stay evidence: `tables` is what shows rows."""
    source.claims = [read_claim(file["claims"][name]) for name in sorted(file["claims"])]
    source.curves = {name: read_curve(file["curves"][name]) for name in file["curves"]}


def read_sweep(source, file):
    source.plan = attributes(file["plan"])
    demand(source.plan, ("scene", "width"), str)
    demand(source.plan, ("points",), int)
    source.point = read_columns(file["points"], SWEEP_COLUMNS, {})
    if not len(source.point["w"]):
        raise ValueError("not one point is finished")


def read_columns(group, columns, wide):
    """The group's datasets, all of one length; `wide` names those of several numbers a line, and how many."""
    column = {name: values[:] for name, values in group.items()}
    count = len(column["engine"])
    for name in columns:
        if column[name].shape != ((count, wide[name]) if name in wide else (count,)):
            raise ValueError(f"the shape of '{name}'")
        if column[name].dtype.kind not in ("S" if name in TEXT_COLUMNS else "iuf"):
            raise ValueError(f"the type of '{name}'")
    return {name: np.array([plain(text) for text in values]) if values.dtype.kind == "S" else values
            for name, values in column.items()}


def read_calibration(source, file):
    source.plan = attributes(file["plan"])
    demand(source.plan, ("scene",), str)
    demand(source.plan, ("across", "aspect", "specimens", "thickness", "h", "density", "meshless"), (int, float))
    source.specimen = read_columns(file["specimens"], SPECIMEN_COLUMNS, SPECIMEN_WIDE)
    source.law = read_columns(file["laws"], LAW_COLUMNS, LAW_WIDE)
    source.found = [plain(file["laws"].attrs[f"found_{n}"]) for n in (1, 2, 3)]
    if not len(source.specimen["w"]):
        raise ValueError("not one specimen is finished")


READERS = {"shapebench results": read_rows, "shapebench claims": read_claims,
           "shapebench sweep": read_sweep, "shapebench calibration": read_calibration}


def read_file(path, file):
    kind, schema = plain(file.attrs.get("kind", "")), plain(file.attrs.get("schema", 0))
    if kind not in SCHEMAS:
        raise Unusable(f"{path}: not a file that can be reported (its kind is {kind!r}): give files that "
                       "`shapebench tables`, `claims`, `sweep` or `calibrate` wrote with -o")
    if schema != SCHEMAS[kind]:
        newer = isinstance(schema, int) and schema > SCHEMAS[kind]
        raise Unusable(f"{path}: {kind} of schema {schema}, and this program reads {SCHEMAS[kind]}: "
                       + ("use a newer shapebench" if newer else "make it again with this version"))
    source = Source(path, kind, attributes(file["machine"]))
    demand(source.machine, MACHINE_TEXTS, str)
    READERS[kind](source, file)
    return source


def read(path):
    """The file as a Source; raises Unusable."""
    with stored.opened(path) as file:
        return read_file(path, file)
