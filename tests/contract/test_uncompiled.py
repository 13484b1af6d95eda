"""The kernels run as plain Python, too: for a debugger, and as a check of what the compiler made of them."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

SCRIPT = """
import json, sys
import numpy as np
import fmbd
model = fmbd.load_model(sys.argv[1], {"simulation.duration": 2e-3, "simulation.output_interval": 1e-3})
system = fmbd.assemble(model)
q = system.start.q + 1e-3 * np.arange(system.planar.nq)
acceleration, multipliers = system.accelerations(q, np.linspace(-1, 1, q.size))
run = fmbd.simulate(model)
print(json.dumps([acceleration.tolist(), multipliers.tolist(), run["rod_right.end.position"].tolist()]))
"""
FIVE_BAR = Path(__file__).parents[2] / "models" / "five_bar.yaml"


def results(**environment: str) -> list[np.ndarray]:
    command = [sys.executable, "-c", SCRIPT, str(FIVE_BAR)]
    done = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=True)
    return [np.array(values) for values in json.loads(done.stdout)]


def test_uncompiled_is_compiled_to_round_off() -> None:
    """Accelerations, multipliers and the first two milliseconds of the five-bar."""
    for compiled, plain in zip(results(), results(NUMBA_DISABLE_JIT="1"), strict=True):
        np.testing.assert_allclose(plain, compiled, rtol=1e-11, atol=1e-13)
