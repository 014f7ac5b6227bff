#!/usr/bin/python3
"""Recompute the recorded steps of a trajectory by brute force and compare.

Usage: check_step.py FILE      (a file of `shapebench run --record particles`)

Everything comes from the group /particles of FILE (results/README.md): regions by breadth-first
search over the cells, goals by fastlsm eqs. 9-12, the step by eqs. 1-2 and 14. Prints the largest
deviations in cells; velocities count as what they move in a step, and are compared after the last
step only, because the others hold the next step's pushes already. Particles that follow a handle
or end within a thousandth of a cell of an obstacle are compared in their goals only.
Exit code: 0 all within tolerance, 1 not, 2 nothing can be compared, 3 the file cannot be used."""
import sys

import h5py
import numpy as np

TOLERANCE = {"double": 1e-9, "single": 1e-4}  # cells


def links(cells, coordinate):
    """For each particle those that share a cell with it, itself too."""
    number = {tuple(c): p for p, c in enumerate(coordinate)}
    near = [set() for _ in coordinate]
    for i, j, k in cells:
        corners = [number[i + a, j + b, k + c] for a in (0, 1) for b in (0, 1) for c in (0, 1)]
        for p in corners:
            near[p].update(corners)
    return near


def regions(near, w):
    """Members of each particle's region: reachable in at most w steps."""
    members = []
    for p in range(len(near)):
        reached = front = {p}
        for _ in range(w):
            front = set().union(*(near[q] for q in front)) - reached
            reached = reached | front
        members.append(np.array(sorted(reached)))
    return members


def goals(members, mass, rest, x):
    """Eqs. 9-12, every region about its own centres of mass."""
    g = np.zeros_like(x)
    for r in members:
        m = mass[r][:, None]
        c0, c = (m * rest[r]).sum(0) / m.sum(), (m * x[r]).sum(0) / m.sum()
        u, _, vt = np.linalg.svd((m * (x[r] - c)).T @ (rest[r] - c0))
        rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        g[r] += c + (rest[r] - c0) @ rotation.T
    return g / sizes(members)


def sizes(members):
    return np.array([len(r) for r in members])[:, None]  # "r in R_i" is "i in R_r": |R_i|


def rigid_velocity(members, mass, x, v):
    """u_i of eq. 14."""
    total = np.zeros_like(v)
    for r in members:
        m = mass[r][:, None]
        c, vr = (m * x[r]).sum(0) / m.sum(), (m * v[r]).sum(0) / m.sum()
        arm = x[r] - c
        inertia = (m * arm**2).sum() * np.eye(3) - (m * arm).T @ arm
        turn = np.linalg.pinv(inertia, 1e-9, hermitian=True) @ np.cross(arm, m * (v[r] - vr)).sum(0)
        total[r] += vr + np.cross(turn, arm)
    return total / sizes(members)


def free(x, held, obstacles, margin):
    """Which particles no handle and no obstacle (lib/boundary.h) has moved."""
    touched = held.astype(bool)
    for kind, *o in obstacles:
        a, b, radius = np.array(o[:3]), np.array(o[3:6]), o[6]
        if kind == 0:
            gap = (x - a) @ b
        elif kind == 1:
            gap = np.linalg.norm(x - a, axis=1) - radius
        elif kind == 2:
            gap = np.maximum(a - x, x - b).max(1)
        else:
            along = ((x - a) @ (b - a) / max((b - a) @ (b - a), 1e-300)).clip(0, 1)[:, None]
            gap = np.linalg.norm(x - a - along * (b - a), axis=1) - radius
        touched |= gap < margin
    return ~touched


def check(group):
    """Returns the largest deviation of each kind and how many steps were compared."""
    a, mass, rest = group.attrs, group["mass"][:], group["rest"][:]
    near = links(group["cells"][:], group["coordinate"][:])
    members = regions(near, a["w"])
    weight = mass / sizes(members)[:, 0]  # modified mass m~
    step, held = group["step"][:], group["held"][:].reshape(-1, len(mass))
    h, every, cell = a["h"], max(1, a["damping_every"]), a["cell"]
    pairs = np.array([(p, q) for p in range(len(near)) for q in near[p] if q > p])
    worst, compared = {"g": 0.0, "x": 0.0, "v": 0.0}, 0

    def note(kind, deviation):
        deviation = np.abs(deviation).max(initial=0.0) / cell
        worst[kind] = max(worst[kind], deviation if np.isfinite(deviation) else np.inf)

    for s in range(len(step)):
        last = s + 1 == len(step) or step[s + 1] != step[s] + 1
        for b, alone in enumerate(held):
            own = slice(b * len(mass), (b + 1) * len(mass))
            x, v, recorded = (group[name][s, own] for name in "xvg")
            stretch = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) / \
                np.linalg.norm(rest[pairs[:, 0]] - rest[pairs[:, 1]], axis=1)
            if a["strain_limit"] > 0 and (step[0] > 0 or stretch.max() > a["strain_limit"]):
                print("links may have broken: their regions are not in the file", file=sys.stderr)
                sys.exit(2)
            if np.isnan(recorded).all():
                continue
            g = goals(members, weight, rest, x)
            note("g", g - recorded)
            compared += 1
            if last:
                continue
            v = v + (g - x) / h + h * a["gravity"]
            if a["damping"] > 0 and step[s] % every == 0:
                v += a["damping"] * (rigid_velocity(members, weight, x, v) - v)
            x = x + h * v
            open_ = free(x, alone, group["obstacles"][:], 1e-3 * cell)
            note("x", (x - group["x"][s + 1, own])[open_])
            if np.isnan(group["g"][s + 1, own]).all():  # else with the next step's pushes in it
                note("v", (h * (v - group["v"][s + 1, own]))[open_])
    return worst, compared


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__)
        sys.exit(0 if sys.argv[1:] in (["-h"], ["--help"]) else 2)
    try:
        open(sys.argv[1], "rb").close()
        with h5py.File(sys.argv[1], "r") as file:
            if "particles" not in file:
                print(f"{sys.argv[1]}: holds no particles: write it with --record particles", file=sys.stderr)
                sys.exit(3)
            worst, compared = check(file["particles"])
            precision = file["particles"].attrs["precision"]
    except (OSError, KeyError) as error:
        reason = getattr(error, "strerror", None) or "not a trajectory with particles"
        print(f"{sys.argv[1]}: {reason}", file=sys.stderr)
        sys.exit(3)
    precision = precision.decode() if isinstance(precision, bytes) else precision
    tolerance = TOLERANCE.get(precision, TOLERANCE["single"])
    print(", ".join(f"{kind} {value:.2e}" for kind, value in worst.items()),
          f"cells at most apart in {compared} steps; tolerance {tolerance:g} ({precision})")
    sys.exit(2 if compared == 0 else int(max(worst.values()) > tolerance))


if __name__ == "__main__":
    main()
