"""The types of the compiled module. A test holds names and parameters against it. Units and shapes are told by `help()`.

What may be given is wider than what comes back: any array, number, mapping or path goes in; arrays of float64 come out.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, Protocol, TypeAlias, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

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

__version__: str

_Path: TypeAlias = str | PathLike[str]
_File: TypeAlias = _Path | Mapping[str, Any]
_Floats: TypeAlias = NDArray[np.float64]
_Flags: TypeAlias = NDArray[np.bool_]
_Recorded: TypeAlias = Recording | _Path
_Calibrated: TypeAlias = Calibration | _File
_Named: TypeAlias = Mapping[str, ArrayLike]
_Range: TypeAlias = Sequence[float] | NDArray[Any]

class _ArrowStream(Protocol):
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

class _Span(TypedDict):
    code: str
    message: str
    help: str | None
    file: str
    line: int
    column: int
    start: int
    end: int

class _Findings(TypedDict):
    motion: list[str]
    meaning: list[str]
    term: list[str]
    link: list[str]
    side: list[str]
    state: list[str]
    detail: list[str]
    share: _Floats
    rms_with: _Floats
    rms_without: _Floats
    unit: list[str]
    compensable: _Flags
    explanation: list[str]

class _Parameters(TypedDict):
    finding: list[int]
    motion: list[str]
    term: list[str]
    parameter: list[str]
    value: _Floats
    low: _Floats
    high: _Floats
    unit: list[str]

class _Returns(TypedDict):
    recording: list[int]
    channel: list[str]
    state: list[str]
    share: _Floats
    left: _Floats
    unit: list[str]

class _States(TypedDict):
    time: _Floats
    run: NDArray[np.int64]
    held_out: _Flags

class Error(Exception):
    code: str | None
    spans: list[_Span]
    text: str
    status: int

class AbbeWarning(UserWarning): ...

@final
class Machine:
    def __new__(cls, machine: _Path | Machine) -> Machine: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str | None: ...
    @property
    def axes(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def directions(self) -> list[str]: ...
    @property
    def constants(self) -> list[str]: ...
    @property
    def motions(self) -> list[str]: ...
    @property
    def meanings(self) -> dict[str, str]: ...
    @property
    def equations(self) -> str: ...
    @property
    def latex(self) -> str: ...
    @property
    def html(self) -> str: ...
    def derive(
        self,
        format: Literal["text", "latex", "html", "json", "maxima", "python", "svg"] = "text",
        names: Literal["iso", "symbols"] = "symbols",
    ) -> str: ...
    def levers(self, *, constants: Mapping[str, float] | None = None, **positions: ArrayLike) -> _Floats: ...
    def _repr_html_(self) -> str: ...
    def _repr_latex_(self) -> str: ...

@final
class Calibration:
    def __new__(cls, calibration: _File) -> Calibration: ...
    @property
    def machine(self) -> Machine: ...
    @property
    def axes(self) -> list[str]: ...
    @property
    def columns(self) -> list[str]: ...
    @property
    def constants(self) -> dict[str, float]: ...
    @property
    def sensors(self) -> list[str]: ...
    @property
    def tools(self) -> list[str]: ...
    @property
    def text(self) -> str: ...
    def error(
        self,
        positions: ArrayLike | _Named | _ArrowStream,
        *,
        direction: ArrayLike | _Named | _ArrowStream | None = None,
        temperatures: _Named | None = None,
        time: ArrayLike | None = None,
        tool: str | None = None,
        travels: _Named | None = None,
        hysteresis: float = 0.001,
        leave_out_uncompensable: bool = False,
    ) -> _Floats: ...
    def compensate(
        self,
        positions: ArrayLike | _Named | _ArrowStream,
        *,
        direction: ArrayLike | _Named | _ArrowStream | None = None,
        temperatures: _Named | None = None,
        time: ArrayLike | None = None,
        tool: str | None = None,
        travels: _Named | None = None,
        hysteresis: float = 0.001,
        leave_out_uncompensable: bool = False,
    ) -> _Floats: ...
    def map(
        self,
        plane: str,
        *,
        points: int | Sequence[int] | None = None,
        ranges: Mapping[str, _Range] | None = None,
        at: Mapping[str, float] | None = None,
        temperatures: Mapping[str, float] | None = None,
        tool: str | None = None,
        leave_out_uncompensable: bool = False,
    ) -> dict[str, _Floats]: ...
    def write(self, path: _Path, *, force: bool = False) -> None: ...

@final
class Recording:
    def __new__(
        cls,
        source: _Path | _Named | NDArray[np.void] | _ArrowStream,
        *,
        machine: _Path | Machine | None = None,
        units: Mapping[str, str | None] | None = None,
        channels: Mapping[str, str | Mapping[str, str]] | None = None,
        setup: Mapping[str, Any] | None = None,
        instrument: Literal["position", "ballbar", "linear", "straightness", "angular", "probe"] | None = None,
        calibration: _Path | Calibration | None = None,
        constants: Mapping[str, str] | None = None,
        holdout: Mapping[str, Any] | None = None,
        title: str | None = None,
    ) -> Recording: ...
    @property
    def file(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def title(self) -> str | None: ...
    @property
    def instrument(self) -> str: ...
    @property
    def machine(self) -> Machine: ...
    @property
    def rows(self) -> int: ...
    @property
    def channels(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    def columns(self) -> dict[str, NDArray[Any]]: ...
    def __getitem__(self, channel: str, /) -> NDArray[Any]: ...
    def __len__(self) -> int: ...

@final
class Diagnosis:
    @property
    def verdict(self) -> Literal["undecided", "adequate", "left-out-physics", "unexplained", "not-repeatable"]: ...
    @property
    def sentence(self) -> str: ...
    @property
    def findings(self) -> _Findings: ...
    @property
    def parameters(self) -> _Parameters: ...
    @property
    def returns(self) -> _Returns: ...
    @property
    def data(self) -> dict[str, Any]: ...
    @property
    def json(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def html(self) -> str: ...
    def units(self, recording: int = 0) -> dict[str, str]: ...
    def residual(self, when: str = "after", recording: int = 0) -> dict[str, _Floats]: ...
    def model(self, when: str = "after", recording: int = 0) -> dict[str, _Floats]: ...
    def measured(self, recording: int = 0) -> dict[str, _Floats]: ...
    def outliers(self, recording: int = 0) -> dict[str, _Flags]: ...
    def states(self, recording: int = 0) -> _States: ...
    def calibration(self, path: _Path | None = None) -> Calibration: ...
    def _repr_html_(self) -> str: ...

@final
class Report:
    @property
    def text(self) -> str: ...
    @property
    def json(self) -> str: ...
    @property
    def data(self) -> dict[str, Any]: ...
    @property
    def html(self) -> str | None: ...
    @property
    def calibration(self) -> Calibration | None: ...
    def _repr_html_(self) -> str | None: ...

@final
class Exported:
    @property
    def files(self) -> dict[str, str]: ...
    @property
    def text(self) -> str: ...

def diagnose(
    recordings: _Recorded | Iterable[_Recorded],
    holdout: _Recorded | None = None,
    watch: Callable[[str, float], object] | None = None,
) -> Diagnosis: ...
def evaluate(recording: _Recorded) -> Report: ...
def explain(name: str | None = None) -> str: ...
def simulate(
    calibration: _Calibrated,
    path: _File | Recording,
    *,
    seed: int | None = None,
    known: _Path | None = None,
    output: _Path | None = None,
    force: bool = False,
) -> Recording: ...
def calibrate(setup: _File, output: _Path | None = None, *, force: bool = False) -> Report: ...
def update(
    calibration: _Calibrated,
    recordings: _Recorded | Iterable[_Recorded],
    output: _Path | None = None,
    *,
    force: bool = False,
    method: Literal["svd", "ridge", "select"] = "svd",
    tolerance: float | None = None,
    datum: str = "free",
    compensated: bool = False,
) -> Report: ...
def export(
    format: str,
    calibration: _Calibrated,
    output: _Path | None = None,
    *,
    force: bool = False,
    ranges: Mapping[str, _Range] | None = None,
    at: Mapping[str, float] | None = None,
    points: int | None = None,
    value: Literal["error", "correction"] | None = None,
    type: Literal[0, 1] | None = None,
    unit: Literal["mm", "in"] | None = None,
    tables: int | None = None,
    name: Mapping[str, str | int] | None = None,
    counts: Mapping[str, float] | None = None,
    leave_out_uncompensable: bool = False,
) -> Exported: ...
