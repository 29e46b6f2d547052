/* Messages of the example: bearings without distances, and tracks. */
#include "protean_planner.h"

typedef struct bearing { double x, y, angle; uint32_t sensor, robot; } bearing;
typedef struct track { double x, y; uint32_t robot, reserved; } track;

static const protean_field BEARING[] = {
    PROTEAN_FIELD(bearing, x, "float64"),     PROTEAN_FIELD(bearing, y, "float64"),
    PROTEAN_FIELD(bearing, angle, "float64"), PROTEAN_FIELD(bearing, sensor, "uint32"),
    PROTEAN_FIELD(bearing, robot, "uint32"),
};
static const protean_topic BEARINGS = {
    "sonar/bearing", PROTEAN_ELEMENTS(bearing, BEARING), .capacity = 64, .drawing = "x=x y=y angle=angle"};

static const protean_field TRACK[] = {
    PROTEAN_FIELD(track, x, "float64"),    PROTEAN_FIELD(track, y, "float64"),
    PROTEAN_FIELD(track, robot, "uint32"), PROTEAN_FIELD(track, reserved, "uint32"),
};
static const protean_topic TRACKS = {"sonar/track", PROTEAN_ELEMENTS(track, TRACK), .capacity = 16, .drawing = "x=x y=y"};
