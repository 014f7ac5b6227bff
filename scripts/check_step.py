#!/usr/bin/python3
"""Recompute the recorded steps of a trajectory by brute force and compare.

Usage: check_step.py FILE      (a file of `shapebench run --record particles` or `--record nodes`)

Everything comes from the group /particles or /nodes of FILE (results/README.md): a lattice's regions
by breadth-first search over the cells, goals by fastlsm eqs. 9-12; an octree's distances by Dijkstra
over the visibility edges, regions by the intervals of octree section 4.2 and the symmetry asked for, goals by octree
eqs. 6-10, leaf by leaf; the step by fastlsm eqs. 1-2 and 14. An octree's cells must be those of one
lattice, its lengths those of their centres, its stored summation nodes those regions' largest cells; the
rest shapes of a plastic body begin at 1 with step 0 and flow from record to record (where a stretch is at
the yield to rounding, it may or may not). Prints the largest deviations in (finest) cells, of rest shapes
in their unit; velocities count as what they move in a step, and are compared after the last step only,
because the others hold the next step's pushes already. Where a step is damped, particles of regions whose
inertia the precision does not resolve (unresolved() below, the rule of bench/check/step_check.h) may end elsewhere by
more than the tolerance, by what rounding does to damping; they are counted and their deviation is given apart.
Particles that follow a handle or end within a
thousandth of a cell of an obstacle are compared in their goals only, and so is a record after which the next
step is missing; how many those are is said.
Exit code: 0 all within tolerance, 1 not, 2 nothing can be compared, or usage, 3 the file cannot be used."""
import heapq
import sys

from plots import fail, opened

import numpy as np  # after plots, which says what is missing

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
            if not front:
                break
            front = set().union(*(near[q] for q in front)) - reached
            reached = reached | front
        members.append(np.array(sorted(reached)))
    return members


class Lattice:
    """Regions, masses and what may break of the group /particles."""

    def __init__(self, group):
        usable_lattice(group)
        self.mass = group["mass"][:]
        near = links(group["cells"][:], group["coordinate"][:])
        self.members = regions(near, group.attrs["w"])
        self.share = np.ones(len(near))  # what a region counts in sums over regions
        self.weight = self.mass / total(self.members, self.share)[:, 0]  # modified mass m~
        self.pairs = np.array([(p, q) for p in range(len(near)) for q in near[p] if q > p])
        self.limit, self.rest = group.attrs["strain_limit"], group["rest"][:]
        self.plastic = False

    def unknown(self, x, begins):
        """Why a state is not to be recomputed, or nothing."""
        stretch = np.linalg.norm(x[self.pairs[:, 0]] - x[self.pairs[:, 1]], axis=1) / \
            np.linalg.norm(self.rest[self.pairs[:, 0]] - self.rest[self.pairs[:, 1]], axis=1)
        if self.limit > 0 and (not begins or stretch.max() > self.limit):
            return "links may have broken: their regions are not in the file"
        return None


