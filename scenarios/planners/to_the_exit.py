#!/usr/bin/env python3
"""A planner in Python: turns its robot to the nearest exit and drives.

What every planner of one's own does, in any language that iceoryx2 speaks:
  1. read the configuration whose path is in PROTEAN_CONFIG;
  2. join the run's iceoryx2 domain (root path and prefix are in the configuration);
  3. open its topics, then say "ready" with the event run/done;
  4. at every turn (event run/turn with its index): read, think, publish, answer with run/done;
  5. end when the id index + 64 comes (it is killed if the orchestrator ends without that).

Needs: pip install iceoryx2==0.10.0, and protean_messages.py beside this file
(protean schema messages > protean_messages.py).
"""
import ctypes
import json
import math
import os
import sys
import tempfile
import time

import iceoryx2 as iox2

import protean_messages as messages

END_OF_TURNS = 64

with open(os.environ["PROTEAN_CONFIG"]) as file:
    config = json.load(file)
run, index = config["run"], config["index"]
exits = [next(iter(region.values()))["center"] for region in run["exits"]]

# iceoryx2 takes root path and prefix from a file only.
with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
    file.write(f'[global]\nroot-path = "{run["root"]}"\nprefix = "{run["prefix"]}"\n')
    file.flush()
    domain = iox2.config.from_file(iox2.FilePath.new(file.name))
iox2.set_log_level(iox2.LogLevel.Error)
node = (
    iox2.NodeBuilder.new()
    .config(domain)
    .signal_handling_mode(iox2.SignalHandlingMode.Disabled)
    .create(iox2.ServiceType.Ipc)
)


def open_topic(topic):
    name = iox2.ServiceName.new(topic.NAME)
    builder = node.service_builder(name).publish_subscribe(iox2.Slice[topic.ELEMENT])
    return builder.user_header(topic.HEADER).open()


def open_event(name):
    return node.service_builder(iox2.ServiceName.new(name)).event().open()


states = open_topic(messages.WorldStateTopic).subscriber_builder().create()
commands = open_topic(messages.RobotCommandTopic).publisher_builder().initial_max_slice_len(1).create()
turns = open_event("run/turn").listener_builder().create()
done = open_event("run/done").notifier_builder().create()
answer = iox2.EventId.new(index)
sequence = 0


def newest_state():
    newest = None
    while (sample := states.receive()) is not None:
        header = sample.user_header().contents
        robots = [robot for robot in sample.payload()]
        copy = messages.WorldHeader.from_buffer_copy(header)
        newest = copy, [messages.RobotState.from_buffer_copy(robot) for robot in robots]
    return newest


def steer(robot, limits):
    gx, gy = min(exits, key=lambda e: math.hypot(e[0] - robot.x, e[1] - robot.y))
    error = math.remainder(math.atan2(gy - robot.y, gx - robot.x) - robot.theta, 2 * math.pi)
    omega = max(-limits["omega_max"], min(limits["omega_max"], 3.0 * error))
    return limits["v_max"] * max(0.0, math.cos(error)), omega


def publish(state, received_ns, robot_index, v, omega):
    global sequence
    sample = commands.loan_slice_uninit(1)
    header = sample.user_header().contents
    ctypes.memset(ctypes.addressof(header), 0, ctypes.sizeof(header))
    header.stamp.tick = state.stamp.tick
    header.stamp.time_ns = state.stamp.time_ns
    header.stamp.sequence = sequence
    header.stamp.source = index
    header.stamp.origin_ns = state.stamp.origin_ns
    sequence += 1
    header.stamp.received_ns = received_ns
    header.stamp.computed_ns = time.monotonic_ns()
    header.stamp.sent_ns = time.monotonic_ns()
    sample.payload()[0] = messages.Command(v=v, omega=omega, robot=robot_index)
    sample.assume_init().send()


def wait_for_turn():
    """True for a turn, False at the end of turns."""
    while True:
        try:
            events = turns.timed_wait(iox2.Duration.from_millis(500))
        except iox2.ListenerWaitError as error:
            if "InterruptSignal" not in str(error):
                raise
            continue  # it was stopped and continued
        ids = [event.id.as_value for event in events]
        if index + END_OF_TURNS in ids:
            return False
        if index in ids:
            return True


done.notify_with_custom_event_id(answer)  # the ports are open
if not wait_for_turn():
    sys.exit(0)
commands.update_connections()
newest_state()
done.notify_with_custom_event_id(answer)  # and connected

while wait_for_turn():
    newest = newest_state()
    if newest is not None:
        state, robots = newest
        received_ns = time.monotonic_ns()
        for robot_index in config["robots"]:
            limits = run["robots"][robot_index]["model"]
            publish(state, received_ns, robot_index, *steer(robots[robot_index], limits))
    done.notify_with_custom_event_id(answer)
