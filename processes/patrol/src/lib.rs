//! Patrols along a contour: the cat-map zig-zag, fictive obstacles, danger zones.
