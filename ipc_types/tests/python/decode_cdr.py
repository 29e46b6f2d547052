"""Decodes CDR messages with the package mcap-ros2-support and packs every field again.

Standard input, per message: the schema's name, the schema and the message in hexadecimal digits,
then `path type` for every number of the message in order, all separated by tabs.
Standard output, per message: the packed numbers in hexadecimal digits. They must be the bytes that
the message had in shared memory.
"""

import struct
import sys

from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory

FORMATS = {
    "uint8": "B", "uint16": "H", "uint32": "I", "uint64": "Q",
    "int8": "b", "int16": "h", "int32": "i", "int64": "q",
    "float32": "f", "float64": "d",
}


def value(message, path):
    for part in path.split("."):
        name, _, index = part.partition("[")
        if name:
            message = getattr(message, name)
        if index:
            message = message[int(index[:-1])]
    return message


for number, line in enumerate(sys.stdin):
    name, schema, data, *fields = line.rstrip("\n").split("\t")
    # A decoder is cached by the schema's id.
    schema = Schema(id=number + 1, name=name, encoding="ros2msg", data=bytes.fromhex(schema))
    decode = DecoderFactory().decoder_for("cdr", schema)
    message = decode(bytes.fromhex(data))
    packed = b""
    for field in fields:
        path, kind = field.split(" ")
        packed += struct.pack("<" + FORMATS[kind], value(message, path))
    print(packed.hex())
