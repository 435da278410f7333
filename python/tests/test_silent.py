"""Nothing in silence: values off a domain, orientation, objects in use, cycles, signals, processes, pickles, equality, frames."""

import copy
import gc
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
import weakref

import numpy as np
import pytest
import viscocontact as vc

F, NAN = vc.Load.force, float("nan")
BODY = vc.Rheology.generalized_maxwell(1e6, [(5e6, 1e-3), (2e6, 0.1)])
RUBBER = vc.Material(BODY)
BALL = vc.Shape.sphere(10e-3)
TIP = vc.ElasticStates.sphere(5e-6)
EXPERIMENT = vc.Experiment.trapezoid(1e-6, (1.0, 3.0, 1.0), 0.05, TIP)
ZENER = vc.Identification("zener")
VALUES = {"E0": 4e3, "Einf": 2e3, "tau": 0.5}


def noisy(seed=0, experiment=EXPERIMENT):
    force, _ = ZENER.respond(experiment, VALUES)
    return vc.Curve(experiment, force + 1e-11 * np.random.default_rng(seed).normal(size=len(force)))


def ball(n=32, **options):
    return vc.ViscoelasticContact(vc.Grid(n, 4e-3), BALL, RUBBER, **options)


SWEPT = vc.ElasticStates.sweep(vc.Grid(16, 4e-3), BALL, level=1e-8)
FIT = ZENER.fit(noisy())
ATTRACTION = vc.Attraction.exponential(0.1, 1e-6)
GROWING = vc.GrowingSphere(1e-2, RUBBER, F(1.0))
WARM = vc.TemperatureHistory(vc.TimeTemperature.wlf(8.86, 101.6, 293.15), 300.0)
JKR = (1e-3, 1e5, 0.1)

# every function that is evaluated at a number or an array, and where it is defined from 0 on
EVALUATED = {
    **{f"{name}.{of}": (getattr(body, of), True)
       for name, body in {"prony": BODY, "elastic": vc.Rheology.elastic(1e6), "burgers": vc.Rheology.burgers(1e6, 1.0, 1e6, 1.0)}.items()
       for of in ("creep_compliance", "relaxation_modulus")},
    **{f"{model}.creep": (getattr(vc.Rheology, model)(*of).creep_compliance, True)
       for model, of in {"power_law": (1e-6, 1.0, 0.3), "kww": (1e-6, 1e-6, 1.0, 0.5), "log_creep": (1e-6, 1e-6, 1.0)}.items()},
    "material": (RUBBER.contact_compliance, True),
    **{f"{kind}.{of}": (getattr(states, of), of != "level_at") for kind, states in {"sphere": TIP, "swept": SWEPT}.items()
       for of in ("approach", "level_at", "area", "stiffness")},
    "conductance": (lambda level: TIP.conductance(level, (1.0, 1.0)), True),
    "traction": (ATTRACTION.traction, True), "energy": (ATTRACTION.energy, True),
    "radius": (GROWING.contact_radius, True), "growing": (GROWING.approach, True), "pressure": (lambda r: GROWING.pressure(r, 1.0), True),
    "temperature": (WARM.at, True), "modulus": (FIT.modulus, True), "deviation": (FIT.modulus_deviation, True),
    "friction": (vc.FrictionLimit.tresca(0.5).limit, True),
    "height": (lambda x: vc.HeightMap(np.zeros((4, 4)), 1.0).height_at(x, 0.0), False),
}


@pytest.mark.parametrize("name", EVALUATED)
def test_nan_stays_nan_and_what_is_off_the_domain_is_refused(name):
    function, from_zero = EVALUATED[name]
    assert np.isnan(function(NAN))
    some = function(np.array([[NAN, 1e-9], [2e-9, NAN]]))
    assert (np.isnan(some) == [[True, False], [False, True]]).all() and some[0, 1] == function(1e-9)
    if from_zero:
        for bad in (-1e-9, np.array([1.0, -1.0]), -np.inf):
            with pytest.raises(ValueError, match="at least 0"):
                function(bad)


