"""Fields to an accuracy, energies, stress, tilts, events, pictures, closed forms, and what fits determine."""

import copy
import threading

import numpy as np
import pytest
import viscocontact as vc

RUBBER = vc.Material(vc.Rheology.zener(1e6, 5e5, 1.0))
BALL = vc.Shape.sphere(10e-3)


def ball(n=32, material=RUBBER, **options):
    return vc.ViscoelasticContact(vc.Grid(n, 4e-3), BALL, material, **options)


@pytest.mark.parametrize("on_states", [False, True])
def test_fields_to_an_accuracy(on_states):
    states = vc.ElasticStates.sweep(vc.Grid(32, 4e-3), BALL, material=RUBBER, load=vc.Load.force(0.3), until=10.0)
    contact = vc.StatesContact(states, RUBBER) if on_states else ball()
    run = contact.follow(vc.Load.force(0.3), 10.0, tolerance=1e-2, sample_at=[0.5, 5.0], fields_to=1e-3)
    samples = [sample for _ in run for sample in run.samples()]
    assert [sample.contact.time for sample in samples] == pytest.approx([0.5, 5.0])
    fine = ball()
    for sample in samples:
        list(fine.follow(vc.Load.force(0.3), sample.contact.time, tolerance=1e-6))
        pressure = (sample.contact.fields(1e-3) if on_states else sample.fields).pressure
        assert abs(pressure - fine.pressure).sum() < 3e-3 * fine.pressure.sum()
        if not on_states:
            assert 0 < sample.field["error"] < 1e-3 and sample.field["elastic_contacts"] > 0
    plain = ball().follow(vc.Load.force(0.3), 1.0, sample_at=[0.5])
    assert [sample.field for _ in plain for sample in plain.samples()] == [None]
    with pytest.raises(ValueError, match="accuracy"):
        contact.follow(vc.Load.force(0.3), 20.0, sample_at=[10.0], fields_to=1.0)
    assert contact.force == pytest.approx(0.3)


def test_times_within_a_step():
    contact = ball()
    run = contact.follow(vc.LoadHistory.ramp(vc.Load.approach(0.0), vc.Load.approach(2e-5), 1.0), 1.0, dt=0.5)
    next(run), next(run)
    assert run.within_step(0.25).approach == pytest.approx(5e-6) and contact.time == 0.5


def test_events_of_a_function():
    contact = ball(times=(vc.Load.force(1.0), 5.0))
    run = contact.follow(vc.LoadHistory.ramp(vc.Load.force(0.0), vc.Load.force(1.0), 1.0), 2.0)
    run.stop_when(lambda contact: contact.pressure.sum() * contact.grid.cell_area, up=0.5)
    run.stop_when("force", up=0.5)
    assert list(run) and run.events[0] == pytest.approx(run.events[1], rel=1e-5) and run.is_beyond == [True, True]
    run = ball().follow(vc.Load.force(1.0), 1.0)
    run.stop_when(lambda contact: 1 / 0, up=1.0)
    with pytest.raises(ZeroDivisionError):
        list(run)
    with pytest.raises(TypeError, match="a name or a function"):
        ball().follow(vc.Load.force(1.0), 1.0).stop_when(3.0, up=1.0)
    with pytest.raises(ValueError, match='"force", "approach", "contact_area"$'):
        vc.StatesContact(vc.ElasticStates.sphere(1e-2), RUBBER).follow(vc.Load.force(1.0), 1.0).stop_when("max_pressure", up=1.0)


def test_mixed_tilts():
    punch = vc.Shape.rectangular_punch((2e-3, 2e-3))
    elastic = vc.Material(vc.Rheology.elastic(1e6))
    contact = vc.ViscoelasticContact(vc.Grid(32, 4e-3), punch, elastic)
    contact.step(0.0, vc.Load.force(1.0, at=(0.2e-3, None)))
    assert contact.tilt[0] > 0 and contact.tilt[1] == 0 and contact.load == vc.Load.force(1.0, at=(0.2e-3, None))
    contact.step(0.0, vc.Load.force(1.0, at=(0.2e-3, None), tilt=(None, 1e-4)))
    assert contact.tilt[1] == 1e-4 and repr(contact.load) == "Load.force(1.0, at=(0.0002, None), tilt=(None, 0.0001))"
    contact.step(0.0, vc.Load.approach(contact.approach, at=(0.0, 0.0)))
    assert contact.tilt == pytest.approx((0, 0), abs=1e-6)
    with pytest.raises(TypeError, match="not both"):
        vc.Load.force(1.0, at=(0.0, 0.0), tilt=(1e-3, None))
    tilted = vc.ElasticStates.sweep(vc.Grid(32, 4e-3), punch + BALL, level=1e-6, at=(0.1e-3, None))
    upright = vc.ElasticStates.sweep(vc.Grid(32, 4e-3), punch + BALL, level=1e-6)
    assert tilted.approach(5e-7) > upright.approach(5e-7) and tilted.grid == upright.grid
    history = vc.LoadHistory.sinusoid_about(vc.Load.force(2.0, tilt=(1e-3, 0.0)), 1.0, 1.0)
    assert history.at(0.25) == vc.Load.force(3.0, tilt=(1e-3, 0.0))


