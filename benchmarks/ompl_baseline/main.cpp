// RRT* and Informed RRT* of OMPL in the city of the chasing game, as a baseline for Protean.
//
//   ompl_baseline PLANNER QUERY SEED BUDGET_MS
//
// PLANNER is RRTstar or InformedRRTstar, QUERY 0 … 2. One line per improvement of the solution:
// planner,query,seed,cpu_ms,cost. CPU time of the process from the call of solve() on, in
// milliseconds; cost is the length in metres. One process per seed: OMPL takes its seed only once.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace {

// Same world, robot and rule as examples/planner_quality.rs of evader_rrt_star: the disc may touch.
constexpr double kRadius = 0.105;
constexpr double kHalf = 9.5;
constexpr double kTouching = 1e-9;
constexpr double kQueries[3][4] = {
    {-4.5, 7.5, 9.0, 0.0}, {-7.5, -7.3, 7.3, 7.5}, {1.5, -6.0, -6.0, 4.5}};

struct Point {
    double x, y;
};

struct Piece {
    std::vector<Point> corners;  // counter-clockwise
    double min_x, min_y, max_x, max_y;
};

Piece piece(std::vector<Point> corners) {
    Piece p{std::move(corners), 1e9, 1e9, -1e9, -1e9};
    for (const Point &c : p.corners) {
        p.min_x = std::min(p.min_x, c.x);
        p.min_y = std::min(p.min_y, c.y);
        p.max_x = std::max(p.max_x, c.x);
        p.max_y = std::max(p.max_y, c.y);
    }
    return p;
}

