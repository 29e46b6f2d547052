/* A planner that drives to the first track. */
#include "bearings.h"

static void *create(const protean_start *start) {
    static char chaser;
    (void)start;
    return &chaser;
}
static void destroy(void *chaser) { (void)chaser; }

static void steer(void *chaser, const protean_tick *tick, protean_steering *out) {
    const protean_messages heard = protean_read(tick, "sonar/track");
    (void)chaser;
    if (heard.count == 0 || heard.all->count == 0) return;
    const track *first = heard.all->elements;
    protean_go_to(tick, (protean_point){first->x, first->y}, out);
    out->target = first->robot;
}

const protean_planner *protean_planner_table(void) {
    static const protean_planner table = {.version = PROTEAN_PLANNER_VERSION, .create = create, .destroy = destroy,
                                          .steer = steer, .reads = &TRACKS, .read_count = 1};
    return &table;
}
