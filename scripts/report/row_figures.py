"""Figures of measured rows (`shapebench tables -o`): shares of stages, times beside the papers', frames of
scenes that change, and threads."""
import numpy as np

import papers
from drawing import COLOURS, MARKS, PAPER, STATUS_MARKS, Figure, canvas, legend_above, number
from tables import explain_marks, of_stages, scenes_of, stage_names

STAGE_TITLES = {"fast_sum": "fast sum", "shape_matching": "shape matching", "polar": "polar decomposition",
                "damping": "damping", "other": "other"}


def valid(rows):
    return [row for row in rows if row["valid"] and row["total_ms"] > 0]


def share_bars(axes, y, values, height, alpha, statuses=()):
    left = 0.0
    for s, value in enumerate(values):
        axes.barh(y, value, height, left=left, color=COLOURS[s % len(COLOURS)], alpha=alpha)
        left += value
    for s, status in enumerate(statuses):
        axes.text(sum(values[:s]) + values[s] / 2, y, STATUS_MARKS.get(status, ""), ha="center", va="center", fontsize=9)


def thirds_bar(axes, y, stages, third):
    """What the octree paper says of its examples; the stages of its first third are one above the other."""
    for left, names in ((0, ("fast_sum", "shape_matching")), (third, ("polar",)), (2 * third, ("damping",))):
        height = 0.2 / len(names)
        for n, name in enumerate(names):
            axes.barh(y - 0.1 + (n + 0.5) * height, third, height, left=left, color=COLOURS[stages.index(name)], alpha=0.45)
    return [third if name in ("polar", "damping") else None for name in stages]


