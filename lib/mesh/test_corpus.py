#!/usr/bin/python3
"""Compares what the program and the Python module read from mesh files of every format with what is in them.

usage: test_corpus.py PROGRAM [LIBRARY] [--keep FOLDER] [--only TEXT]

--keep leaves the files and expected.json in FOLDER, for other readers; --only takes the files whose name has TEXT."""
import argparse
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import corpus_files
import corpus_gltf

SECONDS = 60  # limit of one file
COORDINATE = 1e-8  # largest error of the bounding box; bodies are at least 1 wide
VOLUME = 1e-8  # largest relative error: coordinates of 10^7 are rounded to 2e-9
COUNTS = ("triangles", "vertices", "components", "open_edges", "nonmanifold_edges", "flipped_edges", "degenerate", "duplicates")
MAP = ("--map", "--nodes", "60")  # is of points, too, and counts them


def info(program, *words):
    """Returns exit code, standard output and messages of `shapebench info`."""
    done = subprocess.run([program, "info", *words], capture_output=True, text=True, errors="replace", timeout=SECONDS,
                          check=False)
    return done.returncode, done.stdout, re.sub("(?m)^shapebench info: ", "", done.stderr.strip())


def read_by_program(program, path):
    """Returns facts or None, and the refusal; raises ValueError where it neither reads nor refuses."""
    code, output, said = info(program, "--particles", "8", "--format", "json", path)
    rows = json.loads(output or "[]")
    if (code, len(rows)) not in ((0, 1), (3, 0)):
        raise ValueError(f"exit code {code} with {len(rows)} meshes: {said}")
    if not rows and (len(said.splitlines()) != 1 or path not in said):
        raise ValueError(f"the refusal is not one line that names the file: {said!r}")
    return rows[0] if rows else None, said


def python_reader(library):
    """Returns a function like read_by_program(), without `program`."""
    os.environ["SHAPEBENCH_LIBRARY"] = os.path.abspath(library)
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "python"))
    import shapebench

    def read(path):
        try:
            return vars(shapebench.Mesh.load(path).facts()), ""
        except shapebench.Error as error:
            return None, str(error)
    return read


def difference(case, facts, said):
    """Returns what is wrong with a reader's answer, or an empty string."""
    if facts is None:
        if case.wanted and not case.may_refuse:
            return f"refused: {said}"
        return "" if re.search(case.says, said, re.IGNORECASE) else f"lacks '{case.says}': {said}"
    if case.wanted is None:
        return f"must be refused, but has {facts['triangles']} triangles"
    wanted = case.wanted.facts()
    wrong = [name for name in COUNTS if facts[name] != wanted[name]]
    wrong += [name for name in ("low", "high") if any(abs(a - b) > COORDINATE for a, b in zip(facts[name], wanted[name]))]
    if facts["volume"] is None or not abs(facts["volume"] - wanted["volume"]) <= VOLUME * wanted["volume"]:
        wrong.append("volume")
    return "; ".join(f"{name} {facts[name]}, not {wanted[name]}" for name in wrong)


def differences(case, path, program, python):
    """Yields a reader and what it reads wrongly."""
    if case.points:
        code, output, said = info(program, path, *MAP)
        count = re.search(r"(?m)^ *points +(\d+)$", output)
        if int(count[1]) != case.points if code == 0 else code != 3 or not case.may_refuse:
            yield "program", f"{count and count[1]} points, not {case.points}: {said}"
        return
    try:
        facts, said = read_by_program(program, path)
    except (ValueError, subprocess.TimeoutExpired) as error:
        yield "program", str(error)
        return
    yield "program", difference(case, facts, said)
    if facts and case.wanted and case.says and not case.may_refuse and not re.search(case.says, said):
        yield "program", f"says nothing of '{case.says}', which it leaves out"
    if python:
        found, message = python(path)
        yield "Python", difference(case, found, message)
        if not facts and message != said:
            yield "both", f"program and Python differ: {said!r}, {message!r}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("library", nargs="?")
    parser.add_argument("--keep", metavar="FOLDER")
    parser.add_argument("--only", metavar="TEXT", default="")
    options = parser.parse_args()
    cases = [case for case in corpus_files.cases() + corpus_gltf.cases() if options.only in case.name]
    python = None
    if options.library and importlib.util.find_spec("numpy"):
        python = python_reader(options.library)
    else:
        print("skipped: the Python module, without its library or numpy; scripts/setup installs it")
    if info(options.program, "shape:block", *MAP)[0]:
        print("skipped: points, which a program without the solver of maps does not count")
        cases = [case for case in cases if not case.points]
    wrong = set()
    with tempfile.TemporaryDirectory(prefix="shapebench_corpus_") as temporary:
        folder = options.keep or temporary
        corpus_files.write(cases, folder)
        for case in cases:
            for reader, text in differences(case, os.path.join(folder, case.name), options.program, python):
                if text:
                    wrong.add(case.name)
                    print(f"{case.name:44} {reader:8} {text[:400]}")
    print(f"{len(cases)} files, {len(wrong)} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
