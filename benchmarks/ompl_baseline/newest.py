#!/usr/bin/env python3
"""RRT*, Informed RRT*, BIT* and AORRTC of OMPL 2 in the city, in the form of `main.cpp`.

    newest.py LIBRARY PLANNER QUERY SEED BUDGET_MS

LIBRARY is `city.cpp` compiled. Needs the wheel `ompl` of PyPI, which has no headers. Its planners call
back into Python for collisions: that time does not count, so OMPL's collision test is free of charge.
"""

import ctypes
import os
import sys
import time

from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

PLANNERS = {"RRTstar": og.RRTstar, "InformedRRTstar": og.InformedRRTstar, "BITstar": og.BITstar, "AORRTC": og.AORRTC}
QUERIES = ((-4.5, 7.5, 9.0, 0.0), (-7.5, -7.3, 7.3, 7.5), (1.5, -6.0, -6.0, 4.5))
HALF = 9.5


def main():
    library, name, query, seed, budget = sys.argv[1:]
    is_free = ctypes.CDLL(library).city_is_free
    is_free.argtypes, is_free.restype = [ctypes.c_double] * 4, ctypes.c_bool
    clock = time.process_time_ns
    begin = clock()
    apart = 0  # time in callbacks

    class Validator(ob.MotionValidator):
        def checkMotion(self, a, b, last=None):
            nonlocal apart
            entered = clock()
            free = is_free(a[0], a[1], b[0], b[1])
            apart += clock() - entered
            return free

    def valid(state):
        nonlocal apart
        entered = clock()
        free = is_free(state[0], state[1], state[0], state[1])
        apart += clock() - entered
        return free

    ou.setLogLevel(ou.LOG_WARN)
    ou.RNG.setSeed(int(seed) + 1)  # 0 would mean: none
    space = ob.RealVectorStateSpace(2)
    bounds = ob.RealVectorBounds(2)
    bounds.setLow(-HALF)
    bounds.setHigh(HALF)
    space.setBounds(bounds)
    information = ob.SpaceInformation(space)
    information.setStateValidityChecker(valid)
    validator = Validator(information)
    information.setMotionValidator(validator)
    information.setup()
    start, goal = space.allocState(), space.allocState()
    start[0], start[1], goal[0], goal[1] = QUERIES[int(query)]
    problem = ob.ProblemDefinition(information)
    problem.setStartAndGoalStates(start, goal)
    problem.setOptimizationObjective(ob.PathLengthOptimizationObjective(information))
    planner = PLANNERS[name](information)
    planner.setProblemDefinition(problem)
    planner.setup()

    best = float("inf")

    def over():
        """Called in every iteration: notes an improvement, and whether the budget is used up."""
        nonlocal best, apart
        entered = clock()
        spent = 1e-6 * (entered - begin - apart)
        cost = planner.bestCost().value()
        if cost < best:
            best = cost
            print(f"{name}2,{query},{seed},{spent:.4f},{best:.9f}")
        apart += clock() - entered
        return spent > float(budget)

    apart, begin = 0, clock()
    planner.solve(ob.PlannerTerminationCondition(over))
    # Without the binding's clean-up, which reports leaks.
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
