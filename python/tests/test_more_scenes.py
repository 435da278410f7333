"""Random scenes of elastic contacts, friction and several bodies give the bits of Rust: `tests/more_scenes.rs` has them in Rust."""

import os
import pathlib
import subprocess

import numpy as np
import pytest
import viscocontact as vc
from test_scenes import MASK, Draw, load, rheology, shape


def grid(draw):
    cells = (12 + draw.below(9), 12 + draw.below(9))
    return vc.Grid(cells, (draw.within(3e-3, 5e-3), draw.within(3e-3, 5e-3)))


def elastic(draw):
    on, form, modulus = grid(draw), shape(draw), draw.within(1e6, 1e7)
    kernel = None if draw.below(2) == 0 else vc.InfluenceKernel.periodic(on)
    contact, parts = vc.ElasticContact(on, form, modulus, kernel=kernel, edge="allow"), []
    for _ in range(3):
        contact.solve(load(draw))
        parts += [[contact.force, contact.approach, contact.contact_area], contact.pressure, contact.displacement, contact.approach_gradient()]
    return parts


def friction(draw):
    on, form, material = grid(draw), shape(draw), vc.Material(rheology(draw))
    f, strength = draw.within(0.1, 1.0), draw.within(1e3, 1e5)
    limits = (
        lambda: f,
        lambda: vc.FrictionLimit.tresca(strength),
        lambda: vc.FrictionLimit.lesser(vc.FrictionLimit.coulomb(f), vc.FrictionLimit.tresca(strength)),
        lambda: vc.FrictionLimit.function(lambda pressure: 0.3 * pressure + 1e3),
    )
    contact = vc.FrictionContact(on, form, material, limits[draw.below(4)](), edge="allow")
    contact.step(0.0, vc.Load.force(draw.within(1e-2, 0.1)), vc.ShearLoad((0.0, 0.0)))
    parts = []
    for _ in range(3):
        dt, normal = draw.within(0.01, 1.0), draw.within(1e-2, 0.1)
        forces, motions = [None] * 3, [None] * 3
        for axis, (force, motion) in enumerate([(1e-2, 2e-6), (1e-2, 2e-6), (1e-6, 1e-3)]):
            if draw.below(2) == 0:
                forces[axis] = draw.within(-force, force)
            else:
                motions[axis] = draw.within(-motion, motion)
        shear = vc.ShearLoad(forces[:2], motions[:2], torque=forces[2], angle=motions[2])
        try:
            report = contact.step(dt, vc.Load.force(normal), shear)
            parts.append([report["residual"], report["convolutions"]])
        except vc.Slides as slides:
            parts.append([*slides.direction, slides.over_limit])
        parts += [contact.motion, [*contact.lateral_force, contact.torque], list(contact.lateral_work.values()), contact.traction, contact.slip]
        parts += [contact.sticks.astype(float), contact.normal.pressure]
    return parts


def sheared(draw):
    is_swept = draw.below(2) == 0
    if is_swept:
        ball = vc.Shape.sphere(draw.within(5e-3, 20e-3))
        states = vc.ElasticStates.sweep(vc.Grid(16, 5e-3), ball, level=5e-7, accuracy=1e-3, keep_pressures=True)
    else:
        states = vc.ElasticStates.sphere(draw.within(5e-3, 20e-3))
    material = vc.Material(rheology(draw), nu=draw.within(0.1, 0.49))
    f = draw.within(0.1, 1.0)
    if draw.below(2) == 0:
        moved = vc.LoadHistory.ramp(vc.Load.approach(0.0), vc.Load.approach(draw.within(-2e-6, 2e-6)), 1.0)
        contact = vc.StatesContact(states, material, estimated_friction=f, sheared_by=moved)
        held = vc.Load.force(draw.within(1e-3, 1e-2))
        for _ in contact.follow(held, draw.within(0.5, 2.0), tolerance=1e-2):
            pass
    else:
        contact = vc.StatesContact(states, material, estimated_friction=f)
        contact.step(0.0, vc.Load.force(5e-3))
        for _ in range(4):
            dt, normal = draw.within(0.01, 1.0), draw.within(1e-3, 1e-2)
            kind = draw.below(3)
            if kind == 0:
                along = vc.Load.force(draw.within(-5e-3, 5e-3))
            elif kind == 1:
                along = vc.Load.approach(draw.within(-1e-6, 1e-6))
            else:
                along = vc.Load.spring(draw.within(1e3, 1e4), draw.within(-1e-5, 1e-5))
            try:
                contact.step_sheared(dt, vc.Load.force(normal), along)
            except vc.Slides as slides:
                assert slides.over_limit > 1 and slides.direction is None
    parts = [[contact.lateral_force, contact.lateral_displacement, contact.slid, contact.stick_level, contact.stick_area]]
    parts += [[contact.lateral_work[name] for name in ("work", "slip", "stored", "creep")], contact.shear_tractions()]
    return parts + ([contact.shear, contact.approach_gradient()] if is_swept else [])


def several(draw):
    ball = lambda x1: vc.Shape.sphere(draw.within(5e-3, 20e-3)).shifted((x1, 0.0))
    shapes = [ball(-1e-3), ball(1e-3)]
    contact = vc.ViscoelasticContact(vc.Grid((32, 16), (4e-3, 2e-3)), shapes, vc.Material(rheology(draw)), edge="allow")
    held = load(draw)
    pressed = vc.LoadHistory.ramp(vc.Load.force(0.0), vc.Load.force(draw.within(1e-3, 0.1)), draw.within(0.1, 1.0))
    for _ in contact.follow([held, pressed], 1.5, tolerance=1e-2):
        pass
    return [[body.force, body.approach] for body in contact.bodies] + [contact.pressure]


def line(kind, seed):
    try:
        numbers = np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in kind(Draw(seed))])
    except (ValueError, RuntimeError, NotImplementedError) as error:
        return f"{seed} {error}"
    mixed = 0
    for value in numbers.view("uint64").tolist():
        mixed = (mixed << 5 | mixed >> 59) & MASK ^ value
    return f"{seed} {mixed:016x} {len(numbers)}"


@pytest.mark.parametrize("kind, count", [(elastic, 100), (friction, 60), (sheared, 100), (several, 40)], ids=lambda of: getattr(of, "__name__", ""))
def test_random_scenes_give_the_bits_of_rust(kind, count):
    program = os.environ.get("VISCOCONTACT_SCENES_IN_RUST")
    if not program or not pathlib.Path(program).exists():
        pytest.skip("VISCOCONTACT_SCENES_IN_RUST names no program: cargo build --example scenes makes it")
    told = subprocess.run([program, kind.__name__, str(count)], capture_output=True, text=True, check=True)
    rust = told.stdout.splitlines()
    assert len(rust) == count
    for seed, expected in enumerate(rust):
        assert line(kind, seed) == expected
    computed = sum(len(expected.split()) == 3 for expected in rust)
    assert computed > 0.8 * count, f"only {computed} of {count} scenes have a state"
