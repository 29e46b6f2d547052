"""Figures of experiments: measured points with intervals, joined to curves, and published points for comparison.

``protean sweep figures DIR`` draws those of an experiment from its results: ``figures/NAME.svg``. All inputs are in the
directory of the results: the rows, the experiment file with its ``[[figures]]`` (without any: one of the main outcome),
and the published points for comparison.
"""

import argparse
import csv
import io
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .._errors import InvalidInput
from .._optional import imported
from . import files
from .results import Results, Row, read, value_text
from .statistics import Mean, Sample

if TYPE_CHECKING:
    from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]

#: Okabe and Ito's palette without yellow, which has too little contrast on white.
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
#: Marks that tell the curves apart in print. Seven marks and six colours: a pair repeats after 42 curves.
_MARKS = "osD^vPX"
#: Distance between the marks of two curves at the same value (pt).
_APART = 3.5
#: Size of a figure (inch).
_SIZE = (9.0, 5.0)


class Point(NamedTuple):
    """A point of a curve: places on both axes, and the ends of its interval, if it has one."""

    x: float
    y: float
    interval: tuple[float, float] | None = None


@dataclass
class Series:
    """A curve: its name, its points, and published points, drawn as hollow marks and not joined."""

    name: str
    points: list[Point] = field(default_factory=list)
    reference: list[Point] = field(default_factory=list)


@dataclass(frozen=True)
class Chart:
    """Curves over one quantity.

    Attributes
    ----------
    name
        Name of its file, without the ending.
    x_label, y_label
        Labels of the axes, with their units.
    series
        The curves, in the order of the legend.
    title, subtitle
        Heading; conditions of the measurement, such as the number of games.
    share
        True if the values are shares of 0 to 1, written in percent.
    x_names
        Names of the values 0, 1, 2 … of the horizontal axis; empty for numbers.
    reference
        Legend of the hollow marks.
    """

    name: str
    x_label: str
    y_label: str
    series: Sequence[Series]
    title: str = ""
    subtitle: str = ""
    share: bool = True
    x_names: Sequence[str] = ()
    reference: str = "published"


def draw(chart: Chart, ax: "Axes") -> "Axes":
    """Draws a chart into axes of matplotlib."""
    transforms, ticker = imported("matplotlib.transforms"), imported("matplotlib.ticker")
    looks = []
    for index, series in enumerate(chart.series):
        shift = _APART * (index - (len(chart.series) - 1) / 2)
        # Marks of different curves at the same value stand side by side.
        place = transforms.offset_copy(ax.transData, fig=ax.figure, x=shift, units="points")
        look: dict[str, Any] = {
            "color": _COLORS[index % len(_COLORS)],
            "marker": _MARKS[index % len(_MARKS)],
            "transform": place,
        }
        looks.append(look)
        line = "" if chart.x_names else "-"
        _bars(ax, sorted(series.points), **look, linestyle=line, markersize=5, label=series.name)
    label: str | None = chart.reference
    for series, look in zip(chart.series, looks, strict=True):
        if series.reference:
            hollow: dict[str, Any] = {"markerfacecolor": "none", "markersize": 8, "linestyle": ""}
            _bars(ax, series.reference, bars=":", label=label, **look, **hollow)
            label = None
    if chart.x_names:
        ax.set_xticks(range(len(chart.x_names)), chart.x_names)
        if len(chart.x_names) > 6:
            ax.tick_params("x", labelrotation=45)
    if chart.share:
        ax.set_ylim(-0.02, 1.02) if _reach(chart) > 0.6 else ax.set_ylim(bottom=0.0)
        ax.yaxis.set_major_formatter(ticker.PercentFormatter(1.0))
    else:
        ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.set_title(chart.title)
    ax.set_xlabel(chart.x_label)
    ax.set_ylabel(chart.y_label)
    ax.grid(color="#e3e6ea")
    ax.set_axisbelow(True)
    if any(series.name for series in chart.series):
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return ax


def _bars(ax: "Axes", points: Sequence[Point], *, bars: str = "-", label: str | None, **look: Any) -> None:
    x, y = [point.x for point in points], [point.y for point in points]
    ends = [point.interval or (point.y, point.y) for point in points]
    spread = [[max(p - low, 0.0) for p, (low, _) in zip(y, ends, strict=True)]]
    spread += [[max(high - p, 0.0) for p, (_, high) in zip(y, ends, strict=True)]]
    _, _, lines = ax.errorbar(x, y, spread, capsize=2.5, elinewidth=1.0, label=label or None, **look)
    for line in lines:
        line.set_linestyle(bars)
    # Marks beside the values must not widen the axes by their place alone.
    ax.update_datalim(list(zip(x, y, strict=True)))
    ax.update_datalim([(p, end) for p, both in zip(x, ends, strict=True) for end in both])
    ax.autoscale_view()


