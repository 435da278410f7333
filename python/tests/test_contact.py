"""Contacts, runs, fields, errors, pickles."""

import copy
import itertools
import math
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest
import viscocontact as vc

GRID, BALL = vc.Grid(32, 4e-3), vc.Shape.sphere(10e-3)
RUBBER = vc.Material(vc.Rheology.zener(1e6, 5e5, 1.0))


def ball(n=32, **options):
    return vc.ViscoelasticContact(vc.Grid(n, 4e-3), BALL, RUBBER, **options)


def test_hertz():
    contact = ball(64)
    report = contact.step(0.0, vc.Load.force(1.0))
    assert report.approach == pytest.approx(vc.hertz(10e-3, 4e6, 1.0)["approach"], rel=2e-3)
    assert contact.pressure.sum() * contact.grid.cell_area == pytest.approx(1.0, rel=1e-6)
    assert contact.max_pressure == contact.pressure.max()


def test_an_array_is_a_shape():
    x1, x2 = GRID.coordinates()
    gap = (x1**2 + x2**2) / (2 * 10e-3)
    given = [gap, vc.Shape.gap_on(GRID, gap), vc.Shape.function(lambda x, y: (x * x + y * y) / (2 * 10e-3))]
    pressures = []
    for shape in given:
        contact = vc.ViscoelasticContact(GRID, shape, RUBBER)
        contact.step(0.0, vc.Load.force(1.0))
        contact.step(0.3, vc.Load.force(0.7))
        pressures.append(contact.pressure)
    exact = ball()
    exact.step(0.0, vc.Load.force(1.0))
    exact.step(0.3, vc.Load.force(0.7))
    for pressure in pressures:
        assert np.abs(pressure - exact.pressure).max() < 1e-9 * exact.pressure.max()


@pytest.mark.parametrize("dtype", ["float32", "float64", "int64", "uint8", ">f8", "float16", "bool", "longdouble"])
@pytest.mark.parametrize("order", ["C", "F", "strided", "reversed", "read-only"])
def test_arrays_of_any_type_and_order(dtype, order):
    values = (np.arange(16 * 16).reshape(16, 16) % 7 % 2).astype(dtype)
    wanted = values.astype("float64")
    if order == "F":
        values = np.asfortranarray(values)
    elif order == "strided":
        wide = np.zeros((32, 48), dtype)
        wide[::2, ::3] = values
        values = wide[::2, ::3]
    elif order == "reversed":
        values = np.ascontiguousarray(values[::-1, ::-1])[::-1, ::-1]
    elif order == "read-only":
        values.flags.writeable = False
    grid = vc.Grid(16, 1.0)
    assert (vc.Shape.gap_on(grid, values).gap(grid) == wanted).all()
    assert (vc.HeightMap(values, 1.0).heights == wanted).all()


def test_a_mask_hides_its_values():
    hidden = np.ma.masked_equal(np.ones((16, 16)), 2.0)
    hidden[2, 3] = np.ma.masked
    assert vc.HeightMap(hidden, 1e-3).missing == 1 == vc.HeightMap(hidden.astype("float32"), 1e-3).missing
    assert vc.HeightMap(np.ma.masked_equal([[1, 2], [3, 4]], 4), 1e-3).missing == 1
    with pytest.raises(ValueError, match="gap: value 35 .* is NaN"):
        vc.Shape.gap_on(vc.Grid(16, 1.0), hidden)
    with pytest.raises(ValueError, match="forces: value 1 .* is NaN"):
        vc.LoadHistory.forces([0.0, 1.0], np.ma.masked_equal([1.0, 2.0], 2.0))


class Early(np.ndarray):
    """An array of NumPy before 2.4: one of a single value is a number, too."""

    def __float__(self):
        return float(self.item())


