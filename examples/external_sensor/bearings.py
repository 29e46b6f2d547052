"""A sensor that measures bearings without distances, a tracker that finds positions from them, and a planner that drives there."""

import numpy as np
import protean_robotics as pr

BEARING = [("x", "f8"), ("y", "f8"), ("angle", "f8"), ("sensor", "u4"), ("robot", "u4")]
TRACK = [("x", "f8"), ("y", "f8"), ("robot", "u4"), ("reserved", "u4")]


@pr.process(writes={"sonar/bearing": pr.Output(BEARING, drawing={"x": "x", "y": "y", "angle": "angle"})})
def sensor(world, rng):
    pairs = [(a, b) for a in world.robots for b in world.robots if a.role == "pursuer" and b.role == "evader"]
    direction = {(a, b): np.arctan2(b.y - a.y, b.x - a.x) + rng.normal(scale=0.05) for a, b in pairs}
    return [(a.x, a.y, direction[a, b], a.index, b.index) for a, b in pairs if a.active and b.active]


@pr.process(reads=["sonar/bearing"], writes={"sonar/track": pr.Output(TRACK, drawing={"x": "x", "y": "y"})})
class tracker:
    def __init__(self):
        self.known = {}

    def __call__(self, inputs):
        self.known = {robot: (0.8 * a, 0.8 * b) for robot, (a, b) in self.known.items()}
        for line in np.concatenate([message.elements for message in inputs["sonar/bearing"]]):
            normal = np.array([-np.sin(line["angle"]), np.cos(line["angle"])])
            a, b = self.known.get(line["robot"], (np.zeros((2, 2)), np.zeros(2)))
            self.known[line["robot"]] = (a + np.outer(normal, normal), b + normal * (normal @ [line["x"], line["y"]]))
        solved = {robot: np.linalg.solve(a, b) for robot, (a, b) in self.known.items() if np.linalg.cond(a) < 1e6}
        return [(*place, robot, 0) for robot, place in solved.items()]


@pr.planner(reads=["sonar/track"])
def chaser(robot, inputs):
    tracks = inputs["sonar/track"][0].elements
    return pr.go_to(robot, (tracks["x"][0], tracks["y"][0])) if len(tracks) else (0.0, 0.0)


if __name__ == "__main__":
    pr.serve(sensor, tracker, chaser)
