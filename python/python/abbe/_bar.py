"""A bar that tells how far work is: in a notebook, or on a terminal; nothing where nobody watches."""

from __future__ import annotations

import html
import sys
from types import TracebackType
from typing import Any

_WIDTH = 30


class Bar:
    """Shown from the first report on, gone when the work is done."""

    def __init__(self, wanted: bool) -> None:
        self._handle: Any = None
        self._drawn = False
        self._notebook = wanted and _in_notebook()
        self._terminal = wanted and not self._notebook and sys.stderr is not None and sys.stderr.isatty()

    @property
    def watched(self) -> bool:
        """Whether anybody watches."""
        return self._notebook or self._terminal

    def show(self, step: str, done: float) -> None:
        """Show what is being done, and the share that is done, 0 to 1."""
        done = min(max(done, 0.0), 1.0)
        self._drawn = True
        if self._terminal:
            bar = ("#" * round(done * _WIDTH)).ljust(_WIDTH)
            sys.stderr.write(f"\r[{bar}] {done:4.0%}  {step}\x1b[K")
            sys.stderr.flush()
        elif self._notebook:
            self._display(f'<progress value="{done:.3f}" max="1"></progress> {done:.0%} {html.escape(step)}')

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._drawn and self._terminal:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
        elif self._drawn and self._notebook:
            self._display("")

    def _display(self, markup: str) -> None:
        from IPython import display

        shown: Any = display
        if self._handle is None:
            self._handle = shown.display(shown.HTML(markup), display_id=True)
        else:
            self._handle.update(shown.HTML(markup))


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"
