"""Reads every exported table with pandas, polars and DuckDB, and compares types and values with its Parquet file.

usage: read_tables.py DIRECTORY

The directory contains `X.csv` with `X.parquet` and lines of JSON `X.jsonl`, at any depth. Standard output: the number of files
of each kind, and a list of what is wrong.
"""

import json
import math
import pathlib
import sys

import duckdb
import pandas
import polars

INTEGERS = ("int", "uint", "bigint", "ubigint", "hugeint")
KINDS = {"float": ("float", "double"), "uint": INTEGERS, "int": INTEGERS, "bool": ("bool",)}


def frames(path):
    """The file as each package reads it without options: types and values of its columns."""
    csv = path.suffix == ".csv"
    frame = polars.read_csv(path) if csv else polars.read_ndjson(path)
    yield "polars", frame.columns, [str(t) for t in frame.dtypes], [c.to_list() for c in frame]
    frame = pandas.read_csv(path) if csv else pandas.read_json(path, lines=True)
    lists = [[None if v is pandas.NA else v for v in frame[c].tolist()] for c in frame]
    yield "pandas", list(frame.columns), [str(t) for t in frame.dtypes], lists
    relation = duckdb.read_csv(str(path)) if csv else duckdb.read_json(str(path))
    columns = list(zip(*relation.fetchall(), strict=True)) or [[]] * len(relation.columns)
    yield "DuckDB", relation.columns, [str(t) for t in relation.types], columns


def equal(expected, value, single):
    """Whether a floating-point number was read; `single`: one of 32 bits."""
    if expected is None or math.isnan(expected):
        return value is None or math.isnan(value)
    # pandas is inexact in the last digits.
    return value is not None and (expected == value or math.isclose(expected, value, rel_tol=1e-6 if single else 1e-14))


def compare(path):
    expected = polars.read_parquet(path.with_suffix(".parquet"))
    for reader, names, types, columns in frames(path):
        where = f"{path.name} in {reader}"
        if list(names) != expected.columns:
            yield f"{where}: {names}"
            continue
        for column, kind, values in zip(expected, types, columns, strict=True):
            wanted = str(column.dtype).lower().rstrip("0123456789")
            numbers = column.to_list()
            if wanted not in KINDS or not any(v is not None for v in numbers):
                continue
            # Integers and truth values with gaps are something else in pandas.
            gaps = reader == "pandas" and column.null_count()
            if not gaps and not kind.lower().startswith(KINDS[wanted]):
                yield f"{where}: {column.name} is {kind}, not {column.dtype}"
            elif wanted == "float":
                single = column.dtype == polars.Float32
                wrong = [(a, b) for a, b in zip(numbers, values, strict=True) if not equal(a, b, single)]
                if wrong:
                    yield f"{where}: {column.name} has {wrong[0][1]}, not {wrong[0][0]}"


folder = pathlib.Path(sys.argv[1])
wrong, counts = [], {"csv": 0, "jsonl": 0}
for path in sorted(folder.rglob("*")):
    kind = path.suffix.removeprefix(".")
    if kind not in counts:
        continue
    counts[kind] += 1
    try:
        wrong += compare(path) if kind == "csv" else [] if list(frames(path)) else []
    except Exception as error:  # noqa: BLE001: any error is one of a reader
        wrong.append(f"{path.relative_to(folder)}: {type(error).__name__}: {error}"[:400])
json.dump({"counts": counts, "wrong": wrong}, sys.stdout)
