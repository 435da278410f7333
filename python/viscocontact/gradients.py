"""The approach of a contact as a differentiable function of the gap, for PyTorch and JAX.

Each function here returns `Approaches`: of a gap [m], an array of the shape of the grid, the approaches [m] under given forces, and their
derivatives with respect to the gap of each cell, which the contacts know in closed form (`ElasticContact.approach_gradient`,
`StatesContact.approach_gradient`). `torch()` and `jax()` make a function of it that these packages differentiate, once.

>>> import numpy as np
>>> import viscocontact as vc
>>> from viscocontact import gradients
>>> grid = vc.Grid(32, 4e-3)
>>> gap = vc.Shape.sphere(10e-3).gap(grid)
>>> approaches, gradient = gradients.elastic(grid, 4e6, [0.1, 0.5])(gap)
>>> approaches.shape, gradient.shape, bool(np.allclose(gradient.sum(axis=(1, 2)), 1))
((2,), (2, 32, 32), True)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from viscocontact import ElasticContact, ElasticStates, Grid, Load, Material, StatesContact

__all__ = ["Approaches", "creeping", "elastic"]

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class Approaches:
    """A function of the gap that returns `count` approaches [m] and their gradients, of the shape (count, cells, cells).

    Any function of this kind does: `Approaches(function, count).torch()`.
    """

    function: Callable[[_Array], tuple[_Array, _Array]]
    count: int

    def __call__(self, gap: ArrayLike) -> tuple[_Array, _Array]:
        """The approaches [m] and their gradients."""
        return self.function(np.asarray(gap, dtype=float))

    def torch(self) -> Callable[[Any], Any]:
        """A function of a tensor, which PyTorch differentiates."""
        import torch  # type: ignore

        def forward(ctx: Any, gap: Any) -> Any:
            approaches, gradient = self(gap.detach().cpu().numpy())
            ctx.save_for_backward(torch.as_tensor(gradient).to(gap))
            return torch.as_tensor(approaches).to(gap)

        @torch.autograd.function.once_differentiable
        def backward(ctx: Any, by: Any) -> Any:
            return torch.tensordot(by, ctx.saved_tensors[0], 1)

        both = {"forward": staticmethod(forward), "backward": staticmethod(backward)}
        return type("Approach", (torch.autograd.Function,), both).apply  # type: ignore

    def jax(self) -> Callable[[Any], Any]:
        """A function of an array, which JAX differentiates, also within `jax.jit`. Set `jax_enable_x64` for its digits."""
        import jax  # type: ignore

        def both(gap: Any) -> Any:
            shapes = [jax.ShapeDtypeStruct((self.count, *inner), gap.dtype) for inner in ((), gap.shape)]
            as_asked = lambda gap: tuple(part.astype(gap.dtype) for part in self(np.asarray(gap)))
            return jax.pure_callback(as_asked, tuple(shapes), gap, vmap_method="sequential")

        approach = jax.custom_vjp(lambda gap: both(gap)[0])
        approach.defvjp(both, lambda gradient, by: (jax.numpy.tensordot(by, gradient, 1),))
        return approach  # type: ignore


def elastic(grid: Grid, modulus: float, forces: Sequence[float], **options: Any) -> Approaches:
    """Approaches of an `ElasticContact` of this contact modulus [Pa] under each of some forces [N]; `options` are its keywords."""

    def solved(gap: _Array) -> tuple[_Array, _Array]:
        contact, found = ElasticContact(grid, gap, modulus, **options), []
        for force in forces:
            contact.solve(Load.force(force))
            found.append((contact.approach, contact.approach_gradient()))
        return _columns(found)

    return Approaches(solved, len(forces))


def creeping(grid: Grid, material: Material, steps: Sequence[tuple[float, float]], **options: Any) -> Approaches:
    """Approaches of a `StatesContact` after each of some steps: their lengths [s] and the forces [N] at their ends.

    The elastic states are swept for each gap; `options` are keywords of `ElasticStates.sweep`. Steps of no length are jumps.

    >>> import viscocontact as vc
    >>> rubber = vc.Material(vc.Rheology.zener(1e6, 1e6, 1.0))
    >>> creep = creeping(vc.Grid(32, 4e-3), rubber, [(0.0, 0.5), (1.0, 0.5), (1.0, 0.1)], accuracy=1e-3)
    >>> approaches, gradient = creep(vc.Shape.sphere(10e-3).gap(vc.Grid(32, 4e-3)))
    >>> approaches.shape, gradient.shape
    ((3,), (3, 32, 32))
    """
    times = np.cumsum([length for length, _ in steps])
    # what forces reach in all steps is below the maximum held to the end
    level = max(force for _, force in steps) * float(material.contact_compliance(float(times[-1])))

    def solved(gap: _Array) -> tuple[_Array, _Array]:
        contact, found = StatesContact(ElasticStates.sweep(grid, gap, level=1.01 * level, **options), material), []
        for length, force in steps:
            contact.step(length, Load.force(force))
            found.append((contact.approach, contact.approach_gradient()))
        return _columns(found)

    return Approaches(solved, len(steps))


def _columns(found: list[tuple[float, _Array]]) -> tuple[_Array, _Array]:
    approaches, gradients = zip(*found)
    return np.array(approaches), np.stack(gradients)
