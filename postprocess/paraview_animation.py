"""A scene in ParaView: beams coloured by their bending moment, solid links, pins, motors, a trail, forces to switch on.

    paraview --script=postprocess/paraview_animation.py         the newest archive of the working directory; press play
    pvpython postprocess/paraview_animation.py run.vtkhdf [OUT.png | OUT.avi | OUT.ogv]

In ParaView with a file open: Tools, Python Shell, Run Script. ParaView 5.13 or newer opens archives; ParaView 5.11 and
5.12 open what `fmbd export run.vtkhdf run.pvd` writes.
"""

import sys
from pathlib import Path

from paraview import servermanager, simple

COLOUR = "bending_moment"  # or "stress", "velocity", "displacement", "deflection"
EXAGGERATION = 1.0  # of the deflection of beams
FORCE = 0.2  # length of the largest arrow against the size of the mechanism; click the eye of "forces" to see them

UNITS = {"bending_moment": "N m", "stress": "Pa", "velocity": "m/s", "displacement": "m", "deflection": "m"}
KINDS = ("joint", "beam", "rigid body", "ground point", "spring", "motor", "trail", "visual", "mass")
INK, BODY, GROUND, BEAM = (0.17, 0.20, 0.24), (0.71, 0.74, 0.79), (0.50, 0.55, 0.61), (0.0, 0.45, 0.70)
SPRING, MOTOR, TRAIL = (0.0, 0.62, 0.45), (0.90, 0.62, 0.0), (0.84, 0.37, 0.0)
#: Colours for many bodies that the colour-blind tell apart (Okabe and Ito).
BODIES = (GROUND, BEAM, MOTOR, SPRING, (0.80, 0.47, 0.65), (0.34, 0.71, 0.91), TRAIL, (0.94, 0.89, 0.26))


