"""A hundred rubbers on one rough surface: its elastic states are found once, and every rubber is then a matter of milliseconds."""

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

cells, rubbers = (64, 20) if arguments.quick else (256, 100)
grid = vc.Grid(cells, 1e-3)
surface = vc.HeightMap.rough(grid, 0.5e-3, 16e-3 / cells, rms_slope=0.1, seed=3)
times, load = np.geomspace(1e-3, 1e3, 50), vc.Load.force(0.02)
relaxation = np.geomspace(1e-2, 1e2, rubbers)
materials = [vc.Material(vc.Rheology.zener(1e6, 5e5, tau)) for tau in relaxation]
states = vc.ElasticStates.sweep(
    grid, surface, material=materials[0], load=load, until=times[-1], kernel=vc.InfluenceKernel.periodic(grid), accuracy=1e-3
)
curves = states.curves(materials, load, times)
share = curves[:, :, 2] / grid.cell_area / cells**2
print(f"{len(states)} elastic states; contact from {share.min():.1%} to {share.max():.1%} of the surface")
assert (np.diff(share, axis=1) > -1e-6).all()

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
colors = plt.cm.viridis(np.linspace(0, 1, rubbers))
for curve, color in zip(share, colors):
    axes.semilogx(times, 100 * curve, color=color, linewidth=0.8)
scale = plt.cm.ScalarMappable(matplotlib.colors.LogNorm(relaxation[0], relaxation[-1]), "viridis")
figure.colorbar(scale, ax=axes, label="retardation time (s)")
axes.set(xlabel="time (s)", ylabel="surface in contact (%)", title=f"{rubbers} rubbers on one rough surface")
figure.savefig(arguments.output / "hundred_materials.png", dpi=120)
