"""A scene's cost from file to file, where it and the machine changed, and two files side by side, as `regress` compares
them."""
import collections
import json
import math
import subprocess
import textwrap

import change_point
from drawing import COLOURS, MARKS, PAPER, Figure, canvas, number
from stored import Unusable
from tables import Table

FEW = 4  # files that are all shown in full
MOST_NAMES = 24  # under the axis
SHORT = {"processor": "CPU", "instruction set": "ISA"}
WORK = "scene engine precision threads particles w epsilon h input_hash".split()  # as bench/regress/comparison.c has it
MACHINE = {"cpu": "processor", "cpu_model": "processor", "compiler": "compiler", "libraries": "libraries",
           "kernel": "kernel", "governor": "governor", "hostname": "host", "isa": "instruction set"}


def timed(source):
    """Rows that are neither INVALID nor BUSY, which have no time."""
    return [row for row in source.rows if row["valid"] and 0 < row["total_ms"] < math.inf]


def same_work(old, new):
    """What the older row does not state is not judged."""
    return all(str(old.get(name, "")) in ("", "nan", str(new.get(name))) for name in WORK)


def find_series(sources):
    """The points of each scene of the same work."""
    found = []
    for at, source in enumerate(sources):
        for row in timed(source):
            point = {"file": at, "row": row, "value": row["total_ms"], "low": row["total_low_ms"], "high": row["total_high_ms"]}
            points = next((points for points in found if points[-1]["file"] != at and same_work(points[-1]["row"], row)), None)
            if points is None:
                found.append(points := [])
            points.append(point)
    return found


def find_changes(points):
    values = [point["value"] for point in points]
    found = change_point.find_changes(values)
    ends = [0, *found, len(values)]
    for before, here, after in zip(ends, ends[1:], ends[2:]):
        ratio, low, high = change_point.ratio(values[before:here], values[here:after])
        yield {"point": here, "p": found[here], "ratio": ratio, "low": low, "high": high}


def find_marks(sources):
    """Where the machine differs from that of the file before, as far as both say."""
    for at, (old, new) in enumerate(zip(sources, sources[1:]), 1):
        for name, what in MACHINE.items():
            before, now = (str(source.machine.get(name, ""))[:120] for source in (old, new))
            if before != now and not {before, now} & {"", "unknown"}:
                yield {"file": at, "what": what, "old": before, "new": now}


def read(sources):
    """The history of all files that have rows, the oldest first; None where no scene is in two of them."""
    sources = list({source.path: source for source in sources}.values())
    files = collections.Counter(scene for source in sources for scene in {row["scene"] for row in timed(source)})
    sources = sorted((source for source in sources if any(files[row["scene"]] > 1 for row in timed(source))),
                     key=lambda source: source.machine["utc"])
    series = [{name: points[-1]["row"][name] for name in ("scene", "engine", "threads")}
              | {"points": points, "changes": list(find_changes(points))}
              for points in find_series(sources) if len(points) > 1]
    return {"sources": sources, "series": series, "marks": list(find_marks(sources))} if series else None


def superseded(found):
    """Of many files those that newer ones repeat: they have no tables and figures of their own."""
    newest = {series["points"][-1]["file"] for series in found["series"]}
    if len(found["sources"]) <= FEW:
        return []
    return [source for at, source in enumerate(found["sources"]) if at not in newest]


def label(series):
    return f"{series['scene']}, {series['threads']} thread{'s' * (series['threads'] > 1)}"


def named(source):
    return f"{source.name} ({source.machine['utc'][:10]}, {source.commit})"


def whats(found, at):
    """What changed of the machine at a file: "kernel and compiler"."""
    return " and ".join(dict.fromkeys(mark["what"] for mark in found["marks"] if mark["file"] == at))


def changes(found):
    """Each change of each series, as a sentence."""
    for series in found["series"]:
        for change in series["changes"]:
            at = series["points"][change["point"]]["file"]
            there = whats(found, at)
            yield (f"{series['scene']} is {'slower' if change['ratio'] > 1 else 'faster'} from "
                   f"{named(found['sources'][at])} on: {change['ratio']:.3f} times ({change['low']:.3f} to "
                   f"{change['high']:.3f}, p {change['p']:.3f})" + (f"; there the {there} changed" if there else ""))


def sentences(found):
    told = list(changes(found))
    most = max(len(series["points"]) for series in found["series"])
    if most < 10:
        yield "No change can be told from noise in fewer than ten files of a scene: this shows the times alone."
    elif not told:
        yield "No scene changed: E-divisive finds none in any."
    yield from (sentence + "." for sentence in told)
    older = superseded(found)
    if older:
        yield f"{len(older)} files whose scenes newer ones have are shown here alone."
    for at, source in enumerate(found["sources"]):
        for mark in (mark for mark in found["marks"] if mark["file"] == at):
            yield f"From {named(source)} on the {mark['what']} is {mark['new']}, before {mark['old']}."


