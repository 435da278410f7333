"""Friction of a rubber that slides on a rough road over eight decades of speed, with Persson's theory beside it."""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import viscocontact as vc

arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("--quick", action="store_true")
arguments.add_argument("--output", type=pathlib.Path, default=pathlib.Path("out"))
arguments = arguments.parse_args()
arguments.output.mkdir(parents=True, exist_ok=True)

cells, points = (64, 9) if arguments.quick else (256, 33)
side, pressure = 10e-3, 2e5
grid = vc.Grid(cells, side)
road = vc.HeightMap.rough(grid, side / 2, 8 * side / cells, rms_slope=0.3, seed=3)
# a rubber that relaxes from 1 GPa to 1 MPa over the times from 1 ns to 0.1 s
rubber = vc.Rheology.generalized_maxwell(1e6, [(1e9 * 10 ** (-1.0 * (8 - k) * 3 / 8), 10 ** (-1.0 - k)) for k in range(9)])
speeds = np.geomspace(1e-6, 1e2, points)

sliding = vc.SteadySliding(grid, road, vc.Material(rubber), kernel=vc.InfluenceKernel.periodic(grid))
table = sliding.sweep(speeds, vc.Load.force(pressure * side**2)).columns()


def modulus(omega):
    """The contact modulus of an incompressible body [Pa]."""
    return 4 * complex(rubber.complex_modulus(omega))


theory = [vc.persson_friction(grid, road, modulus, pressure, (speed, 0.0), 0.5) for speed in speeds]
share = table["contact_area"] / side**2
print(f"friction up to {table['friction'].max():.3f} at {speeds[table['friction'].argmax()]:.1e} m/s; theory up to {max(each['friction'] for each in theory):.3f}")
assert (table["friction"] > 0).all() and (np.diff(share) < 0.01).all()

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
left.semilogx(speeds, table["friction"], "o-", label="computed")
left.semilogx(speeds, [each["friction"] for each in theory], "--", label="Persson's theory, γ = 1/2")
left.set(xlabel="speed (m/s)", ylabel="coefficient of friction")
left.legend()
right.loglog(speeds, share, "o-")
right.loglog(speeds, [each["contact_share"] for each in theory], "--")
right.set(xlabel="speed (m/s)", ylabel="share of the surface in contact")
figure.savefig(arguments.output / "road_friction.png", dpi=120)
