"""What plot_sweep.py, plot_map.py, plot_calibration.py, plot_convergence.py and render.py share: how
they are called, read and write, and end."""

import os
import sys

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "report"))
import interrupt

interrupt.watch()  # before what takes long to import

import argparse
import contextlib


def fail(text, code):
    print(f"{os.path.basename(sys.argv[0])}: {text}", file=sys.stderr)
    sys.exit(code)


try:
    import draft
    import sources
    import stored
except ImportError as missing:
    fail(f"{missing}: scripts/setup installs it (python3-h5py)", 3)


def parse(says, what, form, several=False):
    """The command line of a script: `says` is its docstring, `what` its file is, `form` ("svg") the usual output's;
    of several, `files` are all, and `file` the first."""
    parser = argparse.ArgumentParser(description=says.split("\n\n")[0])
    parser.add_argument("files", metavar="file", nargs="+" if several else 1, help=what)
    parser.add_argument("-o", "--output", help=f"SVG, PNG or PDF to write (default: FILE.{form})")
    parser.add_argument("--overwrite", action="store_true", help="replace a picture that is there")
    arguments = parser.parse_args()
    arguments.file = arguments.files[0]
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


def engines(column):
    """Of points: whether it has an epsilon, and the name, of each engine; those without come first."""
    return sorted(set(zip(column["sampled"].tolist(), column["engine"].tolist())))


def drawing():
    """matplotlib's pyplot, without a display; only now, because it takes a second."""
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError as missing:
        fail(f"{missing}: scripts/setup installs it (python3-matplotlib)", 3)
    return pyplot


@contextlib.contextmanager
def opened(path):
    """The file for `with`, where it is whole (stored.py); with what is wrong in it the script ends."""
    try:
        with stored.opened(path, stored.print_remark) as file:
            yield file
    except stored.Unusable as error:
        fail(error, 3)


def write(figure, output, overwrite, **how):
    """The figure's file, whole or not at all. `how` is of savefig()."""
    form = os.path.splitext(output)[1][1:]
    try:
        with draft.begun(output, overwrite) as file:
            figure.savefig(file, **{"dpi": 130, "format": form or "png", **how})
    except draft.Refused as error:
        fail(error, 4)
    except (OSError, ValueError) as error:
        fail(f"{output}: cannot be written: {getattr(error, 'strerror', None) or error}", 4)
    print(f"wrote {output}")
