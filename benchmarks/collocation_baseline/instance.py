"""Planning instances: reading, and refusing what the baseline cannot treat."""

import json
import math
from dataclasses import dataclass

import numpy as np


class Refused(ValueError):
    """An instance that is valid but not of the kind solved here, or that is malformed."""


@dataclass
class Instance:
    """One problem, in pixels, seconds and radians. `None` means free or unlimited."""

    id: str
    cm_per_px: float
    v_min: float  # -v_max to 0 (forwards only)
    v_max: float
    w_max: float
    bounds: tuple  # x0, y0, x1, y1: for the robot's centre
    start: tuple  # x, y
    start_theta: float
    start_speed: float | None
    start_turn_rate: float | None
    goal: tuple  # x, y
    goal_theta: float | None
    goal_speed: float | None
    wheel_speed: float | None
    wheel_separation: float | None
    acceleration: float | None
    angular_acceleration: float | None
    centres: np.ndarray  # (n, 2)
    radii: np.ndarray  # (n,): grown by the buffer

    @property
    def millimetre(self):
        """One millimetre in pixels: tolerance of penetration and of the goal."""
        return 0.1 / self.cm_per_px

    @property
    def has_inertia(self):
        """`False` if speed and turn rate may step."""
        return self.acceleration is not None or self.angular_acceleration is not None


def number(value, name, positive=False):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise Refused(f"{name} is {value!r}: expected a finite number")
    if positive and value <= 0:
        raise Refused(f"{name} is {value!r}: expected a positive number")
    return float(value)


def optional(raw, key, positive=False):
    return None if raw.get(key) is None else number(raw[key], key, positive)


def parse(raw):
    """An `Instance` of one element of an instance file."""
    try:
        buffer_px = number(raw["buffer_px"], "buffer_px")
        discs = []
        for obstacle in raw["obstacles"]:
            if "polygon" in obstacle:
                raise Refused("has polygons; this baseline takes discs only")
            discs.append([number(obstacle[key], f"obstacle's {key}") for key in ("x", "y", "r")])
        discs = np.array(discs, dtype=float).reshape(-1, 3)
        start, goal = raw["start"], raw["goal"]
        bounds = tuple(number(edge, "bounds_px") for edge in raw["bounds_px"])
        if len(bounds) != 4:
            raise Refused("bounds_px has not four numbers")
        v_max = number(raw["vmax_px_s"], "vmax_px_s", positive=True)
        instance = Instance(
            id=str(raw["id"]),
            cm_per_px=number(raw["cm_per_px"], "cm_per_px", positive=True),
            v_min=-v_max if raw.get("v_min") is None else number(raw["v_min"], "v_min"),
            v_max=v_max,
            w_max=number(raw["wmax_rad_s"], "wmax_rad_s", positive=True),
            bounds=bounds,
            start=(number(start["x"], "start.x"), number(start["y"], "start.y")),
            start_theta=number(start["theta"], "start.theta"),
            start_speed=optional(raw, "start_speed"),
            start_turn_rate=optional(raw, "start_turn_rate"),
            goal=(number(goal["x"], "goal.x"), number(goal["y"], "goal.y")),
            goal_theta=optional(goal, "theta"),
            goal_speed=optional(raw, "goal_speed"),
            wheel_speed=optional(raw, "wheel_speed_px_s", positive=True),
            wheel_separation=optional(raw, "wheel_separation_px", positive=True),
            acceleration=optional(raw, "acceleration_px_s2", positive=True),
            angular_acceleration=optional(raw, "angular_acceleration_rad_s2", positive=True),
            centres=discs[:, :2],
            radii=discs[:, 2] + buffer_px,
        )
    except (KeyError, TypeError) as error:
        raise Refused(f"is malformed: {type(error).__name__} {error}") from None
    if (instance.wheel_speed is None) != (instance.wheel_separation is None):
        raise Refused("wheel_speed_px_s and wheel_separation_px belong together")
    if not -instance.v_max <= instance.v_min <= 0.0:
        raise Refused(f"v_min is {instance.v_min:g}: expected {-instance.v_max:g} to 0")
    return instance


def load(path, limit=None):
    """The raw elements of an instance file, the first `limit` of them."""
    with open(path, encoding="utf-8") as file:
        raw = json.load(file)
    if not isinstance(raw, list) or not all(isinstance(each, dict) for each in raw):
        raise Refused(f"{path}: expected an array of instances")
    return raw if limit is None else raw[:limit]
