#!/usr/bin/python3
"""Films a page that scripts/view/view has made, frame by frame in a browser without a screen: `scripts/run view
SCENE --video FILE` starts it.

usage: film.py PAGE (--video FILE | --picture FILE | --use FILE) [--seconds S] [--size WxH] [--check]

A video is in the simulation's own time, from its start; a picture is the last frame of that. --use films the whole
page with a pointer that pulls and turns a knob: results/page.webp. --check only looks at the command line and for
what is needed. Exit code: 0 done, 2 usage, 3 something is missing or refused, 4 FILE cannot be written."""
import os
import pathlib
import sys

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
import interrupt

if __name__ == "__main__":
    sys.argv[0] = "view"
    interrupt.watch()  # before what takes long to import

import argparse
import base64
import contextlib
import math
import re
import shutil
import subprocess
import tempfile

import draft

# By the name's end: pictures a second at most, and what ffmpeg is told.
EVEN = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=0xF4F5F7", "-pix_fmt", "yuv420p"]
VIDEOS = {
    ".mp4": (60, ["-c:v", "libx264", *EVEN, "-movflags", "+faststart", "-f", "mp4"]),
    ".webm": (60, ["-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", *EVEN, "-f", "webm"]),
    ".gif": (25, ["-filter_complex", "split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none", "-f", "gif"]),
    ".webp": (30, ["-c:v", "libwebp_anim", "-loop", "0", "-q:v", "82", "-f", "webp"]),
}
PICTURES = {".png": "image/png", ".webp": "image/webp"}
USE_SIZE, USE_WIDTH, USE_RATE = (1280, 800), 800, 50 / 3  # the window, and the film of it


USE_TEXT = "text.replace('bend = 0.7', 'bend = 0.0').replace('damping = 0.05', 'damping = 0.1')"  # calm at first


def fail(text, code):
    print(f"{os.path.basename(sys.argv[0])}: {text}", file=sys.stderr)
    sys.exit(code)


class Output(argparse.Action):
    """The file, and which of the three it is."""

    def __call__(self, parser, options, value, option):
        options.output, options.what = value, option[2:]


class Parser(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message}; usage: scripts/run view [SCENE] --video FILE | --picture FILE.png|.webp [--seconds S] "
             "[--size WxH]", 2)


def parse():
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("page")
    what = parser.add_mutually_exclusive_group(required=True)
    for name in ("video", "picture", "use"):
        what.add_argument(f"--{name}", metavar="FILE", dest="output", action=Output)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    ends = PICTURES if options.what == "picture" else VIDEOS
    options.form = os.path.splitext(options.output)[1].lower()
    if options.form not in ends:
        parser.error(f"{options.output}: a {options.what}'s name ends in {' or '.join(ends)}")
    size = re.fullmatch(r"(\d{2,4})x(\d{2,4})", options.size)
    if not size or not all(64 <= int(side) <= 4096 for side in size.groups()):
        parser.error(f"--size {options.size}: wants WxH, each 64 to 4096")
    options.size = tuple(map(int, size.groups()))
    if not 0 <= options.seconds <= 3600:
        parser.error(f"--seconds {options.seconds}: wants 0 to 3600")
    return options


def load_browser(options):
    """The module that starts browsers, where all is there that a film needs."""
    try:
        import browser
    except ImportError as missing:
        package = missing.name if missing.name.startswith("chromium") else "python3-selenium"
        fail(f"a film needs a browser to be driven: apt-get install {package}", 3)
    if options.what != "picture" and not shutil.which("ffmpeg"):
        fail("a video needs ffmpeg: apt-get install ffmpeg", 3)
    return browser


@contextlib.contextmanager
def opened(browser, page, size):
    """The page in a browser whose window has just this size inside; the browser ends with the body."""
    try:
        driver = browser.start(*size, own_session=True)  # Ctrl-C is for us
    except browser.WebDriverException as error:
        fail(f"chromium does not start: {error.msg.strip().splitlines()[0]}", 3)
    try:
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False})
        driver.get(pathlib.Path(page).resolve().as_uri())
        yield lambda body, *values: browser.ask(driver, body, *values), driver
    except (browser.Refused, browser.WebDriverException) as error:
        fail(f"{page}: the page failed in the browser: {str(error).strip().splitlines()[0]}", 3)
    finally:
        driver.quit()


