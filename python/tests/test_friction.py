"""Friction on elastic states and in space, and several bodies along histories."""

import copy
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest
import viscocontact as vc

RUBBER = vc.Material(vc.Rheology.zener(1e6, 1e6, 1.0))
BALL = vc.Shape.sphere(10e-3)
# at a tolerance of the contact problems of 1e-11
RELATIVE = 1e-8
FOAM = vc.Material(vc.Rheology.zener(1e6, 1e6, 1.0), nu=0.0)


def pressed(friction=0.5, **options):
    contact = vc.FrictionContact(vc.Grid(48, 4e-3), BALL, RUBBER, friction, **options)
    contact.step(0.0, vc.Load.force(1.0), vc.ShearLoad((0.0, 0.0)))
    return contact


def test_cattaneo_on_states():
    contact = vc.StatesContact(vc.ElasticStates.sphere(10e-3), RUBBER, estimated_friction=0.5)
    contact.step(0.0, vc.Load.force(1.0))
    contact.step_sheared(0.0, vc.Load.force(1.0), vc.Load.force(0.3))
    assert contact.stick_area / contact.contact_area == pytest.approx(0.4 ** (2 / 3), rel=1e-9)
    assert contact.lateral_force == pytest.approx(0.3, rel=1e-12) and contact.slid == 0 < contact.stick_level < contact.level
    level, traction = contact.shear_tractions().T
    assert (traction * np.diff(level, prepend=0.0)).sum() == pytest.approx(0.3, rel=1e-12)
    before = contact.lateral_displacement
    contact.step_sheared(1.0, vc.Load.force(1.0), vc.Load.force(0.3))
    assert contact.lateral_displacement > before
    work = contact.lateral_work
    assert work["work"] == pytest.approx(work["slip"] + work["stored"] + work["creep"], rel=1e-12) and work["slip"] > 0


def test_sheared_along_a_history_and_pickled():
    turn = vc.LoadHistory.sinusoid(vc.Load.approach(-20e-6), vc.Load.approach(20e-6), 0.5)
    make = lambda: vc.StatesContact(vc.ElasticStates.sphere(10e-3), RUBBER, estimated_friction=0.6, sheared_by=turn)
    contact = make()
    for _ in contact.follow(vc.Load.force(1.0), 3.0, tolerance=1e-3):
        pass
    other = pickle.loads(pickle.dumps(contact))
    for one in (contact, other):
        one.step(0.1, vc.Load.force(1.0))
    assert other.lateral_force == contact.lateral_force != 0 and other.lateral_work == contact.lateral_work
    rows = [(0.0, vc.Load.approach(0.0)), (1.0, vc.Load.approach(1e-6))]
    with_rows = vc.StatesContact(vc.ElasticStates.sphere(10e-3), RUBBER, estimated_friction=0.6, sheared_by=rows)
    with_rows.step(1.0, vc.Load.force(1.0))
    assert with_rows.lateral_displacement == pytest.approx(1e-6, rel=1e-12)


def test_states_and_cells_agree():
    # ν = 0, and two bodies of one material: what both compute is the same
    grid, pair = vc.Grid(48, 6e-3), FOAM.against(FOAM)
    cells = vc.FrictionContact(grid, BALL, pair, 0.5, tolerance=1e-11)
    swept = vc.ElasticStates.sweep(grid, BALL, level=1.0 * pair.contact_compliance(1.0), keep_pressures=True, tolerance=1e-11)
    with pytest.raises(NotImplementedError, match="estimated_friction="):
        vc.StatesContact(swept, FOAM, friction=0.5)
    contact = vc.StatesContact(swept, pair, friction=0.5, exact_states=True)
    for dt, along in [(0.0, 0.0), (0.0, 0.15), (0.5, 0.3), (0.5, -0.2)]:
        cells.step(dt, vc.Load.force(1.0), vc.ShearLoad((along, 0.0)))
        contact.step_sheared(dt, vc.Load.force(1.0), vc.Load.force(along))
    assert cells.motion[0] == pytest.approx(contact.lateral_displacement, rel=RELATIVE)
    assert cells.traction[0] == pytest.approx(contact.shear, abs=RELATIVE * abs(contact.shear).max())


def test_fields_in_space():
    contact = pressed()
    report = contact.step(0.0, vc.Load.force(1.0), vc.ShearLoad((0.3, 0.1), torque=1e-5))
    assert report["residual"] <= 1e-6 and report["iterations"] > 0 and report["normal"].force == pytest.approx(1.0)
    traction, normal = contact.traction, contact.normal
    assert traction.shape == contact.slip.shape == (2, 48, 48) and contact.sticks.dtype == bool
    area = np.prod(normal.grid.spacing)
    x1, x2 = normal.grid.coordinates()
    sums = (traction[0].sum() * area, traction[1].sum() * area, (x1 * traction[1] - x2 * traction[0]).sum() * area)
    assert sums == pytest.approx((0.3, 0.1, 1e-5), rel=1e-5) and (*contact.lateral_force, contact.torque) == pytest.approx(sums, rel=1e-9)
    assert (np.hypot(*traction) <= 0.5 * normal.pressure * (1 + 1e-9)).all()
    assert contact.sticks.sum() == contact.stick_cells and 0 < contact.stick_cells < normal.contact_cells
    assert np.hypot(*contact.slip)[contact.sticks].max() <= 1e-6 * max(map(abs, contact.motion[:2])) * 10
    work = contact.lateral_work
    assert work["work"] == pytest.approx(work["slip"] + work["stored"] + work["creep"], rel=1e-12) and work["stored"] > work["slip"] > 0
    other = copy.copy(contact)
    other.step(1.0, vc.Load.force(1.0), vc.ShearLoad((0.3, 0.1), torque=1e-5))
    assert contact.time == 0.0 and other.motion[0] > contact.motion[0]


