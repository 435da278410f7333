"""Gradients with respect to the shape: against differences, and through PyTorch and JAX where they are installed."""

import doctest

import numpy as np
import pytest
import viscocontact as vc
from viscocontact import gradients

GRID = vc.Grid(24, 4e-3)
GAP = vc.Shape.sphere(10e-3).gap(GRID) + 1e-6 * np.random.default_rng(1).normal(size=(24, 24))
RUBBER = vc.Material(vc.Rheology.zener(1e6, 1e6, 1.0))
CELLS = [(12, 12), (11, 13), (14, 12), (0, 0)]
ELASTIC = gradients.elastic(GRID, 4e6, [0.1, 0.5], tolerance=1e-12)
CREEPING = gradients.creeping(GRID, RUBBER, [(0.0, 0.5), (1.0, 0.5), (1.0, 0.1)], accuracy=1e-7, tolerance=1e-12)


def difference(function, cell, by):
    """Central, where no cell begins or ends to touch."""
    moved = np.zeros_like(GAP)
    moved[cell] = by
    return (function(GAP + moved)[0] - function(GAP - moved)[0]) / (2 * by)


@pytest.mark.parametrize(
    "function, cells, tolerance", [(ELASTIC, CELLS, 1e-6), (CREEPING, CELLS[1:2], 3e-4)], ids=["elastic", "creeping"]
)
def test_gradients_are_those_of_differences(function, cells, tolerance):
    _, gradient = function(GAP)
    assert gradient.min() >= 0 and gradient.sum(axis=(1, 2)) == pytest.approx(np.ones(function.count), abs=1e-8)
    assert (gradient[:, 0, 0] == 0).all()
    for cell in cells:
        assert gradient[(slice(None), *cell)] == pytest.approx(difference(function, cell, 1e-9), abs=tolerance)


def test_a_force_at_a_given_approach_falls_by_the_stiffness():
    contact = vc.ElasticContact(GRID, GAP, 4e6, tolerance=1e-12)
    contact.solve(vc.Load.approach(1e-5))
    slope = -4e6 * contact.stiffness_over_modulus() * contact.approach_gradient()[12, 12]
    forces = []
    for by in (1e-10, -1e-10):
        moved = GAP.copy()
        moved[12, 12] += by
        other = vc.ElasticContact(GRID, moved, 4e6, tolerance=1e-12)
        other.solve(vc.Load.approach(1e-5))
        forces.append(other.force)
    assert (forces[0] - forces[1]) / 2e-10 == pytest.approx(slope, rel=1e-4)


def test_what_has_no_gradient_says_so():
    closed = vc.StatesContact(vc.ElasticStates.sphere(10e-3), RUBBER)
    closed.step(0.0, vc.Load.force(1.0))
    with pytest.raises(NotImplementedError, match="no surface"):
        closed.approach_gradient()
    apart = vc.ElasticContact(GRID, GAP, 4e6)
    assert (apart.approach_gradient() == 0).all()


def test_examples_of_docstrings():
    report = doctest.testmod(gradients)
    assert report.failed == 0 < report.attempted


def test_pytorch():
    torch = pytest.importorskip("torch")
    gap = torch.tensor(GAP, requires_grad=True)
    approaches = ELASTIC.torch()(gap)
    weights = torch.tensor([2.0, -3.0], dtype=torch.float64)
    (weights * approaches).sum().backward()
    expected, gradient = ELASTIC(GAP)
    assert (approaches.detach().numpy() == expected).all()
    assert gap.grad.numpy() == pytest.approx(2 * gradient[0] - 3 * gradient[1], abs=1e-15)
    # a chain, and single precision
    height = torch.tensor(1e-6, dtype=torch.float32, requires_grad=True)
    wave = torch.cos(torch.arange(24, dtype=torch.float32))[:, None].expand(24, 24)
    ELASTIC.torch()(torch.tensor(GAP, dtype=torch.float32) + height * wave).sum().backward()
    assert height.grad.dtype == torch.float32 and np.isfinite(height.grad.item())


def test_jax():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    of = ELASTIC.jax()
    expected, gradient = ELASTIC(GAP)
    weighted = lambda gap: (np.array([2.0, -3.0]) * of(gap)).sum()
    for call in (of, jax.jit(of)):
        assert (np.asarray(call(GAP)) == expected).all()
    for slope in (jax.grad(weighted), jax.jit(jax.grad(weighted))):
        assert np.asarray(slope(GAP)) == pytest.approx(2 * gradient[0] - 3 * gradient[1], abs=1e-15)
    assert np.asarray(jax.vmap(of)(np.stack([GAP, GAP]))).shape == (2, 2)