@pytest.mark.parametrize("law", [vc.Jkr(*JKR).state, vc.Dmt(*JKR).state, vc.MaugisDugdale(*JKR, 1e5).state, vc.AdhesiveCylinder(*JKR).force])
def test_contacts_of_negative_size_are_refused(law):
    assert np.isnan(law(NAN)).all()
    with pytest.raises(ValueError, match="at least 0"):
        law(-1e-5)


def test_complex_moduli_of_all_frequencies():
    omega = np.geomspace(1e-6, 1e6, 41)
    for body in (BODY, vc.Rheology.maxwell(1e6, 1.0), vc.Rheology.burgers(1e6, 1.0, 1e6, 1.0), vc.Rheology.kelvin_voigt(1e6, 1.0)):
        assert body.complex_modulus(-omega) == pytest.approx(body.complex_modulus(omega).conj(), rel=1e-14)
        # the Fourier transform of a series, term by term
        assert body.complex_modulus(np.fft.rfftfreq(8)).shape == (5,)
        assert np.isnan(body.complex_modulus(NAN))
    terms = sum(g * 1j * omega * tau / (1 + 1j * omega * tau) for g, tau in ((5e6, 1e-3), (2e6, 0.1)))
    assert BODY.complex_modulus(omega) == pytest.approx(1e6 + terms, rel=1e-9)
    assert vc.Rheology.maxwell(1e6, 1.0).complex_modulus(0.0) == 0 and BODY.complex_modulus(0.0) == pytest.approx(1e6)
    assert isinstance(BODY.complex_modulus(1.0), complex)


def test_a_matrix_has_one_orientation(tmp_path):
    heights = np.arange(12.0).reshape(3, 4) * 1e-6
    np.savetxt(tmp_path / "a.txt", heights), np.save(tmp_path / "a.npy", heights)
    read = lambda name, lengths=(3e-3, 4e-3), **more: vc.HeightMap.read(tmp_path / name, lengths=lengths, unit="m", **more)
    for name in ("a.txt", "a.npy"):
        assert (read(name).heights == heights).all() and read(name).lengths == (3e-3, 4e-3)
        picture = read(name, (4e-3, 3e-3), orientation="picture")
        # a line along x1, the first at the maximum x2
        assert (picture.heights == heights[::-1].T).all() and picture.lengths == (4e-3, 3e-3)
        with pytest.raises(ValueError, match=r"lengths = \(0.004, 0.003\)"):
            read(name, (4e-3, 3e-3))
        with pytest.raises(ValueError, match="orientation"):
            read(name, orientation="turned")
    with pytest.warns(UserWarning, match="other axes"):
        vc.HeightMap(heights, (4e-3, 3e-3))
    for nothing in (lambda: vc.HeightMap(np.full((4, 4), NAN), 1.0), lambda: vc.HeightMap(np.eye(4) * NAN + NAN, 1.0).masked()):
        with pytest.raises(ValueError, match="none is known"):
            nothing()


