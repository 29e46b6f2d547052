"""Drives the robot to its goal along the shortest way."""

import protean_robotics as pr


@pr.planner
def steer(robot: pr.Robot, world: pr.World, map: pr.Map) -> tuple[float, float]:
    return pr.go_to(robot, map.path(robot, robot.goal))


if __name__ == "__main__":
    pr.serve(steer)
