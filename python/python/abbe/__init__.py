"""Abbe: error equations, compensation and diagnosis of machine tools.

Positions are in mm and deg, errors and samples in mm and rad, times in s, temperatures in degC. Every number is that of the
command line ``abbe``: both call the same code.
"""

from __future__ import annotations

from ._abbe import (
    AbbeWarning,
    Calibration,
    Diagnosis,
    Error,
    Exported,
    Machine,
    Recording,
    Report,
    __version__,
    calibrate,
    evaluate,
    explain,
    export,
    simulate,
    update,
)
from ._diagnose import diagnose

__all__ = [
    "AbbeWarning",
    "Calibration",
    "Diagnosis",
    "Error",
    "Exported",
    "Machine",
    "Recording",
    "Report",
    "__version__",
    "calibrate",
    "diagnose",
    "evaluate",
    "explain",
    "export",
    "simulate",
    "update",
]
