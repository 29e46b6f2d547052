"""Decodes every message of logs and bags with `rosbags`, which accepts only what strict ROS 2 programs write.

usage: read_rosbag.py DIRECTORY
Standard output: {log: {topic: number of messages}}.
"""

import collections
import json
import pathlib
import sys

from rosbags.highlevel import AnyReader

counts = {}
folder = pathlib.Path(sys.argv[1])
bags = [file.parent for file in folder.glob("*/metadata.yaml")]
for log in sorted(folder.glob("*.mcap")) + bags:
    count = counts[log.stem] = collections.Counter()
    with AnyReader([log]) as reader:
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
            count[connection.topic] += 1
json.dump(counts, sys.stdout)
