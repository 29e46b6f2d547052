"""Views of objects in a notebook: small HTML, complete in itself."""

import base64
import html
import itertools
import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._core import Map
    from ._run import Run
    from ._sweep import Sweep
    from .trajectory import Trajectory

#: Largest width and height of a drawing (px).
_SIDE = 480
#: Rows of a table that a view shows.
_ROWS = 6
#: Columns of a table that a view shows.
_COLUMNS = 12
#: Colours of the pictures: walls, their edges, robots, goals.
WALL, EDGE, PATH, GOAL = "#cdd2da", "#9aa1ad", "#0072b2", "#009e73"


def block(title: str, *parts: str) -> str:
    """Returns a view: a heading and what follows. It is as wide as the page, and scrolls within itself."""
    return (
        '<div style="max-width: 100%; overflow-x: auto; font-family: system-ui, sans-serif">'
        f"<div><strong>{html.escape(title)}</strong></div>{''.join(parts)}</div>"
    )


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Returns a table; numbers are to the right."""
    cells = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.number)):
        return f'<td style="text-align: left">{html.escape(str(value))}</td>'
    text = f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)
    return f'<td style="text-align: right">{text}</td>'


def note(text: str) -> str:
    """Returns a line of small text."""
    return f'<div style="opacity: 0.7; font-size: 0.9em">{html.escape(text)}</div>'


def frame(page: str) -> str:
    """Returns a page in a frame of the notebook."""
    text = html.escape(page)
    return f'<iframe srcdoc="{text}" style="width: 100%; height: 720px; border: 0" allowfullscreen></iframe>'


def run_html(run: "Run") -> str:
    """Returns the outcome of a run."""
    summary = run.summary
    rows = [(robot["name"], robot["outcome"]) for robot in summary["robots"]]
    return block(
        f"{summary['scenario']}, seed {run.seed}: {run.time:.2f} s simulated",
        table(("robot", "outcome"), rows),
        note(f"digest {run.digest[:12]}…; no log: out= records one"),
    )


def sweep_html(sweep: "Sweep", figures: Iterable[tuple[str, bytes]]) -> str:
    """Returns the figures, names and SVG, and the missions of a sweep."""
    missions, failed = sweep.summary["missions"], len(sweep.summary["failures"])
    pictures = (_picture("image/svg+xml", figure, name) for name, figure in figures)
    text = note(f"{missions} missions, {failed} failed; results in {sweep.directory}")
    return block(f"Sweep {sweep.directory.name}", text, *pictures)


def table_html(title: str, columns: Mapping[str, NDArray[Any]]) -> str:
    """Returns the first rows of a table."""
    rows = len(next(iter(columns.values()), ()))
    shown = list(columns)[:_COLUMNS]
    cells = ([_value(columns[name][row]) for name in shown] for row in range(min(rows, _ROWS)))
    text = f"{rows} rows, {len(columns)} columns"
    others = ", ".join(itertools.islice(columns, _COLUMNS, None))
    return block(title, table(shown, cells), note(f"{text}; further columns: {others}" if others else text))


def _value(value: Any) -> Any:
    return "" if value is np.ma.masked or value is None else value


def map_html(map: "Map") -> str:
    """Returns a map as an image of its cells."""
    (x0, y0), (x1, y1) = map.bounds.tolist()
    rows, columns = map.grid.shape
    image = _picture("image/png", _png(_cells(map)), "map", f"image-rendering: pixelated; border: 1px solid {EDGE}")
    title = f"Map of {x1 - x0:g} m × {y1 - y0:g} m"
    return block(title, image, note(f"x {x0:g} to {x1:g} m, y {y0:g} to {y1:g} m; {columns} × {rows} cells of {map.resolution:g} m"))


def _cells(map: "Map") -> NDArray[np.uint8]:
    """Returns the colours of the cells, the largest y first, at most about four times as many as pixels."""
    grid = map.grid
    step = max(1, max(grid.shape) // (2 * _SIDE))
    edges = [range(0, size, step) for size in grid.shape]
    occupied = np.logical_or.reduceat(np.logical_or.reduceat(grid, edges[0], axis=0), edges[1], axis=1)
    wall = np.frombuffer(bytes.fromhex(WALL[1:]), np.uint8)
    return np.where(occupied[::-1, :, None], wall, np.uint8(255))


def _png(pixels: NDArray[np.uint8]) -> bytes:
    """Returns an image of shape (height, width, 3) as PNG."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    height, width, _ = pixels.shape
    lines = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines.tobytes())) + chunk(b"IEND", b"")


def _picture(kind: str, data: bytes, title: str, style: str = "") -> str:
    source = f"data:{kind};base64,{base64.b64encode(data).decode()}"
    size = f"max-width: 100%; {style}" if kind == "image/svg+xml" else f"width: {_SIDE}px; max-width: 100%; {style}"
    return f'<img alt="{html.escape(title)}" src="{source}" style="{size}">'


def trajectory_html(plan: "Trajectory") -> str:
    """Returns the path of a trajectory among its obstacles."""
    path = plan.pose[:, :2]
    around = [path]
    for obstacle in plan.obstacles:
        around.append(obstacle if obstacle.ndim == 2 else obstacle[:2] + obstacle[2] * np.array([[-1, -1], [1, 1]]))
    points = np.concatenate(around)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = max(0.05 * float((high - low).max()), 1e-6)
    low, high = low - margin, high + margin
    width, height = (high - low).tolist()
    scale = _SIDE / max(width, height)

    def place(points: NDArray[np.float64]) -> str:
        x, y = (points[:, 0] - low[0]) * scale, (high[1] - points[:, 1]) * scale
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))

    def disc(x: float, y: float, radius: float, look: str) -> str:
        return f'<circle cx="{(x - low[0]) * scale:.1f}" cy="{(high[1] - y) * scale:.1f}" r="{radius:.1f}" {look}/>'

    wall = f'fill="{WALL}" stroke="{EDGE}"'
    shapes = [
        f'<polygon points="{place(obstacle)}" {wall}/>'
        if obstacle.ndim == 2
        else disc(obstacle[0], obstacle[1], obstacle[2] * scale, wall)
        for obstacle in plan.obstacles
    ]
    # More points than pixels show nothing more.
    step = max(1, len(path) // 1000)
    line = np.concatenate([path[:-1:step], path[-1:]])
    shapes.append(f'<polyline points="{place(line)}" fill="none" stroke="{PATH}" stroke-width="2.5"/>')
    shapes.append(disc(path[0, 0], path[0, 1], 4, f'fill="#ffffff" stroke="{PATH}" stroke-width="2"'))
    shapes.append(disc(path[-1, 0], path[-1, 1], 4, f'fill="{GOAL}"'))
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * scale:.0f}" height="{height * scale:.0f}" '
        f'viewBox="0 0 {width * scale:.1f} {height * scale:.1f}" role="img" '
        f'style="max-width: 100%; height: auto; background: #ffffff; border: 1px solid {EDGE}">'
        f"<title>Path of the trajectory</title>{''.join(shapes)}</svg>"
    )
    text = f"{plan.status}; at least {plan.lower_bound:.3f} s; {len(path)} samples"
    return block(f"Trajectory of {plan.duration:.3f} s and {plan.length:.3f} m", svg, note(text))
