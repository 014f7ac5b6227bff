#!/usr/bin/python3
"""Recomputes the recorded steps of a trajectory (run --record particles or nodes) in double precision.

    scripts/brute_force.py FILE...

Written from the papers alone (fastlsm: Rivers and James 2007; octree: Steinemann, Otaduy and Gross 2008), without
sight of the engines or of reference/, so that an error has to be made twice to go unseen. Regions are found from the
recorded cells or edges, every sum is over a region's members one by one, and rotations are by SVD. An octree's stored
summation nodes must be its regions', and the rest shapes of a plastic body must flow from record to record.
Prints the largest deviations of goals, positions and velocities in (finest) cells, and how far momentum strays where
nothing acts from outside. Memory grows with the square of the particles: for some 5,000 a body at most.
Exit code 0: all within the tolerance printed; 1: not; 2: nothing to compare, or usage; 3: not such a file.
"""
import heapq
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent / "report"))
from stored import Unusable, opened  # noqa: E402

LARGE = 1e30  # no number of a run is as large


class Differs(Exception):
    """What is stored beside the steps is not what follows from the cells or edges."""


def roundings(group, octree):
    """Half epsilons of the body's radius that all roundings of a goal come to if each is the worst and of one sign.

    A lattice's sums go through three stages of w + 1 additions one after the other, up and down again: 6 w + 6; x,
    m~ x, 1/M and 1/|R| and the products with them are 6 more. Of an octree, 4 levels of 8 children and lists of up to
    32 summation nodes in 4 columns would come to 90, as of the hand; 32 are allowed, as roundings have no one sign."""
    return 32 if octree else 6 * group.attrs["w"] + 12


def word(group, name):
    """An attribute that is a word, empty where there is none."""
    value = group.attrs.get(name, "")
    return value.decode() if isinstance(value, bytes) else value


def lattice_regions(lattice):
    """members[r, i]: i lies within w one-ring steps of r, by breadth-first search (fastlsm section 3)."""
    number = {tuple(place): i for i, place in enumerate(lattice["coordinate"][:])}
    ring = [set() for _ in number]
    for cell in lattice["cells"][:]:
        corners = {number[tuple(cell + (bit & 1, bit >> 1 & 1, bit >> 2))] for bit in range(8)}
        for corner in corners:
            ring[corner] |= corners
    members = np.zeros((len(ring),) * 2, bool)
    for centre in range(len(ring)):
        reached = front = {centre}
        for _ in range(lattice.attrs["w"]):
            front = set().union(*(ring[i] for i in front)) - reached
            reached = reached | front
            if not front:
                break
        members[centre, list(reached)] = True
    return members


def distances(links, start):
    """Shortest paths from a node (Dijkstra) over the visibility graph; infinite where there is none."""
    best, queue = np.full(len(links), np.inf), [(0, start)]
    while queue:
        far, node = heapq.heappop(queue)
        if far < best[node]:
            best[node] = far
            for other, length in links[node]:
                heapq.heappush(queue, (far + length, other))
    return best


