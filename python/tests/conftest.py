"""What the tests share: the repository, the command line that every number is held against, and a recording in memory."""

from __future__ import annotations

import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
ABBE = pathlib.Path(os.environ.get("ABBE", ROOT / "target" / "debug" / "abbe"))


def command(*arguments: object, stdin: str = "", cwd: pathlib.Path = ROOT) -> str:
    """What the command line prints."""
    words = [str(ABBE), *map(str, arguments)]
    done = subprocess.run(words, input=stdin, capture_output=True, text=True, cwd=cwd, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def root(monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """The repository, as the current folder: names of files in messages are then those of the command line."""
    monkeypatch.chdir(ROOT)
    return ROOT


@pytest.fixture(scope="session")
def stage_table() -> dict[str, np.ndarray]:
    """A stage that goes to and fro, with a play of 10 um and white noise."""
    t = np.arange(4000) * 0.01
    x = 50 - 50 * np.cos(np.pi * t / 4)
    noise = np.random.default_rng(1).normal(0, 0.0003, len(t))
    return {"time": t, "command.x": x, "measured.x": x - 0.005 * np.sign(np.sin(np.pi * t / 4)) + noise}


MILL = str(ROOT / "calibrations" / "postech-mill.yaml")

UNITS = {"time": "s", "command.x": "mm", "measured.x": "mm"}
