"""Whether this machine can draw off-screen: asked in a process of its own, as a machine that cannot kills it."""

import subprocess
import sys
from functools import cache

PATIENCE = 60.0  # seconds
PROGRAM = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow
window = vtkRenderWindow()
window.OffScreenRenderingOn()
window.AddRenderer(vtkRenderer())
window.Render()
raise SystemExit(0 if window.SupportsOpenGL() else 3)
"""

ADVICE = "this machine cannot draw in three dimensions (on Debian: apt-get install libegl1 or libosmesa6)"


@cache
def can_render() -> bool:
    """Whether vtk draws here without a display."""
    try:
        done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0