def test_energies():
    contact = ball(material=vc.Material(vc.Rheology.relaxing(4e6, 1e6, 1.0)))
    balance = vc.EnergyBalance(contact)
    for report in contact.follow(vc.LoadHistory.ramp(vc.Load.approach(0.0), vc.Load.approach(1e-4), 1.0), 11.0):
        energies = balance.record(contact, report)
    assert energies == balance.energies and energies["viscous"] > 0.3 * energies["work"]
    parts = energies["stored"] + energies["viscous"] + energies["lost"]
    assert energies["imbalance"] == pytest.approx(energies["work"] - parts, abs=1e-15)
    with pytest.raises(ValueError, match="before any step"):
        vc.EnergyBalance(contact)


def test_stress():
    contact = ball()
    contact.step(0.0, vc.Load.force(0.5))
    stress, depths = contact.stress(), [1e-4, 2e-4, 4e-4]
    own = vc.SubsurfaceStress(vc.InfluenceKernel.half_space(contact.grid), contact.pressure, 0.5)
    volume = stress.in_volume(depths)
    assert volume.shape == (3, 32, 32, 6) and own.on_plane(2e-4) == pytest.approx(volume[1], rel=1e-9, abs=1e-6)
    assert (stress.in_volume(depths, quantity="von_mises")[1] == stress.on_plane(2e-4, quantity="von_mises")).all()
    positions, section = stress.on_section(0, 0.0, depths, quantity="tresca")
    assert section.shape == (32, 3) and len(positions) == 32
    s = volume[1, 16, 16]
    mean = stress.at([(*(x[16] for x in (contact.grid.coordinates()[0][:, 0], contact.grid.coordinates()[1][0])), 2e-4)], quantity="mean")
    assert mean == pytest.approx([s[:3].mean()], rel=1e-9)
    with pytest.raises(ValueError, match='"von_mises", "tresca"'):
        stress.on_plane(1e-4, quantity="mises")
    with pytest.raises(ValueError, match="pressure: two axes"):
        vc.SubsurfaceStress(vc.InfluenceKernel.half_space(contact.grid), np.ones(3), 0.5)


def test_files_of_stress(tmp_path):
    contact = ball()
    contact.step(0.0, vc.Load.force(0.5))
    stress = contact.stress()
    stress.write(tmp_path / "stress.npz", contact, [1e-4, 2e-4], title="ball")
    with np.load(tmp_path / "stress.npz") as file:
        assert (file["von_mises"] == np.moveaxis(stress.in_volume([1e-4, 2e-4], quantity="von_mises"), 0, -1)).all()
    stress.write(tmp_path / "stress.vtr", contact, [1e-4, 2e-4], format="vtk")
    assert (tmp_path / "stress.vtr").stat().st_size > 0


def test_passes_of_attraction():
    law = vc.Attraction.exponential(0.05, 0.5e-6)
    law.check()
    grid, gel = vc.Grid(64, 0.4e-3), vc.Material(vc.Rheology.elastic(1e6))
    contact = vc.ViscoelasticContact(grid, vc.Shape.sphere(1e-3), gel, attraction=law)
    contact.step(0.0, vc.Load.approach(2e-6))
    passes = contact.passes
    assert passes["passes"] > 1 and passes["jumped"] in (True, False) and ball().passes is None
    with pytest.raises(ValueError, match="energy"):
        vc.Attraction.function(law.traction, lambda gap: 2 * law.energy(gap)).check()


