"""Films: the last seconds that the page keeps, and those that are made frame by frame without a screen."""
import base64
import glob
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import urllib.parse

import film
from page_case import HERE, PageCase

FFMPEG = shutil.which("ffmpeg")


def ffmpeg(*words):
    return subprocess.run([FFMPEG, "-v", "error", *words], check=True, capture_output=True).stdout


def probe(path):
    """Width, height, seconds and the number of pictures of a video."""
    said = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries",
                           "stream=width,height,nb_read_frames:format=duration", "-of", "default=nk=1:nw=1", path],
                          check=True, capture_output=True, text=True).stdout.split()
    return int(said[0]), int(said[1]), float(said[3]), int(said[2])


def frames(path, width, height):
    """The decoded pictures, as bytes."""
    raw = ffmpeg("-i", path, "-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "-")
    size = 3 * width * height
    return [raw[at:at + size] for at in range(0, len(raw), size)]


def make(*words, **how):
    return subprocess.run([HERE / "film.py", *words], capture_output=True, text=True, **how)


@unittest.skipUnless(FFMPEG, "no ffmpeg: apt-get install ffmpeg")
class Film(PageCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.page = urllib.parse.urlparse(self.driver.current_url).path

    def save(self, name, body):
        """The Blob that a script returns, as a file."""
        data = self.ask(f"const blob = await (async () => {{ {body} }})(); const reader = new FileReader();"
                        "reader.readAsDataURL(blob); await new Promise((done) => { reader.onload = done; });"
                        "return reader.result.split(',')[1]")
        path = self.folder / name
        path.write_bytes(base64.b64decode(data))
        return path

    def test_the_button_saves_what_was_seen(self):
        self.open("hand")
        path = self.save("seen.webm", PLAY)
        width, height, seconds, count = probe(path)
        canvas = self.ask("const { width, height } = document.getElementById('canvas'); return [width, height]")
        self.assertEqual([width, height], [2 * (side // 2) for side in canvas])
        self.assertGreaterEqual(count, 4)
        self.assertGreater(seconds, 1)
        seen = frames(path, width, height)
        self.assertEqual(len(seen), count)
        self.assertNotEqual(seen[0], seen[-1])

    def test_only_the_last_ten_seconds_are_kept(self):
        """25 seconds of a grey that grows lighter: the film begins with what was seen ten seconds before its end."""
        path = self.save("greys.webm", GREYS)
        width, height, seconds, count = probe(path)
        self.assertTrue(10 <= seconds <= 11.1, seconds)
        self.assertAlmostEqual(count, 10 * seconds, delta=2)
        seen = frames(path, width, height)
        self.assertAlmostEqual(seen[-1][0], 249, delta=6)
        self.assertAlmostEqual(seen[0][0], 249 - 10 * seconds, delta=8)

    def test_a_browser_without_an_encoder(self):
        disabled, why = self.ask("const own = window.VideoEncoder; window.VideoEncoder = undefined;"
                                 "const button = document.createElement('button');"
                                 "new (await import('view/film')).Film(button); window.VideoEncoder = own;"
                                 "await new Promise((done) => setTimeout(done));"
                                 "return [button.disabled, button.title]")
        self.assertTrue(disabled)
        self.assertIn("cannot encode video", why)

    def test_the_same_command_makes_the_same_frames(self):
        size, videos = (320, 182), []
        made = subprocess.run([HERE / "view", "hand", "--video", self.folder / "a.mp4", "--seconds", "0.2", "--size",
                               "320x182"], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        self.assertEqual(made.returncode, 0, made.stderr)
        again = make(self.page, "--video", self.folder / "b.mp4", "--seconds", "0.2", "--size", "320x182")
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        for name in ("a.mp4", "b.mp4"):
            *measured, seconds, count = probe(self.folder / name)
            self.assertEqual((tuple(measured), count), (size, 10))  # a frame is 0.02 s of the hand's time
            self.assertAlmostEqual(seconds, 0.2, delta=0.01)
            videos.append(frames(self.folder / name, *size))
        self.assertEqual(videos[0], videos[1])
        self.assertEqual(len(set(videos[0])), 10, "nothing moves")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.mp4", "b.mp4"])
        self.encode_all(size)

    def encode_all(self, size):
        """The other formats, of pictures that are there."""
        ffmpeg("-i", self.folder / "a.mp4", "-frames:v", "5", self.folder / "%d.png")
        pictures = [path.read_bytes() for path in sorted(self.folder.glob("*.png"))]
        for form in (".webm", ".gif", ".webp"):
            with open(self.folder / f"other{form}", "wb") as file:
                film.encode(pictures, file, form, 25)
        for form in (".webm", ".gif"):
            *measured, seconds, count = probe(self.folder / f"other{form}")
            self.assertEqual((tuple(measured), count), (size, 5), form)
            self.assertAlmostEqual(seconds, 0.2, delta=0.02)
        self.assertEqual((self.folder / "other.webp").read_bytes().count(b"ANMF"), 5)

    def test_a_picture(self):
        made = make(self.page, "--picture", self.folder / "p.png", "--seconds", "0.3", "--size", "300x200")
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        self.assertIn("after 0.3 s", made.stdout)
        pixels = frames(self.folder / "p.png", 1, 1)
        self.assertEqual(len(pixels), 300 * 200)
        self.assertTrue(any(p[2] > p[0] + 90 for p in pixels), "nothing is blue")
        self.assertTrue(any(p[0] > p[2] + 90 for p in pixels), "nothing is orange")
        made = make(self.page, "--picture", self.folder / "p.webp", "--seconds", "0.3", "--size", "300x200")
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        self.assertRegex((self.folder / "p.webp").read_bytes()[:16], b"(?s)RIFF....WEBPVP8")

    def test_what_cannot_be_done_is_a_line(self):
        few = self.folder / "few"
        few.mkdir()
        for program in ("chromium", "chromedriver"):
            (few / program).symlink_to(shutil.which(program))
        for words, code, said in (
                (["--video", "film.avi"], 2, "ends in .mp4 or"), (["--picture", "film.mp4"], 2, "ends in .png"),
                (["--video", "a.mp4", "--size", "9x9"], 2, "--size 9x9"),
                (["--video", "a.mp4", "--seconds", "-1"], 2, "--seconds"), ([], 2, "required"),
                (["--video", "/proc/none/a.mp4"], 4, "cannot be written")):
            done = make(self.page, *words, "--check", cwd=self.folder)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (code, 1), done.stderr)
            self.assertIn(said, done.stderr)
        done = make(self.page, "--video", "a.mp4", cwd=self.folder, env={"PATH": str(few)})
        self.assertEqual((done.returncode, done.stderr), (3, "view: a video needs ffmpeg: apt-get install ffmpeg\n"))
        done = make(self.page, "--video", "a.mp4", cwd=self.folder, env={"PATH": "/none"})
        self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), done.stderr)
        self.assertIn("apt-get install chromium", done.stderr)
        done = subprocess.run([HERE / "view", "hand", "--video", "a.mp4", "-o", "b.html"], capture_output=True,
                              text=True)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertEqual(os.listdir(self.folder), ["few"])

    def test_an_interrupt_leaves_nothing(self):
        mark = {"FILM_TEST": str(self.folder)}
        run = subprocess.Popen([HERE / "film.py", self.page, "--video", self.folder / "a.mp4", "--size", "128x96"],
                               stderr=subprocess.PIPE, text=True, env={**os.environ, **mark})
        try:
            for _ in range(600):
                if {"ffmpeg", "chromedriver"} <= {os.path.basename(command) for command in running(mark)}:
                    break
                time.sleep(0.05)
            run.send_signal(signal.SIGINT)
            said = run.communicate(timeout=60)[1]
        finally:
            run.kill()
        self.assertEqual((run.returncode, said), (130, "view: interrupted: nothing was written\n"))
        self.assertEqual(os.listdir(self.folder), [])
        for _ in range(100):
            if not running(mark):
                break
            time.sleep(0.05)
        self.assertEqual(running(mark), [])


def running(mark):
    """Programs of the processes that have this in their environment."""
    wanted, found = "=".join(*mark.items()).encode(), []
    for folder in glob.glob("/proc/[0-9]*"):
        try:
            with open(f"{folder}/environ", "rb") as environment, open(f"{folder}/cmdline", "rb") as command:
                if wanted in environment.read():
                    found.append(command.read().split(b"\0")[0].decode())
        except OSError:
            pass  # it has ended, or is another's
    return [command for command in found if command]


# Plays for two seconds, presses the button, and takes what it saves.
PLAY = """
const press = (id) => document.getElementById(id).click();
press('pause');
const before = shapebench.film.frames.at(-1)?.time ?? 0;
const long = () => { // enough of it, however slow the machine
    const times = shapebench.film.frames.map(({ time }) => time).filter((time) => time > before);
    return times.length >= 6 && times.at(-1) - times[0] > 1200;
};
while (!long()) await new Promise((done) => setTimeout(done, 100));
press('pause');
const own = URL.createObjectURL;
try {
    return await new Promise((done, fail) => {
        URL.createObjectURL = (blob) => { done(blob); return 'data:,'; };
        setTimeout(() => fail(new Error(document.getElementById('status').textContent)), 5000);
        press('video');
    });
} finally {
    URL.createObjectURL = own;
}
"""

# Ten pictures a second, of one grey each.
GREYS = """
const { film } = shapebench;
const from = { width: 64, height: 48 };
for (let n = 0; n < 250; n++) {
    while (film.encoder?.encodeQueueSize) await new Promise((done) => setTimeout(done));
    film.add(1e9 + 100 * n, from, (copy) => {
        const pen = copy.getContext('2d', { alpha: false });
        pen.resetTransform();
        pen.fillStyle = `rgb(${n} ${n} ${n})`;
        pen.fillRect(0, 0, 64, 48);
    });
}
const video = await film.video();
film.last = -Infinity;
film.restart();
return video;
"""