def test_saved_and_pickled(tmp_path):
    contact = pressed()
    contact.step(0.0, vc.Load.force(1.0), vc.ShearLoad((0.3, 0.1), torque=1e-5))
    contact.save(tmp_path / "friction")
    resumed = pressed()
    resumed.resume(tmp_path / "friction")
    others = [pickle.loads(pickle.dumps(contact)), copy.deepcopy(contact), resumed]
    for one in [contact, *others]:
        one.step(0.5, vc.Load.force(1.2), vc.ShearLoad((-0.2, 0.1), torque=0.0))
    for other in others:
        assert (other.traction == contact.traction).all() and (other.slip == contact.slip).all()
        assert other.motion == contact.motion and other.lateral_work == contact.lateral_work and other.time == contact.time
    with pytest.raises(OSError, match="friction"):
        vc.FrictionContact(vc.Grid(48, 4e-3), BALL, RUBBER, 0.6).resume(tmp_path / "friction")


def test_what_friction_cannot_carry_slides():
    contact = pressed()
    contact.step(0.0, vc.Load.force(1.0), vc.ShearLoad((0.3, 0.0)))
    before = (contact.lateral_force, contact.traction)
    with pytest.raises(vc.Slides, match="slides") as caught:
        contact.step(1.0, vc.Load.force(1.0), vc.ShearLoad((0.6, 0.0)))
    assert caught.value.over_limit == pytest.approx(1.2, rel=1e-6) and caught.value.direction[0] == 1.0
    assert contact.force == pytest.approx(1.0) and contact.lateral_force == before[0] and (contact.traction == before[1]).all() and contact.time == 0.0
    contact.step(0.0, vc.Load.force(1.0), vc.ShearLoad(motion=(1e-3, 0.0)))
    # what slips is not moved along x1 alone, as the surface bulges: a little less than f P
    assert contact.lateral_force[0] == pytest.approx(0.5, rel=1e-5) and contact.stick_cells == 0
    on_states = vc.StatesContact(vc.ElasticStates.sphere(10e-3), RUBBER, estimated_friction=0.5)
    with pytest.raises(vc.Slides) as caught:
        on_states.step_sheared(0.0, vc.Load.force(1.0), vc.Load.force(1.0))
    assert caught.value.over_limit == pytest.approx(2.0) and caught.value.direction is None
    again = pickle.loads(pickle.dumps(caught.value))
    assert isinstance(again, ValueError) and again.over_limit == caught.value.over_limit


def test_limits():
    own = vc.FrictionLimit.function(lambda pressure: min(0.5 * pressure, 2e4))
    law = vc.FrictionLimit.lesser(vc.FrictionLimit.coulomb(0.5), vc.FrictionLimit.tresca(2e4))
    states = []
    for limit in (own, law):
        contact = pressed(limit)
        contact.step(0.5, vc.Load.force(1.0), vc.ShearLoad((0.05, None), (None, 1e-6)))
        states.append((contact.motion, contact.lateral_force, contact.torque))
    assert states[0] == states[1] and np.hypot(*contact.traction).max() <= 2e4 * (1 + 1e-9)
    assert repr(law) == "FrictionLimit.lesser(FrictionLimit.coulomb(0.5), FrictionLimit.tresca(20000.0))"
    assert pickle.loads(pickle.dumps(law)).limit(1e3) == 500.0

    def fails(pressure):
        raise LookupError("no such pressure")

    with pytest.raises(LookupError, match="no such pressure"):
        pressed(vc.FrictionLimit.function(fails))
    for wrong in (-1.0, float("nan")):
        with pytest.raises(ValueError, match="a limit of friction"):
            pressed(vc.FrictionLimit.function(lambda pressure: wrong))
    with pytest.raises(TypeError):
        pressed(vc.FrictionLimit.function(lambda pressure: "much"))


