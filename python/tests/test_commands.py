"""What makes recordings, calibrations and files gives the bytes of the command line."""

from __future__ import annotations

import json
import pathlib

import numpy as np
import pytest
from conftest import UNITS, command

import abbe

RECORDING = "recordings/postech-ballbar/recording.yaml"
MILL = "calibrations/postech-mill.yaml"

STAGE = {"calibration": 1, "machine": "FX", "errors": {"EXX": [{"backlash": {"lost_motion": "10 um"}}]}}
PATH = {
    "path": 1,
    "line": {"axis": "X", "from": "0 mm", "to": "20 mm"},
    "feed": "1000 mm/min",
    "rate": "100 Hz",
    "instrument": "position",
    "noise": "0.2 um",
    "seed": 1,
}


def test_simulate(tmp_path: pathlib.Path) -> None:
    stage = abbe.Calibration(STAGE)
    stage.write(tmp_path / "stage.yaml")
    (tmp_path / "path.yaml").write_text(json.dumps(PATH))
    command("simulate", "stage.yaml", "path.yaml", "--seed", 5, "--output", "told", cwd=tmp_path)
    written = abbe.simulate(abbe.Calibration(tmp_path / "stage.yaml"), tmp_path / "path.yaml", seed=5, output=tmp_path / "made")
    for name in ["recording.yaml", "data.csv"]:
        assert (tmp_path / "made" / name).read_bytes() == (tmp_path / "told" / name).read_bytes()
    memory = abbe.simulate(stage, PATH, seed=5)
    assert memory.channels == written.channels
    for channel in memory.channels:
        assert np.array_equal(memory[channel], written[channel], equal_nan=True)
    assert not np.array_equal(memory["measured.x"], abbe.simulate(stage, PATH, seed=6)["measured.x"])
    with pytest.raises(abbe.Error, match="already exists"):
        abbe.simulate(stage, PATH, output=tmp_path / "made")


def test_replay(root: pathlib.Path, tmp_path: pathlib.Path) -> None:
    command("simulate", MILL, RECORDING, "--output", tmp_path / "told")
    abbe.simulate(abbe.Calibration(MILL), abbe.Recording(RECORDING), output=tmp_path / "made")
    for name in ["recording.yaml", "data.csv"]:
        assert (tmp_path / "made" / name).read_bytes() == (tmp_path / "told" / name).read_bytes()
    with pytest.raises(abbe.Error, match="seed"):
        abbe.simulate(abbe.Calibration(MILL), RECORDING, seed=1)


def test_evaluate(root: pathlib.Path) -> None:
    done = abbe.evaluate(abbe.Recording(RECORDING))
    assert done.json == command("evaluate", RECORDING, "--format", "json")
    assert done.html == command("evaluate", RECORDING, "--format", "html")
    assert str(done) == command("evaluate", RECORDING)


@pytest.mark.parametrize("format", ["linuxcnc", "isg", "pmac"])
def test_export(format: str, root: pathlib.Path, tmp_path: pathlib.Path) -> None:
    more = {"pmac": (["--name", "X=1", "--counts", "X=10000"], {"name": {"X": "1"}, "counts": {"X": 10000}})}
    words, named = more.get(format, ([], {}))
    (tmp_path / "told").mkdir()
    (tmp_path / "made").mkdir()
    table = {"axis": "X", "start": "0 mm", "step": "50 mm", "unit": "um", "values": [0, 3, 5]}
    # A volumetric file is one of three slides.
    calibration = pathlib.Path(MILL) if format == "isg" else tmp_path / "stage.yaml"
    if not calibration.is_file():
        abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": [{"table": table}]}}).write(calibration)
    text = command("export", format, calibration, "--output", tmp_path / "told", *words)
    made = abbe.export(format, abbe.Calibration(calibration), tmp_path / "made", **named)
    assert str(made) == text.replace(str(tmp_path / "told"), str(tmp_path / "made"))
    assert made.files
    for name, content in made.files.items():
        assert content == (tmp_path / "told" / name).read_text() == (tmp_path / "made" / name).read_text()


def test_export_refuses_options_of_others() -> None:
    with pytest.raises(abbe.Error, match="tables has no effect on linuxcnc"):
        abbe.export("linuxcnc", abbe.Calibration(STAGE), tables=3)
    with pytest.raises(abbe.Error, match="formats are"):
        abbe.export("fanuc", abbe.Calibration(STAGE))


def test_calibrate(tmp_path: pathlib.Path) -> None:
    (tmp_path / "x.csv").write_text("target,deviation\n0,0\n100,2\n200,5\n")
    setup = tmp_path / "setup.yaml"
    one = {"motion": "EXX", "data": "x.csv", "targets": {"origin": "0 mm", "sign": 1, "unit": "mm"}, "deviations": {"sign": 1, "unit": "um"}}
    setup.write_text(json.dumps({"setup": 1, "machine": "FX", "measurements": [one]}))
    told = command("calibrate", setup, "--output", tmp_path / "told.yaml", "--format", "json")
    made = abbe.calibrate(setup, tmp_path / "made.yaml")
    assert made.json == told
    assert (tmp_path / "made.yaml").read_text() == (tmp_path / "told.yaml").read_text()
    assert np.array_equal(made.calibration.error([[200.0]])[0], [0.005, 0, 0])


def test_update(tmp_path: pathlib.Path) -> None:
    known = {"calibration": 1, "machine": "FX", "errors": {"EXX": [{"polynomial": {"axis": "X", "per": "mm", "unit": "um", "coefficients": [0, 0.01]}}]}}
    abbe.Calibration(known).write(tmp_path / "known.yaml")
    x = np.linspace(0, 200, 41)
    part = abbe.Recording({"time": np.arange(41.0), "command.x": x, "measured.x": x + 20e-6 * x}, machine="FX", units=UNITS)
    (tmp_path / "part.yaml").write_text(part.text)
    rows = zip(part["time"], part["command.x"], part["measured.x"])
    (tmp_path / "memory").write_text("time,command.x,measured.x\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows))
    told = command("update", "known.yaml", "part.yaml", "--output", "told.yaml", "--format", "json", cwd=tmp_path)
    made = abbe.update(abbe.Calibration(tmp_path / "known.yaml"), abbe.Recording(tmp_path / "part.yaml"), tmp_path / "made.yaml")
    without = lambda text: json.loads(text) | {"parts": None, "calibration": None}
    assert without(made.json) == without(told)
    assert abbe.Calibration(tmp_path / "told.yaml").error([[100.0]]).tolist() == made.calibration.error([[100.0]]).tolist()
    # The slope of the part is 20 um a metre: twice what was known.
    assert made.calibration.error([[200.0]])[0, 0] - made.calibration.error([[0.0]])[0, 0] == pytest.approx(0.004, rel=1e-9)


def test_explain() -> None:
    assert abbe.explain("E0407") == command("explain", "E0407")
    assert abbe.explain() == command("explain")
    with pytest.raises(abbe.Error, match="did you mean backlash"):
        abbe.explain("baklash")