@pytest.mark.parametrize("bad, error, text", [
    (lambda: ball(max_iterations=-1), ValueError, "whole number"),
    (lambda: vc.HeightMap.rough(vc.Grid(16, 1e-3), 5e-4, 2e-4, rms_slope=0.1, seed=-1), ValueError, "whole number"),
    (lambda: ball(tolerence=1e-3), TypeError, "did you mean 'tolerance'"),
    (lambda: vc.Identification("zener", robsut=True), TypeError, "did you mean 'robust'"),
    (lambda: ball(times=(10, 1)), ValueError, "times = "),
    (lambda: ball(temperature=300.0), TypeError, "TemperatureHistory"),
    (lambda: vc.Rheology.function(3.0), TypeError, "a function is needed"),
    (lambda: vc.Identification(("prony", 0)), ValueError, "1 to 50"),
    (lambda: vc.Identification(("prony", 100)), ValueError, "1 to 50"),
    (lambda: vc.Identification("prony"), ValueError, "power_law_solid"),
    (lambda: vc.Identification("zener", start={"tau": -1.0}), ValueError, "tau"),
    (lambda: vc.Identification("zener", known_sigma=-1.0), ValueError, "noise"),
    (lambda: vc.Identification("zener", noise=2.0), ValueError, "autoregressive"),
    (lambda: vc.Identification(("power_law", -1.0)), ValueError, "cutoff"),
    (lambda: vc.Recording([0.0, 1.0]), ValueError, "no column"),
    (lambda: vc.Recording([1.0, 0.0], force=[1.0, 2.0]), ValueError, "ascend"),
    (lambda: ZENER.respond(EXPERIMENT, {"E0": 4e3}), ValueError, "Einf"),
    (lambda: vc.Grid(True, 1.0), TypeError, "no number"),
    (lambda: np.zeros((4, 4)) + BALL, TypeError, "gap_on"),
    (lambda: ball().step(1.0, 2.0), TypeError, "Load.force"),
    (lambda: vc.SteadySliding(vc.Grid(16, 4e-3), BALL, RUBBER).pressure, RuntimeError, "no state"),
    (lambda: vc.HeightMap.read("nothing.sdf"), FileNotFoundError, "nothing.sdf"),
    (lambda: ball().resume("nothing"), FileNotFoundError, "nothing"),
    (lambda: ball().picture().save("x.jpg"), ValueError, "png"),
    (lambda: ball().plot("speed"), ValueError, "must be one of pressure"),
    (lambda: ball().follow(F(0.1), 1.0, fields_to=1e-3), TypeError, "sample_at"),
    (lambda: vc.FrictionLimit.coulomb(0.5).limit(-1.0), ValueError, "pressure = -1"),
    (lambda: vc.ElasticContact(vc.Grid(16, 4e-3), BALL, 4e6).stress(), ValueError, "SubsurfaceStress"),
    (lambda: ball().stress(in_counter_body=True), ValueError, "no counter_body="),
    (lambda: ball(tolerance=2.0), ValueError, "^tolerance = 2"),
    (lambda: FIT.profile_interval("contact_pont"), ValueError, "the names are"),
])
def test_what_is_not_allowed_is_told_when_it_is_given(bad, error, text):
    with pytest.raises(error, match=text) as caught:
        bad()
    if sys.version_info >= (3, 11) and text == "TemperatureHistory":
        assert caught.value.__notes__ == ["while processing 'temperature'"]
    if isinstance(caught.value, FileNotFoundError):
        assert caught.value.errno == 2 and caught.value.filename.startswith("nothing")


def test_sums_of_shapes():
    grid = vc.Grid(8, 1e-3)
    assert (sum([BALL, BALL, BALL]).gap(grid) == 3 * BALL.gap(grid)).all()


def test_an_object_in_use_says_so():
    run = ball(128).follow(F(0.1), until=1.0, dt=0.02)
    errors, stop = set(), threading.Event()

    def watch():
        while not stop.is_set():
            for name in ("progress", "events", "is_met", "rejected_steps"):
                try:
                    getattr(run, name)
                except Exception as error:
                    errors.add((type(error), str(error)[:40]))

    thread = threading.Thread(target=watch)
    thread.start()
    assert len(list(run)) == 51
    stop.set(), thread.join()
    assert {kind for kind, _ in errors} <= {RuntimeError} and all("is computing" in text for _, text in errors)
    again = ball().follow(F(0.1), until=1.0)
    again.stop_when(lambda contact: next(again).time, up=0.05)
    with pytest.raises(RuntimeError, match="is computing"):
        list(again)
    last = ball().follow(F(0.1), until=1.0, progress=lambda share: next(last))
    with pytest.raises(RuntimeError, match="Run is computing"):
        list(last)


class Model:
    """A model of one's own, as classes are written."""

    def gap(self, x1, x2):
        return x1 * x1 + x2 * x2

    def of_time(self, t):
        return 1e-6 * (1.0 + t)

    def load(self, t):
        return F(0.1)

    def force(self, contact):
        return contact.force


