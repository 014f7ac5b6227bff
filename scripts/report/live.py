"""The page that runs both engines (scripts/view), packed into a report beside the tables of its scenes."""
import base64
import gzip
import os

HERE = os.path.dirname(os.path.abspath(__file__))
PLACES = (os.path.join(HERE, "..", "page.html"),  # where it is installed
          os.path.join(HERE, "..", "..", "results", "page.html"))
ENGINES = ("fastlsm", "octree")


def packed():
    """The page's bytes, gzip in base64, or None where it is not there."""
    for path in PLACES:
        if os.path.isfile(path):
            with open(path, "rb") as file:
                return base64.b64encode(gzip.compress(file.read(), mtime=0)).decode()
    return None


def scenes(files):
    """Of rows of the page's engines, each name once."""
    return list(dict.fromkeys(row["scene"] for source in files for row in source.rows if row["engine"] in ENGINES))
