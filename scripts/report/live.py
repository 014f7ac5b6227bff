"""Scenes of a report as cards: a picture of each (scripts/view/pictures), and the page that runs both engines
(scripts/view), packed into the report, which a card opens."""
import base64
import gzip
import os

from drawing import number

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDERS = (os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "results"))  # where it is installed; of the sources


def content(*names):
    """The bytes of a file that comes along with the report, or None where it is not there."""
    for folder in FOLDERS:
        path = os.path.join(folder, *names)
        if os.path.isfile(path):
            with open(path, "rb") as file:
                return file.read()
    return None


def packed():
    """The page's bytes, gzip in base64, or None."""
    page = content("page.html")
    return page and base64.b64encode(gzip.compress(page, mtime=0)).decode()


class Card:
    """A scene's name, its picture's address or None, and its time in words."""

    def __init__(self, scene, row=None):
        picture = content("scenes", scene + ".webp") if scene == os.path.basename(scene) else None
        self.scene, self.picture, self.words = scene, None, ""
        if picture:
            self.picture = "data:image/webp;base64," + base64.b64encode(picture).decode()
        if row and row["valid"] and row["total_ms"] > 0:
            self.words = f"{number(row['total_ms'])} ms a {'frame' if 'elastic' in row else 'step'}"
            if row["paper_total_ms"] > 0:
                self.words += f", the paper {number(row['paper_total_ms'])} ms"


def cards(files):
    """One for each scene that has a row, was swept or calibrated; the first row of several."""
    made = {}
    for source in files:
        for row in source.rows:
            made.setdefault(row["scene"], Card(row["scene"], row))
    for plan in (source.plan for source in files if source.plan):
        made.setdefault(plan["scene"], Card(plan["scene"]))
    return list(made.values())
