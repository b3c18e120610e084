"""What came of a case: numbers by name, tables, words, and what the commands print with --json."""

from __future__ import annotations

import ctypes
import functools
import json
import threading
from collections.abc import Iterator, Mapping, Sequence
from ctypes import byref
from typing import Any, NamedTuple, Protocol, Union

from . import _library as c
from ._arrays import Column, Rows, Series, values_of, view_of
from ._notebook import html_of
from ._values import Number, UnknownName, nearest, without_unit

TABLES = ("series", "contacts", "spikes")


class Quantity(NamedTuple):
    """A number that runs have."""

    path: str  #: with a star for a name, as in docs/output.md: "joints.*.force_max_N"
    name: str  #: without the unit: "force_max"
    unit: str  #: SI; "" where it has none
    doc: str  #: what it means
    is_timed: bool  #: whether <name>_crank_deg beside it says where it stood


@functools.lru_cache(maxsize=None)
def quantities() -> tuple[Quantity, ...]:
    """All numbers that runs have, from the library's one table of them."""
    found = c.CQuantity()
    made = []
    for index in range(c.library.jp_quantity_count()):
        c.library.jp_quantity_at(index, byref(found))
        path, name, unit, doc = map(c.text_of, (found.path, found.name, found.unit, found.doc))
        made.append(Quantity(path, name, unit, doc, bool(found.is_timed)))
    return tuple(made)


def _fits(pattern: Sequence[str], parts: Sequence[str]) -> bool:
    """Whether the parts of a name begin a pattern, in which a star stands for any of them."""
    return len(pattern) >= len(parts) and all(x in ("*", y) for x, y in zip(pattern, parts))


@functools.lru_cache(maxsize=1024)
def _full_names(parts: tuple[str, ...]) -> Mapping[str, tuple[str, ...]]:
    """What the numbers at a place in an answer are called in full, by their names with and without
    units: of those whose unit depends on the joint both."""
    names: dict[str, tuple[str, ...]] = {}
    for quantity in quantities():
        *of, name = quantity.path.split(".")
        if len(of) == len(parts) and _fits(of, parts):
            names[quantity.name] = (*names.get(quantity.name, ()), name)
            names[name] = (name,)
    return names


@functools.lru_cache(maxsize=1024)
def _names_below(parts: tuple[str, ...]) -> Sequence[str]:
    """Some of the numbers somewhere below a place in an answer, from there on."""
    paths = [quantity.path.split(".") for quantity in quantities()]
    below = [path[len(parts) :] for path in paths if len(path) > len(parts) and _fits(path, parts)]
    return [".".join(path) for path in below if "*" not in path][:4]


class Source(Protocol):
    """Where an answer comes from: the library's memory, or what another process has sent."""

    def number(self, name: str) -> Number:
        ...  # CaseError where there is none

    def word(self, name: str) -> str:
        ...  # likewise

    def numbers(self) -> Sequence[Number]:
        ...  # all of them

    def json(self) -> str:
        ...

    def column_names(self, table: str) -> Sequence[str]:
        ...

    def column(self, table: str, name: str) -> Column:
        ...

    def text(self, form: str) -> str:
        ...  # "screen", "full" or "picture"

    def close(self) -> None:
        ...


def _number(found: c.CNumber) -> Number:
    name, unit, doc = c.text_of(found.name), c.text_of(found.unit), c.text_of(found.doc)
    return Number(found.value, name, unit, doc, found.uncertainty)