class Tree:
    """Regions and masses of the group /nodes, from its edges; compares the stored summation nodes."""

    def __init__(self, group):
        self.mass, self.node, self.rest = group["mass"][:], group["node"][:], group["rest"][:]
        usable_tree(group)
        self.parent, self.plastic = group["tree/parent"][:].tolist(), group.attrs["creep"] > 0
        self.creep = group.attrs["creep"] * group.attrs["h"]
        self.yield_, self.most = group.attrs["yield"], group.attrs["most"]
        wrong = misplaced(group)
        if wrong:
            print(wrong, file=sys.stderr)
            sys.exit(1)
        self.children = [[] for _ in self.parent]
        for child, parent in enumerate(self.parent):
            if parent >= 0:
                self.children[parent].append(child)
        self.below = [0] * len(self.parent)  # leaves; parents come before their children
        for n in reversed(range(len(self.parent))):
            self.below[n] = sum(self.below[c] for c in self.children[n]) if self.children[n] else 1
        self.edges = [[] for _ in self.node]
        for (i, j), length in zip(group["edge"][:].tolist(), group["length"][:].tolist()):
            self.edges[i].append((j, length))
            self.edges[j].append((i, length))
        self.number = group["tree/leaf"][:].tolist()
        symmetry = text(group.attrs.get("symmetry", "union"))
        inside = self.regions(group["w"][:].tolist(), group.attrs["epsilon"], symmetry)
        first, stored = group["region_first"][:], group["summation"][:]
        for i, leaves in enumerate(inside):
            if sorted(self.largest(leaves)) != stored[first[i]:first[i + 1]].tolist():
                print(f"the summation nodes of region {i} are not those of its intervals", file=sys.stderr)
                sys.exit(1)
            if self.distances(i, np.inf, leaves) != group["reached"][i]:
                print(f"region {i} does not reach as far as is stored", file=sys.stderr)
                sys.exit(1)
        print(f"{len(inside)} regions, {len(stored) / len(inside):.3g} summation nodes each, recomputed")
        self.members = [np.array(sorted(leaves)) for leaves in inside]
        self.share = self.mass  # eq. 8: regions count by m_r
        plain = text(group.attrs["weighting"]) == "plain"
        self.weight = self.mass if plain else self.mass / total(self.members, self.share)[:, 0]

    def distances(self, source, most, wanted=None):
        """Dijkstra; with `wanted` only the distance of the farthest of these leaves."""
        found, queue, left = {}, [(0, source)], set(wanted or ())
        while queue:
            d, leaf = heapq.heappop(queue)
            if leaf not in found:
                found[leaf] = d
                if wanted:
                    left.discard(leaf)
                    if not left:
                        return d
                for to, length in self.edges[leaf]:
                    if to not in found and d + length <= most:
                        heapq.heappush(queue, (d + length, to))
        return found

    def leaves(self, node):
        """Leaf numbers below a tree node."""
        return [leaf for c in self.children[node] for leaf in self.leaves(c)] or [self.number[node]]

    def interval(self, i, w, most):
        """The leaves of region i before symmetry."""
        spans = {}  # tree node: least and greatest distance, leaves reached
        for leaf, d in self.distances(i, most).items():
            node = int(self.node[leaf])
            while node >= 0:
                low, high, count = spans.get(node, (d, d, 0))
                spans[node] = min(low, d), max(high, d), count + 1
                node = self.parent[node]
        inside, open_ = set(), [n for n in spans if self.parent[n] < 0]
        while open_:
            node = open_.pop()
            low, high, count = spans.get(node, (np.inf, np.inf, 0))
            if low > w:
                continue
            if count == self.below[node] and high <= most:
                inside.update(self.leaves(node))
            else:
                open_ += self.children[node]
        return inside

    def regions(self, w, epsilon, symmetry):
        """Leaves of every region: j is in R_i if the intervals of i put it in (none), and those of j
        put i in (intersection), or if those of one of them put the other in (union)."""
        own = [self.interval(i, w[i], w[i] + int(np.floor(epsilon * w[i]))) for i in range(len(w))]
        if symmetry == "none":
            return own
        if symmetry == "intersection":
            return [{j for j in leaves if i in own[j]} for i, leaves in enumerate(own)]
        for i, leaves in enumerate(own):
            for j in list(leaves):
                own[j].add(i)
        return own

    def largest(self, leaves):
        """The largest cells all of whose leaves are given."""
        counts = {}
        for leaf in leaves:
            node = int(self.node[leaf])
            while node >= 0:
                counts[node] = counts.get(node, 0) + 1
                node = self.parent[node]
        whole = {n for n, count in counts.items() if count == self.below[n]}
        return [n for n in whole if self.parent[n] not in whole]

    def unknown(self, x, begins):
        return None


def demand_numbers(group, ranges):
    """Raises ValueError unless the attributes are single numbers in their ranges, ends included."""
    for name, (low, high) in ranges.items():
        value = np.asarray(group.attrs[name])
        if value.shape != () or value.dtype.kind not in "iuf" or not low <= value <= high:
            raise ValueError(f"attribute {name} is {group.attrs[name]}, not from {low:g} to {high:g}")


