"""An AFM curve of a gel, read by afmformats where it is installed (`--curve file`), else simulated, and identified.

    python afm_curve.py --curve curve.jpk-force --radius 5e-6
"""

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
arguments.add_argument("--curve", type=pathlib.Path, help="file of an instrument; default: a simulated curve")
arguments.add_argument("--radius", type=float, default=5e-6, help="radius of the tip [m]")
arguments.add_argument("--stiffness", type=float, help="of the cantilever [N/m]; default: that of the file")
arguments = arguments.parse_args()
arguments.output.mkdir(parents=True, exist_ok=True)

tip = vc.ElasticStates.sphere(arguments.radius)
zener = vc.Identification("zener", contact_point=True, offset=True)
truth = {"E0": 4000.0, "Einf": 1500.0, "tau": 0.3}
if arguments.curve:
    import afmformats

    data = afmformats.load_data(arguments.curve)[0]
    # afmformats: the height of the piezo falls toward the sample
    recording = vc.Recording(data["time"], force=data["force"], drive=-data["height (measured)"])
    curve = recording.curve(tip, stiffness=arguments.stiffness or data.metadata["spring constant"])
    if curve.pull_off():
        curve = curve.until_release()  # the model does not stick
else:
    step = 0.02 if arguments.quick else 0.005
    experiment = vc.Experiment.trapezoid(2e-6, (1.0, 3.0, 1.0), step, tip, stiffness=arguments.stiffness or 0.05)
    force, _ = zener.respond(experiment, truth)
    curve = vc.Curve(experiment, force + 2e-11 * np.random.default_rng(1).normal(size=len(force)))
curve.check()
fit = zener.fit(curve)
print(fit)
for warning in fit.warnings:
    print("warning:", warning)
if not arguments.curve:
    assert all(fit[name].interval[0] / 1.1 < value < 1.1 * fit[name].interval[1] for name, value in truth.items())

times, (fitted, residuals) = curve.experiment.times, fit.force()
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
left.plot(times, curve.force * 1e9, ".", markersize=2, label="measured")
left.plot(times, fitted * 1e9, label="fitted")
left.set(xlabel="time (s)", ylabel="force (nN)")
left.legend()
t = np.geomspace(times[1] - times[0], times[-1], 100)
modulus, deviation = fit.modulus(t), fit.modulus_deviation(t)
right.semilogx(t, modulus / 1e3)
right.fill_between(t, modulus * (1 - 2 * deviation) / 1e3, modulus * (1 + 2 * deviation) / 1e3, alpha=0.3)
right.set(xlabel="time after a step (s)", ylabel="contact modulus (kPa)")
figure.savefig(arguments.output / "afm_curve.png", dpi=120)