def draw_series(axes, series, n):
    """Medians and quartiles, the medians between changes as steps, and the first points after them as rings."""
    points, colour = series["points"], COLOURS[n % 7]
    first = points[0]["value"]
    x, y = [p["file"] for p in points], [p["value"] / first for p in points]
    spread = [[max(0, (p["value"] - p["low"]) / first) for p in points],
              [max(0, (p["high"] - p["value"]) / first) for p in points]]
    axes.errorbar(x, y, yerr=spread, marker=MARKS[n % 7], color=colour, capsize=2,
                  linewidth=0.8 if series["changes"] else 1.5, markersize=4, label=label(series))
    ends = [0] + [change["point"] for change in series["changes"]] + [len(points)]
    for begin, end in zip(ends, ends[1:]):
        if series["changes"]:
            middle = sorted(y[begin:end])
            middle = (middle[(end - begin) // 2] + middle[(end - begin - 1) // 2]) / 2
            axes.plot([x[begin] - 0.4, x[end - 1] + 0.4], [middle, middle], color=colour, linewidth=2.2, alpha=0.6)
        if begin:
            axes.plot(x[begin], y[begin], "o", markersize=12, markerfacecolor="none", color=colour, markeredgewidth=1.8)


def draw_marks(axes, found):
    for at in sorted({mark["file"] for mark in found["marks"]}):
        what = ", ".join(dict.fromkeys(SHORT.get(mark["what"], mark["what"]) for mark in found["marks"]
                                       if mark["file"] == at))
        axes.axvline(at - 0.5, color=PAPER, linestyle="--", linewidth=1)
        axes.annotate(textwrap.fill(what, 24), (at - 0.5, 1), xycoords=("data", "axes fraction"), xytext=(2, 2),
                      textcoords="offset points", fontsize=9, color="#444444", rotation=35, va="bottom")


def name_files(axes, sources):
    every = -(-len(sources) // MOST_NAMES)
    many = len(sources) > 6
    texts = [f"{s.commit}\n{s.machine['utc'][:10]}" if many else f"{s.name}\n{s.commit}\n{s.machine['utc'][:16]}"
             for s in sources]
    axes.set_xticks(range(0, len(sources), every), texts[::every], fontsize=9, rotation=90 if many else 0)
    axes.set_xlabel("commit and day, the oldest first" if many else "file, commit and time, the oldest first")


def figure(found):
    """All series, relative to their first."""
    canvas_, axes = canvas(4.6)
    data, words = [], []
    for n, series in enumerate(found["series"]):
        points = series["points"]
        draw_series(axes, series, n)
        after = {change["point"] for change in series["changes"]}
        for i, point in enumerate(points):
            source = found["sources"][point["file"]]
            data.append([series["scene"], series["engine"], series["threads"], source.machine["utc"], source.commit,
                         source.name, point["value"], point["low"], point["high"], int(i in after),
                         whats(found, point["file"])])
        a, b = points[0], points[-1]
        apart = "overlap" if a["low"] <= b["high"] and b["low"] <= a["high"] else "do not overlap"
        words.append(f"{series['scene']} from {number(a['value'])} to {number(b['value'])} ms "
                     f"({b['value'] / a['value']:.3f} times; quartiles {apart})")
    draw_marks(axes, found)
    name_files(axes, found["sources"])
    axes.axhline(1, color=PAPER, linewidth=0.8)
    axes.set_ylabel("time of a step, first file = 1")
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    return Figure("history", "A scene from file to file",
                  "Medians and quartiles, relative to the oldest file; + marks a build from changed sources. A ring is the "
                  "first file after a change (E-divisive, Matteson and James 2014; p at most 0.01), a thick line the median "
                  "between changes. At a dashed line what it names changed of the machine.",
                  "; ".join(words + list(changes(found))) + ".",
                  ["scene", "engine", "threads", "utc", "commit", "file", "total_ms", "low_ms", "high_ms", "changed",
                   "machine_changed"], data).draw(canvas_)


def side_by_side(program, found):
    """The oldest and the newest file that share a scene, as `regress` compares them."""
    shared = [(series["points"][0]["file"], series["points"][-1]["file"]) for series in found["series"]]
    old, new = max(shared, key=lambda pair: pair[1] - pair[0])
    old, new = found["sources"][old], found["sources"][new]
    done = subprocess.run([program, "regress", "--format", "json", "--quiet", "--", old.path, new.path], capture_output=True,
                          text=True)
    if not done.stdout:  # otherwise its exit code is a verdict
        raise Unusable(done.stderr.strip().split(": ", 1)[-1] or f"{program} regress ended with {done.returncode}")
    compared = json.loads(done.stdout)
    table = Table("Side by side: the oldest file and the newest",
                  ["scene", "time", "A ms", "B ms", "B / A", "95%", "threshold", "verdict"],
                  f"A: {named(old)}. B: {named(new)}. {compared['verdict'][:1].upper()}{compared['verdict'][1:]}. Repeats are "
                  "the samples; shapebench regress A.h5 B.h5 does this of any two files."
                  + "".join(f" {remark[:1].upper()}{remark[1:]}." for remark in compared["remarks"]),
                  folded=len(compared["comparisons"]) > 24)
    for one in compared["comparisons"]:
        shown = [number(one[side]["ms"]) for side in ("old", "new")]
        if one["ratio"] is None:
            table.add([one["scene"], "–", *shown, "–", "–", "–", f"{one['verdict']}: {one['reason']}"])
            continue
        table.add([one["scene"], one["time"].replace("_", " "), *shown, f"{one['ratio']:.3f}",
                   f"{one['low']:.3f} to {one['high']:.3f}", f"{100 * one['threshold']:.1f}%", one["verdict"]])
    return table
