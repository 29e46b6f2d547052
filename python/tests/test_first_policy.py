"""The tutorial "Your first policy": its game can be learned, its network acts as in training; rewards that pay."""

import ast
import importlib.util
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import protean_robotics as pr
import pytest
from numpy.typing import NDArray

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "examples/first_policy"
Array = NDArray[np.float32]


def games() -> dict[str, dict[str, Any]]:
    """The games of the script, which this test reads without its libraries."""
    body = ast.parse((FOLDER / "train.py").read_text()).body
    (value,) = [node.value for node in body if isinstance(node, ast.AnnAssign) and ast.unparse(node.target) == "GAMES"]
    assert value
    found: dict[str, dict[str, Any]] = ast.literal_eval(value)
    for game in found.values():
        if game["scenario"].endswith(".toml"):
            game["scenario"] = FOLDER / game["scenario"]
    return found


def outcomes(policy: Callable[[Array], Array], game: dict[str, Any], count: int = 24) -> tuple[list[str], list[int]]:
    """Plays as `escapes` of the script does; returns the outcomes and the seeds of the episodes."""
    envs = pr.VectorEnv(num_envs=count, seed=9000, **game)
    observations, _ = envs.reset()
    seeds = [int(seed) for seed in envs.seeds]
    found = [""] * count
    while not all(found):
        observations, _, terminations, truncations, infos = envs.step(policy(observations))
        for i in np.flatnonzero(terminations | truncations):
            found[i] = found[i] or infos["outcome"][i][0]
    return found, seeds


