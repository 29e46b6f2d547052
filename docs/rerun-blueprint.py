"""Shows a log in Rerun, from above: walls, robots, beliefs and events. Needs rerun-sdk.

usage: rerun-blueprint.py LOG [--size METRES] [--save FILE.rrd]
"""

import argparse

import rerun as rr
import rerun.blueprint as rrb

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("log")
parser.add_argument("--size", type=float, default=21, help="what to show around the centre of the map [m]")
rr.script_add_args(parser)
args = parser.parse_args()
mission = rrb.Spatial3DView(
    name="mission",
    contents=["/walls", "/beliefs", "/tf"],
    spatial_information=rrb.SpatialInformation("map/centre"),
    eye_controls=rrb.EyeControls3D(position=(0, 0, args.size), look_target=(0, 0, 0), eye_up=(0, 1, 0)),
    overrides={
        "/walls": rr.Points3D.from_fields(colors=0xAAB2BDFF, radii=0.03),
        "/beliefs": rr.Points3D.from_fields(colors=0xCC79A7FF, radii=0.03),
        "/tf": rr.TransformAxes3D(0.5, show_frame=True),
    },
)
events = rrb.TextLogView(name="events", origin="/rosout")
time = rrb.TimePanel(timeline="message_log_time", state="collapsed")
layout = rrb.Blueprint(rrb.Vertical(mission, events, row_shares=[4, 1]), time, collapse_panels=True)
rr.script_setup(args, "protean", default_blueprint=layout)
rr.log_file_from_path(args.log)
rr.script_teardown(args)
