"""Claims of a report: a table of each kind, and a figure for each group of curves measured for them."""
import re

import numpy as np
from matplotlib.ticker import MaxNLocator

from drawing import COLOURS, MARKS, PAPER, STATUS_MARKS, Figure, canvas, legend_above, number
from sources import CLAIM_KINDS
from tables import Table, explain_marks

# Groups of curves by how their names begin: title, caption, and which axes are logarithmic.
GROUPS = {
    "sums": ("Cost of the sums against w", "FastLSM Fig. 4: nanoseconds a particle for the sums alone, in a solid cube, "
             "against the mean side of its regions; the exponent that fits stands with each curve.", "xy"),
    "body-sums": ("Cost of the sums of a body against w", "FastLSM Fig. 4, which is of the solid Buddha: the sums of a cube and of "
             "bodies with irregular regions, against their mean side.", "xy"),
    "body-additions": ("Additions of the sums of a body", "The same by additions a particle: an index of an irregular body "
                       "owns the more different bars and plates the wider its regions are.", "xy"),
    "additions": ("Additions of the sums", "FastLSM section 3.1 in a solid cube: additions an index by (2w+1)³, 3(2w+1) or "
                  "6.", ""),
    "subsums": ("Indices with one bar or plate", "FastLSM section 3.1: the share of the lattice's indices that own a single "
                "one.", ""),
    "left": ("What is left of a deformation", "FastLSM section 2: a body whose particles go to their goals, again and again.",
             "xy"),
    "growth": ("Energy of a free body by how hard it is kicked", "Kinetic energy over the last tenth of 20,000 steps by that "
               "over the first, against the velocities it starts with. The time step does not matter: in cells a step, it "
               "is in none of the equations.", "xy"),
    "distances": ("Cost of distances", "Octree section 6.2: from a leaf to all within reach, against how many those are.",
                  "xy"),
    "smoothing": ("How far two steps of smoothing spread", "FastLSM Fig. 2: a cross-section of a bar is displaced and two "
                  "steps of smoothing follow.", ""),
    "blending": ("How well clusters blend", "FastLSM Fig. 3: the largest jump of the displacement gradient between "
                 "neighbouring particles of a bar bent and twisted by half a turn; one region a particle (lattice) against "
                 "few overlapping clusters.", "y"),
    "size": ("Cost against size", "Milliseconds a step against the number of particles or nodes.", "xy"),
    "sag": ("Stiffness against w", "How deep the tip of a clamped beam hangs when it has come to rest: forces are in balance, "
            "nothing swings.", ""),
    "elastic-sag": ("Sag of a meshless beam against theory", "The static sag of a clamped beam by that of Timoshenko's beam.", "x"),
    "regions": ("Summation nodes against epsilon", "Octree section 4.2: epsilon is to bound how many summation nodes a region "
                "has; by how regions are made symmetric.", ""),
    "breaking": ("Cost of breaking links", "FastLSM section 4: what a broken link costs, against the size of the body.", "xy"),
}

# Words for the parts of curves' names and the fields that axes are named by; of others "_" becomes a space.
WORDS = {
    "fast": "fast sums", "naive": "added one by one", "bars": "bars alone", "lists": "from lists", "blocks": "in blocks",
    "sums": "the sums alone", "resolution": "one body, finer and finer", "step": "whole step",
    "lattice": "a region for every particle", "linear": "clusters of linear matching",
    "quadratic": "clusters of quadratic matching", "rigid": "clusters of rigid matching",
    "asymmetric": "not made symmetric", "intersection": "symmetric by intersection", "volume": "masses by volume",
    "plain": "as printed", "fastlsm": "FastLSM", "octree": "octree", "played": "played", "smoothed": "smoothed alone",
    "most_summation": "summation nodes of the region with the most", "summation_nodes": "summation nodes of a region, mean",
    "beyond_percent": "percent of nodes beyond (1 + epsilon) w", "parts": "parts of the body that no region joins",
    "one-bar": "indices with a single bar", "one-plate": "indices with a single plate",
    "w": "w, half the width of a region in cells", "particles": "number of particles", "nodes": "number of nodes",
    "clusters": "number of clusters", "leaves reached": "number of leaves reached", "sag by theory's": "sag over theory's",
    "additions by the paper's": "additions, times the paper's", "tip's sag, mesh units": "sag of the tip at rest, mesh units",
}
UNITS = {"ns/": "nanoseconds a ", "us/": "microseconds a ", "ms/": "milliseconds a "}
CLASSES = {"reproduced": "good", "not reproduced": "bad", "not as set": "bad", "undecided": "open", "differs": "open",
           "BUSY": "open", "INVALID": "invalid"}


def value_text(values):
    """Three a line."""
    texts = [number(v) for v in values]
    return " /\n".join(" / ".join(texts[i:i + 3]) for i in range(0, len(texts), 3))


