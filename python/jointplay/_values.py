"""What an answer is made of: numbers that know their unit, and records of them by name."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Mapping
from typing import Any


class Number(float):
    """A float in SI that knows what it is.

    ``name`` is its name in docs/output.md, ``unit`` its unit ("N"; "" without one), ``doc`` its
    meaning, and ``uncertainty`` how far it may be off, in the same unit: NaN where that is not
    known. A number that the run does not have is NaN. Arithmetic gives plain floats.
    """

    __slots__ = ("name", "unit", "doc", "uncertainty")

    name: str
    unit: str
    doc: str
    uncertainty: float

    def __new__(
        cls,
        value: float,
        name: str = "",
        unit: str = "",
        doc: str = "",
        uncertainty: float = math.nan,
    ) -> Number:
        number = super().__new__(cls, value)
        number.name = name
        number.unit = unit
        number.doc = doc
        number.uncertainty = uncertainty
        return number

    def __repr__(self) -> str:
        text = float.__repr__(self)
        if self.uncertainty == self.uncertainty:
            text += f" +- {self.uncertainty:.1g}"
        return f"{text} {self.unit}".rstrip()

    # text and files get the number alone, which reads back as the same double
    __str__ = float.__repr__

    def __reduce__(self) -> tuple[Any, ...]:
        return Number, (float(self), self.name, self.unit, self.doc, self.uncertainty)


def nearest(word: str, words: Any) -> str:
    """A sentence's end that names what may have been meant, or what there is."""
    words = [str(known) for known in words]
    near = difflib.get_close_matches(word, words, n=1)
    if near:
        return f"; did you mean '{near[0]}'?"
    return f"; there are {', '.join(words)}" if words else "; there are none"


class Record(Mapping[str, Any]):
    """What is known of one thing, by name: as items, and as attributes.

    ``record["force_max_N"]``, ``record.force_max_N`` and, as a number knows its unit,
    ``record.force_max`` are the same.
    """

    __slots__ = ("_of", "_items", "_short")

    def __init__(self, of: str, items: Mapping[str, Any]) -> None:
        self._of = of
        self._items = dict(items)
        self._short = {
            without_unit(name, value.unit): name
            for name, value in self._items.items()
            if isinstance(value, Number)
        }

    def _find(self, name: str) -> Any:
        if name in self._items:
            return self._items[name]
        if name in self._short:
            return self._items[self._short[name]]
        raise KeyError(name)

    def _lacks(self, name: str) -> str:
        return f"{self._of} has no '{name}'{nearest(name, self._names())}"

    def _names(self) -> list[str]:
        short = {name: short for short, name in self._short.items()}
        return [short.get(name, name) for name in self._items]

    def __getitem__(self, name: str) -> Any:
        try:
            return self._find(name)
        except KeyError:
            raise UnknownName(self._lacks(str(name))) from None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self._find(name)
        except KeyError:
            raise AttributeError(self._lacks(name), name="") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __dir__(self) -> list[str]:
        return [name for name in self._names() if name.isidentifier()] + ["items", "keys", "values"]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._items)

    def __repr__(self) -> str:
        return f"<{self._of}: {', '.join(self._names())}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Record, (self._of, self._items)


class UnknownName(KeyError):
    """A name that an answer does not have; its text says which there are."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


_NOT_IN_NAMES = str.maketrans("", "", "^()")


def without_unit(name: str, unit: str) -> str:
    """A name of docs/output.md without the unit of SI that it ends in: force_max_N is force_max."""
    if unit in ("", "deg"):
        return name
    ending = "_" + unit.replace("/", "_").replace(" ", "_").translate(_NOT_IN_NAMES)
    return name.removesuffix(ending)