def stage_shares(rows):
    """Percent of a step in each stage; the paper's beneath, pale."""
    rows = valid(rows)
    if not rows:
        return None
    stages = stage_names(rows)
    figure, axes = canvas(1 + 0.36 * len(rows))
    data, shown, marked, thirds = [], [], [], False
    third = papers.number("octree", "hand-third")
    for y, row in enumerate(rows):
        shares = 100 * np.array(of_stages(row, "stage_ms", stages, 0.0)) / row["total_ms"]
        share_bars(axes, y - 0.13, shares, 0.42, 1)
        data.append([row["scene"], "measured"] + [float(v) for v in shares] + [""])
        paper = np.array(of_stages(row, "paper_stage_percent", stages))
        if np.isfinite(paper).any():
            statuses = of_stages(row, "paper_stage_statuses", stages, "")
            share_bars(axes, y + 0.25, np.nan_to_num(paper), 0.2, 0.45, statuses)
            data.append([row["scene"], "paper"] + [None if v != v else float(v) for v in paper]
                        + [" ".join(statuses)])
            shown += statuses
            marked += [f"the paper's {STAGE_TITLES.get(s, s)} of {row['scene']} ({STATUS_MARKS[status]})"
                       for s, status in zip(stages, statuses) if status in STATUS_MARKS]
        elif third and row["paper"] == row["engine"] == "octree":
            data.append([row["scene"], "paper"] + thirds_bar(axes, y + 0.25, stages, third) + [""])
            thirds = True
    axes.set_yticks(range(len(rows)), [row["scene"] for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(0, 100)
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("percent of a step")
    legend_above(axes, [axes.barh(0, 0, color=COLOURS[s % len(COLOURS)]) for s in range(len(stages))],
                 [STAGE_TITLES.get(s, s) for s in stages])
    most = [row["stage_names"][int(np.argmax(row["stage_ms"]))] for row in rows]
    largest = [f"{row['scene']}: {STAGE_TITLES.get(name, name)} most" for row, name in zip(rows, most)]
    return Figure("stage-shares", "Where a step's time goes",
                  "Share of each stage in a step; thin pale bars are the paper's, where it gives them."
                  + (" The octree paper's are thirds, of its hand and roughly of its other examples, without low-level "
                     "optimisation: fast sums with shape matching (together), polar decompositions, and damping." if thirds else "") + explain_marks(shown),
                  "Stacked bars, one for each scene. " + "; ".join(largest + marked) + ".",
                  ["scene", "source"] + [s + "_percent" for s in stages] + ["statuses"], data).draw(figure)


def beside_paper(rows):
    """ns per particle and step, and the paper's."""
    rows = valid(rows)
    if not any(row["paper_ns"] > 0 for row in rows):
        return None
    figure, axes = canvas(1 + 0.3 * len(rows))
    data = []
    for y, row in enumerate(rows):
        ns, paper = row["ns_per_particle_step"], row["paper_ns"]
        if paper == paper:
            axes.plot([ns, paper], [y, y], color="#cccccc", linewidth=1.5, zorder=1)
            axes.plot(paper, y, "D", color=PAPER, markersize=5)
            axes.annotate(STATUS_MARKS.get(row["paper_status"], ""), (paper, y), xytext=(5, 0), textcoords="offset points",
                          va="center")
        axes.plot(ns, y, "o", color=COLOURS[0])
        data.append([row["scene"], ns, None if paper != paper else paper, row["paper_status"]])
    axes.set_xscale("log")
    axes.set_yticks(range(len(rows)), [row["scene"] for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel("nanoseconds per particle and step (logarithmic)")
    legend_above(axes, [axes.plot([], [], "o", color=COLOURS[0])[0], axes.plot([], [], "D", color=PAPER, markersize=5)[0]],
                 ["measured here", "the paper, its machine"])
    times = [f"{scene} {number(ns)} against {number(paper)}{STATUS_MARKS.get(status, '')}"
             for scene, ns, paper, status in data if paper]
    return Figure("beside-paper", "Cost of a particle and step",
                  "Median of this run beside what the paper's table gives for its own processor and "
                  "particles." + explain_marks(line[3] for line in data),
                  "Dots on a logarithmic scale of nanoseconds: " + "; ".join(times) + ".",
                  ["scene", "ns_per_particle_step", "paper_ns_per_particle_step", "paper_status"], data).draw(figure)


def frames(row):
    """What each frame of a scene that changes cost."""
    time = row["frames_samples"] * 1e3
    figure, axes = canvas(3.8)
    names = ["simulation", "resampling", "splitting of surfaces", "moving a surface"]
    count = np.arange(1, len(time) + 1)
    for part, name in enumerate(names):
        shown = np.where(time[:, part] > 0, time[:, part], np.nan)
        axes.plot(count, shown, "-" if part in (0, 3) else MARKS[part], markersize=3, linewidth=1.2, label=name)
    axes.set_yscale("log")
    axes.set_xlabel("frame of the scene")
    axes.set_ylabel("milliseconds a frame (logarithmic)")
    legend_above(axes)
    return Figure(f"frames-{row['scene']}", f"Frames of {row['scene']}",
                  f"{row['change.changed']} of {len(time)} frames change the body; resampling in others finds nothing to "
                  "change. Each time is the least of three rounds.",
                  f"Curves over {len(time)} frames: simulation takes {number(row['change.first_ms'])} ms before the "
                  f"first change and {number(row['change.last_ms'])} ms after the last; resampling "
                  f"{number(row['change.change_ms'])} ms at the median and {number(row['change.change_most_ms'])} ms "
                  "at most, in frames that change.",
                  ["frame"] + [name.replace(" ", "_") + "_ms" for name in names],
                  [[int(n)] + [float(v) for v in line] for n, line in zip(count, time)]).draw(figure)


def key(row):
    return row["scene"], row["engine"], row["precision"]


def threads(sources):
    """Steps a second against threads, of scenes measured with several numbers of them."""
    best = {}
    for source in sources:
        for row in valid(source.rows):
            best.setdefault((source.machine.get("cpu"), source.commit) + key(row), {})[row["threads"]] = row["total_ms"]
    curves = {name: sorted(times.items()) for name, times in best.items() if len(times) > 1}
    if not curves:
        return None
    figure, axes = canvas(3.6)
    data = []
    for n, (name, times) in enumerate(sorted(curves.items(), key=str)):
        count = [t for t, _ in times]
        gain = [times[0][1] * times[0][0] / ms for _, ms in times]
        axes.plot(count, gain, marker=MARKS[n % 7], color=COLOURS[n % 7], label=name[2])
        data += [[name[2], name[3], t, ms, g] for (t, ms), g in zip(times, gain)]
    most = max(line[2] for line in data)
    axes.plot([1, most], [1, most], color=PAPER, linestyle=":", label="as many times as threads")
    axes.set_xticks(sorted({line[2] for line in data}))
    axes.set_xlabel("threads")
    axes.set_ylabel("times as fast as with the fewest threads")
    legend_above(axes)
    words = [f"{scene} {number(gain)} times as fast with {t}" for scene, _, t, _, gain in data if t > 1]
    return Figure("threads", "Threads", "Medians of a step, of rows that several files hold with different threads.",
                  "; ".join(words) + ".", ["scene", "engine", "threads", "total_ms", "gain"], data).draw(figure)


def all_figures(sources):
    made = []
    for source in sources:
        group = [row for row in source.rows if "elastic" not in row]
        for make in (beside_paper, stage_shares):
            figure = make(group)
            if figure:
                figure.title += f": {scenes_of(source)}"
                made.append(figure)
        made += [frames(row) for row in valid(group) if "frames_samples" in row]
    made += [figure for figure in [threads(sources)] if figure]
    return made
