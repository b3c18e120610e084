"""Columns of numbers: arrays of numpy where it is there, memoryviews where it is not.

Neither is a copy: both read the memory of the library and keep it alive for as long as they are
there themselves, whatever has become of the run.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, Union

from ._values import Number, Record, UnknownName, nearest

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

# a numpy.ndarray of float64 or a memoryview of format "d"; of words a list
Values = Any


class MissingPackage(ImportError):
    """What was asked for needs a package that is not installed; its text names it."""


def need(package: str, purpose: str) -> Any:
    """A package that only some calls need, or an error that names it."""
    try:
        return __import__(package)
    except ImportError:
        raise MissingPackage(
            f"{purpose} needs {package}, which is not installed: apt install python3-{package}",
            name=package,
        ) from None


def view_of(address: int, count: int, owner: object) -> Values:
    """A read-only view of so many doubles at an address that holds for as long as the owner lives."""
    memory: Any = (ctypes.c_double * count).from_address(address)
    memory._owner = owner
    if numpy is not None:
        array = numpy.frombuffer(memory, dtype=numpy.float64)
        array.flags.writeable = False
        return array
    return memoryview(memory).cast("B").cast("d").toreadonly()


def values_of(data: bytes) -> Values:
    """The same of doubles that stand in bytes."""
    if numpy is not None:
        return numpy.frombuffer(data, dtype=numpy.float64)
    return memoryview(data).cast("d")


class Column(NamedTuple):
    """A column of a table."""

    name: str
    unit: str  #: SI, "" where it has none
    doc: str  #: what it means
    values: Values


class Columns(Protocol):
    """Where the columns of a table come from."""

    def names(self) -> Sequence[str]:
        ...

    def column(self, name: str) -> Column:
        ...


class _Table:
    """Columns of equal length by their names; they are made when they are first asked for."""

    __slots__ = ("_of", "_columns", "_names")

    def __init__(self, of: str, columns: Columns) -> None:
        self._of = of
        self._columns = columns
        self._names: Union[tuple[str, ...], None] = None

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns."""
        if self._names is None:
            self._names = tuple(self._columns.names())
        return self._names

    def column(self, name: str) -> Column:
        """A column with its unit and meaning."""
        try:
            return self._columns.column(name)
        except (ValueError, LookupError):
            raise UnknownName(
                f"{self._of} has no column '{name}'{nearest(str(name), self.columns)}"
            ) from None

    def unit(self, name: str) -> str:
        """The unit of a column, "" where it has none."""
        return self.column(name).unit

    def doc(self, name: str) -> str:
        """What a column means."""
        return self.column(name).doc

    def to_pandas(self) -> Any:
        """A pandas.DataFrame of all columns."""
        frame = need("pandas", "to_pandas()").DataFrame
        return frame({name: _for_pandas(self.column(name).values) for name in self.columns})

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.columns)

    def __repr__(self) -> str:
        return f"<{self._of}: {', '.join(self.columns)}>"


def _for_pandas(values: Values) -> Any:
    return list(values) if isinstance(values, memoryview) else values


class Series(_Table, Mapping[str, Values]):
    """The samples of a run: a column by its name in docs/output.md, such as "crank_deg"."""

    __slots__ = ()

    def __getitem__(self, name: str) -> Values:
        return self.column(name).values

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __contains__(self, name: object) -> bool:
        return name in self.columns


class Rows(_Table, Sequence[Record]):
    """A table with a row for each event.

    ``rows["force_max_N"]`` is a column, ``rows[0]`` a record of the first row. With numpy
    ``rows.array`` is a structured array, and so is what a mask or a slice gives.
    """

    __slots__ = ("_array",)

    def __init__(self, of: str, columns: Columns) -> None:
        super().__init__(of, columns)
        self._array: Any = None

    def __len__(self) -> int:
        return len(self.column(self.columns[0]).values) if self.columns else 0

    @property
    def array(self) -> Any:
        """The rows as a structured array of numpy."""
        if self._array is None:
            np = need("numpy", "rows.array")
            columns = [self.column(name) for name in self.columns]
            kinds = [
                (x.name, "f8" if isinstance(x.values, np.ndarray) else _text_kind(x))
                for x in columns
            ]
            array = np.empty(len(self), dtype=kinds)
            for column in columns:
                array[column.name] = column.values
            array.flags.writeable = False
            self._array = array
        return self._array

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.array if dtype is None else self.array.astype(dtype)

    def __getitem__(self, which: Any) -> Any:
        if isinstance(which, str):
            return self.column(which).values
        if not isinstance(which, int):
            return self.array[which]
        if not -len(self) <= which < len(self):
            raise IndexError(f"{self._of} has {len(self)} rows, and none with number {which}")
        return Record(
            f"row {which} of {self._of}", {name: self._cell(name, which) for name in self.columns}
        )

    def _cell(self, name: str, row: int) -> Any:
        column = self.column(name)
        value = column.values[row]
        return value if isinstance(value, str) else Number(value, name, column.unit, column.doc)


def _text_kind(column: Column) -> str:
    return f"U{max((len(word) for word in column.values), default=1) or 1}"
