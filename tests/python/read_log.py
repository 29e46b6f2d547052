"""Reads a whole log with the ecosystem's packages: checksums on, every message decoded by the
schemas in the log and nothing else.

usage: read_log.py LOG.mcap
Standard output: one JSON object, as `History` of tests/support/history.rs, and `transforms`: what
the viewers are told of the robots' places, [log_time, name, x, y].
"""

import json
import struct
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory as Ros2

messages, states, events, commands, beliefs = [], [], [], [], []
sightings, maps, obstacles, transforms, counts, viewer = [], [], [], [], {}, {}


def state(m):
    states.append({
        "tick": m.stamp.tick, "over": m.phase == 1, "map_revision": m.map_revision,
        "robots": [{
            "robot": r.robot, "x": r.x, "y": r.y, "theta": r.theta, "v": r.v, "omega": r.omega,
            "distance": r.distance, "team": r.team, "status": r.status,
            "present": r.present != 0, "fail_safe": r.fail_safe != 0,
        } for r in m.robots],
    })


def world_map(m):
    maps.append({
        "tick": m.stamp.tick, "revision": m.revision, "width": m.width, "height": m.height,
        "occupied": sum(c.occupied for c in m.cells),
    })


def event(m):
    events.extend({
        "tick": m.stamp.tick, "kind": e.kind, "robot": e.robot, "other": e.other,
        "value": e.value, "x": e.x, "y": e.y,
    } for e in m.events)


def obstacle(m):
    fields = ("id", "action", "shape", "x", "y", "theta", "half_x", "half_y")
    obstacles.append({"tick": m.stamp.tick} | {f: getattr(m, f) for f in fields})


def sighting(m):
    sightings.extend({
        "tick": m.stamp.tick, "robot": s.robot, "seen": s.seen != 0, "visibility": s.visibility,
    } for s in m.sightings)


def total(numbers):
    # Not `sum`, which compensates for rounding: the other reader adds up plainly.
    result = 0.0
    for number in numbers:
        result += number
    return result


def belief(m):
    beliefs.append({
        "tick": m.stamp.tick, "robot": m.robot, "seen": m.seen != 0,
        "mean_x": m.mean_x, "mean_y": m.mean_y, "particles": len(m.particles),
        "weight": total(p.weight for p in m.particles),
        "sum_x": total(p.x for p in m.particles), "sum_y": total(p.y for p in m.particles),
    })


def command(m):
    commands.append({
        "tick": m.stamp.tick, "source": m.stamp.source,
        "robot": m.robot, "v": m.v, "omega": m.omega,
    })


TAKE = {
    "world/state": state, "world/map": world_map, "world/event": event,
    "world/obstacle_event": obstacle, "perception/sighting": sighting,
    "perception/belief": belief, "robot/command": command,
}


def see(topic, log_time, m):
    """Asks every message for viewers for what it is made of."""
    kind = topic.split("/")[-1]
    if kind in ("tf", "tf_static"):
        for t in m.transforms:
            at = t.transform.translation
            transforms.append([log_time, t.child_frame_id, at.x, at.y])
    elif kind in ("beliefs", "walls"):
        assert len(m.data) == m.point_step * m.width > 0
        offsets = {f.name: f.offset for f in m.fields}
        struct.unpack_from("<f", m.data, offsets["x"])
    elif kind == "map":
        assert len(m.data) == m.info.width * m.info.height > 0
    elif kind == "rosout":
        assert m.msg
    elif kind == "scan":
        assert len(m.ranges) > 0
    elif kind == "clock":
        assert m.clock.sec * 10**9 + m.clock.nanosec == log_time
    elif kind == "odom":
        assert m.header.frame_id == "map" and m.child_frame_id in topic
    elif kind == "plan":
        assert all(p.header.frame_id == "map" for p in m.poses)
    else:
        assert kind in ("robots", "trails", "plans", "trees", "obstacles", "sight", "fields_of_view", "dominance"), kind
        assert all(marker.header.frame_id == "map" for marker in m.markers)
    viewer[topic] = viewer.get(topic, 0) + 1


with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[Ros2()], validate_crcs=True)
    for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
        count = counts.setdefault(channel.topic, [0, 0])
        count[0] += 1
        count[1] += len(message.data)
        if channel.topic.startswith("/"):
            see(channel.topic, message.log_time, decoded)
            continue
        if channel.topic == "world/robots":
            # The recorder writes it; it has no stamp.
            assert [robot.robot for robot in decoded.robots] == list(range(len(decoded.robots)))
            continue
        stamp = decoded.stamp
        messages.append({
            "topic": channel.topic, "source": stamp.source, "tick": stamp.tick,
            "time_ns": stamp.time_ns, "sequence": stamp.sequence,
            "logged_sequence": message.sequence, "log_time": message.log_time,
            "publish_time": message.publish_time, "sent_ns": stamp.sent_ns,
        })
        TAKE.get(channel.topic, lambda m: None)(decoded)

json.dump({
    "messages": messages, "states": states, "events": events, "commands": commands,
    "beliefs": beliefs, "sightings": sightings, "maps": maps, "obstacles": obstacles,
    "counts": counts, "transforms": transforms,
}, sys.stdout)
