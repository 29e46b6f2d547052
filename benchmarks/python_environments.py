#!/usr/bin/env python3
"""Steps per second of environments for learning on one core, beside other simulators.

usage: python_environments.py [--seconds S] [--instances N ...]

    pip install 'protean-robotics[gym]'                 # or target/wheels/*.whl
    pip install torch vmas jaxmarl mpe2                 # those that shall be measured, too
    benchmarks/python_environments.py

A step of an instance is one step of all its robots: here four pursuers and two evaders. Ours has eight lines of sight, the
others none. Actions are random and drawn before the measurement.
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


def rust(instances: int, seconds: float, scenario: str, agents: list[str]) -> float:
    """The same instances in a loop in Rust."""
    envs = pr.VectorEnv(scenario, instances, agents=agents, seed=1)
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

    @jax.jit
    def run(state: object, key: object) -> object:
        """Several steps in one call, as JaxMARL is meant to be used."""

        def body(state: object, key: object) -> tuple[object, object]:
            keys = jax.random.split(key, instances)
            actions = {
                agent: jax.vmap(env.action_space(agent).sample)(keys) for agent in env.agents
            }
            observations, state, rewards, _, _ = jax.vmap(env.step)(keys, state, actions)
            return state, (sum(o.sum() for o in observations.values()), sum(r.sum() for r in rewards.values()))

        return jax.lax.scan(body, state, jax.random.split(key, unroll))

    holder = [state]

    def step(k: int) -> None:
        holder[0], sums = run(holder[0], jax.random.PRNGKey(k))
        jax.block_until_ready(sums)

    return rate(step, instances * unroll, seconds)


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
    print(f"{'steps of instances per second, one core':52} " + " ".join(f"{n:>10}" for n in arguments.instances))
    rows: list[tuple[str, Callable[[int], float]]] = [
        ("six robots by the learner: loop in Rust", lambda n: rust(n, seconds, *everything)),
        ("six robots by the learner: pr.VectorEnv, copy=False", lambda n: ours(n, seconds, *everything, False)),
        ("six robots by the learner: pr.VectorEnv", lambda n: ours(n, seconds, *everything, True)),
        ("four built-in Police: loop in Rust", lambda n: rust(n, seconds, *evaders)),
        ("four built-in Police: pr.VectorEnv, copy=False", lambda n: ours(n, seconds, *evaders, False)),
        ("vmas simple_tag, 4 + 2", lambda n: vmas(n, seconds)),
        ("jaxmarl MPE_simple_tag_v3, 4 + 2, jit", lambda n: jaxmarl(n, seconds)),
        ("mpe2 simple_tag_v3, 4 + 2, one instance", lambda n: mpe2(n, seconds)),
    ]
    for name, measure in rows:
        figures = []
        for instances in arguments.instances:
            try:
                figures.append(f"{measure(instances):10.0f}")
            except ImportError as error:
                figures.append(f"{error.name or error} missing")
                break
        print(f"{name:52} {' '.join(figures)}", flush=True)


if __name__ == "__main__":
    main()
