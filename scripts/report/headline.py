"""What was found, in a few plain sentences, each of a section of the page: all from the files."""
import math
import re
import subprocess

import alternatives
import history
from drawing import STATUS_MARKS, number
from tables import PAPERS, joined, threads_text

MACHINES = {"fastlsm": "a Pentium 4 at 3.4 GHz in 2007",
            "octree": "a Pentium 4 in 2008, at 3.4 GHz by our reading of '235Hz'",
            "meshless": "two Xeons at 2.8 GHz in 2009"}  # as the papers say
NAMED = 3  # of many claims and changes these are named


def validity(rows):
    """Whether each row was right on the scene that it was timed on, and undisturbed."""
    bad = [row["scene"] for row in rows if not row["valid"]]
    busy = [row["scene"] for row in rows if row["valid"] and row["total_ms"] != row["total_ms"]]
    yield (f"{len(rows)} row{' was' if len(rows) == 1 else 's were'} measured; each was checked on the very scene timed: "
           + ("all are VALID." if not bad else f"{len(bad)} are INVALID and have no times: {', '.join(bad)}."))
    if busy:
        yield f"Other programs or the container's quota left no undisturbed time to {', '.join(busy)}: they are BUSY."


def gains(rows):
    """(times as fast as the paper, scene) by engine, of what papers print themselves, least first."""
    found = {}
    for row in rows:
        if row["valid"] and row["total_ms"] > 0 and row["paper_total_ms"] > 0 and row["paper_status"] not in STATUS_MARKS:
            found.setdefault(row["engine"], []).append((row["paper_total_ms"] / row["total_ms"], row["scene"]))
    return {engine: sorted(times) for engine, times in found.items()}


def named(engine):
    name = PAPERS.get(engine, engine)
    return name[:1].upper() + name[1:]


def speeds(files):
    """How many times as fast as papers' figures, on the fewest threads, and whose processors these are."""
    rows = [row for source in files for row in source.rows]
    if not rows:
        return
    fewest = min(row["threads"] for row in rows)
    rows = [row for row in rows if row["threads"] == fewest]
    found = gains(rows)
    for engine, times in found.items():
        (least, first), (most, last) = times[0], times[-1]
        yield (f"{named(engine)}: a {'frame' if engine == 'meshless' else 'step'} is {number(least)} times ({first}) "
               + (f"to {number(most)} times ({last}) " if len(times) > 1 else "") + "as fast as the paper's figure, on "
               f"{threads_text(fewest)}.")
    theirs = [f"{MACHINES[paper]} ({PAPERS[paper]})" for paper in dict.fromkeys(row["paper"] for row in rows)
              if paper in MACHINES]
    if found and theirs:
        yield (f"Such factors are of machines too, and not of programs alone: {joined(processors(files))} here, there "
               f"{joined(theirs)}.")


def processors(files):
    return sorted({source.machine.get("cpu", "an unknown processor") for source in files})


def far(claim):
    """How many times a claim's value is off the paper's, as a logarithm; of several values nothing can be said."""
    if claim["count"] != 1 or claim["values"] != 1 or not min(claim["measured"][0], claim["paper_value"][0]) > 0:
        return 0
    return abs(math.log(claim["measured"][0] / claim["paper_value"][0]))


def counted(count, verdict):
    one = verdict if verdict == "differs" else f"is {verdict}"
    return f"{count} {one if count == 1 else one.replace('is ', 'are ').replace('differs', 'differ')}"


def claims(source):
    """How many of the method's claims have which verdict, and which are farthest from the paper."""
    method = [claim for claim in source.claims if claim["kind"] == "method"]
    if not method:
        return
    verdicts = [claim["verdict"] for claim in method]
    told = [counted(verdicts.count(verdict), verdict) for verdict in sorted(set(verdicts), reverse=True)]
    apart = sorted((claim for claim in method if claim["verdict"] != "reproduced" and far(claim)), key=far)[:-NAMED - 1:-1]
    which = [f"{claim['paper']} {claim['name']}, {number(claim['measured'][0])} where the paper has "
             f"{number(claim['paper_value'][0])}" for claim in apart]
    yield (f"Of {len(method)} claim{'s' * (len(method) > 1)} of method {joined(told)}"
           + (f". Farthest off: {'; '.join(which)}" if which else "") + ".")


def recommendations(program, source):
    """What the program itself has to choose from in a sweep, by stiffness; nothing where it is not there."""
    try:
        done = subprocess.run([program, "sweep", source.path, "--recommend"], capture_output=True, text=True)
    except OSError:
        return
    for choice, hz, points in re.findall(r"^  (\w+): --stiffness (\S+)\n((?: {4}.*\n)+)", done.stdout, re.MULTILINE):
        of = re.findall(r"    (.*?): (.*? a step) .* that (sags \S+)", points)
        yield (f"{source.plan['scene'].capitalize()}, {choice} (a beam of {hz} Hz): "
               + "; ".join(f"{point} {sags}, {ms}" for point, ms, sags in of) + ".")


def found(program, files, past):
    """(section, what it is about, sentences), of those that there are; `past` is history.read()'s."""
    rows = [row for source in files for row in source.rows]
    told = {("measured", "Speed"): speeds(files), ("measured", "Checks"): validity(rows) if rows else ()}
    if past:
        changes = [change + "." for change in history.changes(past)] or list(history.sentences(past))[:1]
        more = [f"{len(changes) - NAMED} more changes are below."] if len(changes) > NAMED + 1 else changes[NAMED:]
        told["history", "History"] = changes[:NAMED] + more
    told["baselines", "Instead"] = (text for source in files if source.method for text in alternatives.summary(source))
    told["claims", "Claims"] = (text for source in files for text in claims(source))
    told["sweeps", "w and epsilon"] = (text for source in files if source.point for text in recommendations(program, source))
    told["calibrations", "Elasticity"] = (source.found[0].split(", those ")[0].rstrip(".") + "."
                                          for source in files if source.found)
    told = {about: list(sentences) for about, sentences in told.items()}
    return [(*about, sentences) for about, sentences in told.items() if sentences]
