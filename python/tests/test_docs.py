"""Every public class, method and function has a docstring; its examples are what they say."""

from __future__ import annotations

import doctest
import inspect
import warnings

import numpy as np
import pytest
from conftest import UNITS

import abbe
import abbe.plot


def documented() -> dict[str, object]:
    things: dict[str, object] = {name: getattr(abbe, name) for name in abbe.__all__ if name != "__version__"}
    things |= {f"plot.{name}": getattr(abbe.plot, name) for name in abbe.plot.__all__}
    for name, thing in list(things.items()):
        if inspect.isclass(thing):
            members = {key: value for key, value in vars(thing).items() if not key.startswith("_")}
            things |= {f"{name}.{key}": value for key, value in members.items()}
    return things


@pytest.fixture(scope="module")
def found(stage_table: dict[str, np.ndarray]) -> abbe.Diagnosis:
    """What the example of `abbe.diagnose` finds: the examples of its methods go on from there."""
    return abbe.diagnose(abbe.Recording(stage_table, machine="FX", units=UNITS), progress=False)


@pytest.mark.parametrize("name", documented())
def test_docstring(name: str, found: abbe.Diagnosis) -> None:
    thing = documented()[name]
    text = thing.__doc__
    assert text, f"{name} has no docstring"
    examples = doctest.DocTestParser().get_doctest(text, {"found": found}, name, None, 0)
    # Properties and what is given to the caller are shown by the examples of what gives them.
    if callable(thing) and not inspect.isclass(thing):
        assert examples.examples, f"{name} has no example"
    told: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", abbe.AbbeWarning)
        result = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(examples, out=told.append)
    assert result.failed == 0, "".join(told)
