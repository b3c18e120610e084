"""A case at many values of its keys, one after another or by several processes."""

from __future__ import annotations

import collections
import concurrent.futures
import itertools
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Union

from . import _library as c
from ._answer import Run
from ._case import Case, Value


class Point:
    """One setting of a sweep: ``point["drive.speed"]`` is the value that was set, ``run`` the run."""

    def __init__(
        self, settings: Mapping[str, Value], run: Union[Run, None], error: Union[Exception, None]
    ) -> None:
        self.settings = dict(settings)
        self.error = error  #: why there is no run, or None
        self._run = run

    @property
    def run(self) -> Run:
        """What came of it; raises what it failed for."""
        if self._run is None:
            assert self.error is not None
            raise self.error
        return self._run

    def __getitem__(self, key: str) -> Value:
        return self.settings[key]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.settings)

    def __repr__(self) -> str:
        values = ", ".join(f"{key} = {value}" for key, value in self.settings.items())
        return f"<{values}{': ' + str(self.error) if self.error else ''}>"


Settings = Union[Mapping[str, Iterable[Value]], Iterable[Mapping[str, Value]]]


def sweep(
    case: Case, settings: Settings, backend: Any = None, *, processes: int = 1, **options: Any
) -> Iterator[Point]:
    """Runs a case at every combination of values, and yields a Point for each, in their order.

    ``settings`` has the values of each key, as in ``{"drive.speed": ["500 rpm", "1000 rpm"]}``, the
    last key changing fastest; or it is a list of what to set together. ``backend`` and the options
    are those of ``Case.run``. With more than one process each run is in a process of its own kind,
    which cannot hurt this one; so many are ahead of what has been read. A run that fails is a point
    with its ``error``, and the sweep goes on. The case itself stays as it is.
    """
    if isinstance(processes, bool) or not isinstance(processes, int) or processes < 1:
        raise c.CaseError("processes is a whole number from 1 on")
    chosen = list(_combinations(settings))
    if processes == 1:
        return _one_by_one(case.copy(), chosen, backend, options)
    return _by_processes(case.copy(), chosen, backend, options, processes)


def _combinations(settings: Settings) -> Iterator[Mapping[str, Value]]:
    if isinstance(settings, Mapping):
        for key, values in settings.items():
            if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
                raise c.CaseError(f"a sweep takes a list of values of {key}, such as [{values!r}]")
        for values in itertools.product(*settings.values()):
            yield dict(zip(settings, values))
    else:
        for together in settings:
            if not isinstance(together, Mapping):
                raise c.CaseError("a sweep takes values by their keys, or a list of such settings")
            yield dict(together)


def _point(
    case: Case, settings: Mapping[str, Value], backend: Any, options: Mapping[str, Any]
) -> Point:
    try:
        changed = case.copy()
        changed.set(settings)
        return Point(settings, changed.run(backend, **options), None)
    except c.Error as error:
        return Point(settings, None, error)


def _one_by_one(
    case: Case, chosen: list[Mapping[str, Value]], backend: Any, options: Any
) -> Iterator[Point]:
    for settings in chosen:
        yield _point(case, settings, backend, options)


# ---- processes ----------------------------------------------------------------------------------


class _Worker:
    """A process that runs what it is sent. It imports this module alone and no script of the user's,
    and Ctrl-C goes to this process, which ends it."""

    def __init__(self) -> None:
        code = "import sys; sys.path.insert(0, sys.argv[1]); from jointplay._sweep import serve; serve()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", code, str(Path(__file__).parent.parent)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "JOINTPLAY_LIBRARY": c.library._name},
            start_new_session=True,
        )

    def ask(self, case: Case, settings: Mapping[str, Value], backend: Any, options: Any) -> Point:
        assert self.process.stdin is not None and self.process.stdout is not None
        try:
            pickle.dump((case, settings, backend, options), self.process.stdin)
            self.process.stdin.flush()
            point: Point = pickle.load(self.process.stdout)
            return point
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            status = self.process.wait()
            raise c.SolverError(
                f"the process of the run ended with status {status}", c.SOLVER
            ) from None

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                pipe.close()


def serve() -> None:
    """What a worker does: answers what it is asked until nobody is there."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints does not get in between
    while True:
        try:
            case, settings, backend, options = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        pickle.dump(_point(case, settings, backend, options), answers)
        answers.flush()


def _by_processes(
    case: Case, chosen: list[Mapping[str, Value]], backend: Any, options: Any, processes: int
) -> Iterator[Point]:
    options = {"threads": 1, **options, "progress": False}
    workers: list[_Worker] = []
    mine = threading.local()

    def ask(settings: Mapping[str, Value]) -> Point:
        if not hasattr(mine, "worker"):
            mine.worker = _Worker()
            workers.append(mine.worker)
        worker: _Worker = mine.worker
        try:
            return worker.ask(case, settings, backend, options)
        except c.SolverError as error:
            del mine.worker  # the next point has another
            return Point(settings, None, error)

    threads = concurrent.futures.ThreadPoolExecutor(processes)
    waiting: collections.deque[concurrent.futures.Future[Point]] = collections.deque()
    try:
        for settings in chosen:
            waiting.append(threads.submit(ask, settings))
            if len(waiting) > 2 * processes:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        for future in waiting:
            future.cancel()
        for worker in workers:
            worker.end()
        threads.shutdown()