def demand_arrays(group, sizes):
    """Raises ValueError unless the datasets have these shapes and hold finite numbers, positive ones where the
    name ends in +, whole ones where it ends in #."""
    for name, size in sizes.items():
        values = group[name.rstrip("+#")]
        if values.shape != size:
            raise ValueError(f"{values.name} is {values.shape}, not {size}")
        if values.dtype.kind not in ("iu" if name.endswith("#") else "iuf"):
            raise ValueError(f"{values.name} holds {values.dtype}")
        if not np.isfinite(values[:]).all() or name.endswith("+") and not (values[:] > 0).all():
            raise ValueError(f"{values.name} has a number that it cannot have")


def usable(group, count):
    """Raises ValueError where what both kinds of bodies have does not fit `count` particles or leaves."""
    a, large = group.attrs, 1e100
    demand_numbers(group, {"h": (1e-30, large), "cell": (1e-30, large), "damping": (0, 1),
                           "damping_every": (0, 2**31), "instances": (1, 2**31)})
    gravity, records, all_ = np.asarray(a["gravity"]), len(group["step"]), int(a["instances"]) * count
    if gravity.shape != (3,) or not (np.abs(gravity) <= large).all():
        raise ValueError(f"attribute gravity is {gravity}")
    demand_arrays(group, {"step#": (records,), "held#": (all_,), "obstacles": (len(group["obstacles"]), 9)})
    if (np.diff(group["step"][:]) <= 0).any():
        raise ValueError("the steps are not in order")
    for name, width in (("x", 3), ("v", 3), ("g", 3)) + ((("S", 9),) if "S" in group else ()):
        if group[name].shape != (records, all_, width) or group[name].dtype.kind != "f":
            raise ValueError(f"{name} is {group[name].shape}, not {(records, all_, width)}")


def usable_lattice(group):
    """Raises ValueError where the lattice's numbers do not fit each other."""
    count, cells, corner = len(group["mass"]), group["cells"][:], group["coordinate"][:]
    usable(group, count)
    demand_numbers(group, {"w": (1, 2**31), "strain_limit": (0, 1e100)})
    demand_arrays(group, {"mass+": (count,), "rest": (count, 3), "coordinate#": (count, 3), "cells#": (len(cells), 3)})
    if len(np.unique(corner, axis=0)) != count:
        raise ValueError("two particles have one place")
    wanted = np.unique((cells[:, None] + np.indices((2, 2, 2)).reshape(3, 8).T).reshape(-1, 3), axis=0)
    if len(np.unique(np.concatenate((corner, wanted)), axis=0)) != count:
        raise ValueError("a cell has a corner that is no particle")


def usable_tree(group):
    """Raises ValueError where the octree's sizes or indices do not fit each other."""
    nodes, leaves, edges = len(group["tree/parent"]), len(group["node"]), len(group["edge"])
    usable(group, leaves)
    demand_numbers(group, {"epsilon": (0, 1e100), "creep": (0, 1e100), "yield": (0, 1e100), "most": (0, 1e100),
                           "levels": (0, 30)})
    if np.shape(group.attrs["origin"]) != (3,) or np.shape(group.attrs["corner"]) != (3,):
        raise ValueError("origin and corner are three numbers each")
    demand_arrays(group, {"tree/centre#": (nodes, 3), "tree/size#": (nodes,), "tree/leaf#": (nodes,),
                          "tree/parent#": (nodes,), "tree/material#": (nodes,), "node#": (leaves,), "rest": (leaves, 3),
                          "size+": (leaves,), "mass+": (leaves,), "w#": (leaves,), "reached#": (leaves,),
                          "edge#": (edges, 2), "length#": (edges,), "region_first#": (leaves + 1,),
                          "summation#": (len(group["summation"]),)})
    ranges = {"node": (0, nodes), "edge": (0, leaves), "tree/leaf": (-1, leaves), "length": (1, 2**31),
              "summation": (0, nodes), "region_first": (0, len(group["summation"]) + 1)}
    for name, (low, high) in ranges.items():
        values = group[name][:]
        if values.size and (values.min() < low or values.max() >= high):
            raise ValueError(f"{name} has an index that is not from {low} to {high - 1}")
    if (group["tree/parent"][:] >= np.arange(nodes)).any() or group["tree/parent"][:].min() < -1:
        raise ValueError("tree/parent has a node before its parent")


