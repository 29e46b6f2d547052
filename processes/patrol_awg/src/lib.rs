//! Patrols along a zig-zag of additional waypoints.
