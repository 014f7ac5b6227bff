#!/usr/bin/python3
"""From result files to one page that can be sent to a colleague: `shapebench report` starts it.

usage: main.py [--title TEXT] [--overwrite] [--no-page] [--program PATH] -o NAME.html|FOLDER FILE.h5...

NAME.html is one file with everything in it; anything else is a folder with index.html, and every figure
as SVG, PNG and CSV. Exit code: 0 done, 2 usage, 3 a file cannot be used, 4 cannot be written."""
import sys

import interrupt

if __name__ == "__main__":
    sys.argv[0] = "shapebench report"
    interrupt.watch()  # before what takes long to import

import argparse
import base64
import os
import shutil
import tempfile


def fail(text, code):
    print(f"shapebench report: {text}", file=sys.stderr)
    sys.exit(code)


try:
    import jinja2
    from markupsafe import Markup

    import alternatives
    import calibration_figures
    import claim_figures
    import draft
    import headline
    import history
    import live
    import row_figures
    import sources
    import sweep_figures
    import tables
except ImportError as error:
    fail(f"{error} (for {sys.executable}): scripts/setup run, or apt-get install python3-jinja2 python3-h5py "
         "python3-matplotlib", 3)

MADE_BY = "Made by shapebench report from"
HERE = os.path.dirname(os.path.abspath(__file__))


class Part:
    """A section of the page; `cards` are of scenes, which can be opened live."""

    def __init__(self, id, title, sentences=(), tables=(), figures=(), cards=()):
        self.id, self.title, self.cards = id, title, list(cards)
        self.sentences, self.tables, self.figures = list(sentences), list(tables), list(figures)


def scenes_part(files):
    cards = live.cards(files)
    return Part("scenes", "The scenes", cards=cards) if cards else None


def measured_part(files):
    rows = [row for source in files for row in source.rows]
    if not rows:
        return None
    return Part("measured", "Measured beside the papers", headline.validity(rows), tables.all_tables(files),
                row_figures.all_figures(files))


def history_part(program, past):
    if not past:
        return None
    return Part("history", "From file to file", history.sentences(past), [history.side_by_side(program, past)],
                [history.figure(past)])


def claims_part(files):
    files = [source for source in files if source.claims]
    if not files:
        return None
    return Part("claims", "What the papers claim", map(claim_figures.summary, files),
                [table for source in files for table in claim_figures.claim_tables(source)],
                [figure for source in files for figure in claim_figures.figures(source)])


def sweeps_part(files):
    files = [source for source in files if source.point]
    if not files:
        return None
    return Part("sweeps", "Which w, which epsilon", map(sweep_figures.summary, files),
                map(sweep_figures.front_table, files),
                [figure for source in files for figure in sweep_figures.figures(source)])


def calibrations_part(files):
    files = [source for source in files if source.specimen]
    if not files:
        return None
    return Part("calibrations", "Which elastic body", map(calibration_figures.summary, files),
                [table(source) for source in files
                 for table in (calibration_figures.law_table, calibration_figures.grid_table)],
                [figure for source in files for figure in calibration_figures.figures(source)])


def baselines_part(files):
    files = [source for source in files if source.method]
    if not files:
        return None
    return Part("baselines", "What one would take instead", (text for source in files for text in alternatives.summary(source)),
                map(alternatives.table, files))


def compose(program, files):
    """What was found, in sentences, and the sections."""
    past = history.read(files)
    if past:
        files = [source for source in files if source not in history.superseded(past)]
    parts = [scenes_part(files), measured_part(files), history_part(program, past), baselines_part(files), claims_part(files),
             sweeps_part(files), calibrations_part(files), Part("environment", "Where and how", tables=tables.environment(files))]
    return headline.found(program, files, past), [part for part in parts if part]


def summary(files):
    days = sorted({source.machine.get("utc", "")[:10] for source in files} - {""})
    when = "" if not days else f", {days[0]}" if days[0] == days[-1] else f", {days[0]} to {days[-1]}"
    return f"Shape-matching deformation on {tables.joined(headline.processors(files))}{when}."


def read_text(name):
    with open(os.path.join(HERE, name), encoding="utf-8") as file:
        return Markup(file.read())


class Page:
    """What every form of the report has: its title, the live page or None, files, headline and sections."""

    def __init__(self, title, packed, files, found, parts):
        self.title, self.packed, self.files, self.found, self.parts = title, packed, files, found, parts


def render(page, picture, data_link):
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE), autoescape=True,
                                     undefined=jinja2.StrictUndefined)
    return environment.get_template("page.html").render(
        title=page.title, made_by=MADE_BY, summary=summary(page.files), style=read_text("style.css"), found=page.found,
        parts=page.parts, picture=picture, data_link=data_link, live=page.packed, script=read_text("live.js"),
        contents=[(part.id, part.title) for part in page.parts], files=[source.name for source in page.files])


def inline(figure):
    """The SVG in the page itself, named for those who cannot see it."""
    text = figure.svg.decode()
    text = text[text.index("<svg"):]
    label = Markup.escape(figure.alternative)
    return Markup(text.replace("<svg", f'<svg role="img" aria-label="{label}"', 1))