def octree_regions(nodes):
    """members[r, i] by intervals of distance, from the roots down (octree section 4.2), then made symmetric."""
    parent, leaf, width = nodes["tree/parent"][:], nodes["tree/leaf"][:], nodes["w"][:]
    if (parent >= np.arange(len(parent))).any() or (nodes["length"][:] <= 0).any():
        raise ValueError("a tree or lengths that no octree has")
    children, leaves = [[] for _ in parent], [[i] if i >= 0 else [] for i in leaf]
    for j in range(len(parent) - 1, -1, -1):  # parents come before children
        if parent[j] >= 0:
            children[parent[j]].append(j)
            leaves[parent[j]] += leaves[j]
    links = [[] for _ in width]
    for (a, b), length in zip(nodes["edge"][:], nodes["length"][:]):
        links[a].append((b, length))
        links[b].append((a, length))
    members, far = np.zeros((len(width),) * 2, bool), np.stack([distances(links, i) for i in range(len(width))])
    for i, w in enumerate(width):
        todo = list(np.flatnonzero(parent < 0))
        while todo:
            j = todo.pop()
            low, high = far[i, leaves[j]].min(), far[i, leaves[j]].max()
            if low <= w and high <= (1 + nodes.attrs["epsilon"]) * w:
                members[i, leaves[j]] = True
            elif low <= w:
                todo += children[j]
    members = {"union": members | members.T, "intersection": members & members.T, "none": members}[word(nodes, "symmetry")]
    first, stored = nodes["region_first"][:], nodes["summation"][:]
    whole = np.stack([members[:, below].all(1) for below in leaves], 1)  # [region, tree node]
    largest = whole & ~np.where(parent >= 0, whole[:, parent], False)
    for i, row in enumerate(largest):
        if not np.array_equal(np.flatnonzero(row), stored[first[i]:first[i + 1]]):
            raise Differs(f"the summation nodes of region {i} are not those of its intervals")
    if not np.array_equal(np.where(members, far, 0).max(1), nodes["reached"][:]):
        raise Differs("regions do not reach as far as is stored")
    return members


class Body:
    """Masses and regions: sums, goals (fastlsm eqs. 9-12, octree eqs. 6-9) and damping (fastlsm eq. 14)."""

    def __init__(self, group, octree):
        self.rest, self.mass = group["rest"][:], group["mass"][:]
        self.rest = self.rest - self.rest.mean(0)
        members = (octree_regions if octree else lattice_regions)(group).astype(float)
        back = members.T if word(group, "goals") == "adjoint" else members
        self.back = back * (self.mass if octree else 1)  # what each region counts in its members' averages
        share = self.back.sum(1)  # |R_i|, or M_i
        self.back /= share[:, None]
        self.weight = members * (self.mass / (1 if word(group, "weighting") == "plain" else share))  # m~ of eq. 9
        self.total = self.weight.sum(1)
        self.c0 = self.centre(self.rest)

    def centre(self, x):
        return self.weight @ x / self.total[:, None]

    def moments(self, a, b, ca, cb):
        """Sum of m~ (a - ca)(b - cb)^T over each region."""
        n = len(a)
        product = (a[:, :, None] * b[:, None, :]).reshape(n, 9)
        return (self.weight @ product).reshape(n, 3, 3) - self.total[:, None, None] * ca[:, :, None] * cb[:, None, :]

    def average(self, matrix, vector, at):
        """The regions' affine maps, averaged for each particle, at `at`."""
        n = len(at)
        return np.einsum("nij,nj->ni", (self.back @ matrix.reshape(n, 9)).reshape(n, 3, 3), at) + self.back @ vector

    def goals(self, x, shape):
        """Goals, the regions' rotations, and their moments A of octree eq. 10."""
        c = self.centre(x)
        moments = self.moments(x, self.rest, c, self.c0) @ shape.transpose(0, 2, 1)
        u, _, vt = np.linalg.svd(moments)
        u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
        turn = u @ vt @ shape
        return self.average(turn, c - np.einsum("nij,nj->ni", turn, self.c0), x * 0 + self.rest), u @ vt, moments

    def flow(self, shape, rotation, moments, creep, most):
        """The rest shapes that regions keep if they yield, and the stretch of each (octree eq. 10)."""
        one = np.eye(3)
        spread = shape @ self.moments(self.rest, self.rest, self.c0, self.c0) @ shape.transpose(0, 2, 1)
        solid = np.linalg.det(spread) > 1e-6 * (np.trace(spread, axis1=1, axis2=2) / 3)**3  # not nodes in a plane
        inverse = np.linalg.inv(np.where(solid[:, None, None], spread, one))
        strain = np.where(solid[:, None, None], rotation.transpose(0, 2, 1) @ moments @ inverse - one, 0)
        off = shape + creep * strain @ shape - one
        size = np.linalg.norm(off, axis=(1, 2))
        kept = one + off * np.minimum(1, most / np.maximum(size, 1e-300))[:, None, None]
        volume = np.linalg.det(kept)
        good = solid & (volume > 0.05) & (volume < 20)
        kept = kept / np.cbrt(np.where(good, volume, 1))[:, None, None]
        return np.where(good[:, None, None], kept, shape), np.linalg.norm(strain, axis=(1, 2))

    def rigid(self, x, v):
        """Velocities of the regions' rigid motions, averaged for each particle."""
        c, mean = self.centre(x), self.centre(v)
        second, twist = self.moments(x, x, c, c), self.moments(x, v, c, mean)
        momentum = np.stack([twist[:, 1, 2] - twist[:, 2, 1], twist[:, 2, 0] - twist[:, 0, 2],
                             twist[:, 0, 1] - twist[:, 1, 0]], 1)
        inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
        omega = np.einsum("nij,nj->ni", np.linalg.pinv(inertia, rcond=1e-10, hermitian=True), momentum)
        spin = np.cross(omega[:, None, :], np.eye(3)).transpose(0, 2, 1)  # its columns are omega x e_i
        return self.average(spin, mean - np.cross(omega, c), x)


