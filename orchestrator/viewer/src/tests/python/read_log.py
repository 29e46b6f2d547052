"""Reads a whole log with the Python packages, verifies checksums and decodes every message.

usage: read_log.py LOG.mcap
Standard output: one line per topic: `topic encoding messages`, then `unsorted N`, then the
particles' x of the first cloud, the names of the robots' frames, and the text of the first event.
"""

import collections
import struct
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory as Ros2

count, last, unsorted_, first = collections.Counter(), {}, 0, {}
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[Ros2()], validate_crcs=True)
    for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
        count[(channel.topic, channel.message_encoding)] += 1
        unsorted_ += message.log_time < last.get(channel.topic, 0)
        last[channel.topic] = message.log_time
        first.setdefault(channel.topic, decoded)
for (topic, encoding), messages in sorted(count.items()):
    print(topic, encoding, messages)
print("unsorted", unsorted_)
cloud = first["/beliefs"]
fields = {field.name: field.offset for field in cloud.fields}
xs = [struct.unpack_from("<f", cloud.data, i + fields["x"])[0]
      for i in range(0, len(cloud.data), cloud.point_step)]
print("particles", len(xs), sum(xs))
print("frames", *[t.child_frame_id for t in first["/tf"].transforms])
print("log", first["/rosout"].msg)
print("markers", *[m.ns for m in first["/robots"].markers if m.ns])