def test_functions_of_numbers_and_arrays():
    body = vc.Rheology.generalized_maxwell(1e6, [(1e6, 1.0)])
    functions = [
        body.creep_compliance,
        body.relaxation_modulus,
        RUBBER.contact_compliance,
        vc.Attraction.exponential(0.05, 1.0).traction,
        vc.TemperatureHistory(vc.TimeTemperature.arrhenius(1e5, 300.0), 300.0).at,
        vc.ElasticStates.sphere(1e-2).approach,
        vc.GrowingSphere(1e-2, RUBBER, vc.Load.force(1.0)).approach,
    ]
    for function in functions:
        for number in (0.5, np.float64(0.5), np.array(0.5)):
            assert isinstance(function(number), float)
        for shape in ((1,), (1, 1), (2, 3), (0,)):
            assert function(np.full(shape, 0.5).view(Early)).shape == shape
        assert function([0.5]).tolist() == [function(0.5)]


def test_there_is_nothing_beside_the_grid_of_a_gap():
    x1, x2 = GRID.coordinates()
    shape = vc.Shape.gap_on(GRID, (x1**2 + x2**2) / (2 * 10e-3))
    assert (shape.gap(GRID) == shape.shifted((0, 0)).gap(GRID)).all()
    moved = shape.shifted((1e-3, 0)).gap(GRID)
    assert np.isinf(moved[:8]).all() and (moved[8:] == shape.gap(GRID)[:-8]).all()
    wide = shape.gap(vc.Grid(64, 8e-3))
    assert (wide[16:48, 16:48] == shape.gap(GRID)).all() and np.isinf(wide).sum() == 64**2 - 32**2


