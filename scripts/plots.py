"""What plot_sweep.py, plot_slice.py, plot_calibration.py and render.py share: how they are called, read and write,
and end."""

import os
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "report"))
import interrupt

interrupt.watch()  # before what takes long to import

import argparse


def fail(text, code):
    print(f"{os.path.basename(sys.argv[0])}: {text}", file=sys.stderr)
    sys.exit(code)


try:
    import sources
except ImportError as missing:
    fail(f"{missing}: scripts/setup installs it (python3-h5py)", 3)

LATTICE, OCTREE = "fastlsm", "octree"


def parse(says, what, form):
    """The command line of a script: `says` is its docstring, `what` its file is, `form` ("svg") the usual output's."""
    parser = argparse.ArgumentParser(description=says.split("\n\n")[0])
    parser.add_argument("file", help=what)
    parser.add_argument("-o", "--output", help=f"SVG, PNG or PDF to write (default: FILE.{form})")
    arguments = parser.parse_args()
    arguments.output = arguments.output or f"{os.path.splitext(arguments.file)[0]}.{form}"
    return arguments


def read(path, what):
    """The file of a sweep or calibration (`what`) as a report reads it, whole or not at all."""
    try:
        source = sources.read(path)
    except sources.Unusable as error:
        fail(error, 3)
    if source.kind != f"shapebench {what}":
        fail(f"{path}: not the file of a {what}", 3)
    return source


def drawing():
    """matplotlib's pyplot, without a display; only now, because it takes a second."""
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError as missing:
        fail(f"{missing}: scripts/setup installs it (python3-matplotlib)", 3)
    return pyplot


def write(figure, output, **how):
    """The figure's file, whole or not at all. `how` is of savefig()."""
    name, form = os.path.splitext(output)
    draft = f"{name}.{os.getpid()}.tmp{form}"
    try:
        try:
            figure.savefig(draft, **{"dpi": 130, **how})
            os.replace(draft, output)
        finally:
            if os.path.exists(draft):
                os.remove(draft)
    except (OSError, ValueError) as error:
        fail(f"{output}: cannot be written: {getattr(error, 'strerror', None) or error}", 4)
    print(f"wrote {output}")
