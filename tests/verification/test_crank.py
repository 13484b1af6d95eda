"""Simeon's flexible slider-crank, problem CRANK of the Test Set for IVP Solvers (release 2.4, Mazzia and Magherini).

Its rod has two sine shapes between its ends, and an axial quadratic whose mass in the published program is 15 times too
large. That does not matter for the rest: angle of the rod, place of the slider and first shape are compared with those
of a rod that does not stretch. Neither has geometric stiffening.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.model import load_model_text
from fmbd.results.simulate import simulate_system

CRANK = """
fmbd: 1
materials: {metal: {density: 7870, youngs_modulus: 2e11}}
sections: {square: {type: rectangle, width: 0.008, height: 0.008}}
bodies:
  crank: {type: rigid, mass: 0.36, inertia: 0.002727, points: {pin: [0.15, 0]}}
  rod: {type: beam, length: 0.3, elements: 8, frame: chord, modes: 2, material: metal, section: square,
        rotary_inertia: ROTARY}
  slider: {type: rigid, mass: 0.075552, inertia: 1}
joints:
  drive: {type: revolute, between: [ground.origin, crank.origin], driven: 150*t}
  pin: {type: revolute, between: [crank.pin, rod.start]}
  wrist: {type: revolute, between: [rod.end, slider.origin]}
  rail: {type: prismatic, between: [ground.origin, slider.origin]}
simulation: {duration: 0.1, rtol: 1e-10, output_interval: 0.1}
"""
# at the start, the rates of the shapes sin(pi x / L) and sin(2 pi x / L) [m/s]
RATES = 0.444896105, 0.00463434311
# at t = 0.1 s: angle of the rod [rad], place of the slider [m], the first shape [m]
ANGLE, SLIDER, SHAPE = -0.331173498825626, 0.169737332842786, 1.893192899613509e-4


@pytest.mark.parametrize("rotary", ["false", "true"])
def test_simeon_s_slider_crank(rotary):
    system = fmbd.assemble(load_model_text(CRANK.replace("ROTARY", rotary)))
    (body, beam), *_ = system.beams.items()
    x = np.linspace(0.0, 0.3, 401)
    shapes = np.stack([np.sin(np.pi * x / 0.3), np.sin(2 * np.pi * x / 0.3)], axis=-1)
    v = system.start.v.copy()
    v[system.reference.inertia.elastic[body]] = e = np.linalg.lstsq(beam.shape(x), shapes @ RATES)[0]
    # the pin turns the end of the rod, which turns against its chord
    v[system.coordinate_names.index("pin.angle")] += beam.slope(0.0) @ e
    run = simulate_system(replace(system, start=replace(system.start, v=v)))
    bent = np.linalg.lstsq(shapes[::50], run.motion.deflection("rod", x[::50])[-1])[0]
    assert_allclose(run["rod.frame.angle"][-1], ANGLE, rtol=1e-4)
    assert_allclose(run["slider.origin.position"][-1], [SLIDER, 0.0], rtol=1e-4, atol=1e-10)
    assert_allclose(bent[0], SHAPE, rtol=1e-3)
