// RRT* and Informed RRT* of OMPL in the city of the chasing game, as a baseline for Protean.
//
//   ompl_baseline PLANNER QUERY SEED BUDGET_MS
//
// PLANNER is RRTstar or InformedRRTstar, QUERY 0 … 2. One line per improvement of the solution:
// planner,query,seed,cpu_ms,cost. CPU time of the process from the call of solve() on, in
// milliseconds; cost is the length in metres. One process per seed: OMPL takes its seed only once.

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

#include "city.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace {

using city::kHalf;
using city::kQueries;
using city::Point;
using city::World;

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