Piece box(double x0, double y0, double x1, double y1) {
    return piece({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

std::vector<Piece> city() {
    std::vector<Piece> pieces;
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
            pieces.push_back(box(3.0 * i - 1, 3.0 * j - 1, 3.0 * i + 1, 3.0 * j + 1));
    pieces.push_back(box(-9, -9, -8, 9));
    pieces.push_back(box(-9, -9, 9, -8));
    pieces.push_back(box(-9, 8, 9, 9));
    pieces.push_back(box(8, -8.75, 9, -1.25));
    pieces.push_back(box(8, 1.25, 9, 8.75));
    pieces.push_back(piece({{-8, -8}, {-7.5, -8}, {-8, -7.5}}));
    pieces.push_back(piece({{8, -8}, {8, -7.5}, {7.5, -8}}));
    pieces.push_back(piece({{8, 8}, {7.5, 8}, {8, 7.5}}));
    pieces.push_back(piece({{-8, 8}, {-8, 7.5}, {-7.5, 8}}));
    return pieces;
}

double squared(double dx, double dy) { return dx * dx + dy * dy; }

double pointSegment(Point p, Point a, Point b) {
    const double dx = b.x - a.x, dy = b.y - a.y, length = squared(dx, dy);
    double t = length > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length : 0;
    t = std::clamp(t, 0.0, 1.0);
    return squared(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

double cross(Point o, Point a, Point b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

bool contains(const Piece &piece, Point p) {
    const std::size_t n = piece.corners.size();
    for (std::size_t i = 0; i < n; ++i)
        if (cross(piece.corners[i], piece.corners[(i + 1) % n], p) < 0) return false;
    return true;
}

class World {
public:
    World() : pieces_(city()) {}

    bool isFree(Point a, Point b) const {
        // The edge of the world is a wall.
        const double most = kHalf - kRadius + kTouching;
        for (double c : {a.x, a.y, b.x, b.y})
            if (std::abs(c) > most) return false;
        const double least = (kRadius - kTouching) * (kRadius - kTouching);
        const double x0 = std::min(a.x, b.x) - kRadius, x1 = std::max(a.x, b.x) + kRadius;
        const double y0 = std::min(a.y, b.y) - kRadius, y1 = std::max(a.y, b.y) + kRadius;
        for (const Piece &piece : pieces_) {
            if (piece.max_x < x0 || piece.min_x > x1 || piece.max_y < y0 || piece.min_y > y1)
                continue;
            if (contains(piece, a)) return false;
            const std::size_t n = piece.corners.size();
            for (std::size_t i = 0; i < n; ++i) {
                const Point c = piece.corners[i], d = piece.corners[(i + 1) % n];
                const bool crosses = cross(a, b, c) * cross(a, b, d) < 0 &&
                                     cross(c, d, a) * cross(c, d, b) < 0;
                if (crosses) return false;
                const double distance =
                    std::min(std::min(pointSegment(a, c, d), pointSegment(b, c, d)),
                             std::min(pointSegment(c, a, b), pointSegment(d, a, b)));
                if (distance < least) return false;
            }
        }
        return true;
    }

private:
    std::vector<Piece> pieces_;
};

Point point(const ob::State *state) {
    const auto *values = state->as<ob::RealVectorStateSpace::StateType>()->values;
    return {values[0], values[1]};
}

class Validator : public ob::MotionValidator {
public:
    Validator(const ob::SpaceInformationPtr &si, const World &world)
        : ob::MotionValidator(si), world_(world) {}

    bool checkMotion(const ob::State *a, const ob::State *b) const override {
        return world_.isFree(point(a), point(b));
    }

    bool checkMotion(const ob::State *a, const ob::State *b,
                     std::pair<ob::State *, double> &last) const override {
        const bool is_free = checkMotion(a, b);
        if (!is_free) {
            last.second = 0.0;
            if (last.first != nullptr) si_->copyState(last.first, a);
        }
        return is_free;
    }

private:
    const World &world_;
};

double cpuMs() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec * 1e3 + time.tv_nsec * 1e-6;
}

}  // namespace

int main(int argc, char **argv) {
    const std::string name = argc > 1 ? argv[1] : "";
    const int query = argc > 2 ? std::atoi(argv[2]) : -1;
    const unsigned seed = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 0;
    const double budget = argc > 4 ? std::atof(argv[4]) : 0.0;
    const bool is_known = name == "RRTstar" || name == "InformedRRTstar";
    if (argc != 5 || !is_known || query < 0 || query > 2 || !(budget > 0)) {
        std::fprintf(stderr, "usage: %s RRTstar|InformedRRTstar 0|1|2 SEED BUDGET_MS\n", argv[0]);
        return 2;
    }
    ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
    ompl::RNG::setSeed(seed + 1);  // 0 would mean: none

    const World world;
    auto space = std::make_shared<ob::RealVectorStateSpace>(2);
    space->setBounds(-kHalf, kHalf);
    auto si = std::make_shared<ob::SpaceInformation>(space);
    si->setStateValidityChecker(
        [&](const ob::State *state) { return world.isFree(point(state), point(state)); });
    si->setMotionValidator(std::make_shared<Validator>(si, world));
    si->setup();

    ob::ScopedState<ob::RealVectorStateSpace> start(space), goal(space);
    start[0] = kQueries[query][0], start[1] = kQueries[query][1];
    goal[0] = kQueries[query][2], goal[1] = kQueries[query][3];
    auto problem = std::make_shared<ob::ProblemDefinition>(si);
    problem->setStartAndGoalStates(start, goal);
    problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si));

    ob::PlannerPtr planner;
    if (name == "RRTstar")
        planner = std::make_shared<og::RRTstar>(si);
    else
        planner = std::make_shared<og::InformedRRTstar>(si);
    planner->setProblemDefinition(problem);
    planner->setup();

    double begin = 0, best = std::numeric_limits<double>::infinity();
    problem->setIntermediateSolutionCallback(
        [&](const ob::Planner *, const std::vector<const ob::State *> &, const ob::Cost cost) {
            if (cost.value() >= best) return;
            best = cost.value();
            std::printf("%s,%d,%u,%.4f,%.9f\n", name.c_str(), query, seed, cpuMs() - begin, best);
        });
    begin = cpuMs();
    planner->solve(ob::PlannerTerminationCondition([&] { return cpuMs() - begin > budget; }));
    return 0;
}
