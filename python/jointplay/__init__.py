"""jointplay: mechanisms with play in their joints, in ODE and beside a certified reference.

>>> import jointplay as jp
>>> case = jp.Case("impact-k66")  # or a path, or the text of a case
>>> case["joints.crank-coupler.radial-clearance"] = "20 um"
>>> run = case.run("reference")
>>> run.joints["crank-coupler"].force_max  # SI, with .unit, .uncertainty and .doc
>>> run.series["follower_omega_rad_s"]  # an array of numpy where it is there

Keys, units and what they mean are those of ``jointplay help case``, numbers those of docs/output.md;
all of them are asked of the C library, libjointplay-case. The manual is docs/python.md.
"""

from ._answer import Answer, Mapped, Quantity, Run, Settled, quantities
from ._arrays import Column, MissingPackage, Rows, Series
from ._case import Case, Key, Setting, keys
from ._library import (
    Cancelled, CaseError, Error, FileError, SolverError, UnknownKey, library, text_of,
)  # fmt: skip
from ._sweep import Point, sweep
from ._values import Number, UnknownName

__version__ = text_of(library.jp_case_version())

__all__ = [
    "Answer", "Cancelled", "Case", "CaseError", "Column", "Error", "FileError", "Key", "Mapped",
    "MissingPackage", "Number", "Point", "Quantity", "Rows", "Run", "Series", "Setting", "Settled",
    "SolverError", "UnknownKey", "UnknownName", "keys", "quantities", "sweep",
]  # fmt: skip
