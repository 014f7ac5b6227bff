"""Result files, read for a report. Nothing here knows how they will look.

Layouts are those of results/README.md: measurements ("shapebench results"), claims ("shapebench claims")
sweeps ("shapebench sweep"), calibrations ("shapebench calibration") and what baselines.py measures ("shapebench
baselines")."""
import math
import os
import re

import numpy as np

import stored
from stored import Unusable, attributes, plain

CLAIM_KINDS = ("method", "machine", "by construction")


class Source:
    """A file: its kind, the machine that wrote it, and what its kind holds."""

    def __init__(self, path, kind, machine):
        self.path, self.kind, self.machine = path, kind, machine
        self.name = os.path.basename(path)
        self.rows, self.claims, self.curves, self.meanings = [], [], {}, {}
        self.plan, self.point = None, None
        self.specimen, self.law, self.found = None, None, []
        self.beam, self.method = None, None

    @property
    def commit(self):
        commit = self.machine.get("git_commit", "unknown")[:10]
        return commit + ("+" if self.machine.get("git_dirty") else "")


def demand(record, texts="", numbers="", lists="", wholes=""):
    """The attributes of these names must be there and of their kind; lists are of numbers."""
    for names, kinds in ((texts, str), (numbers, (int, float)), (lists, np.ndarray), (wholes, int)):
        for name in names.split():
            value = record.get(name)
            if not isinstance(value, kinds) or kinds is np.ndarray and (value.ndim != 1 or value.dtype.kind not in "iuf"):
                raise ValueError(f"'{name}'")


def read_paper(row):
    """What the file says of the paper's values, or nothing: how they came to us (of a total that follows from a rate,
    how the rate did), the time of a particle and step, and the stages' percents."""
    count = len(row["stage_ms"])
    for name in ("paper_total_status", "paper_rate_status", "paper_stage_status"):
        row.setdefault(name, "")
    row.setdefault("paper_stage_percent", np.full(count, math.nan))
    demand(row, texts="paper_total_status paper_rate_status paper_stage_status", lists="paper_stage_percent")
    derived = row["paper_total_status"] == "derived"
    row["paper_status"] = row["paper_rate_status" if derived else "paper_total_status"]
    row["paper_stage_statuses"] = row["paper_stage_status"].split() or [""] * count
    row["paper_ns"] = 1e6 * row["paper_total_ms"] / (row.get("paper_particles") or math.nan)


def read_row(group):
    row = attributes(group)
    change = ("frames changed first_nodes most_nodes most_added first_ms last_ms change_ms change_most_ms follow_ms "
              "surface_ms first_triangles last_triangles pieces open_edges left")
    demand(row, texts="paper scene engine precision reason stages", lists="stage_ms paper_stage_ms",
           numbers="valid particles regions w threads total_ms total_low_ms total_high_ms ns_per_particle_step "
           "summation_nodes damping paper_total_ms " + " ".join("change." + name for name in change.split()))
    read_paper(row)
    if not (len(row["stages"].split()) == len(row["stage_ms"]) == len(row["paper_stage_ms"])
            == len(row["paper_stage_statuses"]) == len(row["paper_stage_percent"])):
        raise ValueError("the number of stages")
    for name in ("total", "stage", "frames"):
        if name in group:
            row[name + "_samples"] = group[name][:]
    if "elastic" in group:
        row["elastic"] = attributes(group["elastic"])
        demand(row["elastic"], numbers="nodes modes matrix_seconds mode_seconds")
    row["stage_names"] = row["stages"].split()
    if "elastic" in row:  # files of before give a meshless body's stages the names of shape matching's
        older = {"shape_matching": "motion", "other": "skin"}
        row["stage_names"] = [older.get(name, name) for name in row["stage_names"]]
    return row


def read_meanings(file):
    """What each attribute of a row is, and its unit, as the file says; older files do not."""
    meaning = attributes(file["columns"]) if "columns" in file else {}
    if "columns" in file:
        meaning |= {f"elastic/{name}": text for name, text in attributes(file["columns/elastic"]).items()}
    for name, text in meaning.items():
        if not isinstance(text, str):
            raise ValueError(f"'{name}'")
    return {name: re.fullmatch(r"(.*?)(?: \[([^][]*)\])?", text, re.DOTALL).groups("") for name, text in meaning.items()}


def read_rows(source, file):
    source.meanings = read_meanings(file)
    source.rows = [read_row(file["rows"][name]) for name in sorted(file["rows"])]


def read_claim(group):
    claim = attributes(group)
    values = "paper_value measured low high"
    demand(claim, wholes="values count", numbers="unset", lists=values + " ratio",
           texts="kind paper name place unit statement status test verdict words evidence over unset_evidence")
    if not 0 <= max(claim["values"], claim["count"]) <= min(len(claim[name]) for name in values.split()):
        raise ValueError("the number of values of a claim")
    if claim["kind"] not in CLAIM_KINDS:
        raise ValueError(f"the kind {claim['kind']!r} of a claim")
    return claim


