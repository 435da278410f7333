"""Shows a defect of MaxwellViscoelastic in Tamaas 2.9.0: pressures are not proportional to the moduli.

Twice the moduli under twice the pressure must give twice the pressures at every step. Prints the greatest difference from that,
relative to the greatest pressure, for a sphere in five steps. Needs `pip install tamaas==2.9.0 numpy`.
"""

import numpy as np
import tamaas as tm

CELLS, STEPS = 64, 5


def pressures(scale):
    """Pressures at every step: shear modulus `scale` in the long term, twice that at once, mean pressure 0.01 `scale`."""
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], [CELLS, CELLS])
    model.E, model.nu = 3.0 * scale, 0.5
    x = (np.arange(CELLS) + 0.5) / CELLS - 0.5
    surface = np.ascontiguousarray(-(x[:, None] ** 2 + x[None, :] ** 2) / 2)
    solver = tm.MaxwellViscoelastic(model, surface, 1e-10, 0.4, [scale], [0.5])
    steps = []
    for _ in range(STEPS):
        solver.solve(0.01 * scale)
        steps.append(np.array(model.traction).copy())
    return steps


for step, (one, two) in enumerate(zip(pressures(1.0), pressures(2.0), strict=True), 1):
    print(f"step {step}: {np.abs(two / 2 - one).max() / one.max():.1e}")
