"""Animations: the pictures show the mechanism where the archive says, whatever the renderer.

Where vtk cannot draw without a display, `fmbd animate` draws flat; the tests of light and depth are skipped there.
"""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

import fmbd
from fmbd.cli import main
from fmbd.results.animation import movie
from fmbd.results.animation.look import Look, frame_rows, rounded
from fmbd.results.animation.probe import can_render
from fmbd.results.scene import scene

MODELS = Path(__file__).parents[2] / "models"
SMALL = ("--size", "320x240")
TRAIL = np.array([0xD5, 0x5E, 0x00])

in_depth = pytest.mark.skipif(
    not can_render(), reason="vtk cannot draw off-screen here (on Debian: apt-get install libegl1)"
)


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pendulum, half a second from its horizontal start."""
    path = tmp_path_factory.mktemp("runs") / "pendulum.vtkhdf"
    fmbd.simulate(fmbd.load_model(MODELS / "pendulum.yaml", {"simulation.duration": 0.5}), path)
    return path


@pytest.fixture(scope="module")
def beam(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("runs") / "beam.vtkhdf"
    fmbd.simulate(fmbd.load_model(MODELS / "cantilever.yaml", {"simulation.duration": 0.3}), path)
    return path


def frames(path: Path) -> list[np.ndarray]:
    with Image.open(path) as picture:
        found = []
        for k in range(picture.n_frames):
            picture.seek(k)
            found.append(np.asarray(picture.convert("RGB")).astype(int))
        return found


def ink(image: np.ndarray) -> np.ndarray:
    """Where something is drawn above the line of the clock."""
    return (image.sum(axis=2) < 720)[:200]


@pytest.mark.parametrize("style", [("--flat",), pytest.param((), marks=in_depth)], ids=["flat", "depth"])
def test_a_gif_moves_from_start_to_end(archive: Path, tmp_path: Path, style: tuple[str, ...]) -> None:
    """The rod of the pendulum reaches left at the start (angle pi) and falls: its end goes down and to the right."""
    out = tmp_path / "a.gif"
    options = (*SMALL, *style, "--speed", "0.5", "--fps", "10", "--trail", "none")
    assert main(["animate", str(archive), str(out), *options]) == 0
    images = frames(out)
    assert len(images) == 11
    assert images[0].shape == (240, 320, 3)
    run = fmbd.open_run(archive)
    x, y = run["bob.center_of_mass.position"][[0, -1]].T
    rows, columns = zip(*(np.nonzero(ink(image)) for image in (images[0], images[-1])))
    assert np.sign(rows[1].mean() - rows[0].mean()) == np.sign(y[0] - y[1])
    assert np.sign(columns[1].mean() - columns[0].mean()) == np.sign(x[1] - x[0])


@pytest.mark.parametrize("style", [("--flat",), pytest.param((), marks=in_depth)], ids=["flat", "depth"])
def test_a_still_has_ghosts_and_a_trail(archive: Path, tmp_path: Path, style: tuple[str, ...]) -> None:
    out, bare = tmp_path / "a.png", tmp_path / "bare.gif"
    assert main(["animate", str(archive), str(out), *SMALL, *style]) == 0
    assert (
        main(
            [
                "animate",
                str(archive),
                str(bare),
                *SMALL,
                *style,
                "--speed",
                "0.5",
                "--fps",
                "1",
                "--trail",
                "none",
            ]
        )
        == 0
    )
    (still,), last = frames(out), frames(bare)[-1]
    assert np.count_nonzero(ink(still)) > 1.5 * np.count_nonzero(ink(last))

    def orange(image: np.ndarray) -> int:
        return np.count_nonzero((image[..., 0] > 150) & (image[..., 1] < 140) & (image[..., 2] < 70))

    assert orange(still) > 80
    assert orange(last) == 0


@in_depth
def test_beams_may_be_coloured(beam: Path, tmp_path: Path) -> None:
    """The clamped end is red or blue where it bends most; the free end, without moment, is grey."""
    out = tmp_path / "a.png"
    options = ("--colour", "bending_moment", "--camera", "front", "--trail", "none", *SMALL)
    assert main(["animate", str(beam), str(out), *options]) == 0
    (image,) = frames(out)
    middle = image[60:110]
    vivid = np.abs(middle[..., 0] - middle[..., 2])
    assert vivid[:, 40:80].max() > 90
    assert vivid[:, 260:280].max() < 50


def test_where_vtk_cannot_draw_it_is_drawn_flat(
    archive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(movie, "can_render", lambda: False)
    assert main(["animate", str(archive), str(tmp_path / "a.png"), *SMALL]) == 0
    assert "apt-get install libegl1 or libosmesa6" in capsys.readouterr().err
    assert main(["animate", str(archive), str(tmp_path / "flat.png"), *SMALL, "--flat"]) == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "flat.png").read_bytes()


def test_frames_keep_time() -> None:
    time = np.linspace(0.0, 3.0, 3001)
    assert_allclose(time[frame_rows(time, Look(speed=0.5, fps=10))], np.linspace(0.0, 3.0, 61))
    assert len(frame_rows(time, Look())) == 151  # half speed lasts six seconds
    assert [rounded(value) for value in (0.0123, 0.3, 4.0, 80.0)] == [0.01, 0.2, 5.0, 100.0]


def test_exaggerated_deflections(beam: Path) -> None:
    """A free end is displaced from the undeflected axis, and the picture has room for it."""
    run = fmbd.open_run(beam)
    drawn = scene(run, [0, len(run.time) - 1]).exaggerated(20.0)
    (curve,) = (item.points for item in drawn.items if item.kind == "beam")
    assert_allclose(curve[-1, -1].imag, 20.0 * run["ruler.end.deflection"][-1])
    assert_allclose(curve[-1, 0], 0.0, atol=1e-12)
    assert_allclose(drawn.tracks["ruler.end"], curve[:, -1])
    assert drawn.extent[2] <= curve.imag.min()


def test_a_video(archive: Path, tmp_path: Path) -> None:
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="the extra `video` is not installed")
    out = tmp_path / "a.mp4"
    assert main(["animate", str(archive), str(out), *SMALL, "--flat", "--speed", "0.5"]) == 0
    count, seconds = imageio_ffmpeg.count_frames_and_secs(str(out))
    assert (count, seconds) == (26, pytest.approx(1.04, abs=0.05))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["a.avi"], "the file must end in .gif, .mp4, .png, not in '.avi'"),
        (["a.png", "--trail", "bob.centre_of_mass"], "did you mean 'bob.center_of_mass'?"),
        (["a.png", "--colour", "stres"], "unknown colour 'stres', did you mean 'stress'?"),
        (["a.png", "--colour", "stress", "--flat"], "colours of beams are not drawn flat"),
        (
            ["no/such/folder/a.png", *SMALL, "--flat"],
            "cannot write no/such/folder/a.png: No such file or directory",
        ),
    ],
)
def test_what_cannot_be_animated_is_answered_in_one_line(
    arguments: list[str], message: str, archive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["animate", str(archive), *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(
    importlib.util.find_spec("imageio_ffmpeg") is not None, reason="imageio-ffmpeg is installed"
)
def test_a_video_without_its_extra(archive: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["animate", str(archive), "a.mp4"]) == 2
    assert "pip install 'fmbd[video]'; gif needs nothing more" in capsys.readouterr().err