def test_wrong_arrays_are_refused_by_name():
    grid, kernel = vc.Grid(16, 1.0), vc.InfluenceKernel.half_space(vc.Grid(16, 1.0))
    with pytest.raises(ValueError, match=r"gap: the shape \[16, 16\] of the grid is needed, the array has \[16, 15\]"):
        vc.Shape.gap_on(grid, np.zeros((16, 15)))
    with pytest.raises(ValueError, match="gap: value 5 .* is NaN"):
        gap = np.zeros((16, 16))
        gap[0, 5] = np.nan
        vc.Shape.gap_on(grid, gap)
    with pytest.raises(TypeError, match="gap: an array of real numbers is needed, not of complex128"):
        vc.Shape.gap_on(grid, np.zeros((16, 16), complex))
    with pytest.raises(TypeError, match="heights: an array of real numbers is needed, not of <U1"):
        vc.HeightMap([["a"]], 1.0)
    with pytest.raises(ValueError, match="heights: two axes are needed"):
        vc.HeightMap(np.zeros(3), 1.0)
    with pytest.raises(ValueError, match="geometry: the shape"):
        vc.ViscoelasticContact(grid, np.zeros((4, 4)), RUBBER)
    with pytest.raises(ValueError, match=r"terms: the shape \(n, 2\) is needed"):
        vc.Rheology.generalized_maxwell(1.0, [1.0, 2.0])
    with pytest.raises(ValueError, match="times: value 0 .* is NaN"):
        vc.LoadHistory.forces([math.nan, 1.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="forces: 3 given, 2 needed"):
        vc.LoadHistory.forces([0.0, 1.0], [0.0, 1.0, 2.0])
    out = np.zeros((16, 16))
    assert kernel.convolve(np.ones((16, 16)), out=out) is out and out.min() > 0
    with pytest.raises(ValueError, match="out: a contiguous array in C order"):
        kernel.convolve(np.ones((16, 16)), out=np.zeros((16, 16), order="F"))
    sliding = vc.SteadySliding(vc.Grid(16, 4e-3), BALL, RUBBER)
    with pytest.raises(ValueError, match="velocities: value 1 .* is NaN"):
        sliding.sweep([0.1, math.nan], vc.Load.force(0.1))
    out.flags.writeable = False
    with pytest.raises(ValueError, match="out: .*read-only|out: .*writ"):
        kernel.convolve(np.ones((16, 16)), out=out)
    with pytest.raises(TypeError, match="out: an array of float64"):
        kernel.convolve(np.ones((16, 16)), out=np.zeros((16, 16), "float32"))


ERRORS = {
    "a value": (ValueError, "sphere radius = -1.0 is not allowed: it must be", lambda: vc.Shape.sphere(-1.0)),
    "a traction": (ValueError, "max_traction = 0.0 is not allowed", lambda: vc.Attraction.dugdale(0.05, max_traction=0.0)),
    "a load": (ValueError, "force", lambda: ball().step(0.0, vc.Load.force(math.nan))),
    "the edge": (ValueError, "enlarge the grid", lambda: ball().step(0.0, vc.Load.force(1e3))),
    "a missing file": (FileNotFoundError, "no_such.sdf", lambda: vc.HeightMap.read("no_such.sdf")),
    "a file of another kind": (OSError, "line 1, column 1", lambda: vc.HeightMap.read(__file__, unit="um", lengths=1.0)),
    "memory": (MemoryError, "take fewer cells", lambda: ball(200_000)),
    "convergence": (vc.ConvergenceError, "iterations", lambda: ball(64, max_iterations=1).step(0.0, vc.Load.force(1.0))),
    "what is not covered": (NotImplementedError, "frame=\"indenter\"", lambda: ball().step_over((1, 0), 1.0, vc.Load.force(1.0))),
    "an option": (ValueError, "\"refuse\", \"allow\"", lambda: ball(edge="fast")),
    "a keyword": (TypeError, "unexpected keyword argument 'toleranse'", lambda: ball(toleranse=1e-3)),
    "a keyword of creep": (TypeError, "unexpected keyword argument 'time_rule'", lambda: vc.ElasticContact(vc.Grid(8, 1e-3), vc.Shape.sphere(1e-2), 1e6, time_rule="linear")),
    "a keyword of creep in a sweep": (TypeError, "unexpected keyword argument 'frame'", lambda: vc.ElasticStates.sweep(vc.Grid(8, 1e-3), vc.Shape.sphere(1e-2), level=1e-9, frame="indenter")),
    "a resistivity": (ValueError, "resistivities = -1", lambda: vc.ElasticStates.sphere(1e-2).conductance(1e-7, (-1.0, 2.0))),
    "a force along the surface": (ValueError, "force along the surface = NaN", lambda: vc.StatesContact(vc.ElasticStates.sphere(1e-2), vc.Material(vc.Rheology.zener(1e6, 1e6, 1.0)), estimated_friction=0.5).step_sheared(0.0, vc.Load.force(1.0), vc.Load.force(float("nan")))),
    "a run": (TypeError, "give dt or tolerance", lambda: ball().follow(vc.Load.force(1.0), 1.0, dt=1.0, tolerance=1.0)),
    "times": (ValueError, "interval of times", lambda: ball().follow(vc.Load.force(1.0), 1.0, stop_at=vc.Times.every(-1.0))),
    "a history": (TypeError, "a Load, a LoadHistory", lambda: ball().follow(1.0, 1.0)),
    "a name": (ValueError, "known", lambda: vc.Material.published("no such rubber", 0.5)),
}


@pytest.mark.parametrize("case", ERRORS, ids=list(ERRORS))
def test_errors_by_kind_with_their_cure(case):
    kind, words, call = ERRORS[case]
    with pytest.raises(kind) as raised:
        call()
    assert type(raised.value) is kind or kind is OSError
    assert words in str(raised.value), raised.value


def test_a_failed_step_leaves_no_trace():
    contact = ball()
    contact.step(0.0, vc.Load.force(1.0))
    before = contact.pressure
    with pytest.raises(ValueError):
        contact.step(0.1, vc.Load.force(1e3))
    assert (contact.pressure == before).all() and contact.time == 0.0
    with pytest.raises(ValueError):
        contact.follow(vc.Load.force(1.0), 2.0, sample_at=[math.inf])
    assert contact.step(0.1, vc.Load.force(1.0)).time == 0.1


class Mine(Exception):
    """An exception of a user."""


def raises(*_):
    raise Mine("of the user")


def test_an_exception_of_a_user_comes_out_as_itself():
    law = vc.TimeTemperature.wlf(17.4, 51.6, 300.0)

    def warm():
        contact = ball(temperature=vc.TemperatureHistory(law, raises))
        contact.step(0.0, vc.Load.force(1.0))
        contact.step(1.0, vc.Load.force(1.0))

    periodic = vc.InfluenceKernel.periodic(GRID)
    wave = vc.Shape.wavy((1e-6, 1e-6), (4e-3, 4e-3))
    def late(t):
        return vc.Load.force(1.0) if t < 0.5 else raises()

    def watched():
        run = ball().follow(vc.Load.force(1.0), 1.0)
        run.stop_when(raises, up=1.0)
        list(run)

    near = vc.Attraction.function(lambda h: 1e3 if h < 1 else raises(), lambda h: 1e-6 if h < 1 else raises())
    own = vc.Rheology.function(lambda t: 1e-6 if t < 0.5 else raises())
    sphere = vc.GrowingSphere(1e-2, RUBBER, late)
    modulus = vc.SteadySliding(GRID, wave, RUBBER, kernel=periodic, modulus=lambda w: 4e6 if w == 0 else raises())
    calls = [
        lambda: near.traction(np.array([0.5, 2.0])),
        lambda: near.traction(2.0),
        lambda: near.energy(2.0),
        lambda: own.creep_compliance([0.0, 1.0]),
        lambda: vc.Material(own).contact_compliance([0.0, 1.0]),
        lambda: vc.Material(own, nu=0.3).contact_compliance(1.0),
        lambda: vc.TemperatureHistory(law, raises).at(1.0),
        lambda: vc.TemperatureHistory(law, raises).at([1.0]),
        lambda: vc.GrowingSphere(1e-2, RUBBER, raises),
        lambda: sphere.contact_radius(1.0),
        lambda: sphere.approach([0.0, 1.0]),
        lambda: sphere.pressure(0.0, 1.0),
        lambda: modulus.at((1.0, 0.0), vc.Load.force(1e-3)),
        lambda: modulus.sweep([1.0, 2.0], [vc.Load.force(1e-3)]),
        watched,
        lambda: list(ball().follow(raises, 1.0)),
        lambda: vc.ViscoelasticContact(GRID, vc.Shape.function(raises), RUBBER),
        lambda: vc.ViscoelasticContact(GRID, BALL, vc.Material(vc.Rheology.function(raises))).step(0.0, vc.Load.force(1.0)),
        lambda: vc.Attraction.function(raises, raises),
        lambda: vc.InfluenceKernel.from_coefficients(GRID, raises),
        lambda: vc.InfluenceKernel.from_spectrum(GRID, raises),
        lambda: list(ball().follow(vc.Load.force(1.0), 1.0, progress=raises)),
        lambda: vc.ElasticStates.sweep(GRID, BALL, approach=1e-5, progress=raises),
        lambda: vc.Study(BALL, RUBBER, vc.Load.force(1.0), 1.0, progress=raises),
        lambda: vc.Study(BALL, RUBBER, vc.Load.force(1.0), 1.0, quantities={"own": raises}),
        lambda: vc.Study(BALL, RUBBER, vc.Load.force(1.0), 1.0, kernel=raises),
        lambda: vc.SteadySliding(GRID, wave, RUBBER, kernel=periodic, modulus=raises).at((1.0, 0.0), vc.Load.force(1e-3)),
        lambda: vc.persson_friction(GRID, wave, raises, 1e3, (1.0, 0.0), 0.5),
        warm,
    ]
    for call in calls:
        with pytest.raises(Mine, match="of the user"):
            call()
        with pytest.raises(ValueError, match="sphere radius"):  # nothing is left for another call
            vc.Shape.sphere(-1.0)
    with pytest.raises(TypeError, match="the load history returned .*float.* at 0 s, not a Load"):
        list(ball().follow(lambda t: 1.0, 1.0))
    assert list(ball().follow(vc.Load.force(1.0), 0.0))  # no exception of an earlier call is left


def test_an_exception_comes_out_in_its_own_thread():
    waiting, done, raised = threading.Event(), threading.Event(), []

    def quantity(contact):
        waiting.set()
        done.wait(20.0)
        raise Mine("of the user")

    def other():
        run = ball().follow(vc.Load.force(1.0), 1.0)
        run.stop_when(quantity, up=1.0)
        try:
            list(run)
        except Mine:
            raised.append("in its own")

    thread = threading.Thread(target=other)
    thread.start()
    assert waiting.wait(20.0)
    reports = list(ball().follow(vc.Load.force(1.0), 1.0))
    with pytest.raises(ValueError, match="sphere radius"):
        vc.Shape.sphere(-1.0)
    done.set()
    thread.join()
    assert reports and raised == ["in its own"]
    assert list(ball().follow(vc.Load.force(1.0), 0.0))


def test_a_run_shows_its_contact_and_ends_with_a_step():
    contact, seen, areas = ball(), [], []
    stops = [0.3] + vc.Times.every(5.0)
    run = contact.follow([(0, vc.Load.force(0)), (1, vc.Load.force(1))], 2.0, stop_at=stops, progress=seen.append)
    for report in run:
        areas.append((report.time, contact.contact_area))
        assert contact.time == report.time
    assert 0.3 in dict(areas) and areas[-1][0] == 2.0 and seen[-1] == 1.0
    assert run.error_budget()["time"] < 1e-3 and run.progress["steps"] == len(areas)
    contact.step(0.1, vc.Load.force(1.0))
    with pytest.raises(RuntimeError, match="the run is over"):
        next(iter(run))


def test_progress_cancels():
    contact = ball()
    with pytest.raises(vc.Cancelled):
        list(contact.follow(vc.Load.force(1.0), 1.0, progress=lambda share: False))
    assert contact.time == 0.0 and contact.force == pytest.approx(1.0)
    few, all = (vc.ElasticStates.sweep(GRID, BALL, approach=1e-4, progress=lambda n: n < most) for most in (4, 10**9))
    assert len(few) < len(all)
    with pytest.raises(vc.Cancelled):
        vc.Study(BALL, RUBBER, vc.Load.force(1.0), 1.0, progress=lambda *at: False)


def test_samples_and_events():
    contact = ball()
    run = contact.follow(vc.LoadHistory.ramp(vc.Load.force(0), vc.Load.force(1), 1.0), 1.0, sample_at=[0.25, 0.5])
    run.stop_when("approach", up=1e-4)
    samples = [sample for _ in run for sample in run.samples()]
    assert [sample.report.time for sample in samples] == [0.25, 0.5]
    assert samples[0].contact.force == pytest.approx(0.25, rel=1e-6)
    (crossing,) = run.events
    assert len(crossing) == 1
    table = ball().follow(vc.LoadHistory.ramp(vc.Load.force(0), vc.Load.force(1), 1.0), 1.0, sample_at=[0.25, 0.5]).table()
    assert table["force"] == pytest.approx([0.25, 0.5], rel=1e-6)


@pytest.mark.parametrize(
    "thing",
    [
        GRID,
        BALL + vc.Shape.wavy(1e-7, 1e-3).shifted((1e-4, 0)),
        vc.HeightMap.rough(GRID, 2e-3, 0.5e-3, rms_slope=0.1, seed=1),
        vc.HeightMap(np.arange(16.0).reshape(4, 4) * 1e-6, 4e-3, periodic=True).inverted().centered_at((1e-3, 0)),
        vc.Rheology.generalized_maxwell(1e6, [(1e6, 1.0)]),
        vc.Material(vc.Tension(vc.Rheology.zener(1e6, 1e6, 1.0)), bulk_modulus=1e9),
        vc.Material(vc.Measurements.creep([0.1, 1, 10, 100], [1e-6, 1.2e-6, 1.5e-6, 1.6e-6]).fit()),
        vc.Load.force(1.0, at=(1e-3, 0)),
        vc.LoadHistory.triangle(vc.Load.force(0), vc.Load.force(1), 2.0),
        vc.Attraction.dugdale(0.05, max_traction=1e5, width=1.0),
        vc.InfluenceKernel.layer(GRID, vc.Layer.bonded_to_rigid(1e-3, 0.3)),
        vc.TemperatureHistory(vc.TimeTemperature.arrhenius(1e5, 300.0), [(0.0, 300.0), (1.0, 310.0)]),
        vc.ElasticStates.sphere(1e-2),
    ],
    ids=lambda thing: type(thing).__name__,
)
def test_pickles(thing):
    again = pickle.loads(pickle.dumps(thing))
    assert repr(again) == repr(thing)
    if isinstance(thing, vc.Shape):
        assert (again.gap(GRID) == thing.gap(GRID)).all()
    if isinstance(thing, vc.Material):
        assert again.contact_compliance(5.0) == thing.contact_compliance(5.0)


# what an array or a list makes, and a number of it
MADE_OF = {
    "terms": (lambda a: vc.Rheology.generalized_maxwell(1e6, a), [[1e6, 0.1]], lambda of: of.creep_compliance(1.0)),
    "a table of shifts": (lambda a: vc.TimeTemperature.table(a, 300.0), [[290.0, 10.0], [300.0, 1.0]], lambda of: of.shift_factor(295.0)),
    "vertical factors": (
        lambda a: vc.TimeTemperature.arrhenius(1e5, 300.0).with_vertical_factors(a),
        [[290.0, 0.9], [300.0, 1.0]],
        lambda of: of.vertical_factor(295.0),
    ),
    "forces": (lambda a: vc.LoadHistory.forces([0.0, 1.0], a), [0.0, 1.0], lambda of: repr(of.at(0.5))),
    "creep": (
        lambda a: vc.Measurements.creep([0.1, 1, 10, 100], a).fit(),
        [1e-6, 1.2e-6, 1.5e-6, 1.6e-6],
        lambda of: of.creep_compliance(1.0),
    ),
    "states": (lambda a: vc.ElasticStates.from_table(a), [[1e-8, 1e-6, 1e-3, 1e-7], [2e-8, 1.5e-6, 1.2e-3, 2e-7]], lambda of: of.approach(1.5e-8)),
    "a temperature": (
        lambda a: vc.TemperatureHistory(vc.TimeTemperature.arrhenius(1e5, 300.0), a),
        [[0.0, 300.0], [1.0, 310.0]],
        lambda of: of.at(0.5),
    ),
    "a gap": (lambda a: vc.Shape.gap_on(vc.Grid(2, 1.0), a), [[0.0, 1.0], [2.0, 3.0]], lambda of: of.gap(vc.Grid(2, 1.0)).tolist()),
    "heights": (lambda a: vc.HeightMap(a, 1.0), [[0.0, 1.0], [2.0, 3.0]], lambda of: of.heights.tolist()),
    "a geometry": (
        lambda a: vc.ViscoelasticContact(vc.Grid(8, 1e-3), np.asarray(a), RUBBER, edge="allow"),
        np.add.outer(np.arange(-3.5, 4) ** 2, np.arange(-3.5, 4) ** 2) * 1e-6,
        lambda of: of.initial_gap.tolist() if hasattr(of, "initial_gap") else of.step(0.0, vc.Load.force(1e-3)).approach,
    ),
}


@pytest.mark.parametrize("case", MADE_OF, ids=list(MADE_OF))
@pytest.mark.parametrize("kind", ["array", "list"])
def test_a_pickle_holds_what_was_given(case, kind):
    make, given, number = MADE_OF[case]
    given = np.array(given) if kind == "array" else np.array(given).tolist()
    thing, again = make(given), make(given)
    wanted, text = number(again), repr(thing)
    if kind == "array":
        given *= 3.0
    else:
        for k, entry in enumerate(given):
            if isinstance(entry, list):
                entry[-1] *= 3.0
            else:
                given[k] = 3.0 * entry
        given.append(given[0])
    pickled = pickle.loads(pickle.dumps(thing))
    assert repr(pickled) == text == repr(thing)
    assert number(pickled) == wanted


def test_a_pickled_contact_goes_on_bit_by_bit(tmp_path):
    states = vc.ElasticStates.sweep(GRID, BALL, approach=2e-4)
    for contact in (ball(tolerance=1e-7), vc.StatesContact(states, RUBBER)):
        contact.step(0.0, vc.Load.force(1.0))
        contact.step(0.5, vc.Load.force(0.5))
        others = [pickle.loads(pickle.dumps(contact)), copy.copy(contact), copy.deepcopy(contact)]
        contact.save(tmp_path / "state")
        contact.step(0.5, vc.Load.force(0.7))
        others[1].resume(tmp_path / "state")
        for other in others:
            other.step(0.5, vc.Load.force(0.7))
            assert (other.approach, other.force) == (contact.approach, contact.force)
    with pytest.raises(OSError, match="no run can be resumed from"):
        ball(48).resume(tmp_path / "state")


def interrupted(call, after=0.4):
    """Seconds from Ctrl-C to its exception."""
    sent = []

    def send():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
        return time.monotonic() - sent[0]
    finally:
        timer.cancel()


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c():
    # large enough that a step takes seconds wherever the tests run; rough, so that the solver takes many iterations
    n = int(os.environ.get("VISCOCONTACT_CELLS", 768))
    grid = vc.Grid(n, 1e-3)
    rough = vc.HeightMap.rough(grid, 0.5e-3, 8e-3 / n, rms_slope=0.3, seed=1)
    contact = vc.ViscoelasticContact(grid, rough, RUBBER, kernel=vc.InfluenceKernel.periodic(grid), tolerance=1e-12)

    def step():
        while True:
            contact.step(0.0, vc.Load.force(0.02))
            contact.step(0.0, vc.Load.force(0.0))

    took = interrupted(step)
    assert took < 2.0, took
    assert contact.time == 0.0
    sliding = vc.SteadySliding(grid, rough, RUBBER, kernel=vc.InfluenceKernel.periodic(grid), tolerance=1e-12)

    def slide():
        while True:
            sliding.at((1e-3, 0.0), vc.Load.force(0.02))
            sliding.sweep([(1.0, 1.0), (2.0, 1.0)], [vc.Load.force(0.01), vc.Load.force(0.03)])

    assert interrupted(slide) < 2.0
    small = ball(64)
    interrupted(lambda: list(small.follow(vc.Load.force(0.5), 1e9, dt=1e-3)))
    assert small.force == pytest.approx(0.5)

    def sweep():
        while True:
            vc.ElasticStates.sweep(vc.Grid(128, 4e-3), BALL, approach=2e-4, accuracy=1e-6)

    def study():
        while True:
            vc.Study(BALL, RUBBER, vc.Load.force(1.0), 2.0, accuracy=1e-5)

    assert interrupted(sweep) < 5.0 and interrupted(study) < 5.0
    # a step that waits for its end is reported: no bytecode runs between the steps
    grid = vc.Grid(256, 1e-3)
    rough = vc.HeightMap.rough(grid, 0.5e-3, 4e-5, rms_slope=0.3, seed=1)
    moving = vc.ViscoelasticContact(grid, rough, RUBBER, kernel=vc.InfluenceKernel.periodic(grid), frame="indenter", tolerance=1e-12)
    moving.step(0.0, vc.Load.force(0.02))
    reports, each = [], [itertools.repeat(value) for value in ((1, 0), 0.5, vc.Load.force(0.02))]
    interrupted(lambda: reports.extend(map(moving.step_over, *each)))
    assert reports and moving.time == 0.5 * len(reports)


def test_an_array_that_another_thread_writes_is_refused():
    grid = vc.Grid(512, 1.0)
    kernel, out, seen = vc.InfluenceKernel.half_space(grid), np.zeros((512, 512)), []
    thread = threading.Thread(target=lambda: [kernel.convolve(np.ones((512, 512)), out=out) for _ in range(5)])
    thread.start()
    while thread.is_alive():
        try:
            vc.Shape.gap_on(grid, out)
        except ValueError as error:
            seen.append(str(error))
    thread.join()
    assert seen and all(text.startswith("gap: ") for text in seen)


def test_the_gil_is_free():
    contact, counted, done = ball(256), [0], []

    def count():
        while not done:
            counted[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    for _ in range(5):
        contact.step(0.05, vc.Load.force(0.8))
    done.append(True)
    thread.join()
    assert counted[0] > 20


def test_several_bodies():
    bodies = [vc.Shape.sphere(10e-3).shifted((-1e-3, 0)), vc.Shape.sphere(5e-3).shifted((1e-3, 0))]
    contact = vc.ViscoelasticContact(vc.Grid(64, 5e-3), bodies, RUBBER)
    contact.step(0.0, [vc.Load.force(0.1), vc.Load.force(0.2)])
    assert [body.force for body in contact.bodies] == pytest.approx([0.1, 0.2], rel=1e-5)
    with pytest.raises(ValueError, match="1 given, 2 needed"):
        contact.step(0.1, vc.Load.force(0.1))