def _reach(chart: Chart) -> float:
    points = [point for series in chart.series for point in (*series.points, *series.reference)]
    return max((max(point.y, *(point.interval or (point.y,))) for point in points), default=1.0)


def svg(chart: Chart) -> bytes:
    """Draws a chart as SVG; with the same version of matplotlib the same chart gives the same bytes."""
    style, backend = imported("matplotlib.style"), imported("matplotlib.backends.backend_svg")
    matplotlib, figure = imported("matplotlib"), imported("matplotlib.figure")
    # Texts stay texts; names of parts are made from the content.
    fixed = {"svg.fonttype": "none", "svg.hashsalt": "protean"}
    with style.context("default"), matplotlib.rc_context(fixed):
        page = figure.Figure(figsize=_SIZE, layout="constrained")
        backend.FigureCanvasSVG(page)
        draw(chart, page.add_subplot())
        if chart.subtitle:
            page.axes[0].set_title(chart.subtitle, fontsize=8, color="#5b6472", wrap=True)
            page.suptitle(chart.title, fontweight="bold")
        out = io.BytesIO()
        page.savefig(out, format="svg", metadata={"Date": None, "Title": chart.title or chart.y_label})
    return out.getvalue()


#: Value of a row; None without one.
Value = Callable[[Row], float | None]


def _laps(value: Callable[[dict[str, Any]], float | None]) -> Value:
    """Mean over the robots of a mission that visit waypoints."""

    def of(row: Row) -> float | None:
        visits = [robot["waypoints"] for robot in row["robots"] if robot["waypoints"] is not None]
        values = [found for visit in visits if (found := value(visit)) is not None]
        return math.fsum(values) / len(values) if values else None

    return of


def _lap(which: str, figure: str) -> Value:
    return _laps(lambda visit: None if visit[which] is None else visit[which][figure])


def _coverage(row: Row) -> float | None:
    return None if row["coverage"] is None else row["coverage"]["coverable_fraction"]


def left_out_share(visit: Mapping[str, int]) -> float:
    """Share of the waypoints of a robot that are left out."""
    left_out = visit["inside_obstacle"] + visit["timed_out"] + visit["unreachable"] + visit["stuck"]
    return left_out / (left_out + visit["reached"]) if left_out + visit["reached"] else 0.0


#: Metrics of figures by name: label of the axis, whether they are shares, and the value of a row, or the name of the
#: evaders that are counted among all of a cell.
METRICS: dict[str, tuple[str, bool, Value | str]] = {
    "escape_chance": ("evaders that escape", True, "escaped"),
    "capture_chance": ("evaders that are caught", True, "caught"),
    "held_out_chance": ("evaders that hold out", True, "held_out"),
    "game_time": ("length of a game [s]", False, lambda row: row["sim_time_s"]),
    "first_capture": ("time of the first capture [s]", False, lambda row: row["first_capture_s"]),
    "first_escape": ("time of the first escape [s]", False, lambda row: row["first_escape_s"]),
    "contacts": ("contacts per game", False, lambda row: float(row["contacts"])),
    "evader_mean_speed": ("mean speed of the evaders [m/s]", False, lambda row: row["evader_mean_speed"]),
    "escape_possible": ("part of the game in which an escape is possible", True, lambda row: row["escape_possible_fraction"]),
    "lap_length": ("length of a lap [m]", False, _lap("planned", "length_m")),
    "longest_lap": ("longest lap [s]", False, _laps(lambda visit: visit["longest_lap_s"])),
    "planned_mae": ("distance from the route, as planned (MAE) [m]", False, _lap("planned", "mae_m")),
    "driven_mae": ("distance from the route, as driven (MAE) [m]", False, _lap("driven", "mae_m")),
    "planned_maa": ("change of direction, as planned (MAA) [rad]", False, _lap("planned", "maa")),
    "driven_maa": ("change of direction, as driven (MAA) [rad]", False, _lap("driven", "maa")),
    "left_out": ("waypoints left out", True, _laps(left_out_share)),
    "coverage": ("area visited", True, _coverage),
}


def _measure(metric: str, rows: Sequence[Row]) -> tuple[float, tuple[float, float] | None] | None:
    """Value of a cell's games and the ends of its 95 % interval; None if they have none."""
    value = METRICS[metric][2]
    if isinstance(value, str):
        sample = Sample.of((row[value], row["evaders"]) for row in rows)
        return None if sample.share is None else (sample.share, sample.interval())
    mean = Mean.of(found for row in rows if (found := value(row)) is not None)
    if mean is None:
        return None
    # One value gives no information about its error.
    return mean.value, mean.interval() if mean.count > 1 else None


