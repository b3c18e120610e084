"""A case: what its file says and what was set since; run, settled and mapped."""

from __future__ import annotations

import ctypes
import functools
import itertools
import math
import os
import threading
from collections.abc import Iterable, Iterator, Mapping, MutableMapping, Sequence
from contextlib import contextmanager
from ctypes import byref
from typing import Any, NamedTuple, Union

from . import _library as c
from ._answer import Live, Mapped, Run, Settled
from ._progress import Progress, Watch, callback
from ._values import Number

# a text as a case file has it, a number in SI, several of either, or None to take a setting back
Value = Union[str, float, int, bool, Sequence[Union[str, float]], None]


# one name or several, also separated by commas; None: as the case or the command has it
Backends = Union[str, Iterable[str], None]


class Setting(NamedTuple):
    """A key as a case has it, resolved: what is not given has its default."""

    key: str
    text: str  #: the value as a case file may have it; 0 of a key left out that has no default
    unit: str  #: SI, of the numbers; "" where they have none
    numbers: tuple[
        float, ...
    ]  #: SI; of a length with a tolerance nominal, lower and upper deviation
    is_used: bool  #: whether the case as it is makes use of it
    doc: str  #: what the key means


class Key(NamedTuple):
    """A key of case files."""

    path: str  #: with a star for a name: "joints.*.hole"
    unit: str  #: SI, of its number; "" where it has none
    doc: str  #: what it means
    low: float  #: SI: the least number that is allowed; NaN of words
    high: float  #: the largest
    words: tuple[str, ...]  #: that it allows


@functools.lru_cache(maxsize=None)
def keys() -> tuple[Key, ...]:
    """All keys of case files, in the order of docs/case-format.md."""
    found = c.CKey()
    made = []
    for index in range(c.library.jp_key_count()):
        c.library.jp_key_at(index, byref(found))
        path, unit, doc = map(c.text_of, (found.path, found.unit, found.doc))
        words = itertools.takewhile(lambda word: word is not None, found.words or ())
        made.append(Key(path, unit, doc, found.low, found.high, tuple(map(c.text_of, words))))
    return tuple(made)


def _setting(found: c.CSetting) -> Setting:
    return Setting(
        c.text_of(found.key),
        c.text_of(found.text),
        c.text_of(found.unit),
        tuple(found.numbers[: found.count]),
        bool(found.is_used),
        c.text_of(found.doc),
    )


_mine = threading.local()  # held: cases that this thread has a call with


def _held_here() -> int:
    return getattr(_mine, "held", 0)


