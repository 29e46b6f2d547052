"""Decodes every message of logs with `rosbags`, which accepts only what strict ROS 2 programs write.

usage: read_rosbag.py DIRECTORY
Standard output: {log: {topic: number of messages}}.
"""

import collections
import json
import pathlib
import sys

from rosbags.highlevel import AnyReader

counts = {}
for log in sorted(pathlib.Path(sys.argv[1]).glob("*.mcap")):
    count = counts[log.stem] = collections.Counter()
    with AnyReader([log]) as reader:
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
            count[connection.topic] += 1
json.dump(counts, sys.stdout)
