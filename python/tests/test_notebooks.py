"""The notebooks of examples/notebooks run from the first cell to the last, and show what a reader expects."""

from __future__ import annotations

import pathlib

import pytest
from conftest import ABBE, ROOT

FOLDER = ROOT / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) == 3


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: the tables of a fleet cannot be read")
    book = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in book.cells), "a notebook is kept without what it shows"
    monkeypatch.setenv("ABBE", str(ABBE))
    # Drawings are shown in the notebook, and not drawn for nobody as in other tests.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    shown = [output for cell in book.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in shown), "no drawing is shown"
    told = [output.get("text") or output.get("data", {}).get("text/plain", "") for output in shown]
    assert not any("nan" in text.lower() for text in told), told
    assert not any("Warning" in text for text in told), told
