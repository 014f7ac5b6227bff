#!/usr/bin/python3
"""Do the tests notice a bound ten times as loose? Mutants of scripts/mutants.txt, compiled in together, run one by one.

usage: mutate.py [PATTERN]     those whose place or text matches the regular expression; default: all
       mutate.py --check       whether each text is found in the tree; builds nothing

The list has sections: a line `FILE: TEST...` names a source and the tests that must fail, cheapest first, each CTest's
PROGRAM or PROGRAM:NAME, of which only the tests like NAME run; its mutants follow, `    OLD => NEW`, expressions both.
OLD is in FILE once; `[[` and `]]` around a part of OLD: only this part is replaced. ` ## WHY` after NEW: no test
can tell it from OLD. The tree with all of them is built in build/mutants/, where `SHAPEBENCH_MUTANT` switches one on.
A test that does not end is one that fails.
Exit codes: 0 at least 95% are killed and each other has its reason; 1 fewer; 2 an error of the list or of building."""
import concurrent.futures
import os
import re
import subprocess
import sys
import time
import zlib
from collections import namedtuple
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIST = ROOT / "scripts" / "mutants.txt"
TREE = ROOT / "build" / "mutants" / "tree"
BUILD = ROOT / "build" / "mutants" / "build"
SHARE = 0.95
HEADER = """#ifndef SM_MUTANT_H
#define SM_MUTANT_H
extern char *getenv(const char *);
extern int atoi(const char *);
static int mutant;
__attribute__((constructor)) static void read_mutant(void)
{
    const char *text = getenv("SHAPEBENCH_MUTANT");
    if (text) mutant = atoi(text);
}
#endif
"""
Mutant = namedtuple("Mutant", "place file tests old new why start end key")


class ListError(Exception):
    pass


def pattern_of(text):
    """Any white space for each."""
    return re.sub(r"(\\\s)+", r"\\s+", re.escape(text))


def find(place, text, old):
    """Start and end of what `old` marks in `text`."""
    before, mark, rest = old.partition("[[")
    marked, _, after = rest.rpartition("]]") if mark else (old, "", "")
    found = list(re.finditer(f"{pattern_of(before if mark else '')}({pattern_of(marked)}){pattern_of(after)}", text))
    if len(found) != 1:
        raise ListError(f"{place}: `{old}` is in the file {len(found)} times, not once: correct the line")
    return found[0].span(1)


def read_list():
    mutants, seen, file, tests, text = [], set(), None, None, ""
    for number, line in enumerate(LIST.read_text().splitlines(), 1):
        place = f"{LIST.name}:{number}"
        if not line.strip() or line.startswith("#"):
            continue
        if not line[0].isspace():
            file, _, tests = line.partition(": ")
            tests = tests.split()
            if not tests or not (ROOT / file).is_file():
                raise ListError(f"{place}: not FILE: TEST..., or no such file: {file}")
            text = (ROOT / file).read_text()
            continue
        old, arrow, rest = line.strip().partition(" => ")
        new, _, why = rest.partition(" ## ")
        if not arrow or file is None:
            raise ListError(f"{place}: not OLD => NEW after a line FILE: TEST...")
        key = zlib.crc32(f"{file} {old} {new}".encode()) >> 2 # an int, the same wherever the line is
        if key in seen or key == 0:
            raise ListError(f"{place}: twice in the list")
        seen.add(key)
        mutants.append(Mutant(place, file, tests, old, new, why, *find(place, text, old), key))
    return mutants


def choose(text, start, end, mutants):
    """text[start:end] with its mutants, which may lie within one another: the outermost first."""
    out, at = "", start
    ordered = sorted(mutants, key=lambda m: (m.start, -m.end))
    while ordered:
        first = ordered[0]
        if first.start < at or any(m.start < first.end < m.end for m in ordered):
            raise ListError(f"{first.place}: overlaps with another mutant; mark the same part of both by [[ and ]]")
        same = [m for m in ordered if (m.start, m.end) == (first.start, first.end)]
        within = [m for m in ordered if m.end <= first.end and m not in same]
        choice = "".join(f"mutant == {m.key} ? ({m.new}) : " for m in same)
        out += f"{text[at:first.start]}({choice}({choose(text, first.start, first.end, within)}))"
        at = first.end
        ordered = [m for m in ordered if m.start >= at]
    return out + text[at:end]


