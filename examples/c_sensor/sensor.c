/* A sensor of all pursuers: directions to the evaders with noise. */
#include "bearings.h"

#include <stdlib.h>

static void *create(const protean_start *start) {
    double *sigma = malloc(sizeof *sigma);
    *sigma = protean_number(start, "sigma", 0.05);
    return sigma;
}

static void step(void *sensor, const protean_tick *tick) {
    const protean_robot *end = tick->robots + tick->robot_count;
    bearing all[64];
    size_t count = 0;
    for (const protean_robot *a = tick->robots; a != end; ++a)
        for (const protean_robot *b = tick->robots; b != end; ++b) {
            if (a->role != 1 || b->role != 2 || !a->active || !b->active || count == 64) continue;
            const double noise = *(double *)sensor * (protean_random(tick) + protean_random(tick) - 1.0);
            const protean_point to = {b->x - a->x, b->y - a->y};
            all[count++] = (bearing){a->x, a->y, protean_angle(tick, to) + noise, a->index, b->index};
        }
    protean_write(tick, "sonar/bearing", all, count);
}

const protean_planner *protean_planner_table(void) {
    static const protean_planner table = {.version = PROTEAN_PLANNER_VERSION, .create = create, .destroy = free,
                                          .step = step, .writes = &BEARINGS, .write_count = 1};
    return &table;
}
