"""States, sliding, attraction, studies, identification, writers, maps."""

import json
import pickle

import numpy as np
import pytest
import viscocontact as vc

RUBBER = vc.Material(vc.Rheology.zener(1e6, 5e5, 1.0))
BALL = vc.Shape.sphere(10e-3)


def test_a_hundred_materials_in_one_call():
    times = np.geomspace(1e-2, 1e2, 20)
    rubbers = [vc.Material(vc.Rheology.zener(1e6, 5e5, tau)) for tau in np.geomspace(1e-1, 1e1, 100)]
    curves = vc.ElasticStates.sphere(10e-3).curves(rubbers, vc.Load.force(1.0), times)
    assert curves.shape == (100, 20, 3)
    closed = [vc.GrowingSphere(10e-3, rubber, vc.Load.force(1.0)).approach(times) for rubber in rubbers]
    assert curves[:, :, 1] == pytest.approx(np.array(closed), rel=1e-3)
    with pytest.raises(ValueError, match="they must ascend"):
        vc.ElasticStates.sphere(10e-3).curves(rubbers[:1], vc.Load.force(1.0), [2.0, 1.0])


def test_states_of_a_sweep(tmp_path):
    states = vc.ElasticStates.sweep(vc.Grid(48, 4e-3), BALL, material=RUBBER, load=vc.Load.force(1.0), until=5.0, keep_pressures=True)
    contact = vc.StatesContact(states, RUBBER)
    in_space = vc.ViscoelasticContact(vc.Grid(48, 4e-3), BALL, RUBBER)
    for dt in (0.0, 0.5, 0.5):
        report, other = contact.step(dt, vc.Load.force(1.0)), in_space.step(dt, vc.Load.force(1.0))
        assert report.approach == pytest.approx(other.approach, rel=1e-3)
    assert contact.fields().pressure.shape == contact.pressure.shape == (48, 48)
    states.save(tmp_path / "states.npz")
    again = vc.ElasticStates.load(tmp_path / "states.npz")
    (tmp_path / "states.npz").unlink()
    assert (pickle.loads(pickle.dumps(again)).table()["level"] == again.table()["level"]).all()
    assert (again.table()["level"] == states.table()["level"]).all() and len(again) == len(states)


def test_steady_sliding():
    grid = vc.Grid(32, 1e-3)
    road = vc.Shape.wavy((2e-6, 2e-6), (1e-3, 1e-3))
    rubber = vc.Rheology.generalized_maxwell(1e6, [(1e7, 1e-4)])
    kernel = vc.InfluenceKernel.periodic(grid)
    sliding = vc.SteadySliding(grid, road, vc.Material(rubber), kernel=kernel)
    speeds, done = np.geomspace(1e-2, 1e3, 6), []
    table = sliding.sweep(speeds, vc.Load.force(0.02), progress=done.append)
    friction = table.columns()["friction"]
    assert done[-1] == 1.0 and len(table) == 6 and table[-1].velocity[0] == 1e3
    assert friction.argmax() not in (0, 5) and friction.min() > 0
    own = vc.SteadySliding(grid, road, vc.Material(rubber), kernel=kernel, modulus=lambda w: 4 * rubber.complex_modulus(w)[()])
    fresh = vc.SteadySliding(grid, road, vc.Material(rubber), kernel=kernel).at((1.0, 0.0), vc.Load.force(0.02))
    assert own.at((1.0, 0.0), vc.Load.force(0.02)).friction == pytest.approx(fresh.friction, rel=1e-9)
    assert (sliding.gap[sliding.pressure > 0] < 1e-9).all()
    warm = sliding.sweep([1.0], vc.Load.force(0.02), law=vc.TimeTemperature.wlf(17.4, 51.6, 300.0), temperatures=[290.0, 300.0])
    assert list(warm.columns()["temperature"]) == [290.0, 300.0]
    pair = {"kernel": kernel, "counter_body": vc.Material(rubber)}
    of = lambda motion: vc.SteadySliding(grid, road, vc.Material(rubber), counter_motion=motion, **pair).at(1.0, vc.Load.force(0.02))
    slides, rolls = of("slides"), of("rolls")
    assert rolls.friction > slides.friction > 0 and isinstance(rolls.warnings, list) and "unmeasured" in rolls.figures
    with pytest.raises(Exception, match="counter_motion="):
        vc.SteadySliding(grid, road, vc.Material(rubber), **pair)


