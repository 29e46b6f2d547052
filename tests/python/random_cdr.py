"""Compares `protean cat` with `rosbags` and `mcap-ros2-support` on random messages of random schemas.

usage: random_cdr.py DIRECTORY

First, DIRECTORY/random.mcap is written, after both packages have decoded its messages to the values that were encoded, and
`rosbags` has refused those that are too long or too short. Standard output: the number of these wrong messages.

With DIRECTORY/cat.jsonl, the output of `protean cat`: a list of the lines that differ from the messages.
"""

import json
import pathlib
import random
import re
import struct
import sys

from mcap.records import Schema
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

FORMATS = {
    "bool": "?", "byte": "B", "char": "B", "uint8": "B", "uint16": "H", "uint32": "I", "uint64": "Q",
    "int8": "b", "int16": "h", "int32": "i", "int64": "q", "float32": "f", "float64": "d",
}  # fmt: skip
BYTES = ("byte", "char", "uint8")
TIME = [("int32", "sec", None), ("uint32", "nanosec", None)]
# Types that neither package reads, and one that `mcap-ros2-support` does not.
WIDE = ("wstring", "wstring<=9")
COMMON = (*FORMATS, "string", "string<=9", "builtin_interfaces/Time")
TEXTS = ("", "a", "hé", "text \U0001f916", '"\\\n')
rng = random.Random(1)


def fields(kinds, depth):
    """Random fields: type (a list of fields for a nested message), name, number of elements."""
    found = []
    for index in range(rng.randint(0 if depth else 1, 5)):
        nested = depth < 3 and rng.random() < 0.3
        kind = fields(kinds, depth + 1) if nested else rng.choice(kinds)
        elements = rng.choice([None, None, rng.randint(1, 3), "[]", "[<=4]"])
        found.append((kind, f"f{index}", elements))
    return found


def definition(members, prefix, sections):
    """The text of the fields; adds the definitions of nested messages to `sections`."""
    text = ""
    for kind, name, elements in members:
        if isinstance(kind, list):
            message = f"{prefix}N{name[1:]}"
            sections.append((message, definition(kind, message, sections)))
            kind = message
        text += f"{kind}{f'[{elements}]' if isinstance(elements, int) else elements or ''} {name}\n"
    return text


def one(kind):
    """A random value of a type."""
    if isinstance(kind, list):
        return {name: some(kind, elements) for kind, name, elements in kind}
    if kind in ("time", "builtin_interfaces/Time"):
        return {"sec": rng.getrandbits(31), "nanosec": rng.getrandbits(32)}
    if "string" in kind:
        return rng.choice(TEXTS)
    if kind.startswith("float"):
        value = rng.choice([400.0, 1e300, 5e-324, -0.0, rng.uniform(-9, 9)])
        return struct.unpack("f", struct.pack("f", rng.uniform(-9, 9)))[0] if kind == "float32" else value
    size = struct.calcsize(FORMATS[kind])
    return struct.unpack(FORMATS[kind], (b"\1" if kind == "bool" else rng.randbytes(size)))[0]


def some(kind, elements):
    if elements is None:
        return one(kind)
    count = elements if isinstance(elements, int) else rng.randint(0, 4)
    values = [one(kind) for _ in range(count)]
    # Not UTF-8: bytes that are printable text are text in `cat`.
    return [0xFF, *values[1:]] if kind in BYTES and values else values