def misplaced(group):
    """What of the tree, of the leaves or of the edges does not fit a lattice of cells, or nothing."""
    centre, size, parent = group["tree/centre"][:], group["tree/size"][:], group["tree/parent"][:]
    material, leaf, node = group["tree/material"][:], group["tree/leaf"][:], group["node"][:]
    child, root = np.nonzero(parent >= 0)[0], np.nonzero(parent < 0)[0]
    inner = np.unique(parent[child])
    whole = np.zeros_like(material)
    np.add.at(whole, parent[child], material[child])
    cell, edge = group.attrs["cell"], group["edge"][:]
    base = 2 << int(group.attrs["levels"])
    low = centre - size[:, None] // 2
    apart = np.abs(centre[node[edge[:, 0]]] - centre[node[edge[:, 1]]]).max(1, initial=0)
    right = {
        "tree/size": (size[root] == base).all() and (2 * size[child] == size[parent[child]]).all(),
        "tree/centre": ((low[root] - 2 * group.attrs["corner"]) % base == 0).all() and
                       (2 * np.abs(centre[child] - centre[parent[child]]) == size[child, None]).all()
                       and len(np.unique(np.column_stack((centre, size)), axis=0)) == len(size),
        "tree/material": (material > 0).all() and (8 * material <= size.astype(float)**3).all() and
                         (whole[inner] == material[inner]).all(),
        "tree/leaf": (leaf[inner] < 0).all() and (leaf >= 0).sum() == len(node) and
                     len(leaf) - len(inner) == len(node) and (leaf[node] == np.arange(len(node))).all(),
        "rest": np.allclose(group["rest"][:], group.attrs["origin"] + 0.5 * cell * centre[node],
                            1e-12, 1e-9 * cell),
        "size": np.allclose(group["size"][:], 0.5 * cell * size[node], 1e-12, 0),
        "edge": (edge[:, 0] != edge[:, 1]).all() and len(np.unique(np.sort(edge, 1), axis=0)) == len(edge),
        "length": (group["length"][:] == apart).all(),
    }
    wrong = [name for name, fits in right.items() if not fits]
    return f"{', '.join(wrong)}: not those of one lattice's cells and their centres" if wrong else None


def tolerance_of(group):
    """In cells; of rest shapes in their own unit, 1."""
    return TOLERANCE.get(text(group.attrs["precision"]), TOLERANCE["single"])


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def goals(body, x, shapes):
    """fastlsm eqs. 9-12, octree eqs. 6-9; every region about its own centres of mass. Of a plastic body
    also the shapes after the step, if they flow, and by how much its stretch exceeds the yield."""
    g, rest, flowed, beyond = np.zeros_like(x), body.rest, shapes.copy(), np.full(len(x), -np.inf)
    for i, (r, share) in enumerate(zip(body.members, body.share)):
        m, shape = body.weight[r][:, None], shapes[i] if body.plastic else np.eye(3)
        c0, c = (m * rest[r]).sum(0) / m.sum(), (m * x[r]).sum(0) / m.sum()
        at = (rest[r] - c0) @ shape.T
        moments = (m * (x[r] - c)).T @ at
        if not np.isfinite(moments).all():
            return np.full_like(x, np.inf), flowed, beyond
        u, _, vt = np.linalg.svd(moments)
        rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        g[r] += share * (c + at @ rotation.T)
        if body.plastic:
            flowed[i], beyond[i] = flow(body, shape, rotation.T @ moments, (m * at).T @ at)
    return g / total(body.members, body.share), flowed, beyond


def flow(body, shape, stretched, spread):
    """Eq. 10: the shape that a region keeps if it yields, and its stretch beyond the yield."""
    if not np.linalg.det(spread) > 1e-6 * (np.trace(spread) / 3)**3:
        return shape, -np.inf  # its nodes lie in a plane: elastic
    strain = stretched @ np.linalg.inv(spread) - np.eye(3)
    off = shape + body.creep * strain @ shape - np.eye(3)
    kept = np.eye(3) + off * min(1, body.most / max(np.linalg.norm(off), 1e-300))
    volume = np.linalg.det(kept)
    kept = kept / np.cbrt(volume) if 0.05 < volume < 20 else shape
    return kept, np.linalg.norm(strain) - body.yield_


