"""What docs/python.md and docs/python-recipes.md show runs."""

from __future__ import annotations

import pathlib
import re
import warnings

import numpy as np
import pytest
from conftest import ROOT

import abbe

BLOCK = re.compile(r"^```python ?(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)

T = np.arange(300) * 0.01
COMMAND = 10 * np.sin(T)
MEASURED = COMMAND + 1e-3 * np.cos(T)


def blocks(page: str) -> list[tuple[str, str]]:
    return BLOCK.findall((ROOT / "docs" / page).read_text())


def test_the_page(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib").use("agg")
    monkeypatch.chdir(tmp_path)
    known: dict[str, object] = {}
    all_of_them = blocks("python.md")
    assert len(all_of_them) >= 6
    for _, code in all_of_them:
        exec(compile(code, "docs/python.md", "exec"), known)
    assert known["levers"].shape == (2, 3, 21)
    assert known["found"].verdict == "left-out-physics"


@pytest.mark.parametrize("library", ["", "scipy", "h5py", "nptdms", "asammdf", "polars"])
def test_recipes(library: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if library:
        pytest.importorskip(library, reason=f"{library} is not installed: its recipe is not tried")
        WRITE[library](tmp_path)
    monkeypatch.chdir(tmp_path)
    known: dict[str, object] = {}
    mine = [code for needed, code in blocks("python-recipes.md") if needed in ("", library)]
    shared = [code for code in mine if "def recorded" in code]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", abbe.AbbeWarning)
        for code in shared + [code for code in mine if code not in shared and (not library or "import" in code and "runs =" not in code)]:
            exec(compile(code, "docs/python-recipes.md", "exec"), known)
    recording = known["recording"]
    if library:
        assert np.allclose(recording["command.x"], COMMAND, rtol=0, atol=1e-12)
        assert np.allclose(recording["measured.x"], MEASURED, rtol=0, atol=1e-12)
        assert np.allclose(recording["time"], T, rtol=0, atol=1e-9)
    else:
        assert recording["run"].tolist() == [1, 1, 1, 2, 2, 2]


def mat(folder: pathlib.Path) -> None:
    from scipy.io import savemat

    savemat(folder / "axis.mat", {"t": T[:, None], "x_cmd": COMMAND[:, None], "x_meas": MEASURED[:, None]})


def hdf5(folder: pathlib.Path) -> None:
    import h5py

    with h5py.File(folder / "axis.h5", "w") as file:
        for name, values in [("t", T), ("x_cmd", COMMAND), ("x_meas", MEASURED)]:
            file.create_dataset(f"run1/{name}", data=values)


def tdms(folder: pathlib.Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(folder / "axis.tdms") as writer:
        channels = [ChannelObject("run1", name, values, {"wf_increment": 0.01}) for name, values in [("x_cmd", COMMAND), ("x_meas", MEASURED)]]
        writer.write_segment(channels)


def mdf(folder: pathlib.Path) -> None:
    from asammdf import MDF, Signal

    with MDF() as file:
        file.append([Signal(values, T, name=name, unit="mm") for name, values in [("x_cmd", COMMAND), ("x_meas", MEASURED)]])
        file.save(folder / "axis.mf4")


def parquet(folder: pathlib.Path) -> None:
    import polars

    polars.DataFrame({"t": T, "x_cmd": COMMAND, "x_meas": MEASURED}).write_parquet(folder / "axis.parquet")


WRITE = {"scipy": mat, "h5py": hdf5, "nptdms": tdms, "asammdf": mdf, "polars": parquet}
