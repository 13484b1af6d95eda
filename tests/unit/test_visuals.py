"""Meshes for looks: what a model may name, where it is placed, how it is refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.cli import main
from fmbd.model import load_model_text, visuals

CORNERS = np.array([[0, 0, 0], [40, 0, 0], [0, 30, 0], [0, 0, 10]], float)
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
MODEL = """
fmbd: 1
bodies:
  crank: {type: rigid, mass: 1, inertia: 1, visual: VISUAL}
  rod: {type: beam, length: 1, elements: 1, mass_per_length: 1, bending_stiffness: 1}
joints:
  hinge: {type: revolute, between: [ground.origin, crank.origin]}
  other: {type: revolute, between: [ground.origin, rod.start]}
"""


def load(folder: Path, visual: str) -> fmbd.Model:
    path = folder / "rig.yaml"
    path.write_text(MODEL.replace("VISUAL", visual))
    return fmbd.load_model(path)


def write_mesh(path: Path, **options: object) -> None:
    meshio.write(path, meshio.Mesh(CORNERS, [("triangle", np.array(TETRAHEDRON))]), **options)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("crank.stl", {"binary": True}),
        ("ascii.stl", {"binary": False}),
        ("crank.obj", {}),
        ("crank.ply", {}),
        ("crank.off", {}),
        ("crank.vtk", {}),
        ("crank.msh", {"file_format": "gmsh"}),
        ("crank.mesh", {}),
        ("sub/CRANK.STL", {"binary": True, "file_format": "stl"}),
    ],
)
def test_a_mesh_comes_in_many_formats(tmp_path: Path, name: str, options: dict) -> None:
    (tmp_path / "sub").mkdir()
    write_mesh(tmp_path / name, **options)
    visual = load(tmp_path, name).bodies["crank"].visual
    assert {tuple(point) for point in visual.points} == {tuple(point) for point in CORNERS}
    drawn = {frozenset(visual.points[k] for k in face) for face in visual.faces}
    assert drawn == {frozenset(tuple(CORNERS[k]) for k in face) for face in TETRAHEDRON}


def test_it_is_scaled_turned_and_placed(tmp_path: Path) -> None:
    """From millimetres, turned by a right angle: (40, 30) becomes (-30, 40) mm."""
    write_mesh(tmp_path / "crank.stl")
    placed = (
        load(tmp_path, "{file: crank.stl, scale: 0.001, angle: pi/2, at: [0.5, 0]}").bodies["crank"].visual
    )
    expected = np.array([[0.5, 0, 0], [0.5, 0.04, 0], [0.47, 0, 0], [0.5, 0, 0.01]])
    assert_allclose(sorted(placed.points), sorted(expected.tolist()), atol=1e-9)


def test_a_mesh_in_millimetres_is_warned_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The rod is 1 m long; the mesh is 40 m x 30 m x 10 m as it is, 40 mm large in millimetres, then 4 mm."""
    write_mesh(tmp_path / "crank.stl")
    wrong = (
        "warning crank: the mesh is 40 m large, the mechanism 1 m: is the file in millimetres? scale: 0.001"
    )
    fine = "visual crank: crank.stl, 0.8 x 0.6 x 0.2 m"
    small = "warning crank: the mesh is 0.04 m large, the mechanism 1 m: is its scale right?"
    for scale, said in (1, wrong), (0.02, fine), (0.001, small):
        load(tmp_path, f"{{file: crank.stl, scale: {scale}}}")
        assert main(["check", str(tmp_path / "rig.yaml")]) == 0
        out = " ".join(capsys.readouterr().out.split())
        assert said in out
        assert ("the mesh is" in out) == (said is not fine)


def refusal(folder: Path, visual: str) -> str:
    with pytest.raises(fmbd.ModelError) as error:
        load(folder, visual)
    (line,) = str(error.value).splitlines()
    return line.removeprefix(f"{folder}/rig.yaml:")


def test_what_cannot_be_drawn_is_refused_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_mesh(tmp_path / "crank.stl")
    folder = tmp_path / "models"
    folder.mkdir()
    write_mesh(folder / "good.stl")
    (folder / "cut.stl").write_bytes((folder / "good.stl").read_bytes()[:150])
    (folder / "text.obj").write_text("v 1 2\nf 1 2 3\n")
    (folder / "points.obj").write_text("v 1 2 3\n")
    (folder / "link.stl").symlink_to(tmp_path / "crank.stl")
    (folder / "loop.stl").symlink_to(folder / "loop.stl")
    where = "4:53: bodies.crank.visual"
    expected = {
        "none.stl": "none.stl: there is no such file in the model's folder",
        "../crank.stl": "../crank.stl: the file must lie in the model's folder",
        "/etc/passwd.stl": "/etc/passwd.stl: the file must lie in the model's folder",
        "link.stl": "link.stl: the file must lie in the model's folder",
        "cut.stl": "cut.stl: cannot be read as a mesh (.stl)",
        "text.obj": "text.obj: cannot be read as a mesh (.obj)",
        "points.obj": "points.obj: has no triangles or other faces",
        "mesh.xdmf": "mesh.xdmf: a mesh for looks ends in .stl, .obj, .ply, .off, .vtk, .msh, .mesh",
    }
    for name, message in expected.items():
        assert refusal(folder, name) == f"{where}: {message}", name
    assert "loop.stl" in refusal(folder, "loop.stl")
    assert refusal(folder, "3") == f"{where}: must be a file or a mapping, not 3"
    assert "must be positive" in refusal(folder, "{file: good.stl, scale: 0}")
    monkeypatch.setattr(visuals, "MAX_FACES", 3)
    assert refusal(folder, "good.stl") == f"{where}: good.stl: has 4 faces; 3 are allowed"
    monkeypatch.setattr(visuals, "MAX_BYTES", 100)
    assert refusal(folder, "good.stl") == f"{where}: good.stl: the file has more than 100 bytes"


def test_a_beam_has_no_mesh(tmp_path: Path) -> None:
    write_mesh(tmp_path / "rod.stl")
    path = tmp_path / "rig.yaml"
    text = MODEL.replace(", visual: VISUAL", "").replace("{type: beam,", "{type: beam, visual: rod.stl,")
    path.write_text(text)
    with pytest.raises(fmbd.ModelError, match=r"rig.yaml:5:\d+: bodies.rod.visual: .* only rigid bodies"):
        fmbd.load_model(path)


def test_a_changed_copy_keeps_the_mesh_that_was_read(tmp_path: Path) -> None:
    write_mesh(tmp_path / "crank.stl")
    model = load(tmp_path, "crank.stl")
    (tmp_path / "crank.stl").unlink()
    assert model.with_("bodies.crank.mass", 2).bodies["crank"].visual == model.bodies["crank"].visual


@pytest.mark.parametrize(
    "text",
    ["", "OFF", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "OFF\n1 1 0\n0 0 nan\n3 0 0 0\n", "OFF\n1 1 0\n0 0 0\n"],
)
def test_an_archive_that_was_tampered_with_is_refused(text: str) -> None:
    with pytest.raises(fmbd.ModelError, match=r"crank\.stl: "):
        load_model_text(MODEL.replace("VISUAL", "crank.stl"), files={"crank.stl": text})
