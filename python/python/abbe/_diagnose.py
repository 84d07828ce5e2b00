"""The call of a diagnosis, with a bar where a person watches."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from os import PathLike

from . import _abbe
from ._bar import Bar


def diagnose(
    recordings: _abbe.Recording | str | PathLike[str] | Iterable[_abbe.Recording | str | PathLike[str]],
    holdout: _abbe.Recording | str | PathLike[str] | None = None,
    *,
    progress: bool | Callable[[str, float], object] = True,
) -> _abbe.Diagnosis:
    """Find what the model of a machine leaves out, from recordings of the real one, which are fitted together.

    ``recordings`` is one recording or several of one machine, each a ``Recording`` or the path of a recording file; ``holdout`` is
    one more that is not fitted: the findings are tested on it. ``progress`` shows a bar in a notebook or a terminal; or it is called
    with what is being done and the share that is done, 0 to 1. The keys that interrupt end the wait.

    The diagnosis is that of ``abbe diagnose``, to the last bit.

    >>> import abbe, numpy as np
    >>> t = np.arange(4000) * 0.01
    >>> x = 50 - 50 * np.cos(np.pi * t / 4)
    >>> noise = np.random.default_rng(1).normal(0, 0.0003, len(t))
    >>> table = {"time": t, "command.x": x, "measured.x": x - 0.005 * np.sign(np.sin(np.pi * t / 4)) + noise}
    >>> stage = abbe.Recording(table, machine="FX", units={"time": "s", "command.x": "mm", "measured.x": "mm"})
    >>> found = abbe.diagnose(stage, progress=False)
    >>> found.verdict, found.findings["term"]
    ('left-out-physics', ['backlash'])
    """
    if callable(progress):
        return _abbe.diagnose(recordings, holdout, progress)
    with Bar(bool(progress)) as bar:
        return _abbe.diagnose(recordings, holdout, bar.show if bar.watched else None)
