"""The figures of README.md: `python figures.py steps`, `states`, `threads` or `interrupt`; `scenes steps` is the Rust of the first."""

import os
import signal
import sys
import threading
import time

import numpy as np
import viscocontact as vc

BALL, RUBBER = vc.Shape.sphere(10e-3), vc.Material(vc.Rheology.maxwell(1e6, 1.0))
LOAD = vc.Load.force(1.0)


def pressed(n):
    contact = vc.ViscoelasticContact(vc.Grid(n, 4e-3), BALL, RUBBER)
    contact.step(0.0, LOAD)
    return contact


def seconds(call):
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def stepped(n, steps, contact=None):
    contact = contact or pressed(n)
    for _ in range(steps):
        contact.step(1e-5, LOAD)


def steps():
    for n, count, rounds in ((16, 100, 400), (64, 10, 400), (256, 2, 200)):
        contact = pressed(n)
        least = min(seconds(lambda: stepped(n, count, contact)) for _ in range(rounds))
        print(f"{n}² cells: {1e6 * least / count:.1f} µs a step")


def states():
    grid, load = vc.Grid(256, 1e-3), vc.Load.force(0.05)
    road = vc.HeightMap.rough(grid, 0.5e-3, 16e-6, rms_slope=0.05, seed=1)
    rubbers = [vc.Material(vc.Rheology.zener(1e6, 5e5, tau)) for tau in np.geomspace(1e-2, 1e2, 100)]
    start, found = time.perf_counter(), []
    sweep = dict(material=rubbers[0], load=load, until=1e6, kernel=vc.InfluenceKernel.periodic(grid), accuracy=1e-3)
    found.append(vc.ElasticStates.sweep(grid, road, **sweep))
    swept = time.perf_counter() - start
    followed = seconds(lambda: found[0].curves(rubbers, load, np.geomspace(1e-3, 1e3, 50)))
    print(f"a surface of 256² cells: {len(found[0])} states in {swept:.1f} s, 100 rheologies in {followed:.2f} s")
    contact = vc.StatesContact(vc.ElasticStates.sphere(10e-3), vc.Material(vc.Rheology.zener(1e6, 5e5, 1.0)), merge_error=1e-4)
    loads = [vc.Load.force(1.0 + 0.5 * np.sin(2e-3 * np.pi * k)) for k in range(1000)]
    loop = seconds(lambda: [contact.step(1e-3, loads[k % 1000]) for k in range(10**6)] and None)
    print(f"1e6 steps on states: {loop:.1f} s with {contact.groups} groups")


def threads():
    ratios = []
    for _ in range(7):
        pair = [threading.Thread(target=stepped, args=(128, 100)) for _ in range(2)]
        one = seconds(lambda: (stepped(128, 100), stepped(128, 100)))
        two = seconds(lambda: [thread.start() for thread in pair] + [thread.join() for thread in pair])
        ratios.append(one / two)
    print(f"two contacts on two threads: {np.median(ratios):.2f} times as fast, {min(ratios):.2f} to {max(ratios):.2f}")


def interrupt():
    for n in (2048,):
        contact = vc.ViscoelasticContact(vc.Grid(n, 4e-3), BALL + vc.Shape.wavy(1e-7, 20e-6), RUBBER)
        pressed, asked = [], []
        timer = threading.Timer(2.0, lambda: (asked.append(time.perf_counter()), os.kill(os.getpid(), signal.SIGINT)))
        timer.start()
        try:
            contact.step(0.0, LOAD)
        except KeyboardInterrupt:
            pressed.append(time.perf_counter() - asked[0])
        timer.cancel()
        print(f"Ctrl-C in a step of {n}² cells: after {pressed} s; the contact has {contact.time} s, {contact.force} N")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        {"steps": steps, "states": states, "threads": threads, "interrupt": interrupt}[name]()
