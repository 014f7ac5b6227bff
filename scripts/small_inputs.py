"""Inputs that take no time, of test_damage.py and test_writers.py."""
import os
import subprocess

SCENE = 'mesh = "shape:block"; particles = 64; w = 1; bend = 0.3; frames = 2; steps_per_frame = 2;\n'
CLAIM = ('claims = ( { kind = "method"; paper = "octree"; name = "mine"; statement = "s"; number = "liver-growth"; '
         'test = "near"; tolerance = 100.0; measure = { experiment = "polar"; field = "cold-sweeps"; }; } );\n')
BEAM = 'mesh = "box.obj"; cell = 0.05; h = 0.001;\n'
FACES = ("1 3 2", "2 3 4", "5 6 7", "6 8 7", "1 2 5", "2 6 5", "3 7 4", "4 7 8", "1 5 3", "3 5 7", "2 4 6", "4 8 6")
BOX = "".join([f"v {0.3 * (i & 1)} {0.1 * (i >> 1 & 1)} {0.1 * (i >> 2)}\n" for i in range(8)]
              + [f"f {face}\n" for face in FACES])
TEXTS = {"a.cfg": SCENE, "mine.cfg": CLAIM, "beam.cfg": BEAM, "box.obj": BOX}
QUICK = ["--repeats", "2", "--block", "0.1"]
MAP = ["info", "shape:block", "--map", "--nodes", "60"]


def has_maps(program):
    """Whether the program was built with the solver that maps of shells need."""
    done = subprocess.run([program, *MAP, "--quiet"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    return "libsuitesparse" not in done.stderr


def write_inputs(folder):
    for name, text in TEXTS.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