def test_attraction():
    law = vc.Attraction.exponential(0.05, 0.5e-6)
    own = vc.Attraction.function(law.traction, law.energy)
    states = []
    for attraction in (law, own):
        contact = vc.ViscoelasticContact(vc.Grid(64, 0.4e-3), vc.Shape.sphere(1e-3), vc.Material(vc.Rheology.elastic(1e6)), attraction=attraction)
        contact.step(0.0, vc.Load.approach(2e-6))
        contact.step(0.0, vc.Load.approach(0.0))
        states.append((contact.force, contact.traction.min()))
    assert states[0][0] < 0 and states[1] == pytest.approx(states[0], rel=1e-9)
    assert vc.Jkr(1e-3, 4e6, 0.05).pull_off_force == pytest.approx(-1.5 * np.pi * 0.05 * 1e-3)


def test_motion():
    options = dict(frame="indenter")
    contact = vc.ViscoelasticContact(vc.Grid((96, 48), (8e-3, 4e-3)), BALL.shifted((2e-3, 0)), vc.Material(vc.Rheology.zener(1e6, 3e5, 0.03)), **options)
    contact.step(0.0, vc.Load.force(0.5))
    for _ in range(30):
        contact.step_over((1, 0), contact.grid.spacing[0] / 0.05, vc.Load.force(0.5))
    ahead, across = contact.slope_force(BALL.shifted((2e-3, 0)))
    assert ahead > 0.003 and abs(across) < 1e-9
    along = vc.ViscoelasticContact(vc.Grid(48, 6e-3), BALL, RUBBER)
    along.step(0.0, vc.Load.force(0.5))
    report, of = along.step_along(BALL, ((0.0, 0.0), (1e-3, 0.0)), 0.1, vc.Load.force(0.5))
    assert of["position"] == [1e-4, 0.0] and of["lateral_force"][0] > 0 and np.isfinite(of["power"]) and report.time == 0.1


def test_a_study(tmp_path):
    load = vc.Load.force(1.0)
    told = []
    study = vc.Study(BALL, RUBBER, load, 2.0, accuracy=1e-2, ask=["contact area"], progress=lambda *at: told.append(at))
    exact = vc.GrowingSphere(10e-3, RUBBER, load).approach(2.0)
    assert study.is_converged and study.ending == "reached" and study.errors["contact area"] < 1e-2
    assert study.contact().approach == pytest.approx(exact, rel=study.errors["approach"])
    assert study.values("approach")[-1] == study.contact().approach and len(study.times) == len(study.values("force"))
    again = study.contact(at_rest=True)
    table = again.follow(load, 2.0, tolerance=study.tolerance, stop_at=study.stops).table()
    assert table["approach"][-1] == study.contact().approach
    assert told[-1][4] == study.work and told[0][5] is None and told[-1][5] is not None
    assert study.cost_for(1e-4)[2] > study.cost_for(1e-2)[2] and study.bytes > 0 and "cells" in str(study)
    study.write_csv(tmp_path / "study.csv")
    study.save_picture(tmp_path / "study.png")
    assert (tmp_path / "study.csv").read_text().startswith("row,cells 1")
    with pytest.raises(ValueError, match="contact area"):
        vc.Study(BALL, RUBBER, load, 2.0, ask=["area"])
    with pytest.raises(ValueError, match="one of"):
        study.values("area")


def test_a_study_of_fields():
    own = {"depth": lambda fields: fields.approach}
    study = vc.Study(BALL, RUBBER, vc.Load.force(1.0), 2.0, accuracy=5e-2, fields=[0.5, 2.0], quantities=own)
    early, late = study.fields()
    assert early.contact_area < late.contact_area and late.force == pytest.approx(study.contact().force, rel=1e-12)
    assert study.errors["pressure field"] < 5e-2 and study.errors["depth"] == study.errors["approach"]
    assert len(study.meshes) > 1 and study.time_errors["depth"] < 5e-2 and set(study.orders) == set(study.errors)


