// Drives to the goal of the robot in the free direction that is nearest to the direction of the goal: a local method
// that goes around single obstacles, but not out of a dead end.
#include "protean_planner.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace {

constexpr double PI = 3.14159265358979323846;
constexpr int DIRECTIONS = 24;  // that are tried on each side of the direction of the goal

class NearestFree {
    double look_ahead;  // distance for which a direction must be free, or up to the goal if that is nearer (m)
    double margin;      // distance that the robot's body keeps from obstacles (m)
    double arrived;     // distance to the centre of the goal at which the robot stops (m)

public:
    explicit NearestFree(const protean_start &start)
        : look_ahead(protean_number(&start, "look_ahead", 0.8)),
          margin(protean_number(&start, "margin", 0.1)),
          arrived(protean_number(&start, "arrived", 0.05)) {
        if (!(look_ahead > 0.0)) throw std::invalid_argument("`look_ahead` must be a number above 0 (m)");
        if (std::isnan(start.own->goal.x)) throw std::invalid_argument("the robot has no `goal`");
    }

    void steer(const protean_tick &tick, protean_steering &out) {
        const protean_point here = {tick.own->x, tick.own->y}, goal = tick.own->goal;
        const protean_point offset = {goal.x - here.x, goal.y - here.y};
        const double distance = std::sqrt(offset.x * offset.x + offset.y * offset.y);
        if (distance <= arrived) return;
        out.aim = goal;
        const double reach = std::min(look_ahead, distance), toward = protean_angle(&tick, offset);
        const auto ahead = [&](protean_point direction) -> protean_point {
            return {here.x + direction.x * reach, here.y + direction.y * reach};
        };
        for (int step = 0; step <= DIRECTIONS; ++step) {
            for (const int side : {step, -step}) {
                const double angle = toward + side * PI / DIRECTIONS;
                const protean_point target = ahead(protean_direction(&tick, angle));
                if (protean_line_is_clear(&tick, here, target, tick.own->radius + margin)) {
                    return protean_go_to(&tick, target, &out);
                }
            }
        }
        protean_go_to(&tick, ahead(protean_away_from_obstacles(&tick, here)), &out);
    }
};

}  // namespace

PROTEAN_PLANNER(NearestFree, 0)
