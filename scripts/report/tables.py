"""Tables of a report: headings and lines of texts, numbers as people read them."""
import math
import re

import papers
from drawing import STATUS_MARKS, number


class Table:
    def __init__(self, title, headings, note="", folded=False):
        self.title, self.headings, self.note = title, headings, note
        self.folded = folded  # only its title is seen at first
        self.lines = []  # (class, cells)

    def add(self, cells, kind=""):
        self.lines.append((kind, cells))

    def fold(self, words):
        """What all rows have alike goes into the note ("All: octree, 1 thread."): `words` makes a text of a heading's
        value, or None of one that stays. Columns in which nothing is known go too. A paper's rows are not asked."""
        own = [cells for kind, cells in self.lines if kind != "paper"]
        one = {heading: {cells[i] for cells in own} for i, heading in enumerate(self.headings)}
        said = {heading: word(*one[heading]) for heading, word in words.items() if len(one.get(heading, ())) == 1}
        said = {heading: text for heading, text in said.items() if text}
        kept = [i for i, heading in enumerate(self.headings)
                if heading not in said and any(cells[i] not in ("", "–") for _, cells in self.lines)]
        self.headings = [self.headings[i] for i in kept]
        self.lines = [(kind, [cells[i] for i in kept]) for kind, cells in self.lines]
        if said:
            self.note += f" All: {', '.join(said.values())}."
        return self

    def classes(self):
        """Of each column: numbers (""), which never wrap, words, texts, or long texts, which want room."""
        columns = [[cells[i] for _, cells in self.lines if isinstance(cells[i], str)] for i in range(len(self.headings))]
        return [class_of(column) for column in columns]


def class_of(column):
    texts = [text for text in column if not re.fullmatch(r"[-–<\d.,()%*?/+e to\n]*", text)]
    longest = max(map(len, texts), default=0)
    return "text long" if longest > 80 else "text" if longest > 24 else "word" if texts else ""


def explain_marks(statuses):
    """What the marks of these values mean."""
    words = {"?": "a question mark is behind a value that is damaged in our text of the paper, or misprinted",
             "*": "a star is behind a value that we know from another source than the paper",
             "~": "a tilde is behind a number of ours, where the paper says it in words"}
    marks = sorted({STATUS_MARKS[status] for status in statuses if status in STATUS_MARKS}, reverse=True)
    text = "; ".join(words[mark] for mark in marks)
    return f" {text[0].upper()}{text[1:]}." if text else ""


def times(values, percents, statuses=None):
    texts = [number(ms) + (f" ({percent:.0f}%)" if ms == ms and percent == percent else "")
             for ms, percent in zip(values, percents)]
    return [text + STATUS_MARKS.get(status, "") for text, status in zip(texts, statuses or [""] * len(texts))]


def stage_names(rows):
    """Of all stages that the rows' engines have, each once."""
    return list(dict.fromkeys(name for row in rows for name in row["stage_names"] if name != "-"))


def of_stages(row, key, names, missing=math.nan):
    """A list that a row has of its stages, in the order of these; `missing` of those of other engines."""
    values = dict(zip(row["stage_names"], row[key]))
    return [values.get(name, missing) for name in names]


def measured_times(row, names):
    """Of these stages; of damping only where there is any."""
    stages = dict(zip(names, of_stages(row, "stage_ms", names)))
    if not row["damping"] > 0:
        stages["damping"] = math.nan
    values = [stages[name] for name in names]
    return times(values, [100 * ms / row["total_ms"] if row["total_ms"] > 0 else math.nan for ms in values])


PAPERS = {"fastlsm": "FastLSM", "octree": "octree", "meshless": "meshless"}


def joined(words):
    """With commas, and "and" before the last."""
    return " and ".join([", ".join(words[:-1])] * (len(words) > 1) + words[-1:])


def threads_text(count):
    return f"{count} thread{'' if count == 1 else 's'}"


def scenes_of(source):
    """What tells a file's rows from another's, in words."""
    names = [PAPERS.get(paper, paper) for paper in dict.fromkeys(row["paper"] for row in source.rows) if paper]
    text = f"scenes of the {joined(names)} paper{'s' * (len(names) > 1)}" if names else "scenes of no paper"
    threads = {row["threads"] for row in source.rows}
    return text + (f", {threads_text(*threads)}" if len(threads) == 1 and threads != {1} else "")


# What a table's note says of a column that all rows have alike.
ALIKE = {"engine": str, "precision": lambda value: f"{value} precision", "threads": threads_text,
         "w": lambda value: f"w {value}" if value != "–" else None, "check": lambda value: value if value == "VALID" else None}