def open_scene(ask, change):
    """Opens the page's scene at its start, as the expression `change` makes it of its `text`."""
    refused = ask("""
await shapebench.ready;
shapebench.pause();
const text = shapebench.text();
const refused = document.getElementById('status').textContent || await shapebench.open(%s, false);
document.getElementById('look').click();
return refused;""" % change)
    if refused:
        fail(f"the page cannot play this scene: {refused}", 3)


def pace(step, most):
    """Of how many frames, each of `step` seconds, one is shown, and how many are shown in a second."""
    every = max(1, math.ceil(1 / (most * step) - 1e-6))
    return every, min(most, max(1, 1 / (every * step)))


# The views alone, side by side in all of the window.
ALONE = """
Object.assign(document.getElementById('views').style, {
    position: 'fixed', inset: 0, zIndex: 1, width: '100vw', height: '100vh', margin: 0, gridTemplateColumns: '1fr 1fr'
});
document.getElementById('look').click();
const figure = (name) => shapebench.engine.figure(shapebench.engine.present()[0], name);
return figure('h') * figure('stepsPerFrame');
"""

# Goes on by some frames; the views then, with their captions.
FRAME = """
shapebench.advance(values[0]);
const { width, height } = document.getElementById('canvas');
window.filmed ??= Object.assign(document.createElement('canvas'), { width, height });
shapebench.copyViews(window.filmed);
return window.filmed.toDataURL(values[1], 0.6).split(',')[1];
"""


def view_frames(ask, every, count):
    """PNGs of the views, from the scene's start."""
    for n in range(count):
        yield base64.b64decode(ask(FRAME, every if n else 0, PICTURES[".png"]))


class Pointer:
    """A mouse that is seen."""

    DRAW = """
let arrow = document.getElementById('arrow');
if (!arrow) {
    document.body.insertAdjacentHTML('beforeend', `<svg id="arrow" width="34" height="42" viewBox="-10 -10 34 42"
        style="position: fixed; z-index: 9; pointer-events: none"><circle r="9" fill="#f0e442" fill-opacity="0.6"/>
        <path d="M0 0v22l5-5 4 9 4-2-4-8h7z" fill="#111" stroke="#fff" stroke-width="1.5"/></svg>`);
    arrow = document.getElementById('arrow');
}
Object.assign(arrow.style, { left: `${values[0] - 10}px`, top: `${values[1] - 10}px` });
arrow.firstElementChild.setAttribute('r', values[2] ? 9 : 0);
"""

    def __init__(self, ask, driver, at):
        self.ask, self.driver, self.at, self.down = ask, driver, at, False

    def send(self, kind):
        self.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": self.at[0], "y": self.at[1], "clickCount": 1, "button": "left" if self.down else "none",
            "buttons": int(self.down)})
        self.ask(self.DRAW, *self.at, self.down)

    def press(self):
        self.down = True
        self.send("mousePressed")

    def release(self):
        self.send("mouseReleased")
        self.down = False
        self.send("mouseMoved")

    def glide(self, to, frames):
        """Goes there smoothly, a step before each frame."""
        start = self.at
        for n in range(1, frames + 1):
            share = (1 - math.cos(math.pi * n / frames)) / 2
            self.at = tuple(a + share * (b - a) for a, b in zip(start, to))
            self.send("mouseMoved")
            yield


# Where the highest point of a side's body is in the window, a little inside.
TIP = """
const { points } = shapebench.engine.surface(values[0]);
let top = 0;
for (let v = 0; v < points.length / 3; v++) if (points[3 * v + 1] > points[3 * top + 1]) top = v;
const at = shapebench.project(values[0], top);
const canvas = document.getElementById('canvas'), box = canvas.getBoundingClientRect();
const scale = box.width / canvas.width;
return [box.left + at.x * scale, box.top + at.y * scale + 6];
"""

# Where the thumb of a slider is in the window at a value.
THUMB = """
const slider = document.getElementById(values[0]), box = slider.getBoundingClientRect();
const share = (values[1] - slider.min) / (slider.max - slider.min);
return [box.left + 8 + share * (box.width - 16), box.top + box.height / 2];
"""