def test_what_a_state_shows():
    contact = ball()
    report = contact.step(0.0, vc.Load.force(0.5))
    assert report.convolutions > 0 and "approach" in report.estimated and report.figures["touch"] is None
    labels, all = contact.patches()
    again, same = vc.patches(contact.grid, contact.pressure)
    assert (labels == again).all() and len(all) == len(same) == 1 and all[0]["cells"] == same[0]["cells"]


def test_states_go_back_and_conduct():
    states = vc.ElasticStates.sphere(10e-3)
    contact = vc.StatesContact(states, RUBBER)
    contact.step(0.5, vc.Load.force(1.0))
    before = contact.snapshot()
    contact.step(0.5, vc.Load.force(0.2))
    contact.restore(before)
    assert contact.time == 0.5 and contact.force == pytest.approx(1.0)
    level, traction = contact.tractions().T
    assert (traction * np.diff(level, prepend=0.0)).sum() == pytest.approx(contact.force) and contact.groups == len(level)
    assert states.conductance(1e-6, (1e-6, 3e-6)) == pytest.approx(2 * states.stiffness(1e-6) / 4e-6)
    assert states.grid is None and states.nu is None and states.first_level == 0
    ball, hertz = vc.ElasticStates.true_sphere(5e-6).level_at(1e-6), vc.ElasticStates.sphere(5e-6).level_at(1e-6)
    assert ball / hertz == pytest.approx(0.98, abs=2e-3)
    with pytest.raises(ValueError):
        contact.restore(vc.StatesContact(vc.ElasticStates.cone(0.5), RUBBER))


def test_an_elastic_contact():
    grid = vc.Grid(64, 3e-3)
    contact = vc.ElasticContact(grid, BALL, 4e6, tolerance=1e-8)
    report = contact.solve(vc.Load.force(0.5))
    radius = (0.75 * 0.5 * 10e-3 / 4e6) ** (1 / 3)
    assert contact.approach == pytest.approx(radius**2 / 10e-3, rel=2e-3) and report["convolutions"] > 0
    assert contact.contact_area == pytest.approx(np.pi * radius**2, rel=5e-3) and not report["warnings"]
    assert contact.picture("gap").pixels.std() > 0 and len(contact.patches()[1]) == 1
    with pytest.raises(ValueError, match="normal force"):
        contact.solve(vc.Load.force(-1.0))
    # a surface that is displaced by u is a gap that is wider by u
    x1 = (np.arange(64) - 31.5) * 3e-3 / 64
    surface = np.broadcast_to(1e-6 * np.cos(2000 * x1)[:, None], (64, 64))
    before = contact.fields
    contact.set_surface(surface)
    contact.solve(vc.Load.force(0.5))
    gaps = 0.5 * (x1[:, None] ** 2 + x1[None, :] ** 2) / 10e-3
    wider = vc.ElasticContact(grid, gaps + surface, 4e6, tolerance=1e-8)
    wider.solve(vc.Load.force(0.5))
    assert abs(contact.pressure - wider.pressure).sum() < 1e-6 * wider.pressure.sum()
    assert before.force == pytest.approx(0.5) and abs(before.pressure - contact.pressure).max() > 0


def test_sliding_shows_its_fields():
    grid = vc.Grid(32, 1e-3)
    parts = grid, vc.Shape.wavy((2e-6, 2e-6), (1e-3, 1e-3)), vc.Material(vc.Rheology.generalized_maxwell(1e6, [(1e7, 1e-4)]))
    kernel = vc.InfluenceKernel.periodic(grid)
    sliding = vc.SteadySliding(*parts, kernel=kernel)
    table = sliding.sweep([0.1, 1.0], vc.Load.force(0.02))
    contact = sliding.fields
    assert (contact.pressure == sliding.pressure).all() and len(contact.patches()[1]) >= 1
    assert (sliding.traction == sliding.pressure).all()
    assert vc.SteadySliding.memory(*parts, kernel=kernel) > 8 * 32 * 32
    assert table.picture().pixels.std() > 0 and table.picture("dissipation").pixels.shape == table.picture().pixels.shape
    with pytest.raises(ValueError, match='"friction"'):
        table.picture("velocity")