def read_curve(group):
    curve = attributes(group)
    for name in ("x", "y", "low", "high"):
        curve[name] = group[name][:] if name in group else np.empty(0)
    demand(curve, "x_name y_name", "valid exponent exponent_low exponent_high", "x y low high")
    for name in ("y", "low", "high"):
        if curve[name].shape != curve["x"].shape:
            raise ValueError(f"the number of values of '{name}'")
    return curve


def read_claims(source, file):
    """Rows measured for claims stay evidence: `tables` is what shows rows."""
    source.claims = [read_claim(file["claims"][name]) for name in sorted(file["claims"])]
    source.curves = {name: read_curve(file["curves"][name]) for name in file["curves"]}


def add_sampled(plan, column):
    """A column `sampled`: has the point's engine an epsilon? The plan names those engines; where it is of an older
    file, they are those with an epsilon that is not 0."""
    names = plan["sampled"].split() if "sampled" in plan else column["engine"][column["epsilon"] != 0]
    column["sampled"] = np.isin(column["engine"], names)


def read_sweep(source, file):
    source.plan = attributes(file["plan"])
    demand(source.plan, "scene width", wholes="points")
    source.point = read_columns(file["points"], "engine",
                                "w epsilon valid total_ms build_seconds bytes summation_nodes goal_rms sag "
                                "frequency path_rms path_most front")
    add_sampled(source.plan, source.point)
    if not len(source.point["w"]):
        raise ValueError("not one point is finished")


def read_columns(group, texts, numbers):
    """The group's datasets, all of one length; "young:4" are four numbers a line."""
    column = {name: values[:] for name, values in group.items()}
    count = len(column[texts.split()[0]])
    for name, kinds in [(name, "S") for name in texts.split()] + [(name, "iuf") for name in numbers.split()]:
        name, _, wide = name.partition(":")
        if column[name].shape != ((count, int(wide)) if wide else (count,)):
            raise ValueError(f"the shape of '{name}'")
        if column[name].dtype.kind not in kinds:
            raise ValueError(f"the type of '{name}'")
    return {name: np.array([plain(text) for text in values]) if values.dtype.kind == "S" else values
            for name, values in column.items()}


def read_calibration(source, file):
    source.plan = attributes(file["plan"])
    demand(source.plan, "scene", "across aspect specimens thickness h density meshless")
    source.specimen = read_columns(file["specimens"], "engine set reason",
                                   "w epsilon across aspect spacing h wide valid spread frequency:3 young young_euler:4 "
                                   "young_timoshenko:4 young_meshless:4")
    add_sampled(source.plan, source.specimen)
    source.law = read_columns(file["laws"], "engine", "specimens scatter c:3 d:3")
    source.found = [plain(file["laws"].attrs[f"found_{n}"]) for n in (1, 2, 3)]
    if not len(source.specimen["w"]):
        raise ValueError("not one specimen is finished")


def read_baselines(source, file):
    source.beam = attributes(file["plan"])
    demand(source.beam, "comparable not_comparable", numbers="nodes sag_percent length w h")
    source.method = read_columns(file["methods"], "method stiffness",
                                 "step sag_percent ms_step ns_node_step ms_second deviation_percent")
    if not len(source.method["method"]):
        raise ValueError("not one method is there")


# By kind: the schema that is read, and what reads it.
READERS = {"shapebench results": (4, read_rows), "shapebench claims": (2, read_claims),
           "shapebench sweep": (1, read_sweep), "shapebench calibration": (1, read_calibration),
           "shapebench baselines": (2, read_baselines)}


def read_file(path, file):
    kind, schema = plain(file.attrs.get("kind", "")), plain(file.attrs.get("schema", 0))
    if kind not in READERS:
        raise Unusable(f"{path}: not a file that can be reported (its kind is {kind!r}): give files that "
                       "`shapebench tables`, `claims`, `sweep` or `calibrate` or scripts/baselines.py wrote with -o")
    known, fill = READERS[kind]
    if schema != known:
        newer = isinstance(schema, int) and schema > known
        raise Unusable(f"{path}: {kind} of schema {schema}, and this program reads {known}: "
                       + ("use a newer shapebench" if newer else "make it again with this version"))
    source = Source(path, kind, attributes(file["machine"]))
    demand(source.machine, "cpu git_commit utc")
    fill(source, file)
    return source


def read(path):
    """The file as a Source; raises Unusable."""
    with stored.opened(path, stored.print_remark) as file:
        return read_file(path, file)
