"""Files that are no models, or attack the reader: each is refused at once, with the reason."""

import os
from pathlib import Path

import pytest

from fmbd.model import ModelError, load_model, load_model_text

FIVE_BAR = (Path(__file__).parents[2] / "models" / "five_bar.yaml").read_bytes()


def problems(text, path=None):
    with pytest.raises(ModelError) as error:
        load_model_text(text, path)
    return error.value.problems


class TestTables:
    """A table of a signal, or of a spring's force, is a CSV file below the model's folder."""

    def reading(self, folder, name="drive.csv", keys=""):
        signal = f"{{type: table, file: {name!r}, {keys}}}"
        body = "bodies: {b: {type: rigid, mass: 1, inertia: 1}}"
        joint = "joints: {j: {type: free, between: [ground.origin, b.origin]}}"
        (line,) = problems(f"fmbd: 1\n{body}\n{joint}\nsignals: {{s: {signal}}}", folder / "m.yaml")
        return line

    @pytest.mark.parametrize(
        ("content", "message"),
        [
            ("t,u\n0,1\n1,2\n1,3\n", "drive.csv:4: the time 1 does not increase (before: 1)"),
            ("t,u\n0,1\n1,two\n", "drive.csv:3: 'two' is not a number"),
            ("t,u\n0,1\n1,inf\n", "drive.csv:3: 'inf' is not a number"),
            ("t,u\n0,1\n\n1\n", "drive.csv:4: column 1 is missing"),
            ("t,u\n0,1\n", "drive.csv: a table needs at least two rows of numbers, has 1"),
            ("\n", "drive.csv: the file is empty"),
            ("t,\xff\n", "drive.csv: cannot be read"),
        ],
    )
    def test_a_bad_row_is_named_by_file_and_line(self, tmp_path, content, message):
        (tmp_path / "drive.csv").write_bytes(content.encode("latin-1"))
        assert message in self.reading(tmp_path)

    def test_columns_must_exist(self, tmp_path):
        (tmp_path / "drive.csv").write_text("time,voltage\n0,1\n1,2\n")
        assert "unknown column 'volt', did you mean 'voltage'?" in self.reading(tmp_path, keys="value: volt")
        assert "drive.csv has columns 0 to 1, not 2" in self.reading(tmp_path, keys="value: 2")

    @pytest.mark.parametrize(
        ("name", "message"),
        [
            ("falls.csv", "falls.csv:3: the stretch 0 does not increase (before: 1)"),
            ("../secret.csv", "../secret.csv: the file must lie in the model's folder"),
            ("none.csv", "none.csv: there is no such file in the model's folder"),
        ],
    )
    def test_the_force_of_a_spring_is_read_as_carefully(self, tmp_path, name, message):
        (tmp_path / "falls.csv").write_text("m,N\n1,1\n0,2\n")
        body = "bodies: {b: {type: rigid, mass: 1, inertia: 1}}"
        joint = f"{{type: prismatic, between: [ground.origin, b.origin], spring: {{force_table: {name}}}}}"
        (line,) = problems(f"fmbd: 1\n{body}\njoints: {{j: {joint}}}", tmp_path / "m.yaml")
        assert line.endswith(f"joints.j.spring.force_table: {message}")

    @pytest.mark.parametrize("name", ["../secret.csv", "link.csv", "/etc/hostname", "loop"])
    def test_files_elsewhere_are_out_of_reach(self, tmp_path, name):
        folder = tmp_path / "models"
        folder.mkdir()
        (tmp_path / "secret.csv").write_text("0,1\n1,2\n")
        (folder / "link.csv").symlink_to(tmp_path / "secret.csv")
        (folder / "loop").symlink_to(folder / "loop")
        line = self.reading(folder, name)
        assert "must lie in the model's folder" in line or "cannot be read" in line or "no such file" in line