GRID = vc.Grid(8, 1e-3)
FLAT = vc.Shape.wavy(1e-6, 1e-3)
HELD = {
    "shape": lambda o: vc.Shape.function(o.gap),
    "sum of shapes": lambda o: vc.Shape.function(o.gap).shifted((1e-4, 0)) + BALL,
    "rheology": lambda o: vc.Rheology.function(o.of_time),
    "material": lambda o: vc.Material(vc.Rheology.function(o.of_time)).fitted(1e-3, 1.0),
    "tension": lambda o: vc.Tension(vc.Rheology.function(o.of_time)),
    "load": lambda o: vc.LoadHistory.function(o.load),
    "temperature": lambda o: vc.TemperatureHistory(vc.TimeTemperature.wlf(8.86, 101.6, 293.15), lambda t: o and 300.0),
    "attraction": lambda o: vc.Attraction.function(o.of_time, o.of_time),
    "kernel": lambda o: vc.InfluenceKernel.from_spectrum(GRID, lambda q1, q2: o and 1.0),
    "contact": lambda o: vc.ViscoelasticContact(GRID, vc.Shape.function(o.gap), RUBBER),
    "copy of a contact": lambda o: copy.copy(vc.ViscoelasticContact(GRID, vc.Shape.function(o.gap), RUBBER)),
    "elastic contact": lambda o: vc.ElasticContact(GRID, vc.Shape.function(o.gap), 1e6),
    "sweep": lambda o: vc.ElasticStates.sweep(vc.Grid(16, 4e-3), vc.Shape.function(o.gap), level=1e-9),
    "states": lambda o: vc.StatesContact(TIP, vc.Material(vc.Rheology.function(o.of_time)).fitted(1e-3, 1.0)),
    "run": lambda o: ball(8).follow(o.load, until=1.0),
    "progress": lambda o: ball(8).follow(F(0.1), until=1.0, progress=o.of_time),
    "event": lambda o: [run := ball(8).follow(F(0.1), until=1.0), run.stop_when(o.force, up=0.05)],
    "event of a contact": lambda o: [c := ball(8), c.follow(F(0.1), until=1.0).stop_when(lambda k: c.force + o.force(k), up=0.05)],
    "load that sees its contact": lambda o: [c := ball(8), c.follow(lambda t: F(0.1) if o and c else None, until=1.0)],
    "sliding": lambda o: vc.SteadySliding(GRID, FLAT, RUBBER, modulus=lambda w: o and 1e6 + 0j, kernel=vc.InfluenceKernel.periodic(GRID)),
    "sliding shape": lambda o: vc.SteadySliding(GRID, vc.Shape.function(o.gap), RUBBER),
    "growing": lambda o: vc.GrowingSphere(1e-2, RUBBER, o.load),
    "edge": lambda o: vc.OpeningEdge(vc.Material(BODY), 0.05, 1e-7) and vc.Shape.function(o.gap),
    "experiment": lambda o: vc.Experiment([0.0, 1.0], [0.0, 1e-9], vc.ElasticStates.sweep(vc.Grid(16, 4e-3), vc.Shape.function(o.gap), level=1e-9)),
    "pickle": lambda o: pickle.loads(pickle.dumps(BALL)) + vc.Shape.function(o.gap),
}


@pytest.mark.parametrize("name", HELD)
def test_cycles_through_functions_are_collected(name):
    model = Model()
    model.part = HELD[name](model)
    seen = weakref.ref(model)
    assert seen() is model
    del model
    gc.collect()
    assert seen() is None


def test_a_function_lives_as_long_as_what_calls_it():
    model = Model()
    contact = vc.ViscoelasticContact(vc.Grid(16, 4e-3), BALL, vc.Material(vc.Rheology.function(model.of_time)), times=(1e-3, 10.0))
    run = contact.follow(model.load, until=1.0)
    states = vc.StatesContact(TIP, vc.Material(vc.Rheology.function(model.of_time)).fitted(1e-3, 10.0))
    del model, contact
    gc.collect()
    assert len(list(run)) > 3 and states.step(0.1, F(1e-9)).approach > 0


def interrupted(job, after=0.2):
    """Seconds from Ctrl-C to KeyboardInterrupt."""
    sent = []

    def send():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        job()
        time.sleep(5.0)
    timer.join()
    return time.perf_counter() - sent[0]


