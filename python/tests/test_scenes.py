"""Random scenes give the same bits in both languages: `cargo run --example scenes` computes them in Rust."""

import os
import pathlib
import struct
import subprocess

import numpy as np
import pytest
import viscocontact as vc

MASK = (1 << 64) - 1
COUNT = int(os.environ.get("VISCOCONTACT_SCENES", 300))


class Draw:
    """Numbers that both languages draw alike (Vigna's xorshift64*)."""

    def __init__(self, seed):
        self.state = 0x9E3779B97F4A7C15 ^ ((seed + 1) * 0xD1342543DE82EF95 & MASK)

    def next(self):
        self.state ^= self.state >> 12
        self.state ^= self.state << 25 & MASK
        self.state ^= self.state >> 27
        return self.state * 0x2545F4914F6CDD1D & MASK

    def below(self, n):
        return self.next() % n

    def within(self, low, high):
        return low + (high - low) * ((self.next() >> 11) / (1 << 53))


def shape(draw):
    kind = draw.below(3)
    if kind == 0:
        base = vc.Shape.sphere(draw.within(5e-3, 20e-3))
    elif kind == 1:
        base = vc.Shape.cone(draw.within(0.02, 0.1))
    else:
        base = vc.Shape.ellipsoid(draw.within(5e-3, 20e-3), draw.within(5e-3, 20e-3))
    kind = draw.below(3)
    if kind == 0:
        return base
    if kind == 1:
        return base.shifted((draw.within(-2e-4, 2e-4), draw.within(-2e-4, 2e-4)))
    return base + vc.Shape.wavy(draw.within(1e-7, 2e-6), draw.within(1e-3, 2e-3))


def rheology(draw):
    g, time = draw.within(0.5e6, 2e6), draw.within(0.1, 10.0)
    kind = draw.below(8)
    if kind == 0:
        return vc.Rheology.elastic(g)
    if kind == 1:
        return vc.Rheology.maxwell(g, time)
    if kind == 2:
        return vc.Rheology.zener(g, draw.within(0.5e6, 2e6), time)
    if kind == 3:
        return vc.Rheology.generalized_maxwell(g, [(draw.within(1e5, 1e7), time), (draw.within(1e5, 1e7), 10.0 * time)])
    if kind == 4:
        return vc.Rheology.fractional_zener(g, draw.within(0.5e6, 2e6), time, draw.within(0.3, 0.9)).fitted(1e-4, 1e2)
    if kind in (5, 6):
        make = vc.Rheology.prony if kind == 5 else vc.Rheology.prony_long_term
        return make(g, [(draw.within(0.1, 0.4), time), (draw.within(0.1, 0.4), 10.0 * time)])
    return vc.Rheology.slow_creep(1.0 / g, draw.within(1e-7, 1e-6), time, draw.within(0.3, 0.9)).fitted(1e-4, 1e2)


def load(draw):
    kind = draw.below(3)
    if kind == 0:
        return vc.Load.force(draw.within(1e-3, 0.1))
    if kind == 1:
        return vc.Load.approach(draw.within(1e-6, 3e-5))
    return vc.Load.spring(draw.within(1e3, 1e4), draw.within(1e-6, 5e-5))


def scene(seed):
    draw = Draw(seed)
    cells = (12 + draw.below(13), 12 + draw.below(13))
    grid = vc.Grid(cells, (draw.within(3e-3, 5e-3), draw.within(3e-3, 5e-3)))
    form, creep = shape(draw), rheology(draw)
    kind = draw.below(3)
    if kind == 0:
        material = vc.Material(creep)
    elif kind == 1:
        material = vc.Material(creep, nu=draw.within(0.1, 0.49))
    else:
        material = vc.Material(creep, bulk_modulus=draw.within(5e6, 1e9))
    rule = "exponential" if draw.below(2) == 0 else "exponential_linear"
    contact = vc.ViscoelasticContact(grid, form, material, symmetry=draw.below(2) == 0, time_rule=rule, edge="allow")
    contact.step(0.0, vc.Load.force(draw.within(1e-3, 0.1)))
    for _ in range(3):
        dt = draw.within(0.01, 1.0)
        contact.step(dt, load(draw))
    start = contact.time
    end = start + draw.within(0.1, 2.0)
    table = [(start, vc.Load.force(draw.within(1e-3, 0.1))), (end, vc.Load.force(draw.within(1e-3, 0.1)))]
    for _ in contact.follow(table, end, tolerance=1e-2):
        pass
    return contact


def bits(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def line(seed):
    try:
        contact = scene(seed)
    except (ValueError, RuntimeError, NotImplementedError, MemoryError) as error:
        return f"{seed} {error}"
    mixed = 0
    for value in np.concatenate([contact.pressure.ravel(), contact.displacement.ravel()]).view("uint64").tolist():
        mixed = (mixed << 5 | mixed >> 59) & MASK ^ value
    state = (contact.time, contact.force, contact.approach)
    return " ".join([str(seed), *(f"{bits(value):016x}" for value in state), f"{mixed:016x}"])


def test_random_scenes_give_the_bits_of_rust():
    program = os.environ.get("VISCOCONTACT_SCENES_IN_RUST")
    if not program or not pathlib.Path(program).exists():
        pytest.skip("VISCOCONTACT_SCENES_IN_RUST names no program: cargo build --example scenes makes it")
    rust = subprocess.run([program, str(COUNT)], capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(rust) == COUNT
    computed = 0
    for seed, expected in enumerate(rust):
        assert line(seed) == expected
        computed += len(expected.split()[1]) == 16
    assert computed > 0.9 * COUNT, f"only {computed} of {COUNT} scenes have a state"