def with_interval(value, low, high):
    return number(value) + (f" ({number(low)} to {number(high)})" if low == low and high > low else "")


def measured_text(claim):
    values, low, high = (claim[name][:claim["count"]] for name in ("measured", "low", "high"))
    if claim["count"] == 1:
        return with_interval(values[0], low[0], high[0])
    return value_text(values) or "–"


# What a table of each kind says beyond the others, and what stands beneath it.
KINDS = {
    "method": ("Method", "test", lambda claim: claim["test"],
               "What the paper's idea should do anywhere, like compared with like; these alone are reproduced or not. "
               "Undecided: the value is outside of what the test wants and its interval is not. "),
    "machine": ("Machine", "times as fast",
                lambda claim: with_interval(*claim["ratio"]) if claim["ratio"][0] == claim["ratio"][0] else "–",
                "Speeds, as many times as fast as the paper's machine, compiler and program. "),
    "by construction": ("By construction", "not set", lambda claim: number(claim["unset"]),
                        "The scene file sets these numbers, and they are counted; not set is what comes where it does not. "),
}


def kind_table(source, kind):
    title, heading, text, note = KINDS[kind]
    table = Table(f"{title}: claims",
                  ["claim", "verdict", "the paper says, and beneath it why the verdict", "paper", "measured", "unit", heading],
                  note + f"Of {source.name}. Brackets hold 95% confidence intervals.")
    claims = [claim for claim in source.claims if claim["kind"] == kind]
    for claim in claims:
        paper = value_text(claim["paper_value"][:claim["values"]])
        paper = paper + STATUS_MARKS.get(claim["status"], "") if paper else "–"
        why = "" if claim["words"] == claim["test"] else "\n" + claim["words"]
        table.add([f"{claim['paper']} {claim['name']}", claim["verdict"], f"{claim['statement']} ({claim['place']}){why}",
                   paper, measured_text(claim), claim["unit"], text(claim)],
                  CLASSES.get(claim["verdict"], ""))
    table.note += explain_marks(claim["status"] for claim in claims if claim["values"])
    return table


def evidence_table(source):
    table = Table("Where the evidence of each claim is", ["claim", "in the file"], f"Of {source.name}.", folded=True)
    for claim in source.claims:
        evidence = " over ".join(claim[name] for name in ("evidence", "over") if claim[name])
        evidence += f", not set {claim['unset_evidence']}" if claim["unset_evidence"] else ""
        table.add([f"{claim['paper']} {claim['name']}", evidence])
    return table


def claim_tables(source):
    return [kind_table(source, kind) for kind in CLAIM_KINDS
            if any(c["kind"] == kind for c in source.claims)] + [evidence_table(source)]


def summary(source):
    parts = []
    for kind in CLAIM_KINDS:
        verdicts = [claim["verdict"] for claim in source.claims if claim["kind"] == kind]
        count = {verdict: verdicts.count(verdict) for verdict in dict.fromkeys(verdicts)}
        words = ", ".join(f"{verdict} {n}" for verdict, n in sorted(count.items(), key=lambda item: -item[1]))
        if verdicts:
            parts.append(f"{len(verdicts)} {kind} ({words})")
    held = "1 claim of the papers was" if len(source.claims) == 1 else f"{len(source.claims)} claims of the papers were"
    return f"{held} measured ({source.name}): " + "; ".join(parts) + "."


def words(name):
    """A part of a curve's name, or what an axis is named by, for people: "sums, ms/step" is milliseconds a step."""
    if name in WORDS:
        return WORDS[name]
    for unit, text in UNITS.items():
        name = name.replace(unit, text)
    name = re.sub(r"[_|]", " ", name).replace("/", " and ")
    name = re.sub(r"^damping(\d+)$", lambda found: f"damping {int(found[1]) / 100:g}", name)
    return re.sub(r"^w(idth)?(\d+)$", r"w = \2", name)


def label(name, curve):
    """What tells a curve from the others of its group, and the power that fits it."""
    parts = re.sub(r"\.[wn]\d+-\d+\.\d+$", "", name).split(".")[1:]
    own = [words(part.removesuffix("-solid")) for part in parts if part not in ("profile", curve["y_name"])]
    text = ", ".join(own) or words(name.split(".")[0])
    low, high = curve["exponent_low"], curve["exponent_high"]
    if name.startswith(("sums", "size", "body", "distances")) and curve["exponent"] == curve["exponent"]:
        text += f": power {curve['exponent']:.2f} ({low:.2f} to {high:.2f})"
    return text


def kind_of(group):
    """The entry of GROUPS that a group of curves is of."""
    return group if group in GROUPS else group.split("-")[0]


