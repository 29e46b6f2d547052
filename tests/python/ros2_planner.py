"""A planner as ROS users write them: it keeps the newest odometry of each robot, and a timer of 20 Hz on simulated time sends
all commands. The turning rate tells which odometry it used.

usage: ros2_planner.py MODE ROBOT...

MODE: `timer`; `stamped` (as `timer`, with TwistStamped); `event` (a command for each odometry); `twice` (two commands for each
odometry); `ends` (as `event`, for one second of simulated time).
"""

import sys

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.parameter import Parameter

mode, *robots = sys.argv[1:]
rclpy.init()
simulated = Parameter("use_sim_time", Parameter.Type.BOOL, True)
node = rclpy.create_node("planner", parameter_overrides=[simulated])
kind = TwistStamped if mode == "stamped" else Twist
writers = {robot: node.create_publisher(kind, f"/{robot}/cmd_vel", 10) for robot in robots}
newest = {}


def answer(robot):
    command = kind()
    twist = command.twist if mode == "stamped" else command
    if robot in newest:
        twist.linear.x = 0.5
        twist.angular.z = newest[robot].pose.pose.position.x
    if mode == "stamped":
        command.header.stamp = node.get_clock().now().to_msg()
    writers[robot].publish(command)


def hear(robot, message):
    newest[robot] = message
    if mode == "ends" and message.header.stamp.sec > 0:
        sys.exit()
    if mode not in ("timer", "stamped"):
        for _ in range(2 if mode == "twice" else 1):
            answer(robot)


for robot in robots:
    node.create_subscription(Odometry, f"/{robot}/odom", lambda m, robot=robot: hear(robot, m), 10)
if mode in ("timer", "stamped"):
    node.create_timer(0.05, lambda: [answer(robot) for robot in robots])
try:
    rclpy.spin(node)
except rclpy.executors.ExternalShutdownException:
    pass
