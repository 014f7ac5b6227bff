#!/usr/bin/python3
"""The example of continuous integration has commands that exist: programs of scripts/, and the program's commands with
their options and values. What can be tried in seconds runs.

usage: test_ci_example.py PROGRAM     exit codes: 0 passed, 1 failed"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())


def fail(text):
    sys.exit(f"ci-example.yml: {text}")


def commands(text):
    """Each line of shell that starts a program of scripts/, as words up to what the shell does with it."""
    for line in text.splitlines():
        line = re.sub(r" # .*", "", re.sub(r"^\s*(- )?(run: )?", "", line))
        if line.startswith("scripts/"):
            words = shlex.split(line)
            yield words[:next((n for n, word in enumerate(words) if word in ("||", "&&", ";") or word[0] in "<>"), len(words))]


def check(*words):
    """The program takes these words one by one, and then says what it is asked last."""
    done = subprocess.run([PROGRAM, *words, "--help"], capture_output=True, text=True)
    if done.returncode:
        fail(f"{' '.join(words)}: {done.stderr}")


def main():
    text = (ROOT / "scripts" / "ci-example.yml").read_text(encoding="utf-8")
    found = list(commands(text))
    if len(found) < 5:
        fail(f"only {len(found)} commands are found")
    for script, *words in found:
        if not (ROOT / script).is_file():
            fail(f"there is no {script}")
        if script == "scripts/run":
            check(*words)
    names = [words[1] for words in found if words[0] == "scripts/run"]
    if "\t" in text or names[:2] != ["info", "regress"]:
        fail("it is no YAML, or does not compare")
    by = next(words for words in found if "regress" in words)
    if by[by.index("--by") + 1] != "cycles" or "--revision" not in by:
        fail("it does not compare with the base by cycles")
    with tempfile.TemporaryDirectory() as folder:  # on one scene
        for words in (words[1:] for words in found if words[:2] == ["scripts/run", "tables"]):
            words += ["--scene", "penguin", "--repeats", "2", "--block", "0.1"]
            done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True)
            if done.returncode:
                fail(f"{' '.join(words)} ended with {done.returncode}: {done.stderr}")
    try:
        import yaml
    except ImportError:
        print("no python3-yaml: its form was not tested")
        return
    steps = [step for job in yaml.safe_load(text)["jobs"].values() for step in job["steps"]]
    if not all(("run" in step) != ("uses" in step) for step in steps):
        fail("a step neither runs nor uses anything")


main()
