"""What the papers print, from reference/papers.cfg, and result files do not have."""
import os
import re

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDERS = (os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "reference"))  # where it is installed; of the sources


def read():
    """Nothing where the file is not there."""
    path = next((path for path in (os.path.join(folder, "papers.cfg") for folder in FOLDERS) if os.path.isfile(path)), None)
    if not path:
        return ""
    with open(path, encoding="utf-8") as file:
        return file.read()


def rows():
    """Values and their statuses by name, of each row by its paper and scene."""
    found = {}
    for row in re.findall(r"^  \{\n(.*?)^  \}", read().partition("\nclaims = (\n")[0], re.DOTALL | re.MULTILINE):
        paper, scene = re.match(r'\s*paper = "([^"]*)"; scene = "([^"]*)";', row).groups()
        values = re.findall(r'(\w+) = \(([-+.\deE]+), "([a-z-]+)"\)', row)
        found[paper, scene] = {name: (float(value), status) for name, value, status in values}
    return found


def number(paper, name):
    """A number outside the rows, or None."""
    found = re.search(rf'\{{ paper = "{paper}"; name = "{name}"; value = \(([-+.\deE]+),', read())
    return float(found[1]) if found else None