class Live:
    """An answer in the memory of the library; by one thread at a time."""

    def __init__(self, handle: c.Handle) -> None:
        self._handle: Union[c.Handle, None] = handle
        # a handler of signals may ask between any two lines
        self._lock = threading.RLock()

    def close(self) -> None:
        with self._lock:
            self._handle = None

    def _address(self) -> int:
        if self._handle is None:
            raise c.Error("the answer is closed")
        return self._handle.address

    def number(self, name: str) -> Number:
        found, error = c.CNumber(), c.CError()
        data = c.c_text(name, "a name")
        with self._lock:
            if c.library.jp_answer_number(self._address(), data, byref(found), byref(error)):
                c.raise_error(error)
            return _number(found)

    def numbers(self) -> list[Number]:
        found, error = c.CNumber(), c.CError()
        numbers = []
        with self._lock:
            address = self._address()
            count = c.library.jp_answer_number_count(address, byref(error))
            if error.status:
                c.raise_error(error)
            for index in range(count):
                if c.library.jp_answer_number_at(address, index, byref(found), byref(error)):
                    c.raise_error(error)
                numbers.append(_number(found))
        return numbers

    def word(self, name: str) -> str:
        found, error = ctypes.c_char_p(), c.CError()
        data = c.c_text(name, "a name")
        with self._lock:
            if c.library.jp_answer_word(self._address(), data, byref(found), byref(error)):
                c.raise_error(error)
            return c.text_of(found.value)

    def json(self) -> str:
        error = c.CError()
        with self._lock:
            text = c.library.jp_answer_json(self._address(), None, byref(error))
            if text is None:
                c.raise_error(error)
            return c.text_of(text)

    def text(self, form: str) -> str:
        error = c.CError()
        with self._lock:
            text = c.library.jp_answer_text(
                self._address(), c.c_text(form, "a form"), None, byref(error)
            )
            if text is None:
                c.raise_error(error)
            return c.text_of(text)

    def column_names(self, table: str) -> list[str]:
        found, error = c.CColumn(), c.CError()
        data = c.c_text(table, "a name")
        names = []
        with self._lock:
            address = self._address()
            count = c.library.jp_answer_column_count(address, data, byref(error))
            if error.status:
                c.raise_error(error)
            for index in range(count):
                if c.library.jp_answer_column_at(address, data, index, byref(found), byref(error)):
                    c.raise_error(error)
                names.append(c.text_of(found.name))
        return names

    def column(self, table: str, name: str) -> Column:
        found, error = c.CColumn(), c.CError()
        of, data = c.c_text(table, "a name"), c.c_text(name, "a name")
        with self._lock:
            if c.library.jp_answer_column(self._address(), of, data, byref(found), byref(error)):
                c.raise_error(error)
            if found.count == 0:
                values: Any = values_of(b"") if not found.words else []
            elif found.words:
                values = [c.text_of(word) for word in found.words[: found.count]]
            else:
                values = view_of(found.numbers, found.count, self._handle)
            return Column(
                c.text_of(found.name), c.text_of(found.unit), c.text_of(found.doc), values
            )


# tables by name: of each column unit, meaning and values; or why there are none
Tables = Mapping[str, Union[Mapping[str, tuple[str, str, Any]], str]]


class _Kept:
    """The same as plain values, which can be pickled."""

    def __init__(
        self, whole: str, numbers: Mapping[str, Number], backends: Sequence[str],
        tables: Tables, texts: Mapping[str, str],
    ) -> None:  # fmt: skip
        self.whole = whole
        self.texts = texts
        self.by_name = numbers
        self.backends = backends
        self.tables = tables

    def close(self) -> None:
        self.whole, self.by_name, self.tables, self.texts = "{}", {}, {}, {}

    def _lacks(self, name: str, names: Any) -> c.CaseError:
        return c.CaseError(f"the answer has no '{name}'{nearest(name, names)}")

    def number(self, name: str) -> Number:
        for full in (name, *(f"{backend}.{name}" for backend in self.backends[:1])):
            if full in self.by_name:
                return self.by_name[full]
        raise self._lacks(name, self.by_name)

    def numbers(self) -> Sequence[Number]:
        return list(self.by_name.values())

    def word(self, name: str) -> str:
        of, _, rest = name.partition(".")
        whole = json.loads(self.whole)
        runs = {run.get("label"): run for run in whole.get("runs", ())}
        runs.update({run.get("backend"): run for run in reversed(whole.get("runs", ()))})
        places = (
            [(runs[of], rest)] if of in runs else [(run, name) for run in whole.get("runs", ())[:1]]
        )
        for place, path in [*places, (whole, name)]:
            found = _walk(place, path)
            if isinstance(found, str) or found is None:
                return found or ""
        raise self._lacks(name, ())

    def json(self) -> str:
        return self.whole

    def text(self, form: str) -> str:
        if form not in self.texts:
            raise self._lacks(form, self.texts)
        return self.texts[form]

    def _table(self, table: str) -> Mapping[str, tuple[str, str, Any]]:
        if table not in self.tables and self.backends:
            table = f"{self.backends[0]}.{table}"
        columns = self.tables.get(table, {})
        if isinstance(columns, str):
            raise c.CaseError(columns)
        return columns

    def column_names(self, table: str) -> list[str]:
        return list(self._table(table))

    def column(self, table: str, name: str) -> Column:
        columns = self._table(table)
        if name not in columns:
            raise self._lacks(name, columns)
        unit, doc, data = columns[name]
        return Column(name, unit, doc, values_of(data) if isinstance(data, bytes) else data)