class Case(MutableMapping[str, Any]):
    """A mechanism, its drive and how it is run.

    ``Case("impact-k66")`` is a case that came with the library, ``Case("mine.yaml")`` a file, and
    a text of more than one line the case itself. Its keys are those of ``jointplay help case``:

    >>> case["drive.speed"] = "1200 rpm"
    >>> case["drive.speed"]
    125.66370614359172 rad/s

    A number without a unit is SI. Every change is checked at once, and one that is wrong raises
    CaseError and changes nothing. A case is run by one thread at a time, others wait for it; give
    each a ``copy()``.
    """

    def __init__(self, source: Union[str, os.PathLike[str]]) -> None:
        if isinstance(source, str) and "\n" in source:
            self._open(("text", source, ""))
        elif isinstance(source, (str, os.PathLike)):
            self._open(("path", os.fspath(source), ""))
        else:
            raise TypeError(f"a case is a name, a path or a text, not {type(source).__name__}")

    @classmethod
    def from_text(cls, text: str, name: str = "") -> Case:
        """A case from the text of a file; the name stands for its path in messages."""
        case = cls.__new__(cls)
        case._open(("text", text, name))
        return case

    # ---- the C library ------------------------------------------------------------------------

    def _open(self, source: tuple[str, str, str]) -> None:
        kind, content, name = source
        error = c.CError()
        if kind == "text":
            data = c.c_text(content, "a case")
            called = c.c_text(name, "the name of a case") if name else None
            address = c.library.jp_case_parse(data, len(data), called, byref(error))
        else:
            address = c.library.jp_case_open(c.c_text(content, "a path"), byref(error))
        if not address:
            c.raise_error(error)
        self._take(source, c.Handle(address, "jp_case_free"))

    def _take(self, source: tuple[str, str, str], handle: c.Handle) -> None:
        self._source = source
        self._handle: c.Handle | None = handle
        # a handler of signals may ask between any two lines
        self._lock = threading.RLock()
        self._holder = 0  # the thread that has the lock
        self._changed: set[str] = set()  # keys that were set

    @contextmanager
    def _held(self) -> Iterator[int]:
        """The case for a call of this thread: its address."""
        this = threading.get_ident()
        if self._holder == this:
            raise c.CaseError(
                "the case is being run; a callback may use a copy that was made before"
            )
        self._wait()
        try:
            self._holder = this
            _mine.held = _held_here() + 1
            if self._handle is None:
                raise c.CaseError("the case is closed")
            handle = self._handle  # for as long as the call takes
            yield handle.address
        finally:
            self._holder = 0
            _mine.held -= 1
            self._lock.release()

    def _wait(self) -> None:
        """Waits for other threads. A callback does not: they may wait for what it belongs to."""
        if not self._lock.acquire(blocking=_held_here() == 0):
            raise c.CaseError("the case is in use by another thread; a callback may use a copy")

    def close(self) -> None:
        """Gives back the memory now; what came of the case stays. Otherwise Python does so."""
        if self._holder == threading.get_ident():
            raise c.CaseError("the case is being run; it can be closed when that is over")
        self._wait()
        self._handle = None
        self._lock.release()

    def __enter__(self) -> Case:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- keys ---------------------------------------------------------------------------------

    def __setitem__(self, key: str, value: Value) -> None:
        error = c.CError()
        name = c.c_text(key, "a key")
        if isinstance(value, (float, int)) and not isinstance(value, bool):
            with self._held() as address:
                status = c.library.jp_case_set_number(address, name, float(value), byref(error))
        else:
            text = self._text_for(key, value)
            with self._held() as address:
                status = c.library.jp_case_set(address, name, text, byref(error))
        if status:
            c.raise_error(error)
        (self._changed.discard if value is None else self._changed.add)(key)

    def _text_for(self, key: str, value: Value) -> bytes | None:
        """A value as a case file has it."""
        if value is None:
            return None
        if isinstance(value, str):
            return c.c_text(value, f"the value of {key}")
        if isinstance(value, bool):
            return b"yes" if value else b"no"
        if isinstance(value, (float, int)):
            return f"{float(value)!r} {self.setting(key).unit}".encode()
        # what counts as a number elsewhere, such as one of numpy's, which may look like a list
        is_list = isinstance(value, Iterable) and getattr(value, "ndim", 1) > 0
        if hasattr(value, "__float__") and not is_list:
            return self._text_for(key, float(value))
        if is_list and not isinstance(value, (bytes, bytearray, Mapping)):
            parts = (self._text_for(key, part) or b"" for part in value)
            return b"[" + b", ".join(parts) + b"]"
        raise TypeError(f"{key} takes a text, a number or several, not {type(value).__name__}")

    def __delitem__(self, key: str) -> None:
        if key not in self._changed:
            self.setting(key)  # a key that there is not is no key to take back
        self[key] = None

    def popitem(self) -> tuple[str, Any]:
        """Takes back one of the keys that were set, and gives it with the value that it had."""
        if not self._changed:
            raise KeyError("nothing is set in the case")
        key = max(self._changed)
        return key, self.pop(key)

    def clear(self) -> None:
        """Takes back all that was set: the case is what its file says."""
        self.set(dict.fromkeys(self._changed))

    def set(self, values: Mapping[str, Value]) -> None:
        """Sets several keys at once, which may be right only together: all of them or none."""
        if not isinstance(values, Mapping):
            raise c.CaseError(f"values by their keys, not {type(values).__name__}")
        keys = [c.c_text(key, "a key") for key in values]
        texts = [self._text_for(key, value) for key, value in values.items()]
        error = c.CError()
        with self._held() as address:
            status = c.library.jp_case_set_all(
                address, c.c_texts(keys), c.c_texts(texts), len(keys), byref(error)  # type: ignore[arg-type]
            )
        if status:
            c.raise_error(error)
        for key, value in values.items():
            (self._changed.discard if value is None else self._changed.add)(key)

    def setting(self, key: str) -> Setting:
        """A key with its value as text and in numbers, its unit and meaning."""
        found, error = c.CSetting(), c.CError()
        name = c.c_text(key, "a key")
        with self._held() as address:
            if c.library.jp_case_setting(address, name, byref(found), byref(error)):
                c.raise_error(error, c.UnknownKey)
            return _setting(found)

    def settings(self) -> list[Setting]:
        """All settings in the order of docs/case-format.md, with a star where there is no name."""
        found, error = c.CSetting(), c.CError()
        settings = []
        with self._held() as address:
            for index in range(c.library.jp_case_setting_count(address)):
                if c.library.jp_case_setting_at(address, index, byref(found), byref(error)):
                    c.raise_error(error)
                settings.append(_setting(found))
        return settings

    def __getitem__(self, key: str) -> Any:
        """A number in SI that knows its unit, a tuple of them, or a word."""
        found = self.setting(key)
        if not found.numbers:
            return found.text
        if found.text.startswith("["):
            return tuple(Number(value, key, found.unit, found.doc) for value in found.numbers)
        # a tolerance is how far the value may be off
        off = max((abs(part) for part in found.numbers[1:]), default=math.nan)
        return Number(found.numbers[0], key, found.unit, found.doc, off)

    def __iter__(self) -> Iterator[str]:
        return (found.key for found in self.settings() if found.is_used and "*" not in found.key)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, key: object) -> bool:
        try:
            return isinstance(key, str) and bool(self.setting(key))
        except c.CaseError:
            return False

    def _ipython_key_completions_(self) -> list[str]:
        return [found.key for found in self.settings() if "*" not in found.key]

    def doc(self, key: str) -> str:
        """What a key means."""
        return self.setting(key).doc

    # a case is itself, whatever it says
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    # ---- copies -------------------------------------------------------------------------------

    def copy(self) -> Case:
        """A case like this one, with what was set in it."""
        error = c.CError()
        with self._held() as address:
            made = c.library.jp_case_copy(address, byref(error))
        if not made:
            c.raise_error(error)
        case = type(self).__new__(type(self))
        case._take(self._source, c.Handle(made, "jp_case_free"))
        case._changed = set(self._changed)
        return case

    __copy__ = copy

    def __deepcopy__(self, _: object) -> Case:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        kind, content, name = self._source
        if kind == "path" and os.path.exists(content):
            content = os.path.abspath(content)
        with self._held():
            keys = sorted(self._changed)
        changed = {key: self.setting(key).text for key in keys}
        return _reopened, (type(self), (kind, content, name), changed)

    # ---- what is asked of it ------------------------------------------------------------------

    def check(self, backends: Backends = None) -> list[str]:
        """What the case gives and makes no use of. CaseError where the backends cannot run it."""
        notes, error = ctypes.c_char_p(), c.CError()
        with self._held() as address:
            if c.library.jp_case_check(address, _names(backends), byref(notes), byref(error)):
                c.raise_error(error)
            return c.text_of(notes.value).splitlines()

    def run(
        self,
        backends: Backends = None,
        *,
        certified: bool = True,
        spread: bool = False,
        whole: bool = False,
        contacts: bool = True,
        ranges: bool = False,
        threads: int = 0,
        drivers: Mapping[str, Union[str, os.PathLike[str]]] | None = None,
        time_limit: float = 0,
        progress: Progress = None,
    ) -> Run:
        """Runs the case, as ``jointplay run`` does, and gives back what came of it.

        ``backends`` is one, such as "reference", or several: "reference, ode" or a list; by default
        those of the case. Without ``certified`` the reference runs alone, in a fifth of the time,
        and how sure it is is not known. ``spread`` adds what the inputs' limits and the assumptions
        do to the largest forces, ``whole`` many starts where the motion cannot be predicted. Without
        ``contacts`` there is no table of them, whose peaks take some evaluations: with ``spread``
        and ``whole``, ``json`` is then what ``jointplay run --json`` prints. With ``ranges`` the
        series has the smallest and largest values between samples, and the picture marks what was
        there. ``threads`` are processors at a time, all that there are by default; no number depends
        on them. ``drivers`` are programs of other engines by name; ``time_limit`` in seconds is of a
        run on one of these.

        ``progress`` is called with what is being done and its share, and what it raises ends the
        run; by default there is a line at a terminal or in a notebook. Ctrl-C ends a run.
        """
        options = c.library.jp_run_options_default()
        named = [_driver(name, path) for name, path in (drivers or {}).items()]
        options.backends = _names(backends)
        options.is_uncertified = not certified
        options.is_quick = not spread
        options.is_whole = bool(whole)
        options.has_contacts = bool(contacts)
        options.has_ranges = bool(ranges)
        options.drivers = c.c_texts(named)
        options.driver_count = len(named)
        options.time_limit_s = _number(time_limit, "time_limit")
        return Run(self._ask("jp_case_run", options, threads, progress))

    def settled(self, *, threads: int = 0, progress: Progress = None) -> Settled:
        """Finds the motion that is left of the case's start, and nothing else."""
        options = c.library.jp_run_options_default()
        return Settled(self._ask("jp_case_settle", options, threads, progress))

    def map(
        self,
        *,
        step: Union[str, float, Iterable[Union[str, float]], None] = None,
        at_step: Union[str, float, None] = None,
        maps: Backends = None,
        laws: Backends = None,
        mass: Union[str, float, None] = None,
        speed: Union[str, float, None] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> Mapped:
        """ERP and CFM of each joint with play, what they deliver, and up to which step they hold.

        ``step`` is one, such as "1 ms", or several; ``at_step`` one that cannot be changed; the rest
        is as ``jointplay map`` has it. Numbers are SI.
        """
        options = c.library.jp_map_options_default()
        options.steps = _with_unit(step, "s")
        options.at_step = _with_unit(at_step, "s")
        options.maps = _names(maps)
        options.laws = _names(laws)
        options.mass = _with_unit(mass, "kg")
        options.speed = _with_unit(speed, "m/s")
        return Mapped(self._ask("jp_case_map", options, threads, progress))

    def _ask(self, function: str, options: Any, threads: int, progress: Progress) -> Live:
        """A call that takes its time, and its answer."""
        if isinstance(threads, bool) or not isinstance(threads, int) or threads < 0:
            raise c.CaseError("threads is a whole number; 0: all processors that there are")
        error = c.CError()
        options.threads = threads
        options.progress = callback
        address = 0
        try:
            with self._held() as case, Watch(progress) as watch:
                options.context = watch.number
                address = getattr(c.library, function)(case, byref(options), byref(error))
        except BaseException:
            if address:
                c.library.jp_answer_free(address)
            raise
        if not address:
            c.raise_error(error)
        return Live(c.Handle(address, "jp_answer_free"))

    def __repr__(self) -> str:
        kind, content, name = self._source
        called = repr(content if kind == "path" else name or "from a text")
        changed = f", {len(self._changed)} set" if self._changed else ""
        return f"<case {called}{changed}>"


def _reopened(kind: type[Case], source: tuple[str, str, str], changed: Mapping[str, str]) -> Case:
    case = kind.__new__(kind)
    case._open(source)
    case.set(changed)
    return case


def _number(value: float, what: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise c.CaseError(f"{what} is a number in s, not {value!r}") from None


def _driver(name: str, path: Union[str, os.PathLike[str]]) -> bytes:
    if not isinstance(name, str) or "=" in name:
        raise c.CaseError(f"a driver is a name and a program, not {name!r}")
    return c.c_text(f"{name}={os.fspath(path)}", "a driver")


def _names(names: Backends) -> bytes | None:
    """Names as the command line has them, separated by commas."""
    if names is None or isinstance(names, str):
        return None if names is None else c.c_text(names, "a name")
    if not isinstance(names, Iterable):
        raise c.CaseError(f"a name or several of them, not {type(names).__name__}")
    return b",".join(c.c_text(name, "a name") for name in names)


def _with_unit(value: Any, unit: str) -> bytes | None:
    """Values as the command line has them: a number gets its unit of SI."""
    if value is None or isinstance(value, str):
        return None if value is None else c.c_text(value, "a value")
    if isinstance(value, Iterable):
        return b",".join(_with_unit(part, unit) or b"" for part in value)
    return f"{_number(value, 'a value')!r} {unit}".encode()