def use(ask, pointer):
    """What is done on the page; after each step it is filmed."""
    def wait(frames):
        yield from (None for _ in range(frames))

    def pull(side, *ways):
        yield from pointer.glide(ask(TIP, side), 10)
        pointer.at = tuple(ask(TIP, side))
        pointer.press()
        for x, y in ways:
            yield from pointer.glide((pointer.at[0] + x, pointer.at[1] + y), 11)
        pointer.release()
        yield from wait(18)

    yield from wait(4)
    yield from pull(0, (75, 60), (-150, 25))
    yield from pointer.glide(ask(THUMB, "knob-w", 2), 8)
    pointer.press()
    yield from pointer.glide(ask(THUMB, "knob-w", 4), 6)
    pointer.release()
    ask("while (!shapebench.text().includes('w = 4;')) await new Promise((done) => setTimeout(done, 50))")
    yield from pull(1, (-60, 50), (130, -10))


def use_frames(ask, driver, every):
    """PNGs of the whole page in use. advance() pauses it, which it does not say here."""
    pointer = Pointer(ask, driver, (60, 420))
    for _ in use(ask, pointer):
        ask("shapebench.advance(values[0]); document.getElementById('pause').textContent = 'Pause'", every)
        yield driver.get_screenshot_as_png()


def encode(frames, file, form, rate, width=None):
    """PNGs into an open file, by ffmpeg."""
    told = list(VIDEOS[form][1])
    if width:
        told = ["-vf", f"scale={width}:-1:flags=lanczos", *told]
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "image2pipe", "-c:v", "png", "-framerate", f"{rate:.9g}",
               "-i", "pipe:0", *told, "-fflags", "+bitexact", f"/dev/fd/{file.fileno()}"]
    with tempfile.TemporaryFile() as log, contextlib.ExitStack() as ended:
        ffmpeg = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=log, pass_fds=[file.fileno()],
                                  start_new_session=True)  # Ctrl-C is for us
        ended.callback(lambda: (ffmpeg.kill(), ffmpeg.wait()))
        with contextlib.suppress(BrokenPipeError):  # it says why
            for frame in frames:
                ffmpeg.stdin.write(frame)
        with contextlib.suppress(BrokenPipeError):
            ffmpeg.stdin.close()
        if ffmpeg.wait():
            log.seek(0)
            said = log.read().decode("utf-8", "replace").strip().split("\n")[-1]
            raise draft.Refused(f"{file.name}: ffmpeg failed: {said or f'exit code {ffmpeg.returncode}'}")


def counted(frames, count):
    """The frames, with how far they are on a terminal."""
    for n, frame in enumerate(frames, 1):
        if sys.stderr.isatty():
            print(f"\rframe {n}{f' of {count}' if count else ''} ", end="", file=sys.stderr, flush=True)
        yield frame
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr, flush=True)


def write(options, browser, file):
    """Fills the file; what it is, in words."""
    size = USE_SIZE if options.what == "use" else options.size
    with opened(browser, options.page, size) as (ask, driver):
        open_scene(ask, USE_TEXT if options.what == "use" else "text")
        if options.what == "use":
            encode(counted(use_frames(ask, driver, 3), None), file, options.form, USE_RATE, USE_WIDTH)
            return "the page in use"
        step = ask(ALONE)
        if options.what == "picture":
            frames = round(options.seconds / step)
            for _ in range(frames // 25):  # each call has its limit of time
                ask("shapebench.advance(25)")
            file.write(base64.b64decode(ask(FRAME, frames % 25, PICTURES[options.form])))
            return f"the views after {frames * step:.4g} s"
        every, rate = pace(step, VIDEOS[options.form][0])
        count = max(1, round(options.seconds * rate))
        encode(counted(view_frames(ask, every, count), count), file, options.form, rate)
        return f"{count} pictures, {rate:.4g} a second"


def main():
    options = parse()
    browser = load_browser(options)
    try:
        if options.check:
            draft.check(options.output, True)
            if not os.access(os.path.dirname(os.path.abspath(options.output)), os.W_OK):
                raise draft.Refused(f"{options.output}: cannot be written: name a file in a folder of yours")
            return
        with draft.begun(options.output, True) as file:
            what = write(options, browser, file)
    except draft.Refused as error:
        fail(str(error), 4)
    except OSError as error:
        fail(f"{options.output}: cannot be written: {error.strerror}", 4)
    print(f"wrote {options.output}: {what}")


if __name__ == "__main__":
    main()