class Scene:
    """The pieces of a drawing as a view shows them."""

    def __init__(self, source, view):
        self.view = view
        view.ViewTime = max(source.TimestepValues or [0.0])
        self.extent = extent(source)
        self.unit = 0.022 * max(self.extent[1] - self.extent[0], self.extent[3] - self.extent[2])
        self.source = exaggerated(source)
        self.kinds, self.bodies = inventory(source)
        simple.Hide(source, view)
        self.name_categories()
        self.draw()
        self.aim()

    def draw(self):
        unit = self.unit
        if "rigid body" in self.kinds:
            links = simple.ExtractSurface(Input=self.of("rigid body"), registrationName="links")
            if 2 in self.kinds["rigid body"]:
                solid = simple.LinearExtrusion(Input=links, ScaleFactor=0.5 * unit, Vector=[0.0, 0.0, 1.0])
                self.show(simple.Transform(Input=solid, registrationName="plates"), BODY, z=-0.25 * unit)
            if 1 in self.kinds["rigid body"]:
                self.show(self.tube(links, 0.55, "rods"), BODY)
        if "visual" in self.kinds:
            self.show(simple.ExtractSurface(Input=self.of("visual"), registrationName="meshes"), BODY)
        if "beam" in self.kinds:
            beams = simple.ExtractSurface(Input=self.of("beam"))
            self.colour(self.show(self.tube(beams, 0.4, "beams"), BEAM))
        for kind, radius, paint in (("spring", 0.16, SPRING), ("trail", 0.12, TRAIL)):
            if kind in self.kinds:
                curve = simple.ExtractSurface(Input=self.of(kind))
                self.show(self.tube(curve, radius, kind), paint)
        for kind, radius, height, paint in (
            ("mass", 3.0, 0.6, BODY),
            ("ground point", 0.9, 0.5, GROUND),
            ("motor", 1.3, 2.0, MOTOR),
            ("joint", 0.5, 2.0, INK),
        ):
            if kind in self.kinds:
                shown = self.show(self.cylinders(kind, radius, height), paint)
                shown.Interpolation = "Flat"  # glyphs are turned without their normals
        self.forces()
        clock = simple.AnnotateTimeFilter(
            Input=self.source, Format="t = {time:.3f} s", registrationName="clock"
        )
        shown = simple.Show(clock, self.view)
        shown.WindowLocation, shown.Color, shown.FontSize = "Lower Left Corner", INK, 22

    def of(self, kind):
        """The cells of a kind."""
        k = KINDS.index(kind)
        return simple.Threshold(
            Input=self.source, Scalars=["CELLS", "kind"], LowerThreshold=k - 0.5, UpperThreshold=k + 0.5
        )

    def tube(self, curve, radius, name):
        tube = simple.Tube(Input=curve, registrationName=name)
        tube.Radius, tube.NumberofSides, tube.Capping = radius * self.unit, 20, 1
        tube.Scalars, tube.VaryRadius = ["POINTS", ""], "Off"
        return tube

    def cylinders(self, kind, radius, height):
        pins = simple.Glyph(Input=self.of(kind), GlyphType="Cylinder", registrationName=kind)
        pins.OrientationArray, pins.ScaleArray = (
            ["POINTS", "No orientation array"],
            ["POINTS", "No scale array"],
        )
        pins.GlyphMode, pins.ScaleFactor = "All Points", 1.0
        pins.GlyphType.Radius, pins.GlyphType.Height = radius * self.unit, height * self.unit
        pins.GlyphType.Resolution = 48
        pins.GlyphTransform.Rotate = [90.0, 0.0, 0.0]
        return pins

    def forces(self):
        """Arrows of what joints put on the bodies of their first points, hidden until asked for."""
        if "force" not in list(self.source.PointData.keys()):
            return
        arrows = simple.Glyph(Input=self.source, GlyphType="Arrow", registrationName="forces")
        arrows.OrientationArray, arrows.ScaleArray = ["POINTS", "force"], ["POINTS", "force"]
        arrows.GlyphMode, arrows.VectorScaleMode = "All Points", "Scale by Magnitude"
        largest = largest_over_time(self.source, "force")
        arrows.ScaleFactor = FORCE * self.unit / 0.022 / largest if largest else 1.0
        self.show(arrows, TRAIL)
        simple.Hide(arrows, self.view)

    def show(self, item, paint, z=0.0):
        if z:
            item.Transform.Translate = [0.0, 0.0, z]
        shown = simple.Show(item, self.view)
        simple.ColorBy(shown, None)
        shown.DiffuseColor = shown.AmbientColor = paint
        shown.Ambient, shown.Diffuse, shown.Specular = 0.15, 0.85, 0.15
        return shown

    def colour(self, shown):
        """Colours by a field, with equal limits for both signs over all times, and their bar."""
        if COLOUR not in list(self.source.PointData.keys()):
            return
        simple.ColorBy(shown, ("POINTS", COLOUR))
        table = simple.GetColorTransferFunction(COLOUR)
        largest = largest_over_time(self.source, COLOUR) or 1.0
        signed = self.source.PointData[COLOUR].GetNumberOfComponents() == 1
        table.ApplyPreset("Cool to Warm" if signed else "Viridis (matplotlib)", True)
        table.RescaleTransferFunction(-largest if signed else 0.0, largest)
        table.NanColor = BODY
        bar = simple.GetScalarBar(table, self.view)
        bar.Title, bar.ComponentTitle = f"{COLOUR.replace('_', ' ')} [{UNITS[COLOUR]}]", ""
        bar.TitleColor = bar.LabelColor = INK
        bar.AddRangeLabels = 0
        bar.Orientation, bar.WindowLocation = "Horizontal", "Lower Right Corner"
        bar.TitleFontSize, bar.LabelFontSize, bar.ScalarBarLength, bar.ScalarBarThickness = 18, 15, 0.3, 12
        shown.SetScalarBarVisibility(self.view, True)

    def name_categories(self):
        """Who colours by `body_id` or `kind` sees names."""
        for array, names in (("body_id", self.bodies), ("kind", dict(enumerate(KINDS)))):
            table = simple.GetColorTransferFunction(array)
            table.InterpretValuesAsCategories = 1
            table.Annotations = [text for k, name in sorted(names.items()) for text in (str(k), name)]
            table.IndexedColors = [part for k, _ in enumerate(names) for part in BODIES[k % len(BODIES)]]

    def aim(self):
        """Everything that ever moves is in the picture, seen a little from below as `fmbd animate` does."""
        left, right, bottom, top = self.extent
        width, height = self.view.ViewSize
        half = 0.5 * max(top - bottom, (right - left) * height / width) + 6.0 * self.unit
        centre = [0.5 * (left + right), 0.5 * (bottom + top) - 2.0 * self.unit, 0.0]
        self.view.CameraParallelProjection = 1
        self.view.CameraParallelScale = half
        self.view.CameraFocalPoint = centre
        self.view.CameraPosition = [centre[0], centre[1] - 1.6 * half, 4.0 * half]
        self.view.CameraViewUp = [0.0, 1.0, 0.0]
        self.view.UseColorPaletteForBackground, self.view.BackgroundColorMode = 0, "Single Color"
        self.view.Background = [1.0, 1.0, 1.0]
        self.view.OrientationAxesVisibility = 0


