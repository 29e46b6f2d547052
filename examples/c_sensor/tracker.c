/* A tracker: the point with the least squared distances to the lines of the bearings, of which old ones count less. */
#include "bearings.h"

#include <stdlib.h>

#define ROBOTS 16

/* Sums of a robot: the matrix (xx, xy; xy, yy) and the right side of its equations. */
typedef struct sums { double xx, xy, yy, x, y; } sums;

static void *create(const protean_start *start) {
    (void)start;
    return calloc(ROBOTS, sizeof(sums));
}

static void step(void *tracker, const protean_tick *tick) {
    const protean_messages heard = protean_read(tick, "sonar/bearing");
    sums *of = tracker;
    track found[ROBOTS];
    size_t count = 0;
    for (sums *s = of; s != of + ROBOTS; ++s) *s = (sums){0.8 * s->xx, 0.8 * s->xy, 0.8 * s->yy, 0.8 * s->x, 0.8 * s->y};
    for (const protean_message *message = heard.all; message != heard.all + heard.count; ++message) {
        const bearing *lines = message->elements;
        for (const bearing *line = lines; line != lines + message->count; ++line) {
            const protean_point along = protean_direction(tick, line->angle), normal = {-along.y, along.x};
            const double shift = normal.x * line->x + normal.y * line->y;
            if (line->robot >= ROBOTS) continue;
            sums *s = of + line->robot;
            s->xx += normal.x * normal.x, s->xy += normal.x * normal.y, s->yy += normal.y * normal.y;
            s->x += normal.x * shift, s->y += normal.y * shift;
        }
    }
    for (uint32_t robot = 0; robot < ROBOTS; ++robot) {
        const sums s = of[robot];
        const double determinant = s.xx * s.yy - s.xy * s.xy;
        if (determinant < 1e-3) continue; /* lines that hardly cross */
        found[count++] = (track){(s.yy * s.x - s.xy * s.y) / determinant, (s.xx * s.y - s.xy * s.x) / determinant, robot, 0};
    }
    protean_write(tick, "sonar/track", found, count);
}

const protean_planner *protean_planner_table(void) {
    static const protean_planner table = {.version = PROTEAN_PLANNER_VERSION, .create = create, .destroy = free,
                                          .step = step, .reads = &BEARINGS, .read_count = 1, .writes = &TRACKS, .write_count = 1};
    return &table;
}
