"""What is seen of a call while the library computes, and how Ctrl-C ends it.

The library calls back now and then, in the thread of the call. That is where Python gets to handle
signals, where a user's function is asked, and where a line at a terminal or in a notebook moves.
"""

from __future__ import annotations

import itertools
import signal
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, Optional, Union

from ._library import CProgress, text_of

SHOWN_AFTER_S = 0.5  # what is over sooner needs no line
SHOWN_EVERY_S = 0.1

# called with what is being done and its share, 0 to 1; what it raises ends the call
ProgressFunction = Callable[[str, float], Any]
# True and False: a line or none; None: a line where somebody watches
Progress = Union[ProgressFunction, bool, None]


class _Terminal:
    """A line on stderr, taken away at the end."""

    def __init__(self) -> None:
        self.width = 0

    def show(self, doing: str, share: float) -> None:
        line = f"{doing} {share:4.0%}"
        sys.stderr.write("\r" + line.ljust(self.width))
        sys.stderr.flush()
        self.width = len(line)

    def end(self) -> None:
        sys.stderr.write("\r" + " " * self.width + "\r")
        sys.stderr.flush()


class _Notebook:
    """A bar below the cell, taken away at the end."""

    def __init__(self) -> None:
        self.handle: Any = None

    def _html(self, html: str) -> None:
        from IPython.display import HTML, display  # type: ignore[import]

        if self.handle is None:
            self.handle = display(HTML(html), display_id=True)
        else:
            self.handle.update(HTML(html))

    def show(self, doing: str, share: float) -> None:
        from html import escape

        self._html(f'<progress value="{share:.3f}"></progress> {escape(doing)} {share:.0%}')

    def end(self) -> None:
        self._html("")


def is_in_notebook() -> bool:
    """Whether what is shown goes to a notebook: where there is IPython with a kernel."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")


class _Line:
    """Shows what takes its time, as seldom as eyes ask for."""

    def __init__(self, place: Union[_Terminal, _Notebook]) -> None:
        self.place: Optional[Union[_Terminal, _Notebook]] = place
        self.next_s = time.monotonic() + SHOWN_AFTER_S
        self.is_shown = False

    def __call__(self, doing: str, share: float) -> None:
        if self.place is not None and time.monotonic() >= self.next_s:
            self.is_shown = True
            self._try(lambda place: place.show(doing, share))
            self.next_s = time.monotonic() + SHOWN_EVERY_S

    def end(self) -> None:
        if self.is_shown:
            self._try(lambda place: place.end())

    def _try(self, what: Callable[[Any], object]) -> None:
        # a terminal that has gone is no reason to lose the run
        try:
            if self.place is not None:
                what(self.place)
        except (OSError, ValueError):
            self.place = None


def _line_for(progress: Union[bool, None]) -> Optional[_Line]:
    if progress is False:
        return None
    if is_in_notebook():
        return _Line(_Notebook())
    is_terminal = sys.stderr is not None and not sys.stderr.closed and sys.stderr.isatty()
    return _Line(_Terminal()) if progress or is_terminal else None


class Watch:
    """A call under way: ``with Watch(progress) as watch`` around it, its number as the context."""

    _all: dict[int, Watch] = {}
    _numbers = itertools.count(1)

    def __init__(self, progress: Progress) -> None:
        if not (progress is None or isinstance(progress, bool) or callable(progress)):
            raise TypeError(
                "progress is a function of what is done and its share, True, False or None"
            )
        self.number = next(Watch._numbers)
        self.line = None if callable(progress) else _line_for(progress)
        self.function: Optional[ProgressFunction] = progress if callable(progress) else self.line
        self.raised: Optional[BaseException] = None
        self.interrupt: Optional[tuple[int, Optional[FrameType]]] = None
        self.handler: Any = None

    def called(self, doing: Optional[bytes], share: float) -> bool:
        """Whether the call is to end."""
        if self.interrupt is None and self.raised is None and self.function is not None:
            try:
                self.function(text_of(doing), share)
            except BaseException as error:  # it must not cross the library
                self.raised = error
        return self.interrupt is not None or self.raised is not None

    def _remember(self, number: int, frame: Optional[FrameType]) -> None:
        self.interrupt = (number, frame)

    def __enter__(self) -> Watch:
        Watch._all[self.number] = self
        # Python's own answer to Ctrl-C would be raised somewhere in the callback and be lost there
        if threading.current_thread() is threading.main_thread():
            handler = signal.getsignal(signal.SIGINT)
            if callable(handler):
                self.handler = handler
                signal.signal(signal.SIGINT, self._remember)
        return self

    def __exit__(
        self,
        kind: Optional[type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        Watch._all.pop(self.number, None)
        if self.handler is not None:
            signal.signal(signal.SIGINT, self.handler)
        if self.line is not None:
            self.line.end()
        if self.raised is not None:
            raise self.raised
        if self.interrupt is not None:
            self.handler(*self.interrupt)


def _called(doing: Optional[bytes], share: float, number: Optional[int]) -> int:
    watch = Watch._all.get(number or 0)
    return 0 if watch is None else int(watch.called(doing, share))


# one for all calls: to make one takes longer than many a call to it
callback = CProgress(_called)
