"""Prints what a node receives of a run until the event with these words, as JSON.

usage: ros2_watcher.py EVADER OTHER WORDS

EVADER: the robot without a namespace. OTHER: a robot that plans.
"""

import json
import sys

import rclpy
from geometry_msgs.msg import PoseArray
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_rosout_default

evader, other, words = sys.argv[1:]
rclpy.init()
node = rclpy.create_node("watcher")
seen = {"frames": set(), "others": set(), "plans": 0, "beliefs": 0, "maps": [], "lines": []}
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def read(message):
    if message.name == "world":
        seen["lines"].append(message.msg)
        if words in message.msg:
            json.dump({key: sorted(value) if isinstance(value, set) else value for key, value in seen.items()}, sys.stdout)
            sys.stdout.flush()
            sys.exit()


def count(key, length):
    seen[key] = max(seen[key], length)


node.create_subscription(Odometry, "/odom", lambda m: seen["frames"].add((m.header.frame_id, m.child_frame_id)), 10)
node.create_subscription(Odometry, f"/{other}/odom", lambda m: seen["others"].add(m.child_frame_id), 10)
node.create_subscription(Path, f"/{other}/plan", lambda m: count("plans", len(m.poses)), 10)
node.create_subscription(PoseArray, f"/belief/{evader}", lambda m: count("beliefs", len(m.poses)), 10)
node.create_subscription(OccupancyGrid, "/map", lambda m: seen["maps"].append([m.info.width, m.info.height]), latched)
node.create_subscription(Log, "/rosout", read, qos_profile_rosout_default)
rclpy.spin(node)
