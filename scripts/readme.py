#!/usr/bin/python3
"""Measures the tables of the documents anew, each by the command that stands above it, <!-- table: COMMAND -->.

usage: readme.py [WORD...]     only tables whose command has one of these words

Leave the machine alone meanwhile, some five minutes; the table of scripts/check_systems.sh takes an hour more,
as root. What is INVALID or BUSY is not taken: the table stays as it was.
Exit codes: 0 done; 1 a table stays; 2 usage."""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENTS = ("README.md", "bench/README.md")
TABLE = re.compile(r"(<!-- table: ([^\n]*) -->\n)(.*?)(<!-- end of table -->)", re.DOTALL)


def main(words):
    if any(word.startswith("-") for word in words):
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    stays = 0

    def measured(table):
        nonlocal stays
        mark, command, _, end = table.groups()
        if words and not any(word in command.split() for word in words):
            return table[0]
        print(f"readme.py: {command}", file=sys.stderr)
        made = subprocess.run(command.split(), stdout=subprocess.PIPE, text=True, cwd=ROOT)
        if made.returncode or re.search("INVALID|BUSY", made.stdout):
            print(f"readme.py: not taken (exit code {made.returncode}):\n{made.stdout}", file=sys.stderr)
            stays += 1
            return table[0]
        return mark + made.stdout + end

    for name in DOCUMENTS:
        file = ROOT / name
        text = TABLE.sub(measured, file.read_text())
        draft = file.with_suffix(".tmp")
        draft.write_text(text)
        os.replace(draft, file)
    return 1 if stays else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