def test_pictures(tmp_path):
    contact = ball()
    with vc.Animation(tmp_path / "ball.gif", "pressure", (0.0, 3e5)) as animation:
        for _ in contact.follow(vc.Load.force(0.5), 0.2, dt=0.1):
            animation.record(contact)
    assert (tmp_path / "ball.gif").read_bytes()[:3] == b"GIF"
    with pytest.raises(RuntimeError, match="finished"):
        animation.record(contact)
    pictures = [contact.picture(field) for field in ("pressure", "gap", "displacement", "traction")]
    pictures += [contact.profile_picture(1), contact.stress_picture([1e-4, 2e-4, 3e-4], "tresca")]
    pictures.append(vc.Picture.map(contact.grid, contact.pressure, "pressure", "Pa", title="own", range=(0, 1e6)))
    pictures.append(vc.Picture.history([1.0, 2.0], {"a": [1.0, 2.0], "b": [2.0, 1.0]}, "force", "N", scale="log_log"))
    for picture in pictures:
        assert picture.pixels.dtype == np.uint8 and picture.pixels.std() > 0 and picture._repr_png_()[1:4] == b"PNG"
    whole = vc.Picture.beside(pictures[:2])
    assert whole.pixels.shape[1] == sum(picture.pixels.shape[1] for picture in pictures[:2])
    whole.save(tmp_path / "whole.png"), whole.save(tmp_path / "whole.svg")
    with pytest.raises(ValueError, match="png"):
        whole.save(tmp_path / "whole.jpg")
    with pytest.raises(ValueError, match="values: two axes"):
        vc.Picture.map(contact.grid, np.ones(3), "pressure")


def test_own_models_are_checked():
    times, grid = np.geomspace(1e-3, 1e3, 50), vc.Grid(16, 1e-3)
    vc.Rheology.zener(1e6, 1e6, 1.0).check(times), BALL.check(grid), vc.LoadHistory.held(vc.Load.force(1.0)).check(times)
    with pytest.raises(ValueError, match="creep rate never increases"):
        vc.Rheology.function(lambda t: 1e-6 * (1 + t**2)).check(times)
    with pytest.raises(ValueError, match="touch"):
        vc.Shape.function(lambda x1, x2: float("inf")).check(grid)
    for check in (vc.Rheology.function(lambda t: 1 / 0).check, vc.LoadHistory.function(lambda t: 1 / 0).check):
        with pytest.raises(ZeroDivisionError):
            check(times)
    with pytest.raises(ZeroDivisionError):
        vc.Shape.function(lambda x1, x2: 1 / 0).check(grid)


def test_more_of_materials():
    steel = vc.Rheology.elastic_young(210e9, 0.3)
    assert vc.Material(steel, nu=0.3).contact_compliance(0.0) == pytest.approx((1 - 0.09) / 210e9)
    assert vc.Material(steel, nu=0.3).nu == [0.3] and RUBBER.measured == (0, np.inf) == vc.Rheology.elastic(1.0).measured
    glassy, fluidity, terms = RUBBER.contact_spectrum
    assert glassy == pytest.approx(1 / 4e6) and fluidity == 0 and len(terms) == 1
    assert vc.Rheology.fractional_relaxing(1e6, 1e5, 1.0, 0.5).creep_compliance(0.0) == pytest.approx(1e-6)
    laws = {name: vc.TimeTemperature.published(name) for name in vc.published_materials()}
    assert any(laws.values())
    assert vc.Rheology.published("PMMA", 0.35).creep_compliance(0.0) > 0
    table = vc.TimeTemperature.table([(291.15, 1.0), (298.15, 0.03), (305.15, 0.001)], 291.15)
    assert table.extrapolated().shift_factor(320.0) < 1e-4
    below = vc.TimeTemperature.wlf(17.44, 51.6, 373.15).with_arrhenius_below(373.15, 200e3)
    assert 1 < below.shift_factor(363.15) < vc.TimeTemperature.wlf(17.44, 51.6, 373.15).shift_factor(363.15)
    warm = vc.TemperatureHistory(vc.TimeTemperature.arrhenius(300e3, 293.15), 298.15)
    assert copy.deepcopy(warm).reduced_time(0.0, 60.0) == warm.reduced_time(0.0, 60.0) > 60


def test_more_of_surfaces():
    grid = vc.Grid(32, 1e-3)
    longer = vc.HeightMap.rough(grid, 1e-3, 0.1e-3, rms_height=1e-6, period=2e-3)
    whole = vc.HeightMap.rough(grid, 1e-3, 0.1e-3, rms_height=1e-6)
    assert whole.is_periodic and whole.center == (0, 0) and longer.shape == (64, 64) and longer.gap(grid).shape == (32, 32)
    assert np.array_equal(whole.resampled(grid).heights, whole.heights)