def measured(source):
    """A paper's rows: totals first, then stages and counts; the paper's beneath."""
    rows = [row for row in source.rows if "elastic" not in row]
    if not rows:
        return None
    names = stage_names(rows)
    table = Table(f"Time of a step: {scenes_of(source)}",
                  ["scene", "total ms", "quartiles ms", "ns / particle / step", "times as fast as the paper", "check"]
                  + [name.replace("_", " ") + " ms" for name in names]
                  + ["particles", "regions", "w", "sums / region", "engine", "precision", "threads"],
                  f"Medians, of {source.name}. The paper's values are those of its own processor.")
    shown = []
    for row in rows:
        total, paper = row["total_ms"], row["paper_total_ms"]
        counts = [number(row["particles"]), number(row["regions"]), row["w"] or "–", number(row["summation_nodes"]),
                  row["engine"], row["precision"], row["threads"]]
        if not row["valid"]:
            table.add([row["scene"]] + ["–"] * 4 + [check(row)] + ["–"] * len(names) + counts, "invalid")
            continue
        faster = number(paper / total) if paper == paper and total > 0 else "–"
        table.add([row["scene"], number(total), f"{number(row['total_low_ms'])} to {number(row['total_high_ms'])}",
                   number(row["ns_per_particle_step"]), faster, check(row)] + measured_times(row, names)
                  + counts)
        if paper == paper:
            mark = STATUS_MARKS.get(row["paper_status"], "")
            table.add(["paper", number(paper) + mark, "", number(row["paper_ns"]) + mark, "", ""]
                      + times(of_stages(row, "paper_stage_ms", names), of_stages(row, "paper_stage_percent", names),
                              of_stages(row, "paper_stage_statuses", names, "")) + [""] * len(counts), "paper")
            shown += [row["paper_status"]] + row["paper_stage_statuses"]
    table.note += explain_marks(shown)
    return table.fold(ALIKE)


def where(point, i):
    """A point of a sweep or calibration: "octree w 2, epsilon 0.5"."""
    epsilon = f", epsilon {point['epsilon'][i]:g}" if point["sampled"][i] else ""
    return f"{point['engine'][i]} w {point['w'][i]:g}{epsilon}"


def check(row):
    """A valid row without a time was left none by other programs or the container's quota."""
    if not row["valid"]:
        return "INVALID: " + row["reason"]
    if row["total_ms"] == row["total_ms"]:
        return "VALID"
    return "BUSY: " + (row["reason"] or "other programs took the processors")


def is_shell(row):
    return row["engine"] == "shell"


# Columns of meshless bodies and of shells: heading, the row's own value in `elastic`, the paper's, is it a whole number?
SOLID = [("nodes", "nodes", "nodes", True), ("modes", "modes", "modes", True),
         ("matrices s", "matrix_seconds", "matrix_s", False), ("modes s", "mode_seconds", "mode_s", False)]
SHELL = [("parameters s", "map_seconds", "map_s", False), ("nodes", "nodes", "nodes", True),
         ("in the end", "end_nodes", "last_nodes", True)]
BOUNDS = ("matrix_s", "mode_s")  # the paper says no more than that all take less


def frames(source, rows, title, columns, note):
    """The paper's beneath each row: of its own values the file has the points and the frame."""
    table = Table(f"Time of a frame of {title}: {scenes_of(source)}",
                  ["scene", "points"] + [heading for heading, *_ in columns]
                  + ["motion ms", "skin ms", "frame ms", "times as fast as the paper", "check"],
                  f"Medians, of {source.name}. The paper's frames are of its own processor and include the drawing of the "
                  "points." + note)
    printed, shown = papers.rows(), []
    for row in rows:
        body, total, paper = row["elastic"], row["total_ms"], row["paper_total_ms"]
        own = [number(body.get(name) or math.nan) if row["valid"] or whole else "–" for _, name, _, whole in columns]
        if not row["valid"]:
            table.add([row["scene"], number(row["particles"])] + own + ["–"] * 4 + [check(row)], "invalid")
            continue
        faster = number(paper / total) if paper == paper and total > 0 else "–"
        table.add([row["scene"], number(row["particles"])] + own
                  + measured_times(row, ["motion", "skin"]) + [number(total), faster, check(row)])
        if paper == paper:
            given = printed.get((row["paper"], row.get("paper_row", row["scene"])), {})
            values = [(name, whole, *given.get(name, (math.nan, ""))) for _, _, name, whole in columns]
            points = row.get("paper_particles", math.nan)
            table.add(["paper", whole_number(points)]
                      + [printed_text(name, whole, value, status) for name, whole, value, status in values]
                      + ["–", "–", number(paper) + STATUS_MARKS.get(row["paper_status"], ""), "", ""], "paper")
            shown += [row["paper_status"]] + [status for *_, status in values]
    table.note += explain_marks(shown)
    return table.fold(ALIKE)


def whole_number(value):
    return number(int(value) if value == value else value)


