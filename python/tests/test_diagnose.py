"""Diagnoses are those of the command line, whatever the data come in; arrays of samples agree with the figures that are told."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from conftest import UNITS, command

import abbe

RECORDING = "recordings/postech-ballbar/recording.yaml"


@pytest.fixture(scope="module")
def ballbar() -> abbe.Diagnosis:
    import os

    from conftest import ROOT

    before = os.getcwd()
    os.chdir(ROOT)
    try:
        yield abbe.diagnose(RECORDING, progress=False)
    finally:
        os.chdir(before)


def test_the_same_bytes_as_the_command_line(ballbar: abbe.Diagnosis, root: pathlib.Path) -> None:
    assert ballbar.json == command("diagnose", RECORDING, "--format", "json")
    assert ballbar.html == command("diagnose", RECORDING, "--format", "html")
    assert str(ballbar) == command("diagnose", RECORDING)


def test_the_same_calibration(ballbar: abbe.Diagnosis, root: pathlib.Path, tmp_path: pathlib.Path) -> None:
    command("diagnose", RECORDING, "--write-calibration", tmp_path / "told.yaml")
    written = ballbar.calibration(tmp_path / "written.yaml")
    assert (tmp_path / "written.yaml").read_text() == (tmp_path / "told.yaml").read_text()
    at = np.zeros((1, len(written.axes)))
    assert np.array_equal(written.error(at), ballbar.calibration().error(at))


def test_arrays_are_what_the_figures_say(ballbar: abbe.Diagnosis) -> None:
    data = ballbar.data
    held_out = ballbar.states()["held_out"]
    (channel,) = ballbar.units()
    used = ~ballbar.outliers()[channel] & np.isfinite(ballbar.residual()[channel])

    def rms(rows: np.ndarray, when: str) -> float:
        return float(np.sqrt(np.mean(ballbar.residual(when)[channel][rows] ** 2)))

    assert rms(used, "after") == pytest.approx(data["after"]["rms"], rel=1e-12)
    assert rms(used & held_out, "after") == pytest.approx(data["after"]["holdout_rms"], rel=1e-12)
    # Outliers are judged anew with the findings: before them, others may have been left out.
    assert rms(used, "before") > 2 * rms(used, "after")
    for when in ["before", "after"]:
        again = ballbar.model(when)[channel] + ballbar.residual(when)[channel]
        assert np.allclose(again[used], ballbar.measured()[channel][used], rtol=0, atol=1e-15)
    assert len(held_out) == len(abbe.Recording(data["recordings"][0]["file"]))


def test_tables_are_those_of_the_object(ballbar: abbe.Diagnosis) -> None:
    data = ballbar.data
    assert ballbar.findings["motion"] == [one["motion"] for one in data["findings"]]
    assert list(ballbar.findings["share"]) == [one["share"] for one in data["findings"]]
    assert list(ballbar.returns["share"]) == [one["share"] for one in data["returns"]]
    table = ballbar.parameters
    for number, finding in enumerate(data["findings"]):
        for name, value in finding["parameters"].items():
            if isinstance(value, dict) and "ci95" in value:
                rows = [row for row in range(len(table["finding"])) if (table["finding"][row], table["parameter"][row]) == (number, name)]
                assert [table["value"][row] for row in rows] == [value["value"]]
                assert [[table["low"][row], table["high"][row]] for row in rows] == [value["ci95"]]


@pytest.mark.parametrize("kind", ["dict", "pandas", "polars", "pyarrow"])
def test_any_table_gives_the_same(kind: str, stage_table: dict[str, np.ndarray], tmp_path: pathlib.Path) -> None:
    table: object = stage_table
    if kind != "dict":
        module = pytest.importorskip(kind)
        table = module.table(stage_table) if kind == "pyarrow" else module.DataFrame(stage_table)
    recording = abbe.Recording(table, machine="FX", units=UNITS)
    for name, values in stage_table.items():
        assert np.array_equal(recording[name], values)
    # The same by way of files: numbers that are written so that they are read as they were.
    rows = zip(*stage_table.values())
    lines = [",".join(stage_table), *(",".join(repr(float(cell)) for cell in row) for row in rows)]
    (tmp_path / "memory").write_text("\n".join(lines) + "\n")
    (tmp_path / "stage.yaml").write_text(recording.text)
    told = json.loads(command("diagnose", tmp_path / "stage.yaml", "--format", "json"))
    data = abbe.diagnose(recording, progress=False).data
    assert data.pop("recordings")[0]["file"] == "<recording>"
    told.pop("recordings")
    for one in told["returns"] + data["returns"]:
        one["recording"] = None
    assert data == told
    assert [one["term"] for one in data["findings"]] == ["backlash"]


def test_missing_values_and_times(stage_table: dict[str, np.ndarray]) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(stage_table)
    frame.loc[5, "measured.x"] = None
    frame["time"] = pandas.Timestamp("2026-03-01") + pandas.to_timedelta(frame["time"], unit="s")
    for table in [frame, {name: frame[name] for name in frame}]:
        recording = abbe.Recording(table, machine="FX", units=UNITS)
        assert np.isnan(recording["measured.x"][5]) and np.isfinite(recording["measured.x"]).sum() == len(frame) - 1
        assert np.allclose(recording["time"], stage_table["time"], rtol=0, atol=2e-9)


def test_what_is_wrong_with_a_table(stage_table: dict[str, np.ndarray]) -> None:
    with pytest.raises(abbe.Error, match="what machine it is of"):
        abbe.Recording(stage_table, units=UNITS)
    with pytest.raises(abbe.Error, match="no column `m` "):
        abbe.Recording(stage_table, machine="FX", units=UNITS, channels={"measured.x": "m"})
    with pytest.raises(abbe.Error) as caught:
        abbe.Recording(stage_table, machine="FX", units=UNITS | {"measured.x": "deg"})
    assert caught.value.code == "E0609" and caught.value.spans[0]["file"] == "<recording>"
    with pytest.raises(abbe.Error, match="holds"):
        abbe.Recording(stage_table | {"measured.x": np.array(["a"] * 4000)}, machine="FX", units=UNITS)
    with pytest.raises(abbe.Error, match="rows"):
        abbe.Recording(stage_table | {"measured.x": np.zeros(3)}, machine="FX", units=UNITS)
    with pytest.raises(abbe.Error, match="file alone"):
        abbe.Recording(RECORDING, machine="FX")


def test_progress_is_told_and_an_exception_ends_the_wait(stage_table: dict[str, np.ndarray]) -> None:
    recording = abbe.Recording(stage_table, machine="FX", units=UNITS)
    told: list[tuple[str, float]] = []
    abbe.diagnose(recording, progress=lambda step, done: told.append((step, done)))
    assert told and all(0 <= done <= 1 for _, done in told)

    def refuse(step: str, done: float) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        abbe.diagnose(recording, progress=refuse)


def test_keys_that_interrupt_end_the_wait() -> None:
    """A diagnosis of 300 s of a mill at 200 Hz takes seconds; it is interrupted in the midst, and another one is made afterwards."""
    program = textwrap.dedent("""
        import os, signal, threading, time
        import numpy as np
        import abbe

        def recorded(rows):
            t = np.arange(rows) * 0.005
            table, units = {"time": t}, {"time": "s"}
            for axis, period in [("x", 4.0), ("y", 5.3), ("z", 7.1)]:
                at = 100 - 100 * np.cos(2 * np.pi * t / period)
                noise = np.random.default_rng(1).normal(0, 0.0003, rows)
                table |= {f"command.{axis}": at, f"measured.{axis}": at - 0.005 * np.sign(np.sin(2 * np.pi * t / period)) + noise}
                units |= {f"command.{axis}": "mm", f"measured.{axis}": "mm"}
            return abbe.Recording(table, machine="XYFZ", units=units, constants={"Xt": "0 mm", "Yt": "0 mm", "Zt": "120 mm"})

        long, short = recorded(60_000), recorded(4_000)
        begun, told = [], []

        def interrupt(step, done):
            # Once it works, not before: the key comes in the midst of the work.
            if not begun:
                begun.append(True)
                threading.Timer(0.5, lambda: (told.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT))).start()

        try:
            abbe.diagnose(long, progress=interrupt)
            print("not interrupted")
        except KeyboardInterrupt:
            print("interrupted", time.monotonic() - told[0] < 1)
        terms = abbe.diagnose(short, progress=False).findings["term"]
        print(sorted(terms))
    """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.splitlines() == ["interrupted True", "['backlash', 'backlash', 'backlash']"], done.stdout + done.stderr
