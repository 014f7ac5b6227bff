#!/usr/bin/python3
"""Tables in Markdown with a column for each instruction set that this processor has, made by the program itself.

usage: by_isa.py SHAPEBENCH times [SCENE...]     one step in ms, and how many times as fast as the paper
       by_isa.py SHAPEBENCH hashes [SCENE...]    `run --hash` of the whole scene on 1, 2 and 3 threads

Default: of times statue-solid, infant and hand-sampled; of hashes all built-in scenes, as many at once as there are
processors, for about ten minutes (half an hour on a busy machine).
Exit codes: 0 done; 1 threads change a hash, or a row is INVALID or BUSY (the table says it); 2 usage; else the
program's."""
import concurrent.futures
import json
import os
import re
import subprocess
import sys
from datetime import date

THREADS = (1, 2, 3)


def run(program, *arguments):
    """What the program prints; INVALID is told by what called it."""
    spin = {"GOMP_SPINCOUNT": "20000", **os.environ}
    done = subprocess.run([program, *arguments], stdout=subprocess.PIPE, text=True, env=spin)
    if done.returncode not in (0, 1):
        sys.exit(done.returncode if done.returncode > 0 else 128 - done.returncode)
    return done.stdout


def write(head, lines):
    print("| " + " | ".join(head) + " |")
    print("| --- |" + " ---: |" * (len(head) - 1))
    for line in lines:
        print("| " + " | ".join(line) + " |")


def where(machine):
    return f"{machine['utc'][:10]}, {machine['cpu']}, {machine['compiler']}"


def times(program, scenes):
    chosen = [word for scene in scenes for word in ("--scene", scene)]
    found = json.loads(run(program, "tables", "--isa", "all", "--format", "json", "--quiet", *chosen))
    machine, rows = found["environment"], found["rows"]
    sets = list(dict.fromkeys(row["isa"] for row in rows))
    print(f"One step, ms, and how many times as fast as the paper, by instruction set: {where(machine)}, "
          f"{machine['threads']} thread.\n")
    cells, right = {}, True
    for row in rows:
        right = right and row["valid"] and not row["busy"]
        scene = row["scene"].removesuffix("-" + row["isa"])
        cell = f"{row['total_ms']:#.3g}" if row["total_ms"] else "BUSY" if row["valid"] else "INVALID"
        if row["ratio"]:
            cell += f" ({row['ratio']:.0f}x)"
        cells.setdefault(scene, [scene, str(row["particles"])]).append(cell)
    write(["scene", "particles", *sets], cells.values())
    return right


def state(program, scene, isa, threads):
    """Steps and hash of a scene's last state."""
    said = run(program, "run", scene, "--hash", "--no-output", "--quiet", "--threads", str(threads), "--isa", isa)
    words = next((line for line in said.splitlines() if line.startswith("state after ")), "").split()
    return (words[2], words[4]) if words else ("-", "INVALID")


def hashes(program, scenes):
    version = run(program, "--version")
    sets = re.sub(r" \(in use\)| \w+ \(not[^)]*\)", "", version.splitlines()[1]).split()[2:]
    cpu = next(line.split(None, 1)[1] for line in run(program, "info").splitlines() if line.split()[:1] == ["processor"])
    print(f"State at the end of each scene (`run --hash`), by instruction set: {version.split()[1]}, {date.today()}, "
          f"{cpu}.\n")
    lines, agree = [], True
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = {(scene, threads, isa): pool.submit(state, program, scene, isa, threads)
                 for scene in scenes for isa in sets for threads in THREADS}
        for scene in scenes:
            by_threads = [[found[scene, threads, isa].result() for isa in sets] for threads in THREADS]
            steps = by_threads[0][0][0]
            same = all(other == by_threads[0] for other in by_threads)
            agree = agree and same and not any(text == "INVALID" for states in by_threads for _, text in states)
            for threads, states in zip(["1, 2, 3"] if same else THREADS, by_threads):
                lines.append([scene, steps, str(threads), *(text for _, text in states)])
    write(["scene", "steps", "threads", *sets], lines)
    return agree


def scenes_of(program):
    """All that are built in, from the list between its heading and an empty line."""
    return [line.split()[0] for line in run(program, "scenes").split("\n\n")[0].splitlines()[1:]]


def main():
    words = sys.argv[1:]
    if len(words) < 2 or words[1] not in ("times", "hashes"):
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    program, what, *scenes = words
    if what == "times":
        return 0 if times(program, scenes or ["statue-solid", "infant", "hand-sampled"]) else 1
    return 0 if hashes(program, scenes or scenes_of(program)) else 1


if __name__ == "__main__":
    sys.exit(main())