def _walk(place: Any, path: str) -> Any:
    """What stands at a path of keys and numbers of places in JSON; the path itself where there is none."""
    for part in path.split("."):
        if isinstance(place, dict) and part in place:
            place = place[part]
        elif isinstance(place, list) and part.isdigit() and int(part) < len(place):
            place = place[int(part)]
        else:
            return ()
    return place


class _Columns:
    """The columns of one table of an answer."""

    def __init__(self, source: Source, table: str) -> None:
        self.source = source
        self.table = table

    def names(self) -> Sequence[str]:
        return self.source.column_names(self.table)

    def column(self, name: str) -> Column:
        return self.source.column(self.table, name)

    def __reduce__(self) -> tuple[Any, ...]:
        columns = map(self.column, self.names())
        return _read_columns, (self.table, {x.name: (x.unit, x.doc, _plain(x.values)) for x in columns})


def _read_columns(table: str, columns: Mapping[str, tuple[str, str, Any]]) -> _Columns:
    return _Columns(_Kept("{}", {}, [], {table: columns}, {}), table)


# what stands at a place: of numbers the unit, of places None
Below = Mapping[str, Union[str, None]]


class Node(Mapping[str, Any]):
    """A place in an answer, with numbers, words and further places in it, by name.

    They are items and attributes; numbers also without their unit, which they know themselves:
    ``run.joints["crank-coupler"].force_max``. ``dir()`` and the tab key show what there is.
    """

    __slots__ = ("_answer", "_before", "_parts")

    def __init__(self, answer: Answer, before: str, parts: tuple[str, ...]) -> None:
        self._answer = answer
        self._before = before  # the backend with a point, or nothing
        self._parts = parts

    def _full(self, *names: str) -> str:
        return self._before + ".".join((*self._parts, *names))

    def _below(self) -> Below:
        """What stands here."""
        return self._answer._below(self._before, self._parts)

    def _number(self, *names: str) -> Union[Number, None]:
        try:
            return self._answer._source.number(self._full(*names))
        except c.CaseError:
            return None

    def _word(self, *names: str) -> Union[str, None]:
        try:
            return self._answer._source.word(self._full(*names))
        except c.CaseError:
            return None

    def _known(self, name: str) -> Any:
        """What the table of quantities leads to, without listing the whole answer."""
        for full in _full_names(self._parts).get(name, ()):
            number = self._number(full)
            if number is not None:
                return number
        for below in _names_below((*self._parts, name)):
            if self._number(name, below) is not None:
                return Node(self._answer, self._before, (*self._parts, name))
        return None

    def _find(self, name: str) -> Any:
        found = self._known(name)
        if found is not None:
            return found
        below = self._below()
        for full, unit in below.items():
            if unit is not None and name in (full, without_unit(full, unit)):
                return self._number(full)
        if name in below:
            return Node(self._answer, self._before, (*self._parts, name))
        # a list may be of things with names
        for index in below:
            if index.isdigit() and name in (self._word(index, "name"), self._word(index, "joint")):
                return Node(self._answer, self._before, (*self._parts, index))
        word = self._word(name)
        if word is not None:
            return word or None
        what = ".".join(self._parts) or "the answer"
        why = self._answer._failure(self._before) or nearest(name, self._names().values())
        raise UnknownName(f"{what} has no '{name}'{why}")

    def _names(self) -> dict[str, str]:
        """What stands here: in full, and without units."""
        below = self._below().items()
        return {name: name if unit is None else without_unit(name, unit) for name, unit in below}

    def __getitem__(self, name: Union[str, int]) -> Any:
        return self._find(str(name))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self._find(name)
        except UnknownName as error:
            # named, Python would guess once more
            raise AttributeError(str(error), name="") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._below())

    def __len__(self) -> int:
        return len(self._below())

    def __contains__(self, name: object) -> bool:
        return name in self._below()

    def _attributes(self) -> list[str]:
        return [name for name in self._names().values() if name.isidentifier()]

    def __dir__(self) -> list[str]:
        return [*self._attributes(), "items", "keys", "values"]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._below())

    def __repr__(self) -> str:
        return f"<{'.'.join(self._parts) or 'answer'}: {', '.join(self._names().values())}>"


