"""A creeping seal: as the rubber creeps into the roughness, the leakage between the surfaces falls.

The leakage is that of Reynolds' flow through the gap, div(h³ grad P) = 0, for a mean gradient along x1. Two closed forms check its solution:
h = 1 + cos(x)/2 has the effective h³ 0.433012702 across its waves and 1.375 along them.
"""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
import viscocontact as vc


def effective_cube(gap):
    """The h³ of an even gap that leaks as much as this periodic one along x1."""
    k = np.where(gap > 0, gap, 0.0) ** 3
    faces = [2 * k * np.roll(k, -1, axis) / np.maximum(k + np.roll(k, -1, axis), 1e-300) for axis in (0, 1)]
    index = np.arange(k.size).reshape(k.shape)
    rows, columns = np.r_[index.ravel(), index.ravel()], np.r_[np.roll(index, -1, 0).ravel(), np.roll(index, -1, 1).ravel()]
    flow = sparse.coo_matrix((np.r_[faces[0].ravel(), faces[1].ravel()], (rows, columns)), (k.size, k.size))
    flow = (flow + flow.T).tocsr()
    total = np.asarray(flow.sum(1)).ravel()
    source = (faces[0] - np.roll(faces[0], 1, 0)).ravel()
    open_ = np.flatnonzero(total > 1e-9 * k.max())
    matrix = (sparse.diags(total) - flow)[open_][:, open_] + 1e-14 * total[open_].mean() * sparse.eye(len(open_))
    pressure = np.zeros(k.size)
    pressure[open_] = sparse.linalg.spsolve(matrix.tocsc(), source[open_], permc_spec="MMD_AT_PLUS_A")
    pressure = pressure.reshape(k.shape)
    return float((faces[0] * (1 + np.roll(pressure, -1, 0) - pressure)).mean())


arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("--quick", action="store_true")
arguments.add_argument("--output", type=pathlib.Path, default=pathlib.Path("out"))
arguments = arguments.parse_args()
arguments.output.mkdir(parents=True, exist_ok=True)

x = 2 * np.pi * (np.arange(64) + 0.5) / 64
across, along = (1 + 0.5 * np.cos(wave) + np.zeros((64, 64)) for wave in (x[:, None], x[None, :]))
assert abs(effective_cube(across) / 0.433012702 - 1) < 1e-2 and abs(effective_cube(along) / 1.375 - 1) < 1e-9

cells, side = (64 if arguments.quick else 128), 1e-3
grid = vc.Grid(cells, side)
surface = vc.HeightMap.rough(grid, 0.5 * side, 16 * side / cells, rms_slope=0.1, seed=3)
rubber = vc.Material(vc.Rheology.generalized_maxwell(1e6, [(4e6, 1.0), (2e6, 1e3)]))
contact = vc.ViscoelasticContact(grid, surface, rubber, kernel=vc.InfluenceKernel.periodic(grid))
run = contact.follow(vc.Load.force(0.16), 1e5, tolerance=1e-2, sample_at=vc.Times.decades(1e-2, 2))
states = []
for _ in run:
    for sample in run.samples():
        gap = np.where(sample.fields.pressure > 0, 0.0, sample.fields.gap)
        states.append((sample.report.time, sample.contact.contact_area / side**2, effective_cube(gap)))
time, share, cube = np.array(states).T
# below this the solution is that of the small term that keeps its matrix regular: no open channel is left
closed = cube < 1e-6 * cube[0]
print(f"contact from {share[0]:.1%} to {share[-1]:.1%} of the surface; the last open channel leaks {cube[~closed][-1] / cube[0]:.2%} of the first leakage")
if closed.any():
    print(f"closed from {time[closed][0]:g} s on")
assert (np.diff(cube) < 1e-6 * cube[0]).all()
cube[closed] = np.nan

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
left.loglog(time, cube / cube[0], "o-")
left.set_xlim(time[0], time[-1])
left.set(xlabel="time (s)", ylabel="leakage over the first one")
image = right.imshow(contact.gap.T * 1e6, origin="lower", extent=(0, side * 1e3, 0, side * 1e3), cmap="magma")
right.set(xlabel="x1 (mm)", ylabel="x2 (mm)", title="gap at the end")
figure.colorbar(image, ax=right, label="gap (µm)")
figure.savefig(arguments.output / "creeping_seal.png", dpi=120)
