import numpy as np
import pytest
from flatsheets import disk

from lce_solver import cholesky
from lce_solver.errors import SolverError


def blocks_of(elements, d, seed=0):
    """Random positive semi-definite blocks that couple the nodes of each element."""
    k = elements.shape[1]
    half = np.random.default_rng(seed).standard_normal((len(elements), k * d, k * d))
    return (half @ half.swapaxes(1, 2)).reshape(-1, k, d, k, d).swapaxes(2, 3)


def dense(n, elements, blocks, shift):
    d = blocks.shape[-1]
    matrix = np.zeros((n, d, n, d))
    for nodes, block in zip(elements, blocks, strict=True):
        matrix[np.ix_(nodes, range(d), nodes, range(d))] += block.transpose(0, 2, 1, 3)
    return matrix.reshape(n * d, n * d) + np.diag(np.repeat(shift, d))


@pytest.mark.parametrize(("rings", "d"), [(1, 3), (9, 3), (12, 1), (9, 2)])
def test_solution_equals_that_of_the_dense_matrix(rings, d):
    points, faces = disk(rings)
    blocks, shift = blocks_of(faces, d), np.linspace(0.5, 2, len(points))
    right = np.random.default_rng(1).standard_normal((len(points), d))
    solve = cholesky.factorise(cholesky.plan(points, faces), blocks, shift)
    exact = np.linalg.solve(dense(len(points), faces, blocks, shift), right.ravel()).reshape(-1, d)
    assert np.abs(solve(right) - exact).max() < 1e-10 * np.abs(exact).max()


def test_parts_that_do_not_touch():
    points, faces = disk(8)
    apart = np.concatenate([points, points + np.array([5.0, 0.0])]), np.concatenate([faces, faces + len(points)])
    blocks, shift = blocks_of(apart[1], 2), np.ones(2 * len(points))
    right = np.random.default_rng(1).standard_normal((2 * len(points), 2))
    exact = np.linalg.solve(dense(2 * len(points), apart[1], blocks, shift), right.ravel()).reshape(-1, 2)
    assert np.abs(cholesky.factorise(cholesky.plan(*apart), blocks, shift)(right) - exact).max() < 1e-11


def test_every_node_is_eliminated_once_and_the_fill_stays_low():
    points, faces = disk(40)
    ordering = cholesky.plan(points, faces)
    assert np.array_equal(np.sort(ordering.order), np.arange(len(points)))
    sizes = [(front.stop - front.start, len(front.border)) for front in ordering.fronts]
    n = len(points)
    assert sum(own * (own + border) for own, border in sizes) < 8 * n * np.log2(n)  # a band would take 120 n


def test_indefinite_matrix_is_refused_with_the_vertex():
    points, faces = disk(4)
    blocks, shift = blocks_of(faces, 3), np.zeros(len(points))
    shift[17] = -1e6
    with pytest.raises(SolverError, match="vertex 17"):
        cholesky.factorise(cholesky.plan(points, faces), blocks, shift)
