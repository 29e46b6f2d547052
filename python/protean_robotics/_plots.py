"""Drawings into axes of matplotlib, which is optional."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arguments import refused
from ._optional import imported
from ._views import EDGE, GOAL, WALL, map_html, trajectory_html

if TYPE_CHECKING:
    from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]

    from ._core import Map
    from ._log import Log
    from ._sweep import Sweep
    from .trajectory import Trajectory


# The compiled classes draw by this module.
__all__ = ["map_axes", "map_html", "trajectory_axes", "trajectory_html"]


def axes(ax: "Axes | None") -> "Axes":
    """Returns the axes, or new ones."""
    pyplot = imported("matplotlib.pyplot")
    if ax is None:
        made: Axes = pyplot.subplots(layout="constrained")[1]
        return made
    if not hasattr(ax, "plot"):
        raise refused("ax", ax, "axes of matplotlib")
    return ax


def _ground(ax: "Axes") -> None:
    ax.set_aspect("equal")
    ax.set_xlabel("x (m)")
    ax.set_ylabel("y (m)")


def _grid(ax: "Axes", occupied: Any, bounds: Any) -> None:
    colors = imported("matplotlib.colors")
    (x0, y0), (x1, y1) = bounds
    look = colors.ListedColormap(["#ffffff", WALL])
    ax.imshow(occupied, origin="lower", extent=(x0, x1, y0, y1), cmap=look, vmin=0, vmax=1, interpolation="nearest")
    _ground(ax)


def map_axes(map: "Map", ax: "Axes | None") -> "Axes":
    """Draws the obstacles of a map."""
    ax = axes(ax)
    low = map.origin
    rows, columns = map.grid.shape
    _grid(ax, map.grid, (low, low + np.array([columns, rows]) * map.resolution))
    return ax


def log_axes(log: "Log", ax: "Axes | None") -> "Axes":
    """Draws the paths of the robots of a log on its map."""
    ax = axes(ax)
    if "world/map" in log.topics:
        cells = log["world/map"]
        # Of the newest map.
        last = cells["sequence"] == cells["sequence"][-1]
        width, height = (int(cells[name][last][0]) for name in ("width", "height"))
        side = float(cells["resolution"][last][0])
        low = np.array([cells[name][last][0] for name in ("origin_x", "origin_y")], dtype=float)
        occupied = cells["cells.occupied"][last].reshape(height, width) != 0
        _grid(ax, occupied, (low, low + side * np.array([width, height])))
    robots = log.robots
    names = robots["name"]
    for name in dict.fromkeys(names.tolist()):
        own = names == name
        x, y = robots["x"][own], robots["y"][own]
        (line,) = ax.plot(x, y, label=name)
        ax.plot(x[:1], y[:1], "o", markerfacecolor="white", color=line.get_color())
        ax.plot(x[-1:], y[-1:], "o", color=line.get_color())
    _ground(ax)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    ax.set_title(f"{log.scenario}, seed {log.seed}")
    return ax


def quantity_axes(log: "Log", name: str, ax: "Axes | None") -> "Axes":
    """Draws a quantity of a log over time."""
    plots = json.loads(log._file.plots())
    found = [plot for plot in plots if name.lower() in plot["title"].lower()]
    if not found:
        titles = "; ".join(plot["title"] for plot in plots)
        raise refused("quantity", name, f"a part of one of: {titles}")
    plot = found[0]
    ax = axes(ax)
    for curve in plot["curves"]:
        times = np.array(curve["times_ns"], dtype=float) * 1e-9
        # Infinite values come as None.
        values = np.array(curve["values"], dtype=float)
        ax.plot(times, values, label=curve["name"], drawstyle="steps-post" if plot["steps"] else "default")
    ax.set_title(plot["title"])
    ax.set_xlabel("t (s)")
    ax.set_ylabel(plot["unit"])
    ax.legend()
    return ax


def trajectory_axes(plan: "Trajectory", ax: "Axes | None") -> "Axes":
    """Draws the path of a trajectory, coloured by the speed, among its obstacles."""
    ax = axes(ax)
    patches, collections = imported("matplotlib.patches"), imported("matplotlib.collections")
    for obstacle in plan.obstacles:
        look = {"facecolor": WALL, "edgecolor": EDGE}
        if obstacle.ndim == 2:
            ax.add_patch(patches.Polygon(obstacle, **look))
        else:
            ax.add_patch(patches.Circle(obstacle[:2], obstacle[2], **look))
    path = plan.pose[:, :2]
    lines = collections.LineCollection(np.stack([path[:-1], path[1:]], axis=1), linewidths=2.5)
    lines.set_array(plan.v[:-1])
    ax.add_collection(lines)
    ax.plot(*path[0], "o", markerfacecolor="white", color=EDGE)
    ax.plot(*path[-1], "o", color=GOAL)
    ax.autoscale_view()
    ax.figure.colorbar(lines, ax=ax, label="speed (m/s)")
    _ground(ax)
    ax.set_title(f"{plan.duration:.3f} s, {plan.length:.3f} m")
    return ax
