"""Two drawings with matplotlib (``pip install "./python[plot]"``): residuals by a state, and the error over a plane.

Both draw into axes of matplotlib that the caller may give, and return them; nothing is shown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from . import Calibration, Diagnosis

__all__ = ["error_map", "residuals"]


def residuals(
    diagnosis: Diagnosis,
    state: ArrayLike,
    *,
    channel: str | None = None,
    recording: int = 0,
    label: str = "",
    ax: Axes | None = None,
) -> Axes:
    """Draw the residuals of a channel, before and after the findings, over a state: an array with a number for each row.

    ``channel`` is the first of the recording by default; ``label`` stands below the axis. Residuals are in um, those of angles in urad.

    >>> import abbe, abbe.plot, numpy as np
    >>> t = np.arange(4000) * 0.01
    >>> x = 50 - 50 * np.cos(np.pi * t / 4)
    >>> noise = np.random.default_rng(1).normal(0, 0.0003, len(t))
    >>> table = {"time": t, "command.x": x, "measured.x": x - 0.005 * np.sign(np.sin(np.pi * t / 4)) + noise}
    >>> stage = abbe.Recording(table, machine="FX", units={"time": "s", "command.x": "mm", "measured.x": "mm"})
    >>> found = abbe.diagnose(stage, progress=False)
    >>> drawn = abbe.plot.residuals(found, stage["command.x"], label="X (mm)")
    >>> drawn.get_ylabel()
    'measured.x minus model (um)'
    """
    axes = _axes(ax)
    name = channel if channel is not None else next(iter(diagnosis.residual("after", recording)))
    unit = {"mm": "um", "rad": "urad"}[diagnosis.units(recording)[name]]
    factor = 1e3 if unit == "um" else 1e6
    for when, marker in [("before", "."), ("after", "+")]:
        left = diagnosis.residual(when, recording)[name] * factor
        axes.plot(np.asarray(state), left, marker, markersize=3, linestyle="none", label=when)
    axes.set_xlabel(label)
    axes.set_ylabel(f"{name} minus model ({unit})")
    axes.legend()
    return axes


def error_map(
    calibration: Calibration, plane: str, *, column: str | None = None, ax: Axes | None = None, **arguments: Any
) -> Axes:
    """Draw the predicted error over a plane of two axes, as colours: the length of the error of the tool tip, or one of
    ``calibration.columns``. The other arguments are those of ``Calibration.map``. Errors are in um, those of directions in urad.

    >>> import abbe, abbe.plot
    >>> mill = abbe.Calibration({"calibration": 1, "machine": "XYFZ", "constants": {"Xt": "0 mm", "Yt": "0 mm", "Zt": "0 mm"},
    ...                          "errors": {"EC0Y": "100 urad"}})
    >>> ranges = {"X": (0, 100), "Y": (0, 200), "Z": (0, 50)}
    >>> abbe.plot.error_map(mill, "XY", column="error_x", ranges=ranges).get_xlabel()
    'X (mm)'
    """
    axes = _axes(ax)
    drawn = calibration.map(plane, **arguments)
    names = calibration.columns
    tip = [number for number, name in enumerate(names) if name in ("error_x", "error_y", "error_z")]
    if column is None:
        values, what = np.linalg.norm(drawn["error"][:, :, tip], axis=2) * 1e3, "length of the error (um)"
    else:
        number = names.index(column)
        factor, unit = (1e3, "um") if number in tip else (1e6, "urad")
        values, what = drawn["error"][:, :, number] * factor, f"{column} ({unit})"
    across, along = plane[0], plane[1]
    mesh = axes.pcolormesh(drawn[across], drawn[along], values, shading="nearest")
    axes.figure.colorbar(mesh, ax=axes, label=what)
    units = dict(zip(calibration.axes, calibration.machine.units))
    axes.set_xlabel(f"{across} ({units[across]})")
    axes.set_ylabel(f"{along} ({units[along]})")
    return axes


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.figure().add_subplot()
