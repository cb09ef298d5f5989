"""Generated broken and nasty meshes: each ends in a design that passes the judge or in one sentence."""

import time

import numpy as np
from meshes import write_obj
from targets import LCE, hill

from lce_solver import judge
from lce_solver.design import design
from lce_solver.errors import LceError
from lce_solver.mirror import even_mesh
from lce_solver.surface import load, mean_edge
from lce_solver.types import Severity, Status

LIMIT = 60
"""Seconds that a mesh may take."""


def slivers(v, f, rng):
    v = v.copy()
    for face in rng.choice(f, 5):
        v[face[2]] = (v[face[0]] + v[face[1]]) / 2 + rng.normal(size=3) * 10.0 ** -rng.integers(2, 9)
    return v, f


def duplicates(v, f, rng):
    return v, np.vstack([f, rng.permuted(rng.choice(f, 3), axis=1)])


def t_junctions(v, f, rng):
    """An edge is halved in one of its triangles only."""
    k = rng.integers(len(f))
    a, b, c = f[k]
    new = np.array([[a, len(v), c], [len(v), b, c]])
    return np.vstack([v, (v[a] + v[b]) / 2]), np.vstack([np.delete(f, k, axis=0), new])


def not_numbers(v, f, rng):
    v = v.copy()
    v[rng.integers(len(v)), rng.integers(3)] = rng.choice([np.nan, np.inf, 1e300])
    return v, f


def inverted(v, f, rng):
    f = f.copy()
    chosen = rng.choice(len(f), rng.integers(1, len(f)), replace=False)
    f[chosen] = f[chosen][:, ::-1]
    return v, f


def bow_ties(v, f, rng):
    return v, np.delete(f, rng.choice(len(f), rng.integers(1, 12), replace=False), axis=0)


def tiny(v, f, rng):
    return v * 1e-9, f


def huge(v, f, rng):
    return v * 1e9 + rng.normal(size=3) * 1e9, f


def far(v, f, rng):
    return v + rng.normal(size=3) * 10.0 ** rng.integers(1, 9), f


def crumpled(v, f, rng):
    return v + rng.normal(size=v.shape) * rng.choice([0.02, 0.1, 0.5]), f


def shuffled(v, f, rng):
    f = f.copy()
    f[rng.integers(len(f))] = rng.integers(len(v), size=3)
    return v, f


def squashed(v, f, rng):
    return v * (1, 10.0 ** -rng.integers(1, 7), 1), f


FAULTS = (
    slivers,
    duplicates,
    t_junctions,
    not_numbers,
    inverted,
    bow_ties,
    tiny,
    huge,
    far,
    crumpled,
    shuffled,
    squashed,
)


def nasty(seed):
    """A mesh with one fault, sometimes two: vertices, faces."""
    rng = np.random.default_rng(seed)
    surface = hill(int(rng.integers(4, 11)), int(rng.integers(3, 9)))
    v, f = FAULTS[seed % len(FAULTS)](surface.vertices, surface.faces, rng)
    second = FAULTS[int(rng.integers(len(FAULTS)))]
    return second(v, f, rng) if rng.random() < 0.2 else (v, f)


def outcome(seed, path):
    """The design of a nasty mesh, or the sentence that refuses it."""
    write_obj(path, *nasty(seed))
    try:
        target, _ = load(path)
        if seed % 2:
            target = even_mesh(target, mean_edge(target))
        return design(target, LCE, 20.0, 0.1, starts=2, tolerance=1e-6, max_iterations=2000)
    except LceError as fault:
        return str(fault)


def check_ends(seeds, path):
    """Every end is one of the allowed; how many there were of each kind."""
    counts = {"design": 0, "faulty": 0, "refused": 0}
    for seed in seeds:
        begin = time.perf_counter()
        end = outcome(seed, path)
        assert time.perf_counter() - begin < LIMIT
        if isinstance(end, str):
            assert "\n" not in end
            assert len(end.split()) > 5
            counts["refused"] += 1
            continue
        solved = end.flattening.status is Status.CONVERGED
        flips = len(judge.flipped(end.uv, end.surface.faces))
        told = {found.check for found in end.findings if found.severity is Severity.ERROR}
        assert (flips == 0 and np.isfinite(end.uv).all()) if solved else "solver" in told
        counts["faulty" if told else "design"] += 1  # too wild a target is solved, and told to be out of reach
    return counts
