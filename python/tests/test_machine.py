"""Machines: the notations of the command line, and lever arms worked by hand."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import command

import abbe


@pytest.mark.parametrize("machine", ["XYFZ", "excello-921", "trunnion-5axis"])
@pytest.mark.parametrize("format", ["text", "latex", "html", "json", "maxima", "python", "svg"])
def test_notations(machine: str, format: str, root: object) -> None:
    assert abbe.Machine(machine).derive(format) == command("derive", machine, "--format", format)


def test_levers_by_hand() -> None:
    machine = abbe.Machine("XYFZ")
    levers = machine.levers(x=np.array([0.0, 10.0]), y=3, z=5, constants={"Xt": 1, "Yt": 2, "Zt": 120})
    assert levers.shape == (2, 3, len(machine.motions))
    of = {name: levers[:, :, number] for number, name in enumerate(machine.motions)}
    # The part moves by EAX about X: what is at (y + Yt, z + Zt) goes by -angle there, seen from the part.
    assert np.array_equal(of["EXX"], [[1, 0, 0]] * 2)
    assert np.array_equal(of["EAX"], [[0, 125, -5]] * 2)
    assert np.array_equal(of["ECX"], [[5, -1, 0], [5, -11, 0]])
    assert machine.levers().shape == (3, 21)


def test_pages_for_notebooks() -> None:
    machine = abbe.Machine("FX")
    page = machine._repr_html_()
    assert page.startswith("<iframe srcdoc=") and "<html" not in page
    assert machine._repr_latex_().count(r"\begin{align*}") == 3
    assert machine.latex.startswith(r"\documentclass")


def test_unknown_names() -> None:
    with pytest.raises(abbe.Error, match="did you mean `excello-921`"):
        abbe.Machine("excelo-921")
    for call in [lambda m: m.levers(q=1), lambda m: m.levers(constants={"Q": 1}), lambda m: m.derive("pdf")]:
        with pytest.raises(abbe.Error, match="help:"):
            call(abbe.Machine("FX"))


def test_errors_point_at_places(tmp_path: object) -> None:
    with pytest.raises(abbe.Error) as caught:
        abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": "3 um", "EQQ": "1 um"}})
    error = caught.value
    assert (error.code, error.status) == ("E0407", 2)
    (span,) = error.spans
    assert (span["file"], span["line"], span["column"]) == ("<calibration>", 5, 3)
    assert str(error) == error.text and "its error motions are" in error.text
    # A pattern of warnings is one of errors too.
    with pytest.raises(abbe.Error) as caught:
        abbe.Machine("XYQ")
    assert [span["code"] for span in caught.value.spans] == ["E0110", "E0112"]