def test_closed_forms():
    assert vc.hertz_ellipse((1e-2, 1e-2), 4e6, 1.0)["approach"] == pytest.approx(vc.hertz(1e-2, 4e6, 1.0)["approach"])
    assert vc.rigid_punch(1e-3, 4e6, 1.0) == {"approach": pytest.approx(1.25e-4), "tilt": 0}
    assert vc.rolling_cylinder(0.1, (2e-7, 8e-7), 2e3, 1e-6)["friction"] == pytest.approx(8e-6, rel=1e-3)
    jkr, dmt = vc.Jkr(1e-3, 1e5, 0.05), vc.Dmt(1e-3, 1e5, 0.05)
    assert jkr.pull_off_force == pytest.approx(0.75 * dmt.pull_off_force)
    assert jkr.state(jkr.radius_at_pull_off)[0] == pytest.approx(jkr.pull_off_force) and dmt.state(0.0)[0] == dmt.pull_off_force
    maugis = vc.MaugisDugdale(1e-3, 1e5, 0.05, 1e4)
    assert dmt.pull_off_force < maugis.pull_off[0] < jkr.pull_off_force and maugis.parameter > 0
    assert maugis.state(maugis.pull_off[1])[0] == pytest.approx(maugis.pull_off[0], rel=1e-6)
    punch = vc.AdhesivePunch(1e-3, 1e5, 0.05)
    assert punch.pull_off_force == pytest.approx(2e-3 * 1e5 * punch.approach_at_pull_off)
    roller = vc.AdhesiveCylinder(1e-3, 1e5, 0.05)
    assert roller.force(roller.width_at_pull_off) == pytest.approx(roller.pull_off_force)
    wave = vc.AdhesiveWave(1e-6, 1e-4, 1e5, 1e-5)
    assert wave.mean_pressure(wave.width_at_pull_off) == pytest.approx(wave.pull_off_pressure) and wave.strength > 0
    edge = vc.OpeningEdge(vc.Material(vc.Rheology.generalized_maxwell(25e3, [(225e3, 1.0)])), 0.1, 1e-6, zone=1.4)
    assert edge.length == pytest.approx(1e-6) and 0.1 < edge.work(1e-6) < 1.0
    with pytest.warns(UserWarning, match="lags by 1.000"):
        fast = edge.pull_off(1e-3, 30e-6, 1e-5)
    slow = edge.pull_off(1e-3, 30e-6, 1e-8)
    # E* = 1e5 Pa of the relaxed body, whose time of relaxation is 1 s
    assert fast["force"] < slow["force"] < 0 and slow["lag"] == pytest.approx(1e-8 / (1e-3 ** (1 / 3) * (0.1 / 1e5) ** (2 / 3)))
    with pytest.raises(ValueError, match="radius"):
        vc.Jkr(-1.0, 1e5, 0.05)


TRUTH = {"E0": 4000.0, "Einf": 2000.0, "tau": 0.5}


@pytest.fixture(scope="module")
def curve():
    experiment = vc.Experiment.trapezoid(1e-6, (0.5, 2.0, 0.5), 0.02, vc.ElasticStates.sphere(5e-6))
    force, _ = vc.Identification("zener").respond(experiment, TRUTH)
    return vc.Curve(experiment, force + 1e-11 * np.random.default_rng(1).normal(size=len(force)))


def test_what_a_fit_determines(curve, tmp_path):
    fit = vc.Identification("zener", robust=True).fit(curve)
    decades = fit.decades()
    assert any(decade["is_determined"] for decade in decades) and all(decade["times"][0] < decade["times"][1] for decade in decades)
    force, difference = fit.verify(vc.Grid(48, 6e-6), vc.Shape.sphere(5e-6))
    assert force == pytest.approx(fit.samples()["force"], abs=0.03 * force.max()) and difference < 0.03
    assert {variant["assumption"] for variant in fit.variants()} <= {"drift", "tilt", "correlated noise", "no outliers"}
    assert fit.model == "Zener" and fit.curves == 1 and fit.autoregression is None and fit.points_in_contact > 100
    assert 0.5 < fit.misfit[0] < 2 and fit.iterations > 0 and fit.covariance("E0", "E0") > 0
    assert fit.picture().pixels.std() > 0
    vc.write_fits(tmp_path / "fits.csv", [fit])
    assert (tmp_path / "fits.csv").read_text().startswith("model,aicc,parameter")
    for call in (fit.force, fit.samples, fit.contact_point):
        with pytest.raises(IndexError, match="curve 1 of 1"):
            call(1)