def inline_data(figure):
    return "data:text/csv;charset=utf-8;base64," + base64.b64encode(figure.csv().encode()).decode()


def linked(figure):
    label = Markup.escape(figure.alternative)
    return Markup(f'<img src="{figure.name}.svg" alt="{label}" loading="lazy">')


def write_file(path, content):
    with open(path, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def write_page(output, page, overwrite):
    """One file, whole or not at all."""
    with draft.begun(output, overwrite) as file:
        file.write(render(page, inline, inline_data).encode())


def may_replace(folder):
    """Is the folder empty, or a report with nothing else in it? A report takes its place, and it goes."""
    if not os.path.isdir(folder) or os.path.islink(folder):
        return False
    names = os.listdir(folder)
    if any(name != "index.html" and os.path.splitext(name)[1] not in (".svg", ".png", ".csv") for name in names):
        return False
    if "index.html" not in names:
        return not names
    with open(os.path.join(folder, "index.html"), encoding="utf-8", errors="replace") as file:
        return MADE_BY in file.read()


def take_place(draft, output):
    """The draft in the output's place. What was there goes last: if anything fails before, it is there again."""
    if not os.path.isdir(output):
        os.rename(draft, output)
        return
    old = draft[:-len(".tmp")] + ".old"
    os.rename(output, old)
    try:
        os.rename(draft, output)
    except BaseException:
        os.rename(old, output)
        raise
    shutil.rmtree(old, ignore_errors=True)


def check_folder(output, overwrite):
    if os.path.lexists(output) and not may_replace(output):
        raise draft.Refused(f"{output}: cannot be written: it is there and is no report; choose another name")
    if os.path.lexists(output) and os.listdir(output) and not overwrite:
        raise draft.Refused(f"{output}: cannot be written: it is there; choose another name, or give --overwrite")


def write_folder(output, page, overwrite):
    """A folder of a page and its figures, in place of an older report of that name."""
    check_folder(output, overwrite)
    parent = os.path.dirname(os.path.abspath(output))
    made = tempfile.mkdtemp(prefix=os.path.basename(output) + ".", suffix=".tmp", dir=parent)
    try:
        os.chmod(made, 0o755)
        for figure in (figure for part in page.parts for figure in part.figures):
            for form, content in (("svg", figure.svg), ("png", figure.png), ("csv", figure.csv().encode())):
                write_file(os.path.join(made, f"{figure.name}.{form}"), content)
        text = render(page, linked, lambda figure: f"{figure.name}.csv")
        write_file(os.path.join(made, "index.html"), text.encode())
        take_place(made, output)
    except BaseException:
        shutil.rmtree(made, ignore_errors=True)
        raise


def parse():
    parser = argparse.ArgumentParser(prog="shapebench report", description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="+", help="files that `shapebench tables`, `claims`, `sweep` and `calibrate` "
                        "and baselines.py wrote with -o")
    parser.add_argument("-o", "--output", default="report.html",
                        help="a page NAME.html, or a folder (default: %(default)s)")
    parser.add_argument("--overwrite", action="store_true", help="replace a page or report that is there")
    parser.add_argument("--title", default="shapebench report")
    parser.add_argument("--no-page", action="store_true", help="leave out the live page, 2.8 MB")
    parser.add_argument("--program", default="shapebench", help="which compares files (default: %(default)s)")
    parser.add_argument("--quiet", action="store_true")
    return parser.parse_args()


def unique_names(parts):
    """No two figures share a name, and so a file."""
    seen = {}
    for figure in (figure for part in parts for figure in part.figures):
        seen[figure.name] = seen.get(figure.name, 0) + 1
        if seen[figure.name] > 1:
            figure.name += f"-{seen[figure.name]}"


def find_page(options, parts):
    """The live page, packed, where there are scenes to open and nobody leaves it out."""
    if options.no_page or not any(part.cards for part in parts):
        return None
    packed = live.packed()
    if not packed:
        print("shapebench report: there is no page.html, so scenes cannot be opened in the report: "
              "scripts/run view hand -o results/page.html makes it", file=sys.stderr)
    return packed


def main():
    options = parse()
    output = options.output.rstrip("/") or "/"
    alone = output.endswith(".html")
    check = draft.check if alone else check_folder
    try:
        check(output, options.overwrite)
        files = [sources.read(path) for path in options.file]
    except draft.Refused as error:
        fail(str(error), 4)
    except sources.Unusable as error:
        fail(str(error), 3)
    try:
        found, parts = compose(options.program, files)
    except sources.Unusable as error:
        fail(str(error), 3)
    unique_names(parts)
    write = write_page if alone else write_folder
    try:
        write(output, Page(options.title, find_page(options, parts), files, found, parts), options.overwrite)
    except draft.Refused as error:
        fail(str(error), 4)
    except OSError as error:
        fail(f"{output}: cannot be written: {error.strerror}", 4)
    if not options.quiet:
        print(f"wrote {output if alone else os.path.join(output, 'index.html')}")


if __name__ == "__main__":
    main()