def test_identification():
    tip = vc.ElasticStates.sphere(5e-6)
    experiment = vc.Experiment.trapezoid(1e-6, (1.0, 3.0, 1.0), 0.02, tip, stiffness=0.1)
    zener = vc.Identification("zener", contact_point=True)
    truth = {"E0": 4000.0, "Einf": 2000.0, "tau": 0.5}
    force, depth = zener.respond(experiment, truth)
    noise = 2e-11 * np.random.default_rng(1).normal(size=len(force))
    curve = vc.Recording(experiment.times, force=force + noise, drive=experiment.drive).curve(tip, stiffness=0.1)
    fit = zener.fit(curve)
    bounds = zener.bounds([experiment], truth, 2e-11)
    for name, value in truth.items():
        assert abs(np.log(fit[name].value / value)) < 4 * bounds[name]
    assert fit.material().contact_compliance(1e9) == pytest.approx(1 / fit["Einf"].value, rel=1e-6)
    with pytest.raises(KeyError, match="there are E0, Einf, tau"):
        fit["G"]
    assert "95 %" in repr(fit) and 0 <= fit.probability <= 1
    for given in ("fix", "start"):
        with pytest.raises(ValueError, match="E1.*E0, Einf, tau"):
            vc.Identification("zener", **{given: {"E1": 1.0}})
    assert [type(one) for one in zener.fit_each([curve, curve])] == [vc.Fit, vc.Fit]
    assert fit["contact_point"] == fit["contact point"]
    assert (fit["tau"].scale, fit["contact point"].scale, fit["tau"].limit) == ("logarithm", "linear", None)
    # one of a list may be left as it is; a parameter is known or begins somewhere
    first, second = vc.Identification("zener", offset=[True, None]).fit_each([curve, curve])
    assert (len(first.estimates), len(second.estimates)) == (4, 3)
    with pytest.raises(TypeError, match="give E0 in fix or in start"):
        vc.Identification("zener", fix={"E0": 1.0}, start={"E0": 2.0})
    for stiffness in (-0.1, 0.0):
        with pytest.raises(ValueError, match="stiffness = .* must be finite and > 0"):
            vc.Identification("zener", stiffness=stiffness).respond(experiment, truth)


def test_writers(tmp_path):
    contact = vc.ViscoelasticContact(vc.Grid(32, 4e-3), BALL, RUBBER)
    csv = vc.CsvHistory(tmp_path / "history.csv", contact, title="ball", notes={"rubber": "red"}, columns=["twice [N]"])
    frames = vc.FrameSeries(tmp_path / "frames", contact, title="ball")
    for report in contact.follow(vc.Load.force(0.5), 0.2, dt=0.1):
        csv.record(contact, report, [2 * report.force])
        path = frames.record(contact)
    assert json.loads((tmp_path / "history.csv.json").read_text(encoding="utf-8"))["notes"] == {"rubber": "red"}
    with open(tmp_path / "history.csv", encoding="utf-8") as file:
        assert file.readline().startswith("time [s]") and len(file.readlines()) == frames.frames == 3
    with np.load(path) as frame:
        assert (frame["pressure"] == contact.pressure).all()
    with pytest.raises(FileExistsError):
        vc.CsvHistory(tmp_path / "history.csv", contact)
    vc.CsvHistory(tmp_path / "history.csv", contact, earlier="replace")


def test_measured_maps(tmp_path):
    heights = np.random.default_rng(2).normal(size=(24, 16)) * 1e-6
    map = vc.HeightMap(heights, (3e-3, 2e-3))
    map.write(tmp_path / "map.sdf")
    assert (vc.HeightMap.read(tmp_path / "map.sdf").heights == heights).all()
    np.save(tmp_path / "map.npy", heights * 1e6)
    read = vc.HeightMap.read(tmp_path / "map.npy", lengths=(3e-3, 2e-3), unit="um")
    assert read.heights == pytest.approx(heights, rel=1e-15)
    holes = heights.copy()
    holes[3, 4] = np.nan
    holed = vc.HeightMap(holes, (3e-3, 2e-3))
    assert holed.missing == 1 and holed.filled().missing == 0
    assert np.isinf(holed.masked().gap(holed.grid)[3, 4])
    points = [(x, y, 1e-6 * x) for x in range(4) for y in range(3)]
    assert vc.HeightMap.from_points(points).shape == (4, 3)
    assert abs(map.leveled("mean").statistics()["mean"]) < 1e-20
    with pytest.raises(TypeError, match="needs the unit"):
        vc.HeightMap.read(tmp_path / "map.npy")


