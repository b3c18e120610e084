"""The C library behind the module: where it is, and include/jointplay/case.h for ctypes.

Nothing of what keys and numbers are called, of their units and meanings stands here: all of that is
asked of the library. tests/python/test_header.py holds this file against the header.
"""

from __future__ import annotations

import ctypes
import os
import sys
from ctypes import POINTER, c_bool, c_char_p, c_double, c_int, c_size_t, c_void_p
from pathlib import Path
from typing import NoReturn

NAME = "libjointplay-case.so.1"

OK, USAGE, CASE, SOLVER, FILE, MEMORY, CANCELLED, INTERNAL = 0, 2, 3, 4, 5, 6, 7, 8

ERROR_SIZE = 2048


class CError(ctypes.Structure):
    _fields_ = [
        ("status", c_int),
        ("line", c_int),
        ("column", c_int),
        ("text", ctypes.c_char * ERROR_SIZE),
    ]


class CSetting(ctypes.Structure):
    _fields_ = [
        ("key", c_char_p),
        ("text", c_char_p),
        ("unit", c_char_p),
        ("count", c_size_t),
        ("numbers", POINTER(c_double)),
        ("is_used", c_bool),
        ("doc", c_char_p),
    ]


CProgress = ctypes.CFUNCTYPE(c_int, c_char_p, c_double, c_void_p)


class CRunOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("backends", c_char_p),
        ("is_uncertified", c_bool),
        ("is_quick", c_bool),
        ("is_whole", c_bool),
        ("threads", c_size_t),
        ("drivers", POINTER(c_char_p)),
        ("driver_count", c_size_t),
        ("time_limit_s", c_double),
        ("progress", CProgress),
        ("context", c_void_p),
        ("has_ranges", c_bool),
        ("has_contacts", c_bool),
    ]


class CMapOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("steps", c_char_p),
        ("at_step", c_char_p),
        ("maps", c_char_p),
        ("laws", c_char_p),
        ("mass", c_char_p),
        ("speed", c_char_p),
        ("threads", c_size_t),
        ("progress", CProgress),
        ("context", c_void_p),
    ]


class CNumber(ctypes.Structure):
    _fields_ = [
        ("name", c_char_p),
        ("value", c_double),
        ("unit", c_char_p),
        ("doc", c_char_p),
        ("uncertainty", c_double),
    ]


class CColumn(ctypes.Structure):
    _fields_ = [
        ("name", c_char_p),
        ("unit", c_char_p),
        ("doc", c_char_p),
        ("count", c_size_t),
        ("numbers", c_void_p),
        ("words", POINTER(c_char_p)),
    ]


class CKey(ctypes.Structure):
    _fields_ = [
        ("path", c_char_p),
        ("unit", c_char_p),
        ("doc", c_char_p),
        ("low", c_double),
        ("high", c_double),
        ("words", POINTER(c_char_p)),
    ]


class CQuantity(ctypes.Structure):
    _fields_ = [
        ("path", c_char_p),
        ("name", c_char_p),
        ("unit", c_char_p),
        ("doc", c_char_p),
        ("is_timed", c_bool),
    ]


_error = POINTER(CError)
_case = c_void_p
_answer = c_void_p

# what each function gives back, and what it takes
FUNCTIONS: dict[str, tuple[object, tuple[object, ...]]] = {
    "jp_case_version": (c_char_p, ()),
    "jp_case_open": (_case, (c_char_p, _error)),
    "jp_case_parse": (_case, (c_char_p, c_size_t, c_char_p, _error)),
    "jp_case_copy": (_case, (_case, _error)),
    "jp_case_free": (None, (_case,)),
    "jp_case_set": (c_int, (_case, c_char_p, c_char_p, _error)),
    "jp_case_set_number": (c_int, (_case, c_char_p, c_double, _error)),
    "jp_case_set_all": (c_int, (_case, POINTER(c_char_p), POINTER(c_char_p), c_size_t, _error)),
    "jp_case_setting_count": (c_size_t, (_case,)),
    "jp_case_setting_at": (c_int, (_case, c_size_t, POINTER(CSetting), _error)),
    "jp_case_setting": (c_int, (_case, c_char_p, POINTER(CSetting), _error)),
    "jp_case_check": (c_int, (_case, c_char_p, POINTER(c_char_p), _error)),
    "jp_run_options_default": (CRunOptions, ()),
    "jp_case_run": (_answer, (_case, POINTER(CRunOptions), _error)),
    "jp_case_settle": (_answer, (_case, POINTER(CRunOptions), _error)),
    "jp_map_options_default": (CMapOptions, ()),
    "jp_case_map": (_answer, (_case, POINTER(CMapOptions), _error)),
    "jp_answer_free": (None, (_answer,)),
    "jp_answer_json": (c_char_p, (_answer, POINTER(c_size_t), _error)),
    "jp_answer_text": (c_char_p, (_answer, c_char_p, POINTER(c_size_t), _error)),
    "jp_answer_number": (c_int, (_answer, c_char_p, POINTER(CNumber), _error)),
    "jp_answer_number_count": (c_size_t, (_answer, _error)),
    "jp_answer_number_at": (c_int, (_answer, c_size_t, POINTER(CNumber), _error)),
    "jp_answer_word": (c_int, (_answer, c_char_p, POINTER(c_char_p), _error)),
    "jp_answer_column_count": (c_size_t, (_answer, c_char_p, _error)),
    "jp_answer_column_at": (c_int, (_answer, c_char_p, c_size_t, POINTER(CColumn), _error)),
    "jp_answer_column": (c_int, (_answer, c_char_p, c_char_p, POINTER(CColumn), _error)),
    "jp_key_count": (c_size_t, ()),
    "jp_key_at": (c_int, (c_size_t, POINTER(CKey))),
    "jp_quantity_count": (c_size_t, ()),
    "jp_quantity_at": (c_int, (c_size_t, POINTER(CQuantity))),
    "jp_case_lost": (c_size_t, (POINTER(c_size_t),)),
}