@pytest.mark.parametrize(
    "call, kind, match",
    [
        (lambda: pressed(-0.1), ValueError, "coefficient of friction = -0.1 .*must be finite and >= 0"),
        (lambda: pressed("much"), TypeError, "friction: a number or a FrictionLimit is needed"),
        (lambda: pressed(time_rule="exponential"), TypeError, "time_rule"),
        (lambda: pressed(tolerence=1e-6), TypeError, "tolerence"),
        (lambda: pressed(attraction=vc.Attraction.exponential(0.1, 1e-6)), NotImplementedError, "not covered"),
        (lambda: vc.FrictionContact(vc.Grid(16, 4e-3), BALL, FOAM, 0.5), NotImplementedError, "Poisson's ratio"),
        (lambda: vc.FrictionContact(vc.Grid(16, 4e-3), [BALL, BALL], RUBBER, 0.5), NotImplementedError, "not covered"),
        (lambda: vc.ShearLoad((0.1, None)), TypeError, "force and motion along x2"),
        (lambda: vc.ShearLoad(), TypeError, "force and motion along x1"),
        (lambda: vc.ShearLoad((0.1, 0.2), (0.0, None)), TypeError, "force and motion along x1"),
        (lambda: vc.ShearLoad((0.1, 0.2), torque=1.0, angle=0.0), TypeError, "torque and angle"),
        (lambda: pressed().step(0.1, vc.Load.force(1.0), vc.ShearLoad((float("nan"), 0.0))), ValueError, "force along x1"),
        (lambda: pressed().step(0.1, vc.Load.force(1.0), vc.ShearLoad((0.0, 0.0), angle=float("inf"))), ValueError, "angle"),
        (lambda: pressed().step(-0.1, vc.Load.force(1.0), vc.ShearLoad((0.0, 0.0))), ValueError, "time step"),
        (lambda: pressed().step(0.1, vc.Load.force(1.0), vc.Load.force(0.1)), TypeError, "ShearLoad"),
        (lambda: vc.FrictionLimit.tresca(float("inf")), ValueError, "shear strength"),
        (lambda: on_ball(friction=0.5, estimated_friction=0.5), TypeError, "not both"),
        (lambda: on_ball(estimated_friction=0.0), ValueError, "coefficient of friction"),
        (lambda: on_ball(sheared_by=vc.Load.force(0.1)), NotImplementedError, "give friction= or estimated_friction="),
        (lambda: on_ball(estimated_friction=0.5, sheared_by=3.0), TypeError, "load: a Load"),
        (lambda: on_ball().step_sheared(0.0, vc.Load.force(1.0), vc.Load.force(0.1)), NotImplementedError, "give friction="),
        (lambda: on_ball(estimated_friction=0.5).step_sheared(0.0, vc.Load.force(1.0), vc.Load.force(float("nan"))), ValueError, "force"),
        (lambda: on_ball(estimated_friction=0.5).shear, NotImplementedError, "pressures"),
    ],
)
def test_wrong_input_says_what_is_wrong(call, kind, match):
    with pytest.raises(kind, match=match):
        call()


def on_ball(**options):
    return vc.StatesContact(vc.ElasticStates.sphere(10e-3), RUBBER, **options)


def test_ctrl_c_ends_a_step_with_friction():
    contact = vc.FrictionContact(vc.Grid(512, 4e-3), BALL, RUBBER, 0.5, window=False, symmetry=False)
    contact.step(0.0, vc.Load.force(1.0), vc.ShearLoad((0.0, 0.0)))
    sent = []

    def later():
        time.sleep(0.3)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=later).start()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(1000):
            contact.step(0.1, vc.Load.force(1.0), vc.ShearLoad((0.45, 0.1)))
            contact.step(0.1, vc.Load.force(1.0), vc.ShearLoad((-0.45, 0.1)))
    assert time.perf_counter() - sent[0] < 3.0, "a bound for a busy machine"


def test_several_bodies_along_histories():
    grid, rubber = vc.Grid((64, 32), (6e-3, 3e-3)), vc.Material(vc.Rheology.zener(4e6, 1.3e6, 1.0))
    shapes = [vc.Shape.sphere(5e-3).shifted((x1, 0.0)) for x1 in (-1.5e-3, 1.5e-3)]
    histories = [vc.Load.approach(20e-6), [(0.0, vc.Load.force(0.0)), (2.0, vc.Load.force(0.5))]]
    contact = vc.ViscoelasticContact(grid, shapes, rubber)
    table = contact.follow(histories, 5.0, tolerance=1e-2, stop_at=[2.0]).table()
    assert 2.0 in table["time"] and contact.bodies[1].force == pytest.approx(0.5) and contact.bodies[0].approach == pytest.approx(20e-6)
    with pytest.raises(ValueError, match="load: 1 given, 2 needed, one for each body"):
        contact.follow(vc.Load.force(1.0), 6.0)
    with pytest.raises(ValueError, match="load: 2 given, 1 needed, one for each body"):
        on_ball().follow([vc.Load.force(1.0), vc.Load.force(1.0)], 6.0)
    for wrong in ([], [vc.Load.force(1.0), 3.0], [(0.0, vc.Load.force(1.0)), (1.0, 2.0)]):
        with pytest.raises((TypeError, ValueError), match="load|table"):
            contact.follow(wrong, 6.0)
    # a contact whose run was refused goes on
    contact.step(0.1, [vc.Load.force(0.1), vc.Load.force(0.1)])
    assert contact.bodies[0].force == pytest.approx(0.1)
