/* Checks all that a library gets and all that it can call; the parameter `mode` selects a fault. */
#include "protean_planner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(condition)               \
    do {                                \
        if (!(condition)) return fault(#condition); \
    } while (0)

typedef struct probe {
    int mode;
    uint64_t seed;
} probe;

static int living = 0;
static const char *first_fault = NULL;

int living_planners(void) {
    return living;
}

static bool fault(const char *condition) {
    first_fault = condition;
    return false;
}

static bool near(double a, double b) {
    return fabs(a - b) < 1e-6;
}

static bool check_start(const protean_start *start) {
    EXPECT(start->robot_count == 3 && start->own == start->robots + 1);
    EXPECT(strcmp(start->own->name, "thief") == 0 && strcmp(start->own->team, "evader") == 0);
    EXPECT(start->own->index == 1 && start->own->role == 2 && start->own->side == PROTEAN_TEAM);
    EXPECT(start->own->x == 1.0 && start->own->y == 1.0 && start->own->theta == 0.5);
    EXPECT(start->own->radius == 0.105 && start->own->v_max == 0.22 && start->own->omega_max == 2.84);
    EXPECT(start->robots[0].side == PROTEAN_OPPONENT && start->robots[0].role == 1);
    EXPECT(isnan(start->robots[0].goal.x) && near(start->robots[2].goal.x, 3.0));
    EXPECT(start->robots[2].side == PROTEAN_OTHER && start->robots[2].role == 0);
    EXPECT(start->exit_count == 1 && near(start->exits[0].x, 3.5));
    EXPECT(start->capture_radius == 0.25 && near(start->dt, 0.05) && start->seed == 7);
    return true;
}

static void *create(const protean_start *start) {
    const int mode = (int)protean_number(start, "mode", 0.0);
    if (!check_start(start)) {
        protean_refuse(start, first_fault);
        return NULL;
    }
    if (protean_number(start, "truth", 0.0) == 1.0) protean_refuse(start, protean_params(start));
    if (mode == 1) return NULL;
    probe *planner = malloc(sizeof *planner);
    planner->mode = mode;
    planner->seed = start->seed;
    ++living;
    return planner;
}

static bool check_tick(const protean_tick *tick) {
    const protean_point here = {tick->own->x, tick->own->y}, wall = {2.0, 1.0}, beyond = {3.0, 1.0};
    protean_point points[64];
    EXPECT(near(tick->time, 1.5) && near(tick->dt, 0.05) && tick->map_revision == 4);
    EXPECT(tick->own->x == 1.2 && tick->own->v == 0.1 && tick->own->active && tick->own->present);
    EXPECT(!tick->robots[0].active && tick->robots[0].x == 3.5 && tick->robot_count == 3);
    EXPECT(tick->exit_count == 1 && near(tick->exits[0].x, 3.5));
    EXPECT(tick->belief_count == 2 && tick->beliefs[0].robot == 0 && tick->beliefs[1].robot == 2);
    EXPECT(tick->beliefs[0].particle_count == 1 && tick->beliefs[1].particle_count == 2);
    EXPECT(tick->beliefs[1].particles[1].x == 3.0f && tick->beliefs[1].particles[1].weight == 0.5f);
    EXPECT(tick->beliefs[0].seen && !tick->beliefs[1].seen && tick->beliefs[1].position_std == 0.5);
    EXPECT(tick->scan && tick->scan->range_count == 2 && tick->scan->ranges[1] == 2.5f);
    EXPECT(near(tick->scan->angle_min, -0.1) && near(tick->scan->range_max, 3.5));
    EXPECT(protean_clearance(tick, here) > 0.3 && protean_clearance(tick, wall) < 0.1);
    EXPECT(!protean_line_is_clear(tick, here, beyond, 0.1) && protean_free_run(tick, here, beyond, 0.1) > 0.2);
    EXPECT(protean_away_from_obstacles(tick, here).x < -0.9);
    const size_t count = protean_way(tick, beyond, 0.02, points, 64);
    EXPECT(count > 2 && count < 64 && near(points[count - 1].x, 3.0) && near(points[count - 1].y, 1.0));
    points[1].x = 77.0;
    EXPECT(protean_way(tick, beyond, 0.02, points, 1) == count && points[1].x == 77.0);
    EXPECT(protean_way(tick, beyond, 0.02, NULL, 9) == count && protean_way(tick, wall, 0.0, points, 64) == 0);
    protean_point nowhere = {NAN, 0.0};
    EXPECT(protean_way(tick, nowhere, 0.0, points, 64) == 0 && protean_clearance(tick, nowhere) == 0.0);
    EXPECT(near(protean_direction(tick, 0.3).y, sin(0.3)) && near(protean_angle(tick, protean_direction(tick, -2.0)), -2.0));
    const double a = protean_random(tick), b = protean_random(tick);
    EXPECT(a != b && a >= 0.0 && a < 1.0 && b >= 0.0 && b < 1.0);
    return true;
}

static void steer(void *data, const protean_tick *tick, protean_steering *out) {
    const probe *planner = data;
    if (!check_tick(tick)) {
        protean_fail(tick, first_fault);
        return;
    }
    if (out->v != 0.0 || out->omega != 0.0 || !isnan(out->aim.x) || out->target != PROTEAN_NO_ROBOT) {
        protean_fail(tick, "the steering is no stop at the call");
        return;
    }
    switch (planner->mode) {
    case 2:
        out->v = NAN;
        return;
    case 3:
        out->v = 1e9;
        out->omega = -1e9;
        return;
    case 4:
        protean_fail(tick, "no fuel");
        return;
    case 5:
        out->v = protean_random(tick);
        return;
    default:
        protean_go_to(tick, tick->exits[0], out);
        out->aim = tick->exits[0];
        out->target = 2;
    }
}

static void destroy(void *planner) {
    --living;
    free(planner);
}

const protean_planner *protean_planner_table(void) {
    static const protean_planner table = {.version = PROTEAN_PLANNER_VERSION, .inputs = PROTEAN_BELIEFS | PROTEAN_SCANS | PROTEAN_WAYS,
                                          .create = create, .steer = steer, .destroy = destroy};
    return &table;
}