def outside(obstacles, x):
    """Smallest distance of each position to an obstacle's surface, negative inside (kinds as in lib/engine/boundary.h)."""
    least = np.full(len(x), np.inf)
    for kind, *numbers in obstacles:
        a, b, radius = np.array(numbers[:3]), np.array(numbers[3:6]), numbers[6]
        if kind == 0:  # a plane through a with normal b
            far = (x - a) @ b / np.linalg.norm(b)
        elif kind == 2:  # a box from a to b
            beyond = np.maximum(a - x, x - b)
            far = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(1), 0)
        else:  # a sphere about a, a capsule from a to b
            along = b - a if kind == 3 else a * 0
            share = np.clip((x - a) @ along / max(along @ along, 1e-300), 0, 1)
            far = np.linalg.norm(x - a - share[:, None] * along, axis=1) - radius
        least = np.minimum(least, far)
    return least


def check(file):
    """Of all recorded steps of all instances: the deviation allowed, the largest ones, in cells (of velocities and
    momentum a step), and how many particles were compared, pushed between steps (their velocity is not compared),
    and pressed by an obstacle (not compared)."""
    octree = "nodes" in file
    if not octree and "particles" not in file:
        raise Unusable(f"{file.filename}: no recorded steps: run with --record particles, or nodes of an octree")
    group = file["nodes" if octree else "particles"]
    if group.attrs.get("strain_limit", 0):
        raise Unusable(f"{file.filename}: links may have broken, and the file does not say which")
    body, n, h, cell = Body(group, octree), len(group["rest"]), group.attrs["h"], group.attrs["cell"]
    precision = word(group, "precision")
    if precision not in ("single", "double") or not all(1 / LARGE < number < LARGE for number in (h, cell)):
        raise ValueError("a precision, time step or cell that no run has")
    damping, every = group.attrs["damping"], max(1, group.attrs["damping_every"])
    gravity, held, steps = group.attrs["gravity"], group["held"][:].astype(bool), group["step"][:]
    obstacles = group["obstacles"][:] if "obstacles" in group else []
    size, far = np.linalg.norm(body.rest, axis=1).max(), np.abs(group["x"][0]).max(initial=0)
    allowed = (roundings(group, octree) * np.finfo(precision).eps / 2 * size + 8e-16 * min(far, LARGE)) / cell
    worst = dict.fromkeys(("goals", "x", "v", "momentum", "spin"), 0.0)
    if "S" in group:
        worst["S"] = np.abs(group["S"][0].reshape(-1, 3, 3) - np.eye(3)).max() if steps[0] == 0 else 0
    count = dict.fromkeys(("compared", "pushed", "pressed"), 0)
    for k in range(len(steps) - 1):
        if steps[k + 1] != steps[k] + 1:
            continue
        record = {name: group[name][k:k + 2] for name in ("x", "v", "g")}
        for first in range(0, len(held), n):
            here = slice(first, first + n)
            if not all(np.abs(record[name][:, here]).max() < LARGE for name in "xv"):
                worst["x"] = np.inf  # also where it is no number
                continue
            middle = record["x"][0, here].mean(0)  # far from the origin the sums would cancel
            x, x1, v0, v1 = (record[name][j, here] for name, j in (("x", 0), ("x", 1), ("v", 0), ("v", 1)))
            x, x1, free = x - middle, x1 - middle, ~held[here]
            shape, next_ = (group["S"][j, here].reshape(n, 3, 3) if "S" in group else np.tile(np.eye(3), (n, 1, 1))
                            for j in (k, k + 1))
            g, rotation, moments = body.goals(x, shape)
            if "S" in group:
                creep = h * group.attrs["creep"]
                flowed, stretch = body.flow(shape, rotation, moments, creep, group.attrs["most"])
                stays, flows = (np.abs(next_ - to).max((1, 2)) / max(1, creep) for to in (shape, flowed))
                over = stretch - group.attrs["yield"]  # at the yield to rounding it may or may not flow
                worst["S"] = max(worst["S"], np.where(np.abs(over) <= allowed, np.minimum(stays, flows),
                                                      np.where(over > 0, flows, stays)).max())
            # What is held takes part in damping as if it were free, and then follows its handle; the papers are silent.
            v = v0 + (g - x) / h + h * gravity
            if damping and steps[k] % every == 0:
                v = v + damping * (body.rigid(x, v) - v)
            x2 = x + h * v
            apart = outside(obstacles, x2 + middle) > 1e-4 * cell
            good, off = free & apart, np.abs(x2 - x1).max(1) / cell
            drift = np.abs(v - v1).max(1) * h / cell
            pushed = good & (drift > allowed) & (off <= allowed) & np.isfinite(record["g"][1, here]).all(1)
            for name, deviation in (("goals", np.abs(g - (record["g"][0, here] - middle)).max(1) / cell),
                                    ("x", off[good]), ("v", drift[good & ~pushed])):
                worst[name] = max(worst[name], np.nan_to_num(deviation, nan=np.inf).max(initial=0))
            for name, which in (("compared", good), ("pushed", pushed), ("pressed", free & ~apart)):
                count[name] += int(which.sum())
            if free.all() and apart.all() and not pushed.any() and word(group, "weighting") != "plain":
                m = body.mass[:, None]
                gain = (m * ((x1 - x) / h - v0 - h * gravity))
                spin = (np.cross(x, gain).sum(0) / m.sum()) * h / (cell * size)
                worst["momentum"] = max(worst["momentum"], np.abs(gain.sum(0) / m.sum()).max() * h / cell)
                worst["spin"] = max(worst["spin"], np.abs(spin).max())
    return allowed, worst, count


def beyond(allowed, worst):
    """Which deviations are larger than allowed, in words."""
    return [f"{name} {worst[name]:.2g} off, {allowed:.2g} allowed" for name in worst
            if not worst[name] <= allowed]


def told(worst, count):
    return " ".join([f"{name} {value:.2g}" for name, value in worst.items()] +
                    [f"{value} {name}" for name, value in count.items()])


def main(paths):
    if not paths or paths[0].startswith("-"):
        print(__doc__)
        return 0 if paths in (["-h"], ["--help"]) else 2
    codes = set()
    for path in paths:
        try:
            with opened(path) as file:
                allowed, worst, count = check(file)
        except (Unusable, Differs) as error:
            print(f"brute_force: {error}", file=sys.stderr)
            codes.add(3 if isinstance(error, Unusable) else 1)
            continue
        fits = not beyond(allowed, worst)
        print(path, "within" if fits else "OFF", f"{allowed:.2g}:", told(worst, count))
        codes.add(1 if not fits else 0 if count["compared"] else 2)
    return next((code for code in (1, 3, 2) if code in codes), 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