def cross_entropy(game: dict[str, Any], generations: int, candidates: int = 64) -> Callable[[Array], Array]:
    """Learns a linear policy: the mean of the best eighth of random ones, again and again; one instance for each."""
    random = np.random.default_rng(1)
    envs = pr.VectorEnv(num_envs=candidates, seed=1, **game)
    shape = (len(envs.entries[0]) + 1, 2)
    mean, deviation = np.zeros(shape), np.full(shape, 0.1)
    for _ in range(generations):
        weights = mean + deviation * random.standard_normal((candidates, *shape))
        returns = np.zeros(candidates)
        playing = np.ones(candidates, dtype=bool)
        observations, _ = envs.reset()
        while playing.any():
            actions = np.tanh(np.einsum("ce,cea->ca", observations, weights[:, :-1]) + weights[:, -1])
            observations, rewards, terminations, truncations, _ = envs.step(actions.astype(np.float32))
            returns += rewards * playing
            playing &= ~(terminations | truncations)
        best = weights[np.argsort(returns)[-candidates // 8 :]]
        mean, deviation = best.mean(axis=0), best.std(axis=0) + 0.05
    return lambda observations: np.tanh(observations @ mean[:-1] + mean[-1]).astype(np.float32)


@pytest.mark.parametrize("name", games())
def test_a_game_is_one_that_the_environments_take(name: str) -> None:
    envs = pr.VectorEnv(num_envs=2, seed=1, **games()[name])
    observations, _ = envs.reset()
    assert not np.array_equal(observations[0], observations[1]), "starts vary with the seed"
    envs.step(np.zeros((2, 2), dtype=np.float32))


def test_the_first_game_is_learned_in_seconds_also_without_the_libraries() -> None:
    policy = cross_entropy(games()["hello"], generations=6)
    found, _ = outcomes(policy, games()["hello"])
    assert found.count("escaped") >= 23, found


def proposed_rewards() -> list[dict[str, float]]:
    """The weights that the documentation, the package and the tutorial propose."""
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("python/**/*.md")]
    files = [*pages, *ROOT.glob("python/protean_robotics/*.py"), *FOLDER.iterdir()]
    texts = [path.read_text() for path in files if path.suffix in (".md", ".py")]
    literals = re.findall(r"""\breward["']?\s*[:=]\s*(\{["'][^{}]*\})""", "\n".join(texts))
    return [ast.literal_eval(literal) for literal in dict.fromkeys(literals)]


def rewards_of(envs: pr.VectorEnv, act: Callable[[Array], Array]) -> list[float]:
    """Rewards of the first agent in one episode."""
    observations, _ = envs.reset()
    rewards: list[float] = []
    while True:
        observations, reward, terminations, truncations, infos = envs.step(act(observations))
        # That of the first agent of several.
        rewards.append(float(infos["rewards"][0, 0] if "rewards" in infos else reward[0]))
        if terminations[0] or truncations[0]:
            return rewards


@pytest.mark.parametrize("reward", proposed_rewards(), ids=str)
def test_a_proposed_reward_pays_for_its_purpose(reward: dict[str, float]) -> None:
    hello: dict[str, Any] = {**games()["hello"], "reward": reward, "seed": 1}
    envs = pr.VectorEnv(num_envs=1, **hello)
    ahead, left = (envs.entries[0].index(f"path.bearing_{name}") for name in ("cos", "sin"))

    def along_the_way(observations: Array) -> Array:
        return np.stack([observations[:, ahead].clip(0.0), observations[:, left]], axis=1)

    def stop(observations: Array) -> Array:
        return np.zeros(envs.action_space.shape, dtype=np.float32)

    # To arrive pays more than to stop anywhere on the way, even if stopping cost nothing.
    sums = np.cumsum(rewards_of(envs, along_the_way))
    assert sums[-1] > max(0.0, sums[:-1].max()) + 0.3
    assert sums[-1] > sum(rewards_of(envs, stop)) + 0.3
    # To hold out until the end of time pays more than to be caught at once.
    near = {"robots.evader_1.start": {"x": 7.5, "y": 4.2, "theta": 0.0}}
    every = ["evader_1", "evader_2", "police"]
    chase: dict[str, Any] = {"ticks_per_action": 100, "reward": reward, "seed": 1}

    def stay(observations: Array) -> Array:
        return np.zeros((1, 6, 2), dtype=np.float32)

    caught, held = (
        sum(rewards_of(pr.VectorEnv("chase_exact", agents=every, set=start, **chase), stay)) for start in (near, None)
    )
    assert held > caught + 0.3


def test_the_weights_of_documented_examples_are_found() -> None:
    assert {"progress": 0.5} in proposed_rewards()


def test_the_page_has_the_script_and_the_printed_outcome() -> None:
    page = (ROOT / "docs/tutorials/first-policy.md").read_text()
    script = (FOLDER / "train.py").read_text()
    assert f"```python\n{script}```" in page
    curve = [line.split(",") for line in (FOLDER / "hello.csv").read_text().splitlines()[1:]]
    printed = "".join(f"{int(steps):6} steps: {count:>2} of 24 escape\n" for steps, count in curve[1:])
    assert f"```text\n{printed}```" in page
    assert int(curve[-1][1]) >= 23 and int(curve[0][1]) == 0


def test_the_picture_is_that_of_the_recorded_curves(tmp_path: Path) -> None:
    subprocess.run([sys.executable, FOLDER / "draw.py", tmp_path / "drawn.svg"], check=True)
    assert (tmp_path / "drawn.svg").read_text() == (ROOT / "docs/images/first-policy.svg").read_text()


def test_the_network_of_the_tutorial_escapes_as_often_in_missions_as_in_the_environments() -> None:
    onnx_reference = pytest.importorskip("onnx.reference", reason="the package onnx is not installed")
    network = onnx_reference.ReferenceEvaluator(str(FOLDER / "hello.onnx"))
    game = games()["hello"]
    found, seeds = outcomes(lambda observations: network.run(None, {"observation": observations})[0], game)
    assert found.count("escaped") >= 23, found
    runs = [pr.run(FOLDER / "hello.toml", seed=seed, in_process=True) for seed in seeds]
    assert [run.outcome["robot"] for run in runs] == found


def test_the_training_of_the_tutorial_escapes(tmp_path: Path) -> None:
    for package in ("stable_baselines3", "onnx", "onnxscript"):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed: torch is too large for this environment")
    done = subprocess.run(
        [sys.executable, FOLDER / "train.py", "hello"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    counts = re.findall(r"steps: +(\d+) of 24 escape", done.stdout)
    assert int(counts[-1]) >= 23, done.stdout
    assert (tmp_path / "hello.onnx").stat().st_size > 1000
