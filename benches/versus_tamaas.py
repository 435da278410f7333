#!/usr/bin/env python3
"""This crate against Tamaas (https://gitlab.com/tamaas/tamaas): the same two scenes, at equal true error, on one thread.

    pip install tamaas numpy
    python3 benches/versus_tamaas.py            # about ten minutes; `sphere` or `rough` after it for one scene

Scenes: a sphere on a Zener half-space under a constant force, 256² cells, to two retardation times; and a periodic
rough surface on an elastic half-space, 512² cells, about half of them in contact. Both programs get the same gap and
the same kernel (Love's coefficients, zero-padded; Westergaard's waves), so that the exact answers of the two agree.

The error is Σ|p − p_ref| / Σ p_ref, on the sphere the greater of that after one retardation time and after two. The
reference is computed by this crate, with 800 steps and a tolerance of 1e-10; that Tamaas's error falls to the order of
its tolerance (rough), and in proportion to its steps (sphere), says that the reference is its answer as well. Tamaas
gets the loosest tolerance that leaves its error nearly as it is; this crate then gets its cheapest steps and tolerance
whose error is no larger. Times are processor
times of the solves alone, without plans and kernels, the least of alternating runs.

CI does not run this, because it needs a package from PyPI.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["RAYON_NUM_THREADS"] = "1"
import numpy as np
import tamaas as tm

ROOT = Path(__file__).resolve().parent.parent


def crate(*arguments):
    """What this crate's side, `benches/versus_tamaas.rs`, prints: words of each line."""
    program = ["cargo", "run", "--quiet", "--release", "--package", "viscocontact-benches", "--bin", "versus_tamaas", "--"]
    command = program + [str(argument) for argument in arguments]
    lines = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    return [line.split() for line in lines if line]


class Scene:
    """A scene as this crate writes it, and Tamaas's answers to it."""

    def __init__(self, name, folder):
        self.name, self.folder = name, folder
        [[self.length, self.force, self.share]] = [map(float, line) for line in crate("reference", name, folder)]
        gap = np.fromfile(folder / "gap")
        n = int(round(np.sqrt(gap.size)))
        self.surface = np.ascontiguousarray(-gap.reshape(n, n))
        self.reference = np.fromfile(folder / "pressures").reshape(-1, n, n)

    def model(self):
        n = len(self.surface)
        return tm.Model(tm.model_type.basic_2d, [self.length] * 2, [n, n])

    def error(self, pressures):
        return max(np.abs(p - r).sum() / r.sum() for p, r in zip(pressures, self.reference, strict=True))

    def once(self, steps, tolerance):
        """Error and time, after a first solve that makes the plans and is not timed."""
        model, solver = self.solver(steps, tolerance)
        solver.solve(self.force / self.length**2)
        model.traction[:] = 0
        if steps:
            solver.reset()
        pressures, seconds = [], 0.0
        for step in range(1, max(steps, 1) + 1):
            start = time.process_time()
            solver.solve(self.force / self.length**2)
            seconds += time.process_time() - start
            if not steps or step % (steps // 2) == 0:
                pressures.append(np.array(model.traction).reshape(self.surface.shape))
        return self.error(pressures), seconds

    def solver(self, steps, tolerance):
        model = self.model()
        if not steps:
            model.E, model.nu = 1.0, 0.0
            return model, tm.PolonskyKeerRey(model, self.surface, tolerance)
        # Incompressible; relaxation modulus 1 + exp(−2t). The long-term modulus has to be 1: MaxwellViscoelastic 2.9
        # divides its history by it, so that with another, pressures are wrong from the second step on.
        model.E, model.nu = 3.0, 0.5
        tm.ModelFactory.registerNonPeriodic(model, "half-space")
        solver = tm.MaxwellViscoelastic(model, self.surface, tolerance, 2.0 / steps, [1.0], [0.5])
        solver.setIntegralOperator("half-space")
        solver.max_iter = 10000
        return model, solver

    def compare(self, steps, tolerances, runs):
        """Both programs in turn, at the error that Tamaas reaches with the loosest tolerance that suits."""
        tried = {tolerance: self.once(steps, tolerance) for tolerance in tolerances}
        print(f"\nTamaas, {steps or 1} steps, error by tolerance:", {t: f"{error:.1e}" for t, (error, _) in tried.items()})
        # a larger error by a tenth is the price of a looser tolerance
        least = min(error for error, _ in tried.values())
        tolerance = max(tolerance for tolerance, (error, _) in tried.items() if error < 1.1 * least)
        (error, tamaas), ours = tried[tolerance], {}
        for run in range(runs):
            if run > 0:
                tamaas = min(tamaas, self.once(steps, tolerance)[1])
            for way, *numbers in crate("measure", self.name, self.folder, error):
                if way not in ours or float(numbers[1]) < float(ours[way][1]):
                    ours[way] = numbers
        print(f"\n{self.name}, {100 * self.share:.0f} % of the cells in contact at the end")
        print(f"{'':24}{'error':>10}{'seconds':>10}{'steps':>7}{'tolerance':>11}{'iterations':>12}{'ratio':>8}")
        print(f"{'Tamaas ' + tm.__version__:24}{error:10.1e}{tamaas:10.3g}{steps or 1:7}{tolerance:11.0e}")
        for way, (e, seconds, n, tol, iterations) in ours.items():
            seconds, n = float(seconds), max(int(n), 1)
            line = f"{'viscocontact, ' + way:24}{float(e):10.1e}{seconds:10.3g}{n:7}{float(tol):11.0e}"
            print(f"{line}{iterations:>12}{tamaas / seconds:8.0f}", flush=True)


def main():
    tm.set_log_level(tm.LogLevel.error)
    wanted = sys.argv[1:] or ["sphere", "rough"]
    with tempfile.TemporaryDirectory() as folder:
        for name in wanted:
            (Path(folder) / name).mkdir()
            scene = Scene(name, Path(folder) / name)
            if name == "rough":
                for tolerance in [1e-3, 1e-4]:
                    scene.compare(0, [tolerance], 2)
            else:
                for steps in [40, 160]:
                    scene.compare(steps, [1e-3, 1e-2], 2)


main()