def _places() -> list[str]:
    """Where the library may be, the likeliest first."""
    asked = os.environ.get("JOINTPLAY_LIBRARY")
    if asked:
        return [asked]
    here = Path(__file__).parent
    # in a build folder, whose python/ has this module
    places = [here.parent.parent / "src/library" / NAME]
    # installed under the same prefix, wherever that is now: PREFIX/lib/pythonX/site-packages
    for folder in here.parents:
        if folder.name in ("lib", "lib64"):
            places += [folder / NAME, *sorted(folder.glob(f"*-linux-*/{NAME}"))]
    return [str(place) for place in places if place.exists()] + [NAME]


def _load() -> ctypes.CDLL:
    reason: OSError | None = None
    for place in _places():
        try:
            return ctypes.CDLL(place)
        except OSError as error:
            reason = error
    raise ImportError(
        f"{NAME}, the C library that this module asks, is not found: {reason}; install "
        "libjointplay-case1, or name the file in the environment variable JOINTPLAY_LIBRARY",
        name="jointplay",
    )


def _declared() -> ctypes.CDLL:
    loaded = _load()
    for name, (result, takes) in FUNCTIONS.items():
        try:
            function = getattr(loaded, name)
        except AttributeError:
            raise ImportError(
                f"{loaded._name} has no {name}: it is older than this module", name="jointplay"
            ) from None
        function.restype = result
        function.argtypes = takes
    return loaded


library = _declared()


class Error(Exception):
    """What a call was refused or has failed for: the sentence of the command line.

    ``status`` is the exit status that `jointplay` has for the same (2 usage, 3 case, 4 solver,
    5 file; 6 no memory, 7 cancelled, 8 a mistake of the library); ``line`` and ``column`` the
    place in the text of the case, or None.
    """

    def __init__(self, text: str, status: int = USAGE, line: int = 0, column: int = 0) -> None:
        super().__init__(text)
        self.status = status
        self.line: int | None = line or None
        self.column: int | None = column or None

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.status, self.line or 0, self.column or 0)


class CaseError(Error, ValueError):
    """A key, a value or a whole case is wrong; the text says what would be allowed."""


class UnknownKey(CaseError, KeyError):
    """A case has no such key; the text says which may have been meant."""

    # that of KeyError is the text in quotation marks
    __str__ = Error.__str__


class SolverError(Error, RuntimeError):
    """A run failed; the text says why."""


class FileError(Error):
    """A file could not be read."""


class Cancelled(Error):
    """The progress callback asked for it."""


KINDS: dict[int, type[Error]] = {
    CASE: CaseError,
    SOLVER: SolverError,
    FILE: FileError,
    CANCELLED: Cancelled,
}


def raise_error(error: CError, usage: type[Error] = CaseError) -> NoReturn:
    """Raises what the library has said; ``usage`` where the call or a value in it is wrong."""
    text = error.text.decode("utf-8", "replace")
    if error.status == MEMORY:
        raise MemoryError(text)
    kind = usage if error.status == USAGE else KINDS.get(error.status, Error)
    raise kind(text, error.status, error.line, error.column)


def text_of(data: bytes | None) -> str:
    return "" if data is None else data.decode("utf-8", "replace")


def c_text(text: object, what: str) -> bytes:
    """A text for C, which ends it at a 0."""
    if not isinstance(text, str):
        raise CaseError(f"{what} is a text, not {type(text).__name__}")
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError:
        raise CaseError(f"{what} holds characters that are not Unicode") from None
    if b"\0" in data:
        raise CaseError(f"{what} holds a zero character")
    return data


def c_texts(texts: list[bytes]) -> ctypes.Array[c_char_p]:
    return (c_char_p * len(texts))(*texts)


class Handle:
    """A case or an answer of the library, freed with the last thing that refers to it."""

    __slots__ = ("address", "_free", "__weakref__")

    def __init__(self, address: int, free: str) -> None:
        self.address = address
        self._free = getattr(library, free)

    def __reduce__(self) -> tuple[object, ...]:
        raise TypeError("memory of the library cannot be copied; a case has copy()")

    # at the interpreter's end the system takes all back
    def __del__(self, is_ending=sys.is_finalizing) -> None:  # type: ignore[no-untyped-def]
        if not is_ending():
            self._free(self.address)
