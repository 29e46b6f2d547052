"""A peer that sends malformed RTPS to all participants of the domain on this machine: random bytes, headers with random submessages,
lengths that are wrong, and old messages again.

usage: ros2_hostile.py (ends when it is killed)
"""

import os
import random
import socket
import struct
import time

# Ports of RTPS 2.5, 9.6.2: discovery and data of the first participants.
first = 7400 + 250 * int(os.environ["ROS_DOMAIN_ID"])
ports = [first, first + 1] + [first + 10 + 2 * participant + kind for participant in range(8) for kind in (0, 1)]
noise = random.Random(1)
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sent = []


def submessage():
    body = noise.randbytes(noise.choice([0, 4, 20, 24, 200]))
    length = noise.choice([len(body), 0, 65535, noise.randrange(65536)])
    kind = noise.choice([0x01, 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E, 0x12, 0x13, 0x15, 0x16, noise.randrange(256)])
    return struct.pack("<BBH", kind, noise.randrange(256), length) + body


def message():
    if sent and noise.random() < 0.2:
        return noise.choice(sent)
    if noise.random() < 0.2:
        return noise.randbytes(noise.randrange(1500))
    header = b"RTPS" + bytes([2, noise.randrange(6)]) + noise.randbytes(2 + 12)
    return header + b"".join(submessage() for _ in range(noise.randrange(1, 6)))


while True:
    for port in ports:
        data = message()
        sent = sent[-100:] + [data]
        out.sendto(data, ("127.0.0.1", port))
    time.sleep(0.001)
