"""Writes a small log with lz4 chunks, as other programs do, and prints how many messages it has.

usage: write_lz4.py LOG
"""

import json
import sys

from mcap.writer import CompressionType, Writer

COUNT = 2000

with open(sys.argv[1], "wb") as log:
    writer = Writer(log, chunk_size=4096, compression=CompressionType.LZ4)
    writer.start(profile="", library="python")
    schema = writer.register_schema(
        name="pkg/msg/Count", encoding="ros2msg", data=b"uint64 number"
    )
    channel = writer.register_channel(
        topic="/count", message_encoding="cdr", schema_id=schema
    )
    for number in range(COUNT):
        writer.add_message(
            channel_id=channel,
            log_time=1_000_000 * number,
            publish_time=0,
            sequence=number,
            data=bytes([0, 1, 0, 0]) + number.to_bytes(8, "little"),
        )
    writer.finish()
print(json.dumps({"messages": COUNT}))