def charts(results: Results) -> list[Chart]:
    """Figures of an experiment, from its results.

    Raises
    ------
    InvalidInput
        They are of plans, or the experiment file or the published points beside them are damaged.
    """
    if results.is_planning:
        raise InvalidInput(
            "results of plans have no figures; `protean reproduce --paper vmc-lp` draws those of the paper"
        )
    experiment = results.experiment
    specs = experiment.get("figures")
    if specs is None:
        specs = [found for found in (_default(results),) if found]
    return [_chart(spec, results, experiment) for spec in specs]


def _default(results: Results) -> dict[str, Any] | None:
    """The main outcome over the first parameter with several values; None without such a parameter."""
    axes = (
        name
        for number, name in enumerate(results.parameters)
        if len({cell.values[number] for cell in results.cells}) > 1
    )
    axis = next(axes, None)
    rows = list(results.rows.values())
    metrics = ("escape_chance", "coverage", "lap_length", "game_time")
    found = next((name for name in metrics if _measure(name, rows) is not None), None)
    return {"name": "outcome", "x": axis, "metric": found} if axis and found else None


def _chart(spec: Mapping[str, Any], results: Results, experiment: Mapping[str, Any]) -> Chart:
    parameters = experiment.get("parameters", {})
    titles = {name: parameters.get(name, {}).get("title", name.replace("_", " ")) for name in results.parameters}
    cases = {case["name"]: case.get("title") for case in experiment.get("cases", [])}
    axis = results.parameters.index(spec["x"])
    places = [cell.values[axis] for cell in results.cells]
    are_numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in places)
    names = [] if are_numbers else list(dict.fromkeys(map(value_text, places)))
    published = list(_published(results.directory / spec["compare"])) if spec.get("compare") else []
    label, share, _ = METRICS[spec.get("metric", "escape_chance")]
    curves: dict[tuple[str, ...], Series] = {}
    counts = []
    for number, cell in enumerate(results.cells):
        others = [
            (name, value_text(value))
            for name, value in zip(results.parameters, cell.values, strict=True)
            if name != spec["x"]
        ]
        key = (cell.case, *(value for _, value in others))
        name = ", ".join(
            [cases.get(cell.case) or cell.case.replace("_", " "), *(f"{n.replace('_', ' ')} {v}" for n, v in others)]
        )
        reference = [point for of, point in published if of in key or of == name]
        curve = curves.setdefault(key, Series(name, [], reference))
        rows = list(results.finished(number).values())
        counts.append(len(rows))
        measured = _measure(spec.get("metric", "escape_chance"), rows)
        if measured is not None:
            place = cell.values[axis]
            curve.points.append(Point(float(place) if are_numbers else names.index(value_text(place)), *measured))
    title = spec.get("title") or results.title
    if not spec.get("title") and results.title == results.name:
        # An experiment without a title: its name stands below.
        title = f"{label} by {titles[spec['x']]}"
    return Chart(
        name=spec["name"],
        title=title,
        subtitle=f"{results.name}: {games_text(counts)}",
        x_label=titles[spec["x"]],
        y_label=label,
        share=share,
        x_names=names,
        series=list(curves.values()),
    )


def games_text(counts: Sequence[int]) -> str:
    """Numbers of games of the points, as text."""
    if not counts:
        return "no games"
    least, most = min(counts), max(counts)
    return f"{most} games per point" if least == most else f"{least} to {most} games per point"


def _published(path: Path) -> Iterator[tuple[str, Point]]:
    """Points of a file of published points, with the names of their curves."""
    try:
        rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror}: expected the published points of the experiment") from error
    for line, row in enumerate(rows, 2):
        try:
            ends = (float(row["low"]), float(row["high"])) if row.get("low") and row.get("high") else None
            yield row["series"], Point(float(row["x"]), float(row["y"]), ends)
        except (KeyError, TypeError, ValueError) as error:
            expected = "the columns series, x, y, and optionally low and high, with numbers"
            raise InvalidInput(f"{path}:{line}: {error!r}: expected {expected}") from error


def write(directory: Path) -> list[Path]:
    """Draws all figures of an experiment beside its results; returns the files."""
    written = []
    for chart in charts(read(directory)):
        path = directory / "figures" / f"{chart.name}.svg"
        files.save(path, svg(chart))
        written.append(path)
    return written


def main(arguments: Sequence[str] | None = None) -> int:
    """Carries out ``protean sweep figures``; returns the exit code."""
    parser = argparse.ArgumentParser("protean sweep figures", description="Draw the figures of existing results.")
    parser.add_argument("results", metavar="DIR", type=Path, help="directory of the results")
    directory = parser.parse_args(arguments).results
    try:
        for path in write(directory):
            print(path)
    except (InvalidInput, ImportError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2 if isinstance(error, InvalidInput) else 1
    return 0