def mutated(file, mutants):
    """The text of `file` with all its mutants."""
    text = (ROOT / file).read_text()
    return f'#include "{TREE}/mutant.h"\n#line 1\n{choose(text, 0, len(text), mutants)}'


def write_tree(mutants):
    """Copies the tree; what has not changed keeps its time, so that only the rest is built again."""
    listed = subprocess.run(["git", "ls-files", "-z", "-c", "-o", "--exclude-standard"], cwd=ROOT, check=True,
                            stdout=subprocess.PIPE, text=True).stdout.split("\0")
    by_file = {}
    for m in mutants:
        by_file.setdefault(m.file, []).append(m)
    files = {name: None for name in listed if name and (ROOT / name).is_file()}
    for name in files:
        data = mutated(name, by_file[name]).encode() if name in by_file else (ROOT / name).read_bytes()
        files[name] = data
    files["mutant.h"] = HEADER.encode()
    for name, data in files.items():
        path = TREE / name
        if not path.is_file() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
            if name in listed:
                path.chmod((ROOT / name).stat().st_mode)
    for path in [p for p in TREE.rglob("*") if p.is_file() and str(p.relative_to(TREE)) not in files]:
        path.unlink() # gone from the tree since


def build(tests):
    for command in (["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                     "-DSHAPEBENCH_NATIVE=ON", "-DSHAPEBENCH_WERROR=OFF"],
                    ["ninja", "-C", BUILD, *sorted({"test_" + test.split(":")[0] for test in tests})]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode:
            raise ListError("\n".join(done.stdout.splitlines()[-40:]) + "\nthe tree with the mutants does not build")


def passes(test, key, limit):
    program, _, name = test.partition(":")
    environment = {**os.environ, "SHAPEBENCH_MUTANT": str(key), "OMP_WAIT_POLICY": "passive"}
    if name:
        environment["SHAPEBENCH_TEST"] = name
    done = subprocess.run(["ctest", "--test-dir", BUILD, "-V", "-R", f"^{program}$", "--timeout", f"{limit:.0f}",
                           "--no-tests=error"], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return done.returncode == 0 and b"***Skipped" not in done.stdout and b"Running 0 test" not in done.stdout


def time_tests(tests):
    """Seconds of each test without a mutant; all must pass."""
    seconds = {}
    for test in tests:
        start = time.monotonic()
        if not passes(test, 0, 600):
            raise ListError(f"{test} fails or is skipped without any mutant: see {BUILD}/Testing")
        seconds[test] = time.monotonic() - start
    return seconds


def killer(mutant, seconds):
    """The test that fails, or None."""
    return next((test for test in mutant.tests if not passes(test, mutant.key, 30 + 10 * seconds[test])), None)


def run(mutants):
    """Prints what becomes of each; returns how many are killed and whether each other has a reason."""
    tests = list(dict.fromkeys(test for m in mutants for test in m.tests))
    build(tests)
    seconds = time_tests(tests)
    killed, explained = 0, True
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for m, by in zip(mutants, pool.map(lambda m: killer(m, seconds), mutants)):
            killed += by is not None
            explained = explained and (by is None) == bool(m.why)
            said = f"killed by {by}" if by else "equivalent" if m.why else "SURVIVED"
            if by and m.why:
                said += ", though said to be equivalent"
            print(f"{said}: {m.place} {m.file}: {m.old} => {m.new}" + (f" ({m.why})" if m.why else ""), flush=True)
    return killed, explained


def main():
    words = sys.argv[1:]
    if len(words) > 1 or words[:1] in (["--help"], ["-h"]):
        print(__doc__)
        return 2
    try:
        mutants = read_list()
        for file in {m.file for m in mutants}:
            mutated(file, [m for m in mutants if m.file == file])
        if words == ["--check"]:
            return 0
        write_tree(mutants)
        chosen = [m for m in mutants if not words or re.search(words[0], f"{m.place} {m.file} {m.old} {m.new}")]
        killed, explained = run(chosen)
    except ListError as error:
        print(f"mutate.py: {error}", file=sys.stderr)
        return 2
    print(f"{killed} of {len(chosen)} killed ({100 * killed / max(len(chosen), 1):.1f}%)")
    return 0 if killed >= SHARE * len(chosen) and explained else 1


if __name__ == "__main__":
    sys.exit(main())
