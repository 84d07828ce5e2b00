"""Errors and compensated positions are those of the command line, to the last bit that it prints."""

from __future__ import annotations

import csv
import io
import os
import pathlib
import threading
import time

import numpy as np
import pytest
from conftest import MILL, command

import abbe

TRUNNION = {
    "calibration": 1,
    "machine": "trunnion-5axis",
    "constants": {"Ya": "1 mm", "Za": "2 mm", "Xc": "3 mm", "Yc": "4 mm", "Zc": "50 mm", "Xt": "0 mm", "Yt": "0 mm", "Zt": "120 mm"},
    "errors": {
        "EXX": [{"backlash": {"lost_motion": "10 um", "wind_up": "0.5 mm"}}],
        "EZZ": [{"growth": {"sensor": "spindle", "coefficient": "2 um/K", "reference": "20 degC", "time_constant": "600 s"}}],
        "EBX": [{"polynomial": {"axis": "X", "per": "mm", "unit": "arcsec", "coefficients": [0, 0.1, 1e-3]}}],
    },
}


def printed(number: float) -> str:
    """A number as the command line prints it: nine places, a zero without a sign."""
    text = f"{number:.9f}"
    return "0.000000000" if text == "-0.000000000" else text


def told(calibration: pathlib.Path | str, table: dict[str, np.ndarray]) -> dict[str, list[str]]:
    """The columns that the command line gives for columns of numbers."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(table)
    writer.writerows([[repr(float(cell)) if not name.startswith("dir_") else f"{int(cell):d}" for name, cell in zip(table, row)] for row in zip(*table.values())])
    rows = list(csv.DictReader(io.StringIO(command("compensate", calibration, stdin=text.getvalue()))))
    return {name: [row[name] for row in rows] for name in rows[0]}


def wander(rows: int, axes: int, low: float, high: float) -> np.ndarray:
    """Positions that go to and fro, now and then by less than the hysteresis."""
    random = np.random.default_rng(7)
    steps = np.cumsum(random.normal(0, 1, (rows, axes)), axis=0)
    steps[::11] += 0.0004
    steps -= steps.min(axis=0)
    return low + steps / steps.max(axis=0) * (high - low)


def test_mill(root: pathlib.Path) -> None:
    mill = abbe.Calibration(MILL)
    # More than one piece of the table, so that what is remembered goes from piece to piece.
    positions = wander(9000, 3, -20, 500)
    expected = told(MILL, {axis.lower(): positions[:, number] for number, axis in enumerate(mill.axes)})
    errors, commands = mill.error(positions), mill.compensate(positions)
    assert errors.shape == (9000, 3)
    for number, name in enumerate(mill.columns):
        assert [printed(one) for one in errors[:, number]] == expected[name]
    for number, axis in enumerate(mill.axes):
        assert [printed(one) for one in commands[:, number]] == expected[f"{axis.lower()}_comp"]


def test_memory_time_temperatures_and_rotary_axes(tmp_path: pathlib.Path) -> None:
    trunnion = abbe.Calibration(TRUNNION)
    trunnion.write(tmp_path / "trunnion.yaml")
    rows = 9000
    positions = wander(rows, 5, -30, 60)
    time = np.cumsum(np.random.default_rng(3).uniform(0.01, 0.2, rows))
    warm = 20 + 5 * np.sin(time / 100)
    table = {axis.lower(): positions[:, number] for number, axis in enumerate(trunnion.axes)}
    expected = told(tmp_path / "trunnion.yaml", table | {"t": time, "T_spindle": warm})
    errors = trunnion.error(positions, time=time, temperatures={"spindle": warm})
    commands = trunnion.compensate(positions, time=time, temperatures={"spindle": warm})
    assert trunnion.columns[-1] in expected
    for number, name in enumerate(trunnion.columns):
        assert [printed(one) for one in errors[:, number]] == expected[name]
    for number, axis in enumerate(trunnion.axes):
        assert [printed(one) for one in commands[:, number]] == expected[f"{axis.lower()}_comp"]


def test_directions_are_those_that_are_given(root: pathlib.Path) -> None:
    mill = abbe.Calibration(MILL)
    positions = wander(50, 3, 0, 400)
    direction = np.where(np.random.default_rng(5).random((50, 3)) < 0.5, -1.0, 1.0)
    table = {axis.lower(): positions[:, number] for number, axis in enumerate(mill.axes)}
    table |= {f"dir_{axis.lower()}": direction[:, number] for number, axis in enumerate(mill.axes)}
    expected = told(MILL, table)
    errors = mill.error(positions, direction=direction)
    for number, name in enumerate(mill.columns):
        assert [printed(one) for one in errors[:, number]] == expected[name]
    assert not np.array_equal(errors, mill.error(positions, direction=-direction))


def test_shapes_and_layouts(root: pathlib.Path) -> None:
    mill = abbe.Calibration(MILL)
    positions = wander(40, 3, 0, 400)
    errors = mill.error(positions)
    assert np.array_equal(mill.error(np.asfortranarray(positions)), errors)
    assert np.array_equal(mill.error(positions.tolist()), errors)
    assert np.array_equal(mill.error(positions[::-1])[0], mill.error(positions[-1]))
    assert mill.error(positions[0]).shape == (3,)
    assert mill.error(np.empty((0, 3))).shape == (0, 3)
    for shape in [(3, 4), (2,), (1, 1, 3)]:
        with pytest.raises(abbe.Error, match="shape"):
            mill.error(np.zeros(shape))


def test_a_map_is_the_errors_at_its_places(root: pathlib.Path) -> None:
    mill = abbe.Calibration(MILL)
    drawn = mill.map("XZ", points=(4, 3), at={"Y": 100})
    assert drawn["error"].shape == (3, 4, 3)
    for row, z in enumerate(drawn["Z"]):
        for column, x in enumerate(drawn["X"]):
            at = dict(zip("XYZ", (x, 100.0, z)))
            position = [at[axis] for axis in mill.axes]
            assert np.array_equal(drawn["error"][row, column], mill.error(position, direction=[1, 1, 1]))


def processor_times() -> dict[str, int]:
    """How long each thread of this program has worked, in ticks of the system."""
    tasks = pathlib.Path("/proc/self/task").iterdir()
    return {task.name: int((task / "stat").read_text().rsplit(")", 1)[1].split()[11]) for task in tasks}


@pytest.mark.parametrize("name", ["error", "compensate"])
def test_all_processors_work_and_other_threads_go_on(name: str, root: pathlib.Path) -> None:
    answer = getattr(abbe.Calibration(MILL), name)
    positions = np.random.default_rng(1).uniform(0, 400, (400_000, 3))
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.wait(0.001):
            ticks.append(time.perf_counter())

    other = threading.Thread(target=tick)
    other.start()
    before = processor_times() if os.path.exists("/proc/self/task") else None
    begun = time.perf_counter()
    answer(positions)
    ended = time.perf_counter()
    after = processor_times() if before is not None else {}
    done.set()
    other.join()
    within = [begun, *(moment for moment in ticks if begun < moment < ended), ended]
    longest = max(later - earlier for earlier, later in zip(within, within[1:]))
    assert longest < 0.5 * (ended - begun), f"another thread waited {longest:.2f} s of {ended - begun:.2f} s"
    if before is not None and len(os.sched_getaffinity(0)) > 1:
        busy = [task for task, worked in after.items() if worked - before.get(task, 0) >= 2]
        assert len(busy) > 1, "one thread alone has worked"


def test_what_is_wrong_is_an_error(root: pathlib.Path) -> None:
    mill = abbe.Calibration(MILL)
    with pytest.raises(abbe.Error, match="row 1, counted from 0"):
        mill.error([[0, 0, 0], [0, np.nan, 0]])
    with pytest.raises(abbe.Error, match="not a direction"):
        mill.error([[0, 0, 0]], direction=[1, 0, 1])
    with pytest.raises(abbe.Error, match="no plane"):
        mill.map("XX")
    trunnion = abbe.Calibration(TRUNNION)
    with pytest.raises(abbe.Error, match="no temperature of sensor spindle"):
        trunnion.error(np.zeros((1, 5)), time=[0])
    with pytest.raises(abbe.Error, match="no `time`"):
        trunnion.error(np.zeros((1, 5)), temperatures={"spindle": 20})
    drifting = abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": [{"drift": {"amplitude": "5 um", "time_constant": "60 s"}}]}})
    with pytest.raises(abbe.Error, match="drift") as caught:
        drifting.error([[0.0]])
    assert caught.value.code is not None
    with pytest.warns(abbe.AbbeWarning, match="left out"):
        assert not drifting.error([[0.0]], leave_out_uncompensable=True).any()