def test_measured_materials(tmp_path):
    truth = vc.Rheology.generalized_maxwell(1e6, [(4e6, 1.0)])
    omega = np.geomspace(1e-2, 1e2, 17)
    moduli = truth.complex_modulus(omega)
    body = vc.Measurements.dynamic(omega, moduli.real, moduli.imag).fit()
    assert body.creep_compliance(2.0) == pytest.approx(truth.creep_compliance(2.0), rel=1e-4)
    law = vc.TimeTemperature.wlf(17.4, 51.6, 300.0)
    isotherms = []
    for temperature in (295.0, 300.0, 305.0):
        cold = law.at(truth, temperature).complex_modulus(omega)
        isotherms.append((temperature, vc.Measurements.dynamic(omega, cold.real, cold.imag)))
    curve = vc.MasterCurve(300.0, isotherms)
    assert [row[1] for row in curve.shift_factors] == pytest.approx([law.shift_factor(T) for T, _ in isotherms], rel=0.05)
    rubber = law.with_entropic_moduli()
    moduli = [(T, rubber.at(truth, T).complex_modulus(omega)) for T, _ in isotherms]
    stiffer = [(T, vc.Measurements.dynamic(omega, both.real, both.imag)) for T, both in moduli]
    found = vc.MasterCurve(300.0, stiffer, vertical_shifts=True)
    for own in (found.wlf(), found.shift_table(), pickle.loads(pickle.dumps(found.wlf()))):
        assert own.vertical_factor(305.0) == pytest.approx(305.0 / 300.0, rel=0.01)
    with pytest.raises(NotImplementedError, match="vertical factors b_T"):
        vc.TemperatureHistory(rubber, 305.0)
    assert vc.TemperatureHistory(rubber.without_vertical_factors(), 305.0).at(0.0) == 305.0
    rows = "\n".join(f"{t},{truth.creep_compliance(t)}" for t in (0.1, 0.3, 1.0, 3.0, 10.0, 100.0))
    (tmp_path / "creep.csv").write_text("t [s],J [1/Pa]\n" + rows)
    table = vc.Measurements.from_csv("creep", tmp_path / "creep.csv")
    fitted = table.fit()
    (tmp_path / "creep.csv").write_text("t [s],J [1/Pa]\n1,1\n")
    for body in (fitted, table.fit()):
        assert pickle.loads(pickle.dumps(body)).creep_compliance(1.0) == fitted.creep_compliance(1.0)
    known = vc.MasterCurve(300.0, isotherms, law=law).fit()
    assert known.creep_compliance(2.0) == pytest.approx(truth.creep_compliance(2.0), rel=1e-3)
    with pytest.raises(ValueError, match="reference = 333.15 K is not that of the law, 300 K: give law.reference"):
        vc.MasterCurve(333.15, isotherms, law=law)
    with pytest.raises(TypeError, match="give law or vertical_shifts"):
        vc.MasterCurve(300.0, isotherms, law=law, vertical_shifts=True)
    assert fitted.creep_compliance(1.0) == pytest.approx(truth.creep_compliance(1.0), rel=1e-3)
    assert fitted.fit_report


def test_observations():
    grid = vc.Grid(64, 1e-3)
    rough = vc.HeightMap.rough(grid, 0.5e-3, 0.1e-3, rms_slope=0.1, seed=3)
    contact = vc.ViscoelasticContact(grid, rough, RUBBER, kernel=vc.InfluenceKernel.periodic(grid))
    contact.step(0.0, vc.Load.force(0.01))
    labels, patches = contact.patches()
    assert labels.max() == len(patches) and sum(patch["force"] for patch in patches) == pytest.approx(0.01, rel=1e-6)
    line = contact.profile(0, 0.0)
    assert (line["pressure"] == contact.pressure[:, 32]).all() or (line["pressure"] == contact.pressure[:, 31]).all()
    assert contact.stiffness_over_modulus() > 0
    assert contact.fit_reports == [] and "ViscoelasticContact(64" in repr(contact)