def total(members, share):
    """What the regions that contain each particle count."""
    sum_ = np.zeros((len(members), 1))
    for r, counts in zip(members, share):
        sum_[r] += counts
    return sum_


def angular_velocity(moments, turning, noise, thinnest):
    """omega of eq. 14 from sum m~ d d^T and sum m~ d x v over M. Where `noise`, what rounding may do to inertia,
    is a 64th of the least or more, rotations are damped a little, too, and about a line wholly: the rule of
    lib/simd/rigid_lanes.h, which says why. `thinnest` of the spread is no inertia."""
    trace = np.trace(moments)
    i = trace * np.eye(3) - moments
    adjugate = np.stack([np.cross(i[1], i[2]), np.cross(i[2], i[0]), np.cross(i[0], i[1])])
    over, more = i[0] @ adjugate[0], noise * np.trace(adjugate)
    if over > thinnest * trace * np.trace(adjugate) + more:
        turning = adjugate @ turning
    else:
        over, more = trace, noise
    return turning / (over + more if 64 * more > over else over)


def rounding(precision):
    """Of numbers, and which share of a region's spread is no inertia to lib/simd/rigid_lanes.h."""
    return (2.0**-52, 1e-10) if precision == "double" else (2.0**-23, 1e-5)


def rigid_velocity(body, x, v, cell, precision):
    """u_i of eq. 14."""
    sum_, (epsilon, thinnest), at = np.zeros_like(v), rounding(precision), (x - x.mean(0)) / cell
    for r, share in zip(body.members, body.share):
        m = body.weight[r][:, None] / body.weight[r].sum()
        c, vr = (m * at[r]).sum(0), (m * v[r]).sum(0)
        arm = at[r] - c
        turn = angular_velocity((m * arm).T @ arm, np.cross(arm, m * (v[r] - vr)).sum(0),
                                8 * epsilon * (c @ c) + 1e-30, thinnest)
        sum_[r] += share * (vr + np.cross(turn, arm))
    return sum_ / total(body.members, body.share)


def unresolved(body, x, cell, precision):
    """What rounding may make of particles' rigid velocities, relative, of those whose regions' inertia is not
    128 times what rounding of sums about the body's middle may do to it, or that may be as thin as a line; 2
    where rounding decides whether a region is solid: `known` of bench/check/step_check.h. An octree's sums may be
    about nearer places (octree/region/frames.h), and then rounding is less."""
    epsilon, thinnest = rounding(precision)
    at, found = (x - x.mean(0)) / cell, np.zeros(len(x))
    for r in body.members:
        if len(r) == 1:
            continue
        m = body.weight[r][:, None] / body.weight[r].sum()
        c = (m * at[r]).sum(0)
        arm = at[r] - c
        spread = (m * arm**2).sum()
        moments = np.linalg.eigvalsh(spread * np.eye(3) - (m * arm).T @ arm)
        known = (moments > 1e-14 * spread).all()
        inertia = 1 / (1 / moments).sum() if known else 0
        noise = 8 * epsilon * (c @ c)
        line = inertia <= 0.5 * (thinnest * spread + (noise if isinstance(body, Lattice) else 0))
        if spread > 0 and (line or inertia >= 4 * (thinnest * spread + noise)):
            known = noise / (spread + noise if line else inertia)
            known *= 0 if known <= 1 / 128 else 2 if known < 1 / 32 else 1
        else:
            known = 2
        found[r] = np.maximum(found[r], known)
    return found


def free(x, held, obstacles, margin):
    """Which particles no handle and no obstacle (lib/engine/boundary.h) has moved."""
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