def test_fits_are_ranked(curve):
    fits = [vc.Identification(model).fit(curve) for model in ("elastic", "zener")]
    (best, none, weight), (other, more, _) = vc.ranked([*fits, ValueError("failed")])
    assert best.model == "Zener" and none == 0 and weight > 0.99 and more > 0 and other.model == "Elastic"


def test_contact_points_of_each_curve(curve):
    fit = vc.Identification("zener", contact_point=[0.0, True], tilt=0.0).fit([curve, curve])
    assert fit.contact_point(0) == 0 and 0 < abs(fit.contact_point(1)) < 1e-8


def test_parts_of_curves(curve):
    assert len(curve.within(0.0, 0.5)) == 25 and len(curve.approach()) < len(curve.loading()) < len(curve)
    assert len(curve.until_release()) <= len(curve) and curve.pull_off() is None
    elastic, _ = vc.Identification("elastic").respond(curve.experiment, {"E": 1e4})
    read = vc.Curve(curve.experiment, elastic).oliver_pharr(0.0, lambda h: 2 * np.pi * 5e-6 * h)
    assert read["modulus"] == pytest.approx(1e4, rel=0.1)
    with pytest.raises(ZeroDivisionError):
        curve.oliver_pharr(0.0, lambda h: 1 / 0)
    hold = curve.hold_relaxation()
    assert hold["glassy"] == pytest.approx(hold["equilibrium"] + hold["relaxing"])


def test_planned_experiments():
    tip = vc.ElasticStates.sphere(5e-6)
    stairs = vc.Experiment.staircase([1e-6, 2e-6], 0.1, 1.0, 0.05, tip)
    assert stairs.drive.max() == 2e-6 and stairs.times[-1] == pytest.approx(2.2)
    afm = vc.Experiment.ramp_hold_retract(2e-6, 1e-6, 3e-6, 5.0, 0.01, tip, stiffness=0.1)
    assert afm.drive[0] == -1e-6 and afm.times[-1] == pytest.approx(9.0)
    assert afm.load_history().at(3.0) == vc.Load.spring(0.1, 3e-6)


def test_text_files_are_read_as_told(tmp_path):
    rows = "\n".join(f"{k};{k},5;{2 * k},0;0" for k in range(5))
    (tmp_path / "curve.txt").write_text("made by a machine\nt [s];force [nN];base [um];other force [nN]\n" + rows)
    told = dict(skipped_lines=1, delimiter="semicolon", decimal_comma=True)
    for choice in ({"headings": {3: ""}}, {"only": ["t", "force", "base"]}):
        recording = vc.Recording.from_csv(tmp_path / "curve.txt", **told, **choice)
        assert recording.column("force") == pytest.approx((np.arange(5) + 0.5) * 1e-9)
        assert [column[1:] for column in recording.columns][:2] == [(0, "t [s]"), (1, "force [nN]")]
    with pytest.raises(OSError, match="absent"):
        vc.Recording.from_csv(tmp_path / "curve.txt", **told, only=["absent"])
    with pytest.raises(TypeError, match="unexpected keyword argument 'skip'"):
        vc.Recording.from_csv(tmp_path / "curve.txt", skip=1)
    (tmp_path / "creep.txt").write_text("\n".join(f"{t}\t{1 + t / (1 + t)}" for t in (0.1, 0.3, 1, 3, 10, 100)))
    creep = vc.Measurements.from_csv("creep", tmp_path / "creep.txt", delimiter="tab", units=(1.0, 1e-6))
    assert creep.fit().creep_compliance(1.0) == pytest.approx(1.5e-6, rel=0.05)


def test_exceptions_of_functions_on_two_threads():
    raised = []

    def solve(error):
        try:
            vc.Shape.function(lambda x1, x2: (_ for _ in ()).throw(error)).gap(vc.Grid(8, 1e-3))
        except Exception as exception:
            raised.append(exception is error)

    threads = [threading.Thread(target=solve, args=(error("own"),)) for error in (KeyError, ArithmeticError) * 5]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert raised == [True] * 10
