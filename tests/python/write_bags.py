"""Writes bags of ROS 2 with `rosbags`, as programs of ROS 2 do.

usage: write_bags.py FOLDER

FOLDER/states.json has the robots of a run: {name: [[x, y, theta, v, omega], …]}, one entry for each tick of 0.05 s. The bag
FOLDER/team has their odometry, each in a frame that /tf places in the map. FOLDER/field has odometry, scans and a map of one
robot without a namespace; FOLDER/old the same in a database; FOLDER/cut a message that is too short; FOLDER/none nothing.
Standard output: the poses in FOLDER/field, and the ranges of its scans.
"""

import json
import math
import pathlib
import sys

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

store = get_typestore(Stores.ROS2_HUMBLE)
types = store.types
START_NS = 1_700_000_000_000_000_000


def make(name, **fields):
    return types[name](**fields)


def header(at_ns, frame):
    stamp = make("builtin_interfaces/msg/Time", sec=at_ns // 10**9, nanosec=at_ns % 10**9)
    return make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def yaw(theta):
    return make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=math.sin(theta / 2), w=math.cos(theta / 2))


def vector(x=0.0, y=0.0, z=0.0):
    return make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def pose(x, y, theta):
    point = make("geometry_msgs/msg/Point", x=x, y=y, z=0.0)
    return make("geometry_msgs/msg/Pose", position=point, orientation=yaw(theta))


def transforms(at_ns, *frames):
    def one(parent, child, x, y, theta):
        transform = make("geometry_msgs/msg/Transform", translation=vector(x, y), rotation=yaw(theta))
        return make(
            "geometry_msgs/msg/TransformStamped", header=header(at_ns, parent), child_frame_id=child, transform=transform
        )

    return make("tf2_msgs/msg/TFMessage", transforms=[one(*frame) for frame in frames])


def within(place, x, y, theta):
    """The pose in the map as one in a frame that is at `place` in the map."""
    dx, dy, (sin, cos) = x - place[0], y - place[1], (math.sin(place[2]), math.cos(place[2]))
    return cos * dx + sin * dy, cos * dy - sin * dx, theta - place[2]


def odometry(at_ns, frame, child, place, x, y, theta, v, omega):
    none = np.zeros(36)
    at = make("geometry_msgs/msg/PoseWithCovariance", pose=pose(*within(place, x, y, theta)), covariance=none)
    twist = make("geometry_msgs/msg/Twist", linear=vector(v), angular=vector(z=omega))
    twist = make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=none)
    return make("nav_msgs/msg/Odometry", header=header(at_ns, frame), child_frame_id=child, pose=at, twist=twist)


class Bag:
    def __init__(self, path, plugin=StoragePlugin.MCAP):
        self.writer = Writer(path, version=9, storage_plugin=plugin)
        self.connections = {}

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *_):
        self.writer.close()

    def write(self, topic, at_ns, message, cut=None):
        kind = message.__msgtype__
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=store)
        data = bytes(store.serialize_cdr(message, kind))
        self.writer.write(self.connections[topic], at_ns, data[:cut])


def write_team(path, robots):
    with Bag(path) as bag:
        for number, (name, states) in enumerate(robots.items()):
            place = (0.5 * number, -1.0, 0.7 * number)
            for tick, state in enumerate(states):
                # Each robot has its own moment within a tick, and its messages come late.
                at_ns = START_NS + tick * 50_000_000 + number * 2_000_000
                frame = f"{name}/odom"
                if tick % 20 == 0:
                    bag.write("/tf", at_ns, transforms(at_ns, ("map", frame, *place)))
                message = odometry(at_ns, frame, f"{name}/base_link", place, *state)
                bag.write(f"/{name}/odom", at_ns + 7_000_000, message)


def write_field(path, plugin=StoragePlugin.MCAP, cut=None):
    place, poses = (1.0, 2.0, 0.5), []
    ranges = [math.nan, 0.0, 0.01, 1.5, math.inf, 99.0, 2.0, 2.5]
    with Bag(path, plugin) as bag:
        bag.write("/note", START_NS, make("std_msgs/msg/String", data="nothing to import"))
        fixed = transforms(START_NS, ("base_footprint", "base_link", 0.0, 0.0, 0.0), ("/base_link", "laser", 0.0, 0.0, 0.25))
        bag.write("/tf_static", START_NS, fixed)
        bag.write("/tf", START_NS, transforms(START_NS, ("map", "odom", *place)))
        for number in range(2):
            cells = np.zeros((60, 80), dtype=np.int8)
            cells[0, :], cells[-1, :] = 100, -1
            cells[20 : 20 + 10 * number, 40] = 65
            info = make(
                "nav_msgs/msg/MapMetaData",
                map_load_time=header(START_NS, "").stamp,
                resolution=0.05,
                width=80,
                height=60,
                origin=pose(0.0, 0.0, 0.0),
            )
            at_ns = START_NS + number * 10**9
            grid = make("nav_msgs/msg/OccupancyGrid", header=header(at_ns, "map"), info=info, data=cells.ravel())
            bag.write("/map", at_ns, grid)
        for tick in range(101):
            at_ns = START_NS + tick * 50_000_000
            state = (0.5 + 0.005 * tick, 0.5, 0.002 * tick, 0.1, 0.04)
            poses.append(state[:3])
            message = odometry(at_ns, "odom", "base_footprint", place, *state)
            bag.write("/odom", at_ns, message, cut if tick == 2 else None)
            if tick % 2 == 0:
                scan = make(
                    "sensor_msgs/msg/LaserScan",
                    header=header(at_ns, "laser"),
                    angle_min=-1.0,
                    angle_max=0.75,
                    angle_increment=0.25,
                    time_increment=0.0,
                    scan_time=0.1,
                    range_min=0.125,
                    range_max=8.0,
                    ranges=np.array(ranges + [1 + tick / 100], dtype=np.float32),
                    intensities=np.zeros(0, dtype=np.float32),
                )
                bag.write("/scan", at_ns, scan)
    return poses


folder = pathlib.Path(sys.argv[1])
robots = json.loads((folder / "states.json").read_text())
write_team(folder / "team", robots)
poses = write_field(folder / "field")
write_field(folder / "old", StoragePlugin.SQLITE3)
write_field(folder / "cut", cut=-9)
(folder / "none").mkdir()
json.dump(poses, sys.stdout)