def check(group, body):
    """Returns the largest deviation of each kind, how many steps were compared, and of what is not
    resolved the particles that are left out and their largest deviation, in cells."""
    a, count = group.attrs, len(body.mass)
    step, held = group["step"][:], group["held"][:].reshape(-1, count)
    h, every, cell = a["h"], max(1, a["damping_every"]), a["cell"]
    worst, compared, left = {"g": 0.0, "x": 0.0, "v": 0.0}, 0, (set(), [0.0])
    none, begin = np.full((count, 3, 3), np.nan), np.eye(3)
    tolerance = tolerance_of(group)

    def note(kind, deviation, unit=cell):
        deviation = np.abs(deviation).max(initial=0.0) / unit
        worst[kind] = max(worst[kind], deviation if np.isfinite(deviation) else np.inf)

    def shapes_of(s, own):
        return group["S"][s, own].reshape(-1, 3, 3) if body.plastic else none

    if body.plastic:
        worst["S"] = 0.0
        for own in [slice(b * count, (b + 1) * count) for b in range(len(held)) if step[:1] == [0]]:
            note("S", shapes_of(0, own) - begin, 1)
    for s in range(len(step)):
        last = s + 1 == len(step) or step[s + 1] != step[s] + 1
        for b, alone in enumerate(held):
            own = slice(b * count, (b + 1) * count)
            x, v, recorded = (group[name][s, own] for name in "xvg")
            if not (np.isfinite(x).all() and np.isfinite(v).all()):
                note("x", np.inf)
                compared += 1
                continue
            why = body.unknown(x, step[0] == 0)
            if why:
                print(why, file=sys.stderr)
                sys.exit(2)
            if np.isnan(recorded).all():
                continue
            shapes = shapes_of(s, own)
            g, flowed, beyond = goals(body, x, shapes)
            note("g", g - recorded)
            compared += 1
            if last:
                continue
            if body.plastic:
                off = [np.abs(shapes_of(s + 1, own) - to).max((1, 2)) for to in (shapes, flowed)]
                note("S", np.where(np.abs(beyond) < tolerance, np.minimum(*off),
                                   np.where(beyond > 0, off[1], off[0])), max(1, body.creep))
            v = v + (g - x) / h + h * a["gravity"]
            most = np.zeros(count)  # by which rounding may put it elsewhere
            if a["damping"] > 0 and step[s] % every == 0:
                fastest = np.linalg.norm(v, axis=1).max(initial=0)
                most = unresolved(body, x, cell, text(a["precision"])) * a["damping"] * h * fastest / cell
                v += a["damping"] * (rigid_velocity(body, x, v, cell, text(a["precision"])) - v)
            x = x + h * v
            open_ = free(x, alone, group["obstacles"][:], 1e-3 * cell)
            off = np.linalg.norm(x - group["x"][s + 1, own], axis=1) / cell
            out = (most > 0) & (off > tolerance) & (off <= most + tolerance) & open_
            left[0].update(own.start + np.nonzero(out)[0])
            left[1].append(off[out].max(initial=0))
            open_ &= ~out
            note("x", (x - group["x"][s + 1, own])[open_])
            if np.isnan(group["g"][s + 1, own]).all():  # else with the next step's pushes in it
                note("v", (h * (v - group["v"][s + 1, own]))[open_])
    return worst, compared, len(left[0]), max(left[1])


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__)
        sys.exit(0 if sys.argv[1:] in (["-h"], ["--help"]) else 2)
    np.seterr(all="ignore")  # what is not finite is a deviation
    with opened(sys.argv[1]) as file:
        kind = next((name for name in ("particles", "nodes") if name in file), None)
        if not kind:
            fail(f"{sys.argv[1]}: holds no particles and no nodes: write it with --record particles, "
                 "of an octree --record nodes", 3)
        group = file[kind]
        worst, compared, left, away = check(group, Lattice(group) if kind == "particles" else Tree(group))
        precision, tolerance = text(group.attrs["precision"]), tolerance_of(group)
        gaps = np.flatnonzero(np.diff(group["step"][:]) != 1)
        after = ", ".join(str(step) for step in group["step"][:][gaps[:5]]) + (", ..." if len(gaps) > 5 else "")
    if len(gaps):
        print(f"after {len(gaps)} of the records, of steps {after}, the next step is missing: compared in their goals only")
    print(", ".join(f"{kind} {value:.2e}" for kind, value in worst.items()),
          f"cells at most apart in {compared} steps; tolerance {tolerance:g} ({precision})")
    if left:
        print(f"{left} left out of x and v, whose regions' inertia the precision does not resolve (within {away:.2e} "
              "cells a step)")
    sys.exit(2 if compared == 0 else int(max(worst.values()) > tolerance))


if __name__ == "__main__":
    main()