@pytest.mark.skipif(sys.platform == "win32", reason="signals are others")
def test_ctrl_c_ends_fits():
    fine = vc.Experiment.trapezoid(1e-6, (1.0, 3.0, 1.0), 0.002, TIP)
    curves = [noisy(seed, fine) for seed in range(40)]
    many = vc.Identification(("prony", 20))
    jobs = [lambda: many.fit(curves[0]), lambda: vc.Identification(("prony", 5), contact_point=True).fit_each(curves)]
    for job in jobs:
        assert interrupted(job) < 1.0       # 0.1 s where nothing else runs


def test_progress_ends_fits():
    seen = []
    with pytest.raises(vc.Cancelled):
        ZENER.fit(noisy(), progress=lambda: seen.append(1) or len(seen) < 3)
    assert len(seen) == 3
    with pytest.raises(ZeroDivisionError):
        ZENER.fit(noisy(), progress=lambda: 1 / 0)
    shares = []
    fits = ZENER.fit_each([noisy(seed) for seed in range(4)], progress=shares.append)
    assert sorted(shares) == [0.25, 0.5, 0.75, 1.0] and all(isinstance(fit, vc.Fit) for fit in fits)


def stepped(force):
    grid = vc.Grid(256, 1e-3)
    contact = vc.ElasticContact(grid, ROUGH, 1e6, kernel=vc.InfluenceKernel.periodic(grid))
    contact.solve(F(force))
    return contact.approach


