"""What callers write, for a type checker: it is not run."""

import pathlib

import numpy as np
from numpy.typing import NDArray

import abbe
import abbe.plot

machine = abbe.Machine("XYFZ")
levers: NDArray[np.float64] = machine.levers(x=[0, 100], z=50, constants={"Zt": 120})
mill = abbe.Calibration({"calibration": 1, "machine": "XYFZ", "errors": {}})
errors = mill.error(np.zeros((3, 3))) + mill.compensate([[0.0, 0.0, 0.0]], direction=[1, 1, 1])
errors += mill.error({"X": [1.0], "Y": [1.0], "Z": [1.0]}, temperatures={"spindle": 20.0})
shape: tuple[int, ...] = mill.map("XY", points=(3, 4), ranges={"X": (0, 1)})["error"].shape

recording = abbe.Recording({"time": np.zeros(3)}, machine=machine, units={"time": "s"}, calibration=mill)
found = abbe.diagnose([recording, pathlib.Path("a.yaml")], holdout="b.yaml", progress=lambda step, done: None)
verdict: str = found.verdict
terms: list[str] = found.findings["term"]
shares: NDArray[np.float64] = found.findings["share"]
held_out: NDArray[np.bool_] = found.states()["held_out"]
left: dict[str, float] = {when: found.residual(when)["measured.x"].std() for when in ["before", "after"]}
better: abbe.Calibration = found.calibration("x.yaml")

report: abbe.Report = abbe.evaluate("a.yaml")
updated: abbe.Calibration | None = abbe.update("mill.yaml", ["a.yaml", recording], method="ridge").calibration
files: dict[str, str] = abbe.export("pmac", mill, name={"X": 1}, counts={"X": 10000}).files
simulated: abbe.Recording = abbe.simulate("mill.yaml", {"path": 1}, seed=1)
abbe.plot.residuals(found, recording["command.x"])
abbe.plot.error_map(mill, "XY", points=3)
try:
    abbe.explain("x")
except abbe.Error as error:
    code: str | None = error.code
    line: int = error.spans[0]["line"]