def draw_printed(axes, group, curves):
    """What FastLSM section 3.1 counts for a side s of regions, s^3, 3 s and 6, as lines; of times, in units of fast sums
    at the first width, as its Fig. 4 has them."""
    fast = [curve for name, curve in curves if "naive" not in name and "bars" not in name]
    if kind_of(group) not in ("sums", "body-sums", "body-additions") or not fast:
        return
    unit = 1 if group == "body-additions" else min(curve["y"][0] for curve in fast) / 6
    side = np.geomspace(min(curve["x"][0] for curve in fast), max(curve["x"][-1] for curve in fast), 40)
    for n, additions in enumerate((side**3, 3 * side, np.full_like(side, 6))):
        axes.plot(side, unit * additions, color=PAPER, linewidth=0.9, linestyle="--", zorder=0,
                  label=None if n else "paper: $s^3$, 3s, 6 additions")


def styles(group, curves):
    """Colour and mark of each curve: of sums of bodies a colour each way to sum, and a mark each body."""
    if group != "body-sums":
        return [(COLOURS[n % 7], MARKS[n % 7]) for n in range(len(curves))]
    parts = [name.split(".")[1:3] for name, _ in curves]
    bodies, ways = (list(dict.fromkeys(column)) for column in zip(*parts))
    return [(COLOURS[ways.index(way) % 7], MARKS[bodies.index(body) % 7]) for body, way in parts]


def group_figure(group, curves):
    """`curves` are (name, curve) of one group that have the same axes."""
    title, caption, logarithmic = GROUPS.get(kind_of(group), (words(group).capitalize(), "Measured for a claim.", ""))
    if group.endswith("-profile"):
        title += ": the profile"
    figure, axes = canvas(6.6) if group == "body-sums" else canvas()
    data, told = [], []
    for (name, curve), (colour, mark) in zip(curves, styles(group, curves)):
        x, y = curve["x"], curve["y"]
        spread = np.maximum(np.nan_to_num([y - curve["low"], curve["high"] - y]), 0)
        axes.errorbar(x, y, yerr=spread if spread.any() else None, marker=mark, color=colour,
                      markersize=4, capsize=2, linewidth=1.3, label=label(name, curve))
        data += [[name, float(a), float(b), float(c), float(d)] for a, b, c, d in zip(x, y, curve["low"], curve["high"])]
        told.append(f"{label(name, curve)}: from {number(y[0])} at {number(x[0])} to {number(y[-1])} at {number(x[-1])}")
    draw_printed(axes, group, curves)
    x_name, y_name = (words(curves[0][1][axis]) for axis in ("x_name", "y_name"))
    axes.set_xlabel(x_name)
    axes.set_ylabel(y_name)
    if "x" in logarithmic:
        axes.set_xscale("log")
    elif all((curve["x"] == np.rint(curve["x"])).all() for _, curve in curves):
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if "y" in logarithmic and all((curve["y"] > 0).all() for _, curve in curves):
        axes.set_yscale("log")
    else:
        axes.axhline(0, color=PAPER, linewidth=0.6)
    legend_above(axes, columns=2 if group == "body-sums" or len(curves) < 5 else 5)
    return Figure(group, title, caption, f"{y_name[:1].upper()}{y_name[1:]} against {x_name}. " + "; ".join(told) + ".",
                  ["curve", "x", "y", "low", "high"], data).draw(figure)


def is_part(name, curve, curves):
    """Is a longer curve of the same thing there, over more of w or n? A profile at one w is of another thing."""
    over = r"\.[wn]\d+-\d+\.\d+$"
    stem, parts = re.subn(over, "", name)
    return any(re.subn(over, "", other) == (stem, 1) and longer["valid"] and len(longer["x"]) > len(curve["x"])
               for other, longer in curves.items() if parts)


def figures(source):
    groups = {}
    for name, curve in source.curves.items():
        if not curve["valid"] or len(curve["x"]) < 2 or is_part(name, curve, source.curves):
            continue
        group = name.split(".")[0] + ("-profile" if name.endswith(".profile") else "")
        groups.setdefault((group, curve["x_name"], curve["y_name"]), []).append((name, curve))
    cube = [(f"body-sums.cube.{name[5:]}", curve) for (group, _, _), some in groups.items() if group == "sums"
            for name, curve in some if "lists" not in name and "blocks" not in name]
    for (group, _, _), some in groups.items():
        if group == "body-sums":
            some[:0] = cube
    order = list(GROUPS)
    ranked = sorted(groups, key=lambda g: (order.index(kind_of(g[0])) if kind_of(g[0]) in order else 99, g))
    made = [group_figure(key[0], groups[key]) for key in ranked]
    for (group, x_name, y_name), figure in zip(ranked, made):
        if sum(group == other for other, _, _ in ranked) > 1:
            figure.title += f": {words(y_name)}"
    return made