def exaggerated(source):
    if EXAGGERATION == 1.0 or "deflection" not in list(source.PointData.keys()):
        return source
    return simple.WarpByVector(Input=source, Vectors=["POINTS", "deflection"], ScaleFactor=EXAGGERATION - 1.0)


def inventory(source):
    """The dimensions of the cells of each kind, and the names of the bodies by their number."""
    data = servermanager.Fetch(source)
    cells = data.GetCellData()
    kinds, bodies = {}, {0: "ground"}
    for k in range(data.GetNumberOfCells()):
        kind = KINDS[int(cells.GetArray("kind").GetTuple1(k))]
        kinds.setdefault(kind, set()).add(data.GetCell(k).GetCellDimension())
        if kind in ("beam", "rigid body", "visual", "mass"):
            names = cells.GetAbstractArray("name")
            row = names.GetValue(k) if names.IsA("vtkStringArray") else names.GetTuple(k)
            name = row if isinstance(row, str) else "".join(chr(int(letter)) for letter in row if letter)
            bodies[int(cells.GetArray("body_id").GetTuple1(k))] = name
    return kinds, bodies


def some_times(source):
    times = list(source.TimestepValues or [0.0])
    return times[:: max(1, len(times) // 40)]


def extent(source):
    """Left, right, bottom and top of all that the drawing reaches."""
    bounds = []
    for time in some_times(source):
        source.UpdatePipeline(time)
        bounds.append(source.GetDataInformation().GetBounds())
    left, right, bottom, top, *_ = zip(*bounds)
    left, right, bottom, top = min(left), max(right), min(bottom), max(top)
    if max(right - left, top - bottom) < 1e-9:
        return left - 0.5, right + 0.5, bottom - 0.5, top + 0.5
    return left, right, bottom, top


def largest_over_time(source, field):
    """The largest magnitude of a field."""
    largest = 0.0
    for time in some_times(source):
        source.UpdatePipeline(time)
        array = source.PointData[field]
        low, high = array.GetRange(-1 if array.GetNumberOfComponents() > 1 else 0)
        if low <= high:
            largest = max(largest, abs(low), abs(high))
    return largest


def opened(named):
    """The file that is named, else what is open, else the newest archive of the working directory."""
    if not named and simple.GetActiveSource() is not None:
        return simple.GetActiveSource()
    found = [path for suffix in ("*.vtkhdf", "*.pvd") for path in Path.cwd().glob(suffix)]
    if not named and not found:
        raise SystemExit("open an archive first, or say which: pvpython paraview_animation.py run.vtkhdf")
    version = simple.GetParaViewVersion()
    plays_archives = (version.major, version.minor) >= (5, 13)
    usable = [path for path in found if plays_archives or path.suffix == ".pvd"] or found
    path = Path(named) if named else max(usable, key=lambda path: path.stat().st_mtime)
    if path.suffix == ".vtkhdf" and not plays_archives:
        number = f"{version.major}.{version.minor}"
        raise SystemExit(f"ParaView {number} does not play archives: fmbd export {path} {path.stem}.pvd")
    return simple.OpenDataFile(str(path))


def main():
    arguments = [word for word in sys.argv[1:] if not word.startswith("-")]
    named = next((word for word in arguments if word.endswith((".vtkhdf", ".pvd"))), None)
    out = next((word for word in arguments if word.endswith((".png", ".avi", ".ogv"))), None)
    source = opened(named)
    view = simple.GetActiveViewOrCreate("RenderView")
    if out:
        view.ViewSize = [1280, 800]
    Scene(source, view)
    animation = simple.GetAnimationScene()
    animation.UpdateAnimationUsingDataTimeSteps()
    animation.PlayMode = "Snap To TimeSteps"
    if out and out.endswith(".png"):
        animation.GoToLast()
        simple.SaveScreenshot(out, view)
    elif out:
        simple.SaveAnimation(out, view, FrameRate=25)
    simple.Render(view)


main()
