"""A robot as nodes of ROS 2 know it: it drives by `/robot/cmd_vel`, late and inexactly, and sends its odometry at 50 Hz.

usage: ros2_robot.py LIMIT

LIMIT: path length (m) from which on it sends no odometry. It ends when it is told to stop after that, or after 60 s, and prints its
path length then and later, as JSON.
"""

import collections
import json
import math
import random
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

PERIOD, DELAY = 0.02, 0.04
limit = float(sys.argv[1])
rclpy.init()
node = rclpy.create_node("robot")
out = node.create_publisher(Odometry, "/robot/odom", 10)
noise = random.Random(1)
x = y = 0.5
theta = way = 0.0
twist = Twist()
commands = collections.deque()
begin = time.monotonic()


def hear(command):
    commands.append((time.monotonic() + DELAY, command))


def move():
    global x, y, theta, way, twist
    now = time.monotonic()
    while commands and commands[0][0] <= now:
        twist = commands.popleft()[1]
    v = twist.linear.x * (1 + noise.gauss(0, 0.02))
    omega = twist.angular.z * (1 + noise.gauss(0, 0.02))
    x += v * PERIOD * math.cos(theta)
    y += v * PERIOD * math.sin(theta)
    theta += omega * PERIOD
    way += abs(v) * PERIOD
    if way < limit:
        odometry = Odometry()
        odometry.header.frame_id, odometry.child_frame_id = "odom", "base_link"
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = x, y
        odometry.pose.pose.orientation.z = math.sin(theta / 2)
        odometry.pose.pose.orientation.w = math.cos(theta / 2)
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = v, omega
        out.publish(odometry)
    elif twist == Twist() or now > begin + 60:
        json.dump({"limit": limit, "way": way, "stopped": twist == Twist()}, sys.stdout)
        sys.stdout.flush()
        sys.exit()


node.create_subscription(Twist, "/robot/cmd_vel", hear, 10)
node.create_timer(PERIOD, move)
try:
    rclpy.spin(node)
except rclpy.executors.ExternalShutdownException:
    pass