class Answer:
    """What came of a call: ``numbers`` by their names in docs/output.md, places in it as
    attributes, ``json`` as the commands print it. It needs its case no more."""

    _root: tuple[str, ...] = ()  # what its attributes are read from

    def __init__(self, source: Source) -> None:
        self._source = source
        self._index: Union[dict[tuple[str, ...], dict[str, Union[str, None]]], None] = None
        self._json: Any = None

    def close(self) -> None:
        """Gives back the memory now, but for columns that are in use. Otherwise Python does so."""
        self._source.close()

    def __enter__(self) -> Answer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- names --------------------------------------------------------------------------------

    def number(self, name: str) -> Number:
        """A number by its name, such as "joints.crank-coupler.force_max_N" or "truth.uncertainty".

        With the name of a backend in front it is that backend's: "ode.error.max". NaN is what is
        not known. CaseError where there is no such name.
        """
        return self._source.number(name)

    def word(self, name: str) -> str:
        """A word by the same kind of name, such as "status"; "" where there is none."""
        return self._source.word(name)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all numbers."""
        return tuple(number.name for number in self._source.numbers())

    @property
    def json(self) -> Any:
        """What the command prints with --json, as dicts and lists."""
        if self._json is None:
            self._json = json.loads(self.json_text)
        return self._json

    @property
    def json_text(self) -> str:
        """The same as text."""
        return self._source.json()

    def _backends(self) -> list[str]:
        """Of a run its backends, in their order."""
        return []

    def _failure(self, before: str) -> str:
        """A sentence's end that says why a run has nothing; empty where it has."""
        return ""

    def _below(self, before: str, parts: tuple[str, ...]) -> Below:
        if self._index is None:
            self._index = {}
            for number in self._source.numbers():
                # settings go by their whole keys
                steps = number.name.split(".", 1 if number.name.startswith("settings.") else -1)
                for depth, step in enumerate(steps):
                    below = self._index.setdefault(tuple(steps[:depth]), {})
                    below[step] = number.unit if depth + 1 == len(steps) else None
        backends = self._backends()
        if before:
            return self._index.get((before[:-1], *parts), {})
        found = dict(self._index.get((backends[0], *parts), {})) if backends else {}
        found.update(self._index.get(parts, {}))
        return {name: unit for name, unit in found.items() if parts or name not in backends}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(Node(self, "", self._root), name)

    def __dir__(self) -> list[str]:
        mine = (name for name in object.__dir__(self) if not name.startswith("_"))
        return sorted({*mine, *Node(self, "", self._root)._attributes()})

    def _described(self) -> str:
        raise NotImplementedError

    def __repr__(self) -> str:
        try:
            return self._described()
        except c.Error:
            return f"<{type(self).__name__.lower()}, closed>"

    # ---- between processes --------------------------------------------------------------------

    def _texts(self) -> Mapping[str, str]:
        return {}

    def _tables(self) -> Tables:
        return {}

    def __reduce__(self) -> tuple[Any, ...]:
        numbers = {number.name: number for number in self._source.numbers()}
        return _read, (
            type(self),
            self.json_text,
            numbers,
            self._backends(),
            self._tables(),
            self._texts(),
        )


def _read(kind: type[Answer], *what: Any) -> Answer:
    return kind(_Kept(*what))


class Settled(Answer):
    """The motion that is left of a case's start: ``settled`` of docs/output.md, as attributes."""

    _root = ("settled",)

    @property
    def screen(self) -> str:
        """What was found, in words."""
        return self._source.text("screen")

    def _texts(self) -> Mapping[str, str]:
        return {"screen": self.screen}

    def _described(self) -> str:
        return self.screen.strip()


