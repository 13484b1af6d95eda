"""Beams that leave linear theory are told of: bent too far, loaded along, turned too fast; others are not."""

import numpy as np
import pytest

import fmbd
from fmbd.beams import floating_beam
from fmbd.beams.limits import softening_load, weight_sag
from fmbd.model import load_model_text
from fmbd.model.pieces import uniform_piece
from fmbd.results.watch import start_warnings

L, EI, RHO_A = 0.8, 3.0, 0.5


@pytest.mark.parametrize(
    ("frame", "sag", "load"),
    [("clamped", 1 / 8, 3), ("chord", 5 / 384, np.pi**2)],
)
def test_sag_and_softening_load_of_uniform_beams(frame, sag, load):
    """Textbook: q L^4 / 8 EI and 5 q L^4 / 384 EI; 3 EI / L^2 and Euler's load."""
    beam = floating_beam([uniform_piece(L, RHO_A, EI)], np.linspace(0, L, 5), frame)
    modes = beam.modal_basis()
    assert weight_sag(beam, *modes) == pytest.approx(sag * RHO_A * L**4 / EI, rel=1e-9)
    assert softening_load(beam, *modes) == pytest.approx(load * EI / L**2, rel=1e-9)


PENDULUM = """
fmbd: 1
gravity: [0, -9.81]
bodies: {rod: {type: beam, length: 0.8, elements: 8, mass_per_length: 0.5, bending_stiffness: 5}}
joints: {hinge: {type: revolute, between: [ground.origin, rod.start]}}
initial: {joints: {hinge: -pi/2}}
simulation: {duration: 0.1, output_interval: 0.01}
"""


def warnings(**changes):
    """What is said before and after a run of the pendulum, or of another model made of it."""
    model = load_model_text(PENDULUM, overrides=changes)
    run = fmbd.simulate(model)
    return start_warnings(run.system), str(run.statistics["warnings"]).splitlines()


def test_a_stiff_rod_is_left_in_peace():
    assert warnings() == ([], [])


def test_a_modulus_in_the_wrong_unit():
    """A rod of steel with E in MPa, that falls from the horizontal; rho A g L^4 / 8 EI = 7334 m."""
    steel = {
        "materials": {"steel": {"density": 7850, "youngs_modulus": 2.1e5}},
        "sections": {"round": {"type": "circle", "diameter": 0.01}},
        "bodies.rod": {"type": "beam", "length": 1, "elements": 2, "material": "steel", "section": "round"},
        "initial.joints": {},
    }
    before, after = warnings(**steel)
    assert (
        "rod: level and held at its start, it sags under its own weight by 7,334 times its length"
        in before[0]
    )
    assert "Pa" in before[0]
    assert after[0].startswith("rod: bends by ") and "segments" in after[0]


def test_a_thick_rod():
    """Ten times as long as high is not; five times: (pi / 5)^2 / 24 (1 + 3) = 6.6 %, with rotary inertia 4.9 %."""

    def said(height, **options):
        steel = {
            "materials": {"steel": {"density": 7850, "youngs_modulus": 2.1e11, "poissons_ratio": 0.3}},
            "sections": {"bar": {"type": "rectangle", "width": 0.1, "height": height}},
            "bodies.rod": {"type": "beam", "length": 1, "elements": 2, "material": "steel", "section": "bar"}
            | options,
        }
        return warnings(**steel)[0]

    assert said(0.099) == []
    [line] = said(0.2)
    assert line.startswith(
        "rod: is only 5 times as long as high; give it `rotary_inertia: true` and `shear: true`"
    )
    assert line.endswith("by some 7%")
    [line] = said(0.2, rotary_inertia=True)
    assert "give it `shear: true`" in line and line.endswith("by some 5%")
    assert said(0.2, rotary_inertia=True, shear=True) == []


def test_a_heavy_load_along_the_rod():
    """Hung from it are 1.5 kg and its own 0.4 kg: 18.6 N at the top, against 3 EI / L^2 = 23.4 N."""
    _, after = warnings(**{"bodies.rod.point_masses": {"end": 1.5}})
    assert len(after) == 1
    assert after[0].startswith("rod: carries 18.6 N along it at t = ")
    assert "; 23.4 N should count as much as its bending stiffness" in after[0]
    assert "`foreshortening: true`, or segments" in after[0]
    assert warnings(**{"bodies.rod.point_masses": {"end": 1.5}, "bodies.rod.segments": 4})[1] == []
    shortened = {"bodies.rod.foreshortening": True, "bodies.rod.frame": "chord"}
    assert warnings(**{"bodies.rod.point_masses": {"end": 1.5}} | shortened)[1] == []


def test_a_fast_turn():
    """First frequency 3.516 sqrt(EI / rho A L^4) = 17.37 rad/s; without weight, the force along it counts less."""
    turning = {"type": "revolute", "between": ["ground.origin", "rod.start"], "driven": "12*t"}
    before, after = warnings(**{"joints.hinge": turning, "gravity": [0, 0], "initial.joints": {}})
    assert before == after[:1]
    assert before[0].startswith(
        "rod: turns at 12 rad/s at t = 0 s, 69% of its first frequency, and should stiffen"
    )
    assert "`foreshortening: true`, or segments" in before[0]
    shortened = {"bodies.rod.foreshortening": True, "gravity": [0, 0], "initial.joints": {}}
    assert warnings(**{"joints.hinge": turning} | shortened) == ([], [])
    slower = turning | {"driven": "4*t"}
    assert warnings(**{"joints.hinge": slower, "gravity": [0, 0], "initial.joints": {}}) == ([], [])