class TestTexts:
    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "<text>: is empty"),
            ("3", "<text>:1:1: a model file must be a mapping, not 3"),
            ("fmbd: 1\nbodies: {}", "missing key 'bodies': a model has at least one body"),
            ("a: 1\n---\nb: 2", "<text>:2:1: a second document begins here"),
            ("? [a]\n: b", "<text>:1:3: a key must be a plain name"),
            ("a: &x [*x]", "<text>:1:8: the alias '*x' stands within its own anchor"),
            ("a: *x", "<text>:1:4: the alias '*x' has no anchor '&x' before it"),
            ("a: \x00", "not valid YAML"),
            ("a: '\ud800'", "<text>: is not valid Unicode text"),
            ("\ta: 1", "<text>:1:1: not valid YAML"),
            ("[" * 100_000, "is nested more than 64 levels deep"),
            ("".join("  " * k + "a:\n" for k in range(1000)), "is nested more than 64 levels deep"),
            ("#" * 50_000_001, "<text>: has 50000001 bytes; at most 50000000 are read"),
        ],
        ids=lambda value: value[:20],
    )
    def test_text_that_is_no_model(self, text, message):
        assert message in problems(text)[0]

    def test_a_billion_laughs_are_not_expanded(self):
        lines = ["a0: &a0 [ha, ha, ha]"] + [
            f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 30)
        ]
        assert "aliases expand to more than 100000 values" in problems("\n".join(lines))[0]

    def test_control_characters_do_not_reach_the_terminal(self):
        (line,) = problems(
            '{fmbd: 1, "\\e[2J\\n\\a": 1, bodies: {b: {type: rigid, mass: 1, inertia: 1}}, joints: {}}'
        )[:1]
        assert line.isprintable()

    def test_a_flood_of_mistakes_ends(self):
        lines = problems("\n".join(f"key{k}: 1" for k in range(100_000)))
        assert len(lines) == 101
        assert "reading stops after 100 problems" in lines[-1]

    def test_a_long_chain_of_parameters_is_no_problem(self):
        chain = "\n".join(f"  p{k}: p{k + 1}" for k in range(5000))
        lines = problems(f"fmbd: 1\nparameters:\n{chain}\n  p5000: p0\n")
        assert "parameters.p0: loop p0 -> p1 -> p2" in lines[-1] + lines[0]


class TestFiles:
    def test_a_missing_file_is_compared_with_its_neighbours(self, tmp_path):
        (tmp_path / "five_bar.yaml").write_text("fmbd: 1")
        with pytest.raises(
            ModelError, match=r"fivebar.yaml: there is no such file, did you mean 'five_bar.yaml'\?"
        ):
            load_model(tmp_path / "fivebar.yaml")

    def test_a_name_is_not_like_another_for_its_suffix_alone(self, tmp_path):
        (tmp_path / "fed.yaml").write_text("fmbd: 1")
        with pytest.raises(ModelError, match=r"nofile.yaml: there is no such file$"):
            load_model(tmp_path / "nofile.yaml")

    def test_an_archive_is_no_model(self, tmp_path):
        (tmp_path / "run.vtkhdf").write_bytes(b"\x89HDF\r\n\x1a\n\0")
        with pytest.raises(ModelError, match=r"run.vtkhdf: holds results, not a model: `fmbd info "):
            load_model(tmp_path / "run.vtkhdf")

    @pytest.mark.parametrize("content", [b"\xff\xfe", b"fmbd: \x80"])
    def test_other_encodings_are_named(self, tmp_path, content):
        (tmp_path / "m.yaml").write_bytes(content)
        with pytest.raises(ModelError, match="is not UTF-8 text"):
            load_model(tmp_path / "m.yaml")

    def test_what_is_not_a_file_is_not_read(self, tmp_path):
        pipe = tmp_path / "pipe.yaml"
        os.mkfifo(pipe)
        for path in (pipe, tmp_path, "/dev/zero", "a\0b", "x" * 5000):
            with pytest.raises(ModelError):
                load_model(path)

    def test_a_byte_order_mark_is_passed_over(self, tmp_path):
        (tmp_path / "m.yaml").write_bytes(b"\xef\xbb\xbf" + FIVE_BAR)
        assert load_model(tmp_path / "m.yaml").name == "five-bar"