class _Shown(Answer):
    """An answer that a command prints."""

    @property
    def screen(self) -> str:
        """The first screen of the command."""
        return self._source.text("screen")

    @property
    def full(self) -> str:
        """All tables, as it prints them with --full."""
        return self._source.text("full")

    @property
    def picture(self) -> str:
        """Its picture, as SVG."""
        return self._source.text("picture")

    def _texts(self) -> Mapping[str, str]:
        return {form: self._source.text(form) for form in ("screen", "full", "picture")}

    def _repr_html_(self) -> str:
        """For a notebook."""
        return html_of(self.screen, self.picture)


class Mapped(_Shown):
    """ERP, CFM and step of each joint with play: what ``jointplay map`` finds."""

    def _described(self) -> str:
        return f"<mapping: {', '.join(self._below('', ()))}>"


class OneRun(Node):
    """What came of a case on one backend: its numbers and places as attributes, and its tables."""

    __slots__ = ()

    @property
    def joints(self) -> Mapping[str, Any]:
        """Each joint by its name, with its numbers."""
        return Node(self._answer, self._before, ("joints",))

    @property
    def bodies(self) -> Mapping[str, Any]:
        """Each body that is not driven by its name, with its numbers."""
        return Node(self._answer, self._before, ("bodies",))

    def _columns(self, table: str) -> _Columns:
        return _Columns(self._answer._source, self._before + table)

    @property
    def series(self) -> Series:
        """The samples: columns as --series writes them."""
        return Series("the series", self._columns("series"))

    @property
    def contacts(self) -> Rows:
        """The contacts in the order of their onsets: columns as --contacts writes them."""
        return Rows("the contacts", self._columns("contacts"))

    @property
    def spikes(self) -> Rows:
        """The spikes of accelerations and of forces."""
        return Rows("the spikes", self._columns("spikes"))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), "contacts", "series", "spikes"]


class Run(_Shown):
    """What came of a case on one backend or several.

    Numbers, tables and words are those of the first backend that was asked for, ``run["ode"]`` has
    those of another. What belongs to no backend, such as ``truth`` and ``settled``, stands beside.
    """

    @functools.cached_property
    def _labels(self) -> list[str]:
        return [run["backend"] for run in self.json["runs"]]

    def _backends(self) -> list[str]:
        return self._labels

    def _failure(self, before: str) -> str:
        backend = before[:-1] or self._labels[0]
        runs = [run for run in self.json["runs"] if run["backend"] == backend]
        if not runs or runs[0]["status"] == "ok":
            return ""
        return f": the run on {backend} failed: {runs[0]['message']}"

    @property
    def backends(self) -> tuple[str, ...]:
        """The backends that ran, in their order."""
        return tuple(self._labels)

    def __getitem__(self, backend: str) -> OneRun:
        if backend not in self._labels:
            raise UnknownName(f"no run on '{backend}'{nearest(str(backend), self._labels)}")
        return OneRun(self, f"{backend}.", ())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._labels)

    @property
    def _first(self) -> OneRun:
        return OneRun(self, "", ())

    @property
    def joints(self) -> Mapping[str, Any]:
        """Each joint by its name, with its numbers."""
        return self._first.joints

    @property
    def bodies(self) -> Mapping[str, Any]:
        """Each body that is not driven by its name, with its numbers."""
        return self._first.bodies

    @property
    def series(self) -> Series:
        """The samples: columns as --series writes them."""
        return self._first.series

    @property
    def contacts(self) -> Rows:
        """The contacts in the order of their onsets: columns as --contacts writes them."""
        return self._first.contacts

    @property
    def spikes(self) -> Rows:
        """The spikes of accelerations and of forces."""
        return self._first.spikes

    def _tables(self) -> Tables:
        return {
            f"{backend}.{table}": self._table(f"{backend}.{table}")
            for backend in self._labels
            for table in TABLES
        }

    def _table(self, table: str) -> Union[Mapping[str, tuple[str, str, Any]], str]:
        try:
            names = self._source.column_names(table)
        except c.CaseError as error:  # contacts that were not kept
            return str(error)
        columns = [self._source.column(table, name) for name in names]
        return {x.name: (x.unit, x.doc, _plain(x.values)) for x in columns}

    def _described(self) -> str:
        return f"<run on {', '.join(self._labels)} of {self.json['case']!r}>"


def _plain(values: Any) -> Any:
    """The values of a column as what can be pickled without numpy."""
    return values if isinstance(values, list) else bytes(memoryview(values))
