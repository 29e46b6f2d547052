"""Tables of columns, as arrays and as data frames."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ._optional import imported
from ._views import table_html

if TYPE_CHECKING:
    # Optional, and two of them have no types.
    import pandas  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import polars  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import pyarrow  # type: ignore[import-not-found, import-untyped, unused-ignore]


class AnyColumn(Protocol):
    """A column of a log, or one made of others."""

    @property
    def values(self) -> NDArray[Any]:
        """One value for each row; of texts, their indices in `texts`."""
        ...

    @property
    def texts(self) -> list[str] | None:
        """The different texts; None unless it is a column of texts."""
        ...

    @property
    def empty(self) -> NDArray[Any] | None:
        """True for each row without a value; None if every row has one."""
        ...


@dataclass(frozen=True)
class MadeColumn:
    """A column made of others."""

    values: NDArray[Any]
    texts: list[str] | None = None
    empty: NDArray[Any] | None = None

    @classmethod
    def of(cls, column: AnyColumn) -> "MadeColumn":
        """A column of a log that can be pickled; its memory is the same."""
        return cls(column.values, column.texts, column.empty)


class Table:
    """Columns of one length, by their names.

    pandas (``pandas.DataFrame.from_arrow``), polars (``polars.DataFrame``), pyarrow (``pyarrow.table``), DuckDB and others
    take a table as it is, by the Arrow stream interface.
    """

    def __init__(self, columns: Mapping[str, AnyColumn]) -> None:
        self._given = columns

    @property
    def _columns(self) -> Mapping[str, AnyColumn]:
        return self._given

    @property
    def _title(self) -> str:
        return "Table"

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(self._columns)

    @cached_property
    def _arrays(self) -> dict[str, NDArray[Any]]:
        return {name: _array(column) for name, column in self._columns.items()}

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Columns as arrays.

        Returns
        -------
        dict of str to numpy.ndarray, shape (rows,)
            Read-only arrays by the names of the columns: ``bool``, ``int64``, ``uint64``, ``float32``, ``float64``, or
            ``object`` with texts. Numbers are not copied from where they were decoded. A column in which some rows have no
            value (those of messages without elements) is a ``numpy.ma.MaskedArray``.

        Raises
        ------
        InvalidInput
            The messages are not of ROS 2, or the log cannot be read any more.
        """
        return dict(self._arrays)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """Returns a column as in `to_numpy`."""
        try:
            return self._arrays[column]
        except KeyError:
            names = ", ".join(self.columns)
            raise KeyError(f"{self._title} has no column {column}; it has {names}") from None

    def to_arrow(self) -> "pyarrow.Table":
        """Columns as a table of Apache Arrow; numbers share the memory of `to_numpy`.

        Raises
        ------
        ImportError
            pyarrow is not installed.
        """
        arrow = imported("pyarrow")
        columns = {name: _arrow(arrow, column) for name, column in self._columns.items()}
        return arrow.table(columns)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Returns the table as an Arrow stream, as `to_arrow`."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_pandas(self) -> "pandas.DataFrame":
        """Columns as a data frame of pandas.

        Raises
        ------
        ImportError
            pandas or pyarrow is not installed.
        """
        imported("pandas")
        return self.to_arrow().to_pandas()

    def to_polars(self) -> "polars.DataFrame":
        """Columns as a data frame of polars.

        Raises
        ------
        ImportError
            polars or pyarrow is not installed.
        """
        frame: polars.DataFrame = imported("polars").from_arrow(self.to_arrow())
        return frame

    def __repr__(self) -> str:
        return f"<{self._title}: {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        """Returns the first rows for a notebook."""
        return table_html(self._title, self._arrays)


def _array(column: AnyColumn) -> NDArray[Any]:
    """Returns a column as an array."""
    values = column.values
    if column.texts is not None:
        values = np.array(column.texts, dtype=object)[values] if column.texts else values.astype(object)
        values.flags.writeable = False
    if column.empty is None:
        return values
    masked: NDArray[Any] = np.ma.MaskedArray(values, mask=column.empty, copy=False)
    return masked


def _arrow(arrow: Any, column: AnyColumn) -> Any:
    """Returns a column as an array of Arrow."""
    if column.texts is None:
        return arrow.array(column.values, mask=column.empty)
    codes = arrow.array(column.values, mask=column.empty)
    texts = arrow.array(column.texts, arrow.string())
    return arrow.DictionaryArray.from_arrays(codes, texts).dictionary_decode()
