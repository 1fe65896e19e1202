# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Queries of batches, by name."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy

from .. import _core
from ..typing import RecordArray

QueryName = Literal["distance", "collide", "within"]

_OPTIONS: dict[QueryName, dict[str, float]] = {
    "distance": {"relative_error": 0.0, "absolute_error": 0.0, "max_distance": math.inf},
    "collide": {},
    "within": {"max_distance": math.nan},  # has to be given
}

QUERY_NAMES = tuple(_OPTIONS)


def dtype_of(name: str) -> numpy.dtype[numpy.void]:
    """The element type of the answers of a query."""
    return {"distance": _core.distance_dtype, "collide": _core.collide_dtype, "within": _core.collide_dtype}[name]


@dataclass(frozen=True)
class Query:
    """A query with its options."""

    name: QueryName
    options: dict[str, float]

    @staticmethod
    def of(name: QueryName, **given: float | None) -> Query:
        """Options that are None are left out. Raises ValueError for those that the query does not have."""
        if name not in _OPTIONS:
            raise ValueError(f"query: expected one of {', '.join(_OPTIONS)}; got {name!r}")
        options = _OPTIONS[name].copy()
        for option, value in given.items():
            if value is None:
                continue
            if option not in options:
                raise ValueError(f"{option}: {name} has no such option")
            options[option] = float(value)
        if name == "within" and math.isnan(options["max_distance"]):
            raise ValueError("max_distance: within needs it")
        return Query(name, options)

    def described(self) -> dict[str, str]:
        """Itself in words, to the bit."""
        return {"query": self.name} | {name: repr(value) for name, value in self.options.items()}

    def ask(self, batch: _core.Batch, records: RecordArray, begin: int, end: int) -> None:
        """Writes the answers for poses begin to end to that part of records."""
        getattr(batch, self.name)(records, begin, end, *self.options.values())

    def check(self, a: _core.Model, b: _core.Model) -> None:
        """Raises ValueError where an option is out of range, or a model has moves that are not committed."""
        self.ask(_core.Batch(a, b, None, None, 1), numpy.zeros(1, dtype_of(self.name)), 0, 1)