ROUGH = vc.HeightMap.rough(vc.Grid(256, 1e-3), 5e-4, 5e-5, rms_slope=0.1)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_process_that_was_forked_computes_on_a_thread_of_its_own():
    expected = [stepped(0.01), stepped(0.02)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(stepped, [0.01, 0.02]).get(60) == expected


CREEP = lambda shift: vc.Measurements.creep(np.geomspace(0.1, 10.0, 9), 1e-6 * (1 + (np.geomspace(0.1, 10.0, 9) / shift) ** 0.3))
MASTER = vc.MasterCurve(300.0, [(300.0, CREEP(1.0)), (310.0, CREEP(0.1))])
PICKLED = {
    "fit": FIT, "estimate": FIT["tau"], "curve": noisy(), "experiment": EXPERIMENT, "identification": vc.Identification("zener", contact_point=True, fix={"tau": 0.5}),
    "recording": vc.Recording([0.0, 1.0], force=[0.0, 1.0]), "report": ball().step(0.1, F(0.1)), "body": ball().bodies[0],
    "times": vc.Times.every(0.1) + [0.5], "jkr": vc.Jkr(*JKR), "growing": GROWING, "edge": vc.OpeningEdge(RUBBER, 0.05, 1e-7),
    "sliding report": vc.SteadySliding(GRID, FLAT, RUBBER, kernel=vc.InfluenceKernel.periodic(GRID)).at(1.0, F(1e-4)),
    "load": F(1.0, at=(1e-3, None)), "map": vc.HeightMap(np.eye(4), 1.0), "shape": BALL + FLAT, "grid": GRID, "measurements": vc.Measurements.creep([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 2.5, 2.8]),
    "swept": vc.SteadySliding(GRID, FLAT, RUBBER, kernel=vc.InfluenceKernel.periodic(GRID)).sweep([0.1, 1.0], F(1e-4)),
    "master curve": MASTER, "body of a master curve": MASTER.fit(), "tension": vc.Tension(BODY),
    "iterators": vc.Material(vc.Rheology.generalized_maxwell(1e6, zip([5e6], [1.0])), 0.3), "generator": vc.Rheology.generalized_maxwell(1e6, ((g, 1.0) for g in (1e6,))),
}


@pytest.mark.parametrize("name", PICKLED)
def test_pickles_and_copies_are_equal(name):
    own = PICKLED[name]
    for again in (pickle.loads(pickle.dumps(own)), copy.copy(own), copy.deepcopy(own)):
        assert type(again) is type(own) and repr(again) == repr(own) and "object at 0x" not in repr(own)
        if name != "fit":
            assert again == own and not again != own
    if name == "fit":
        again = pickle.loads(pickle.dumps(own))
        assert again.estimates == own.estimates and (again.force()[0] == own.force()[0]).all()
        assert again.profile_interval("tau") == own.profile_interval("tau") and again.aicc == own.aicc


def test_a_steady_motion_travels_as_it_was_made():
    options = {"kernel": vc.InfluenceKernel.periodic(GRID), "tolerance": 1e-8}
    made = [vc.SteadySliding(GRID, FLAT, RUBBER, **options), vc.SteadySliding(GRID, FLAT, RUBBER, modulus=abs_of_one, **options)]
    for own in made:
        first = own.at(1.0, F(1e-4))
        again = pickle.loads(pickle.dumps(own))
        with pytest.raises(RuntimeError, match="no state"):
            again.pressure
        assert again.at(1.0, F(1e-4)) == first


def abs_of_one(omega):
    return 1e6 * (1 + 0.1j * omega / (1 + omega))


def test_a_master_curve_of_a_file_travels(tmp_path):
    path, t = tmp_path / "curve.csv", np.geomspace(0.1, 10.0, 9)
    rows = [f"{T},{t_},{1e-6 * (1 + (t_ / shift) ** 0.3)}" for T, shift in ((300.0, 1.0), (310.0, 0.1)) for t_ in t]
    path.write_text("T [K],t [s],J [1/Pa]\n" + "\n".join(rows) + "\n")
    curve = vc.MasterCurve.from_csv("creep", path, 300.0, units="headings")
    path.unlink()
    again = pickle.loads(pickle.dumps(curve))
    assert again == curve and again.shift_factors == curve.shift_factors == MASTER.shift_factors
    assert pickle.loads(pickle.dumps(curve.fit())).creep_compliance(1.0) == curve.fit().creep_compliance(1.0)


def test_lateral_force_is_one_property():
    sliding = vc.SteadySliding(GRID, FLAT, RUBBER, kernel=vc.InfluenceKernel.periodic(GRID))
    report = sliding.at(1.0, F(1e-4))
    rubbed = vc.StatesContact(TIP, RUBBER, estimated_friction=0.5)
    rubbed.step_sheared(0.0, F(1e-6), F(2e-7))
    in_space = vc.FrictionContact(vc.Grid(16, 4e-3), BALL, RUBBER, 0.5)
    in_space.step(0.0, F(0.1), vc.ShearLoad((0.02, 0.0)))
    assert report.dissipation == pytest.approx(1.0 * report.lateral_force[0])
    assert rubbed.lateral_force == pytest.approx(2e-7) and in_space.lateral_force == pytest.approx((0.02, 0.0), abs=1e-8)
    assert (report.force, rubbed.force, in_space.force) == pytest.approx((1e-4, 1e-6, 0.1))
    assert not any(hasattr(kind, "lateral_force") for kind in (vc.ViscoelasticContact, vc.ElasticContact, vc.Fields))


def test_a_prony_series_is_of_the_pairs_of_rust():
    shares = vc.Rheology.prony(4e6, [(0.5, 0.1), (0.25, 10.0)])
    assert shares.creep_spectrum == vc.Rheology.generalized_maxwell(1e6, [(2e6, 0.1), (1e6, 10.0)]).creep_spectrum
    assert shares.creep_spectrum == vc.Rheology.prony_long_term(1e6, [(2.0, 0.1), (1.0, 10.0)]).creep_spectrum
    with pytest.raises(ValueError, match="generalized_maxwell"):
        vc.Rheology.prony(1e6, [(5e6, 1e-3)])
    with pytest.raises(ValueError, match="sum of the shares"):
        vc.Rheology.prony(1e6, [(0.6, 1.0), (0.6, 2.0)])


def test_tables_are_read_by_pandas_without_an_option(tmp_path):
    pandas = pytest.importorskip("pandas")
    contact = ball()
    history = vc.CsvHistory(tmp_path / "history.csv", contact, notes={"a": "b,c\n#"}, columns=["twice, or so [N]"])
    for report in contact.follow(F(0.2), 0.3, dt=0.1):
        history.record(contact, report, [2 * report.force])
    PICKLED["swept"].write_csv(tmp_path / "swept.csv")
    vc.write_fits(tmp_path / "fits.csv", [FIT])
    vc.Study(BALL, RUBBER, F(1.0), 1.0, accuracy=1e-2).write_csv(tmp_path / "study.csv")
    words = {"history": set(), "swept": {"warnings"}, "fits": {"model", "parameter", "unit", "scale of deviation", "warnings"}, "study": {"row"}}
    for name, of_words in words.items():
        frame = pandas.read_csv(tmp_path / f"{name}.csv")
        numbers = set(frame.select_dtypes("number").columns)
        assert len(frame) >= 2 and numbers | of_words == set(frame.columns) and len(numbers) >= 4, name
    frame = pandas.read_csv(tmp_path / "history.csv")
    assert frame["time [s]"].iloc[-1] == contact.time and frame["twice, or so [N]"].iloc[-1] == pytest.approx(0.4)


def test_a_fit_of_a_list_keeps_what_was_of_its_curve():
    curves = [noisy(0), noisy(1)]
    fits = vc.Identification("zener", contact_point=[1e-9, True], noise="autoregressive").fit_each(curves)
    for fit in fits:
        assert pickle.loads(pickle.dumps(fit)).estimates == fit.estimates
    assert len(fits[1].estimates) == len(fits[0].estimates) + 1
    assert vc.ranked(fits[:1])[0][0] is fits[0]


def test_a_parameter_has_the_name_of_its_keyword():
    fit = vc.Identification("zener", contact_point=True).fit(noisy())
    assert fit["contact_point"] == fit["contact point"]
    assert fit.correlation("contact_point", "tau") == fit.correlation("contact point", "tau") is not None
    low, high = fit.profile_interval("contact_point")
    assert low < fit["contact_point"].value < high


def test_a_table_without_its_headings_is_told_by_keywords(tmp_path):
    (tmp_path / "curve.csv").write_text("a,b\n1,2\n3,4\n")
    with pytest.raises(OSError, match="only=, name columns by headings=, .* skipped_lines, or state delimiter"):
        vc.Recording.from_csv(tmp_path / "curve.csv")


def test_fields_are_kept_while_a_contact_goes_on():
    contact = ball()
    contact.step(0.1, F(0.1))
    before = contact.fields
    contact.step(0.1, F(0.2))
    assert before.force == 0.1 and (before.pressure != contact.pressure).any()


def test_values_are_equal_and_hashed_by_value():
    made = [
        lambda: vc.Grid((4, 8), 1.0), lambda: F(1.0), lambda: BALL + FLAT, lambda: vc.HeightMap(np.ones((2, 2)), 1.0), lambda: vc.Material(BODY, 0.3),
        lambda: vc.Rheology.generalized_maxwell(1e6, np.array([[5e6, 1.0]])), lambda: vc.LoadHistory.ramp(F(0), F(1), 1.0), lambda: vc.InfluenceKernel.periodic(GRID),
        lambda: vc.Shape.gap_on(GRID, np.zeros((8, 8))), lambda: vc.Attraction.dugdale(0.1, 1e-6), lambda: vc.TimeTemperature.arrhenius(1e5, 300.0),
    ]
    every = [make() for make in made]
    for k, make in enumerate(made):
        assert make() == every[k] and hash(make()) == hash(every[k])
        assert sum(one == every[k] for one in every) == 1
    assert vc.Rheology.generalized_maxwell(1e6, [(5e6, 1.0)]) == vc.Rheology.generalized_maxwell(1e6, [[5e6, 1]]) != vc.Rheology.generalized_maxwell(1e6, [(5e6, 2.0)])
    assert len({make() for make in made} | set(every)) == len(made) and BALL != 3


def test_pickles_need_no_folder(monkeypatch):
    monkeypatch.setenv("TMPDIR", "/nowhere")
    contact, states = ball(), vc.StatesContact(SWEPT, RUBBER)
    contact.step(0.1, F(0.1)), states.step(0.1, F(1e-3))
    for own in (contact, states):
        again = pickle.loads(pickle.dumps(own))
        assert again.step(0.1, F(1e-3)).approach == own.step(0.1, F(1e-3)).approach
    assert (pickle.loads(pickle.dumps(SWEPT)).table()["level"] == SWEPT.table()["level"]).all()


def test_frames_and_plots(tmp_path):
    plt = pytest.importorskip("matplotlib.pyplot")
    plt.switch_backend("agg")
    contact = ball()
    contact.step(0.1, F(0.1))
    sliding = vc.SteadySliding(GRID, FLAT, RUBBER, kernel=vc.InfluenceKernel.periodic(GRID))
    table = sliding.sweep([0.1, 1.0], F(1e-4))
    map = vc.HeightMap(np.random.default_rng(0).normal(size=(4, 6)), (4.0, 6.0))
    for drawn in (contact, sliding, table, map, noisy(), FIT, SWEPT, ball().follow(F(0.1), 1.0, dt=0.5)):
        ax = plt.subplots()[1]
        assert drawn.plot(ax=ax) is ax and ax.get_xlabel() and ax.get_ylabel()
    assert map.plot().get_xlabel() == "x1 [mm]"
    with pytest.raises(ValueError, match="must be one of"):
        table.plot("speeed")
    plt.close("all")
    pandas = pytest.importorskip("pandas")
    for made, rows in ((table, 2), (noisy(), 101), (FIT, 3), (SWEPT, len(SWEPT)), (ball().follow(F(0.1), 1.0, dt=0.5), 3)):
        assert isinstance(made.to_dataframe(), pandas.DataFrame) and len(made.to_dataframe()) in (rows, 0)
    history = vc.CsvHistory(tmp_path / "h.csv", contact)
    history.record(contact, contact.step(0.1, F(0.2)))
    assert history.to_dataframe()["force [N]"].iloc[0] == contact.force
    pytest.importorskip("xarray")
    fields = contact.to_xarray()
    assert (fields["pressure"].values == contact.pressure).all() and float(fields["x1"][0]) == contact.grid.coordinates()[0][0, 0]
    assert map.to_xarray()["heights"].sel(x1=0.5, method="nearest").shape == (6,)


def test_a_map_of_a_topography():
    class Topography:
        unit, physical_sizes, is_periodic = "um", (3.0, 4.0), True

        def heights(self):
            return np.ma.masked_array(np.arange(12.0).reshape(3, 4), np.arange(12).reshape(3, 4) == 5)

    map = vc.HeightMap.from_topography(Topography())
    assert map.lengths == pytest.approx((3e-6, 4e-6)) and map.missing == 1 and map.is_periodic
    assert map.heights[2, 3] == pytest.approx(11e-6)
    Topography.unit = None
    with pytest.raises(ValueError, match="unit"):
        vc.HeightMap.from_topography(Topography())


def test_maps_are_what_they_were_made_of(tmp_path):
    """Points beside a map stay masked in a pickle, marks of missing points are told, files are whole."""
    small = vc.HeightMap(np.arange(16.0).reshape(4, 4) * 1e-6, (1e-3, 1e-3))
    wide = small.resampled(vc.Grid(8, 2e-3))
    again = pickle.loads(pickle.dumps(wide))
    assert wide.missing == again.missing > 0
    for shape in [wide, again]:
        vc.ViscoelasticContact(vc.Grid(8, 2e-3), shape, vc.Material(vc.Rheology.elastic(1e6)))
    points = [[0, 0, 1e-6], [1e-3, 0, NAN], [0, 1e-3, 1e-6], [1e-3, 1e-3, 2e-6]]
    assert vc.HeightMap.from_points(points).missing == 1
    path = tmp_path / "map.npy"
    np.save(path, np.array([[1, 2, 3], [4, -9999, 6]], dtype="int16"))
    with pytest.raises(TypeError, match="missing_height"):
        vc.HeightMap.read(path, lengths=(1e-3, 1e-3), unit="um", missing_height=-9999)
    with pytest.raises((OSError, ValueError), match="-9999"):
        vc.HeightMap.read(path, lengths=(2e-3, 3e-3), unit="um")
    small.write(path)
    assert vc.HeightMap.read(path, lengths=(1e-3, 1e-3), unit="m").missing == 0
    assert [file.name for file in tmp_path.iterdir()] == ["map.npy"]


def test_known_laws_have_no_isotherm_at_their_reference():
    law = vc.TimeTemperature.wlf(10.0, 60.0, 300.0)
    curve = vc.MasterCurve(300.0, [(310.0, CREEP(0.1)), (320.0, CREEP(0.01))], law=law)
    assert curve.shift_table().shift_factor(300.0) == 1.0