def printed_text(name, whole, value, status):
    text = whole_number(value) if whole or name in BOUNDS else number(value)
    bound = "< " if name in BOUNDS and value == value else ""
    return bound + text + STATUS_MARKS.get(status, "")


def elastic(source):
    """Rows of meshless bodies: a frame is the modes' motion and the points that it carries."""
    rows = [row for row in source.rows if "elastic" in row and not is_shell(row)]
    return frames(source, rows, "meshless bodies", SOLID, "") if rows else None


def shells(source):
    """Rows of thin shells, whose frame is their nodes' motion and the points."""
    rows = [row for row in source.rows if "elastic" in row and is_shell(row)]
    breaks = any(row["elastic"].get("whole_ms", 0) > 0 for row in rows)
    note = " Frames of a shell that breaks are those that make cracks or let some grow." if breaks else ""
    return frames(source, rows, "thin shells", SHELL, note) if rows else None


def changing(source):
    rows = [row for row in source.rows if row["change.frames"]]
    if not rows:
        return None
    table = Table(f"Bodies that change: {scenes_of(source)}",
                  ["scene", "frames", "with a change", "nodes", "added at once", "simulation ms", "resampling ms",
                   "splitting ms", "a surface ms", "triangles", "pieces", "open edges", "check"],
                  f"Of {source.name}. Simulation is a frame's before the first change and after the last; resampling is the "
                  "median and the most of frames that change.")
    for row in rows:
        c = {name[7:]: value for name, value in row.items() if name.startswith("change.")}
        table.add([row["scene"], c["frames"], c["changed"], f"{number(c['first_nodes'])} to {number(c['most_nodes'])}",
                   number(c["most_added"])]
                  + (["–"] * 4 if not row["valid"] else
                     [f"{number(c['first_ms'])} to {number(c['last_ms'])}",
                      f"{number(c['change_ms'])}, {number(c['change_most_ms'])}", number(c["follow_ms"]),
                      number(c["surface_ms"])])
                  + [f"{number(c['first_triangles'])} to {number(c['last_triangles'])}", c["pieces"], c["open_edges"],
                     check(row)], "" if row["valid"] else "invalid")
    return table.fold(ALIKE)


def text_of(value):
    """An attribute of a row; nothing of an array, which is another table's."""
    if isinstance(value, int) and value > 1 << 53:  # a hash
        return f"{value:016x}"
    return number(value) if isinstance(value, (int, float)) else value if isinstance(value, str) else ""


def everything(source):
    """All numbers and texts of every valid row, named and explained by the file itself: what the other tables leave
    out is here, and so is what is new."""
    rows = [row for row in source.rows if row["valid"]]
    if not rows or not source.meanings:
        return None
    table = Table(f"All that was stored: {scenes_of(source)}", ["quantity", "unit"] + [row["scene"] for row in rows]
                  + ["what it is"], f"Of {source.name}.", folded=True)
    for name, (meaning, unit) in source.meanings.items():
        group, _, own = name.rpartition("/")
        values = [text_of((row.get(group, {}) if group else row).get(own)) for row in rows]
        if any(values):
            table.add([name, unit] + values + [meaning])
    return table


ENVIRONMENT = [("cpu", "processor"), ("cores", "cores"), ("threads", "threads"), ("l1_bytes", "L1 bytes"),
               ("l2_bytes", "L2 bytes"), ("l3_bytes", "L3 bytes"), ("governor", "governor"), ("kernel", "system"),
               ("hostname", "host"), ("compiler", "compiler"), ("flags", "flags"), ("libraries", "libraries"),
               ("version", "version"), ("git_commit", "commit"), ("git_dirty", "uncommitted changes"), ("utc", "begun"),
               ("command", "command")]


def environment(sources):
    """What wrote the files: what all share, and then what is each file's own."""
    def value(source, name):
        value = source.machine.get(name, "unknown")
        if value == "unknown":
            return value
        return ("yes" if value else "no") if name == "git_dirty" else f"{value:,}" if isinstance(value, int) else value

    shared = Table("Where these were measured", ["", "all files" if len(sources) > 1 else sources[0].name])
    own = {}
    for name, title in ENVIRONMENT:
        values = [value(source, name) for source in sources]
        if not any(name in source.machine for source in sources):
            continue
        known = sorted(set(values) - {"unknown"})
        if len(known) <= 1:
            shared.add([title, known[0] if known else "unknown"])
        else:
            own[title] = [text[:10] for text in values] if name == "git_commit" else values
    differ = Table("What each file has of its own", ["file", *own])
    for i, source in enumerate(sources):
        differ.add([source.name, *(values[i] for values in own.values())])
    return [shared, differ] if own else [shared]


def all_tables(sources):
    made = (make(source) for source in sources for make in (measured, changing, elastic, shells, everything))
    return [table for table in made if table]
