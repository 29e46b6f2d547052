#!/usr/bin/env python3
"""Steps per second of environments for learning on one core, beside other simulators.

usage: python_environments.py [--seconds S] [--instances N ...]

    pip install 'protean-robotics[gym]'                 # or target/wheels/*.whl
    pip install torch vmas jaxmarl mpe2 navground pufferlib   # those that shall be measured, too
    benchmarks/python_environments.py

A step of an instance is one step of all its robots: here four pursuers and two evaders. Actions are random and drawn before
the measurement. The last column says in what a peer differs from ours, which has walls, contacts and eight lines of sight.
"""

import argparse
import os
import time
from collections.abc import Callable

# One core for all, before libraries start their threads.
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["JAX_PLATFORMS"] = "cpu"

import numpy as np
import protean_robotics as pr


def rate(step: Callable[[int], object], instances: int, seconds: float) -> float:
    """Returns the steps of instances per second: the best of three measurements."""
    best = 0.0
    count = 0
    for _ in range(4):
        begin = time.perf_counter()
        done = 0
        while (spent := time.perf_counter() - begin) < seconds / 4:
            for _ in range(16):
                step(count)
                count += 1
            done += 16
        # The first measurement warms up.
        best = max(best, done * instances / spent)
    return best


def draw(envs: pr.VectorEnv) -> np.ndarray:
    """Draws the actions of several steps: the loop in Rust and that in Python play the same games."""
    envs.action_space.seed(1)
    return np.stack([envs.action_space.sample() for _ in range(max(64, 4096 // envs.num_envs))])


def ours(instances: int, seconds: float, scenario: str, agents: list[str], copy: bool) -> float:
    envs = pr.VectorEnv(scenario, instances, agents=agents, seed=1, copy=copy)
    envs.reset()
    actions = draw(envs)
    return rate(lambda k: envs.step(actions[k % len(actions)]), instances, seconds)


def rust(instances: int, seconds: float, scenario: str, agents: list[str], observation: str = "state") -> float:
    """The same instances in a loop in Rust."""
    envs = pr.VectorEnv(scenario, instances, agents=agents, seed=1, observation=observation)
    envs.reset()
    actions = draw(envs)
    return rate(lambda _: envs._instances.core.steps(actions), instances * len(actions), seconds)


def vmas(instances: int, seconds: float) -> float:
    import torch
    from vmas import make_env

    torch.set_num_threads(1)
    env = make_env("simple_tag", num_envs=instances, device="cpu", seed=1, num_good_agents=2, num_adversaries=4)
    env.reset()
    actions = [[env.get_random_action(agent) for agent in env.agents] for _ in range(16)]
    with torch.no_grad():
        return rate(lambda k: env.step(actions[k % 16]), instances, seconds)


def jaxmarl(instances: int, seconds: float) -> float:
    import jax
    from jaxmarl import make

    env = make("MPE_simple_tag_v3", num_good_agents=2, num_adversaries=4)
    keys = jax.random.split(jax.random.PRNGKey(0), instances)
    _, state = jax.vmap(env.reset)(keys)
    unroll = 128
    draws = jax.random.randint(jax.random.PRNGKey(1), (unroll, len(env.agents), instances), 0, env.action_space(env.agents[0]).n)

    @jax.jit
    def run(state: object) -> object:
        """Several steps in one call, as JaxMARL is meant to be used."""

        def body(state: object, draw: object) -> tuple[object, object]:
            actions = dict(zip(env.agents, draw))
            observations, state, rewards, _, _ = jax.vmap(env.step)(keys, state, actions)
            return state, (sum(o.sum() for o in observations.values()), sum(r.sum() for r in rewards.values()))

        return jax.lax.scan(body, state, draws)

    holder = [state]

    def step(_: int) -> None:
        holder[0], sums = run(holder[0])
        jax.block_until_ready(sums)

    return rate(step, instances * unroll, seconds)


def ocean(instances: int, seconds: float) -> float:
    from pufferlib.ocean.target.target import Target

    env = Target(num_envs=instances, num_agents=6)
    env.reset()
    actions = np.random.default_rng(1).integers(env.single_action_space.nvec, size=(64, 6 * instances, 2))
    return rate(lambda k: env.step(actions[k % 64]), instances, seconds)


def navground(behavior: str, seconds: float) -> float:
    """Six robots that cross a room with twelve discs, on and on."""
    from navground import core, sim

    world = sim.World()
    corners = np.array([(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)])
    for begin, end in zip(corners, np.roll(corners, -1, axis=0)):
        world.add_wall(sim.Wall(begin, end))
    for angle in np.arange(12) * np.pi / 6:
        world.add_obstacle(sim.Obstacle((1.5 * np.cos(angle), 1.5 * np.sin(angle)), 0.2))
    for angle in np.arange(6) * np.pi / 3:
        place = 3.0 * np.array([np.cos(angle), np.sin(angle)])
        kinematics = core.Kinematics.make_type("2WDiff")
        kinematics.max_speed, kinematics.wheel_axis = 0.3, 0.2
        mind = core.Behavior.make_type(behavior)
        mind.optimal_speed, mind.safety_margin, mind.horizon = 0.25, 0.05, 5.0
        task = sim.Task.make_type("Waypoints")
        task.waypoints, task.tolerance = [-place, place], 0.2
        sight = sim.StateEstimation.make_type("Bounded")
        sight.range = 5.0
        agent = sim.Agent(0.15, mind, kinematics, task, [sight], 0.05)
        agent.position = place
        world.add_agent(agent)
    return rate(lambda _: world.run(64, 0.05), 64, seconds)


def mpe2(_: int, seconds: float) -> float:
    from mpe2 import simple_tag_v3

    env = simple_tag_v3.parallel_env(num_good=2, num_adversaries=4, max_cycles=1 << 30)
    env.reset(seed=1)
    actions = [{agent: env.action_space(agent).sample() for agent in env.agents} for _ in range(64)]
    return rate(lambda k: env.step(actions[k % 64]), 1, seconds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=4.0, help="time of each measurement")
    parser.add_argument("--instances", type=int, nargs="+", default=[1, 64, 1024])
    arguments = parser.parse_args()
    seconds = arguments.seconds
    everything = ("chase_exact", ["police", "evader"])
    evaders = ("chase_exact", ["evader"])
    head = " ".join(f"{n:>10}" for n in arguments.instances)
    print(f"{'steps of instances per second, one core':52} {head}  differs from ours")
    game = "no walls, no contacts, no sight"
    rows: list[tuple[str, str, Callable[[int], float]]] = [
        ("six robots by the learner: loop in Rust", "", lambda n: rust(n, seconds, *everything)),
        ("six robots by the learner: pr.VectorEnv, copy=False", "", lambda n: ours(n, seconds, *everything, False)),
        ("six robots by the learner: pr.VectorEnv", "", lambda n: ours(n, seconds, *everything, True)),
        ("four built-in Police: loop in Rust", "", lambda n: rust(n, seconds, *evaders)),
        ("the same with state+path", "", lambda n: rust(n, seconds, *evaders, "state+path")),
        ("four built-in Police: pr.VectorEnv, copy=False", "", lambda n: ours(n, seconds, *evaders, False)),
        ("chase: Police and beliefs: pr.VectorEnv, copy=False", "", lambda n: ours(n, seconds, "chase", ["evader"], False)),
        ("pufferlib ocean target, 6 robots", game + ", 24 numbers each", lambda n: ocean(n, seconds)),
        ("jaxmarl MPE_simple_tag_v3, 4 + 2, compiled rollout", "no walls, no sight; never back in Python", lambda n: jaxmarl(n, seconds)),
        ("vmas simple_tag, 4 + 2", "no walls, no sight", lambda n: vmas(n, seconds)),
        ("mpe2 simple_tag_v3, 4 + 2, one instance", "no walls, no sight", lambda n: mpe2(n, seconds)),
    ]
    for behavior in ("Dummy", "ORCA", "HL"):
        measure = lambda _, behavior=behavior: navground(behavior, seconds)
        rows.append((f"navground {behavior}, 6 robots, one world", "no game, no observations; robots steer themselves", measure))
    for name, unlike, measure in rows:
        figures = []
        for instances in arguments.instances:
            try:
                figures.append(f"{measure(instances):10.0f}")
            except ImportError as error:
                figures.append(f"{error.name or error} missing")
                break
        print(f"{name:52} {' '.join(figures)}  {unlike}", flush=True)


if __name__ == "__main__":
    main()