class Encoder:
    def __init__(self, little, unit):
        self.body, self.order, self.unit = bytearray(), "<" if little else ">", unit

    def put(self, form, value):
        self.body += bytes(-len(self.body) % struct.calcsize(form)) + struct.pack(self.order + form, value)

    def one(self, kind, value):
        if isinstance(kind, list) or kind in ("time", "builtin_interfaces/Time"):
            members = kind if isinstance(kind, list) else TIME
            if not members:
                self.put("B", 0)
            for kind, name, elements in members:
                values = [value[name]] if elements is None else value[name]
                if isinstance(elements, str):
                    self.put("I", len(values))
                for element in values:
                    self.one(kind, element)
        elif kind.startswith("wstring"):
            units = value.encode("utf-16-le")
            self.put("I", len(units) // 2)
            for (unit,) in struct.iter_unpack("<H", units):
                self.put(self.unit, unit)
        elif kind.startswith("string"):
            self.put("I", len(value.encode()) + 1)
            self.body += value.encode() + b"\0"
        else:
            self.put(FORMATS[kind], value)


def same(kind, value):
    """A value in one form, from whatever decoded it."""
    if kind in ("time", "builtin_interfaces/Time"):
        kind = TIME
    if isinstance(kind, list):
        get = value.get if isinstance(value, dict) else lambda name: getattr(value, name)
        return {name: each(kind, elements, get(name)) for kind, name, elements in kind}
    if kind == "float32":
        return struct.pack("f", value).hex()
    # `mcap-ros2-support` takes a char for a signed one.
    return int(value) % 256 if kind in BYTES else value if isinstance(value, str) else type(value)(value)


def each(kind, elements, value):
    if elements is None:
        return same(kind, value)
    if kind in BYTES and isinstance(value, str):
        value = bytes.fromhex(value.removeprefix("0x"))
    return [same(kind, element) for element in value]


def text(members, value):
    return json.dumps(same(members, value), default=lambda number: number.item())


def check(store, name, schema, data, expected, members, wide):
    """Both packages agree with the encoder, and refuse what is too long or too short."""
    if wide:
        return
    found = store.deserialize_cdr(data, name)
    assert text(members, found) == expected, (schema.data.decode(), text(members, found), expected)
    if not re.search(rb"^time", schema.data, re.MULTILINE):
        found = DecoderFactory().decoder_for("cdr", schema)(data)
        assert text(members, found) == expected, (schema.data.decode(), text(members, found), expected)


def messages():
    """Schema, fields, data and expected text of each message; no text for wrong ones."""
    for index in range(150):
        wide = index % 5 == 0
        members = fields((*COMMON, *WIDE) if wide else (*COMMON, "time") if index % 5 == 1 else COMMON, 0)
        sections = []
        name = f"p/msg/T{index}"
        own = definition(members, f"T{index}", sections)
        joined = own + "".join(f"{'=' * 80}\nMSG: p/{message}\n{text}" for message, text in sections)
        schema = Schema(id=index + 1, name=name, encoding="ros2msg", data=joined.encode())
        store = get_typestore(Stores.ROS2_HUMBLE)
        if not wide:
            store.register(get_types_from_msg(joined, name))
        for _ in range(3):
            value, little = one(members), rng.random() < 0.7
            encoder = Encoder(little, rng.choice("IH"))
            encoder.one(members, value)
            data = bytes([0, little, 0, 0]) + encoder.body
            expected = text(members, value)
            check(store, name, schema, data + bytes(rng.randint(0, 3)), expected, members, wide)
            yield schema, members, data + bytes(rng.randint(0, 3)), expected
            if wide:
                continue
            for wrong in (data + bytes(rng.randint(4, 40)), data[:-1]):
                try:
                    store.deserialize_cdr(wrong, name)
                except SerdeError:
                    yield schema, members, wrong, None
                else:
                    raise AssertionError((joined, wrong.hex()))


folder = pathlib.Path(sys.argv[1])
printed = folder / "cat.jsonl"
if printed.exists():
    lines = printed.read_text().splitlines()
    differences = []
    for (schema, members, _, expected), line in zip(messages(), lines, strict=True):
        read = json.loads(line)
        if expected is None:
            right = "note" in read
        else:
            right = "message" in read and text(members, read["message"]) == expected
        if not right:
            differences.append(f"{line}, not {expected}: {schema.data.decode()}")
    json.dump(differences, sys.stdout)
else:
    count = 0
    with (folder / "random.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        channels = {}
        for time, (schema, _, data, expected) in enumerate(messages()):
            if schema.name not in channels:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[schema.name] = writer.register_channel(f"/{schema.name}", "cdr", known)
            writer.add_message(channels[schema.name], time, data, time)
            count += expected is None
        writer.finish()
    json.dump(count, sys.stdout)
