"""Environments for learning, against the checks of Gymnasium and PettingZoo and against ordinary runs."""

import re
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import protean_robotics as pr
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

#: A chase that lasts one second.
SHORT = {"rules.time_limit": 1.0}
SCAN = {"defaults.robot.scan": {"beams": 8, "angle_increment": 0.785, "noise": 0.01}}


def run_of(scenario: str, env_agents: tuple[str, ...], episode: Any, **arguments: Any) -> pr.Run:
    """An ordinary run whose planners send the commands of an episode."""

    @pr.planner
    class Scripted:
        def __init__(self, robot: pr.Robot) -> None:
            self.actions = iter(episode.actions[:, env_agents.index(robot.name)].astype(np.float64))

        def __call__(self, robot: pr.Robot) -> tuple[float, float]:
            speed, turn = next(self.actions)
            return speed * (robot.v_max if speed >= 0 else robot.v_reverse_max), turn * robot.omega_max

    planners = dict.fromkeys(env_agents, Scripted) | arguments.pop("planners", {})
    return pr.run(scenario, seed=episode.seed, in_process=True, planners=planners, **arguments)


@pytest.mark.parametrize(
    ("scenario", "agents", "observation", "set"),
    [
        ("hello", ["robot"], "state", {}),
        ("chase_exact", ["evader_1"], "state+scan", SHORT | SCAN),
        ("chase_exact", ["evader", "police"], "state", SHORT),
        ("chase", ["police"], "belief", SHORT),
    ],
)
def test_an_env_passes_the_check_of_gymnasium(
    scenario: str, agents: list[str], observation: str, set: dict[str, Any]
) -> None:
    env = pr.Env(scenario, agents=agents, observation=observation, set=set)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # It has no registered specification.
        warnings.filterwarnings("ignore", message=".*env.spec.*")
        warnings.filterwarnings("ignore", message=".*not having a spec.*")
        check_env(env)


def test_an_episode_is_an_ordinary_run_of_the_same_actions() -> None:
    for scenario, agents in [("chase_exact", ["evader"]), ("chase_exact", ["evader", "police"]), ("chase", ["police"])]:
        envs = pr.VectorEnv(scenario, 2, agents=agents, set=SHORT)
        envs.reset(seed=5)
        envs.action_space.seed(1)
        for _ in range(20):
            _, _, _, truncations, infos = envs.step(envs.action_space.sample())
        assert truncations.all()
        for i in range(2):
            episode = envs.episode(i)
            assert episode.actions.shape == (20, len(envs.agents), 2)
            run = run_of(scenario, envs.agents, episode, set=SHORT)
            assert envs.digest(i) == run.digest
            assert list(infos["outcome"][i]) == [run.outcome[name] for name in envs.agents]


def test_the_log_of_an_episode_is_complete(tmp_path: Path) -> None:
    env = pr.Env("chase_exact", agents=["evader"], set=SHORT)
    env.reset(seed=1)
    for _ in range(7):
        env.step(env.action_space.sample())
    run = env.save_log(tmp_path / "running.mcap", running=True)
    assert run.log.topics["world/state"] == 8
    assert run.digest == env.digest(running=True)
    with pytest.raises(pr.InvalidInput, match="no episode"):
        env.digest()
    with pytest.raises(pr.InvalidInput, match="exists"):
        env.save_log(tmp_path / "running.mcap", running=True)


def test_threads_do_not_change_results() -> None:
    def run(threads: int) -> list[NDArray[Any]]:
        envs = pr.VectorEnv("chase_exact", 5, agents=["evader"], set=SHORT, threads=threads)
        results = [envs.reset(seed=3)[0]]
        envs.action_space.seed(3)
        for _ in range(30):
            results += envs.step(envs.action_space.sample())[:4]
        return results

    alone = run(1)
    for threads in (2, 5):
        assert all(np.array_equal(a, b) for a, b in zip(alone, run(threads), strict=True))


def test_ended_episodes_are_followed_in_the_same_step() -> None:
    envs = pr.VectorEnv("chase_exact", 2, agents=["evader_1"], set=SHORT, reward={"time": -1.0})
    assert isinstance(envs, gymnasium.vector.VectorEnv)
    assert envs.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.SAME_STEP
    first, _ = envs.reset(seed=2)
    seeds = envs.seeds
    for step in range(1, 21):
        observations, rewards, terminations, truncations, infos = envs.step(np.zeros((2, 2), dtype=np.float32))
        assert rewards == pytest.approx(-0.05)
        assert truncations.all() == (step == 20) and not terminations.any()
    assert infos["return"] == pytest.approx(-1.0)
    assert infos["length"].tolist() == [20, 20]
    assert infos["_final_obs"].all() and infos["final_info"]["outcome"].tolist() == [["timed_out"]] * 2
    assert not (envs.seeds == seeds).any()
    # Entry 0 is 1 in the game.
    assert [final[0] for final in infos["final_obs"]] == [0.0, 0.0]
    assert observations[:, 0].tolist() == [1.0, 1.0]
    assert observations in envs.observation_space and first.dtype == np.float32


def test_the_reward_of_several_agents_is_their_sum() -> None:
    weights = {"time": -1.0, "contact": -0.5}
    envs = pr.VectorEnv("chase_exact", 2, agents=["police", "evader"], seed=1, reward=weights)
    envs.reset()
    actions = np.zeros((2, 6, 2), dtype=np.float32)
    actions[:, :, 0] = 1.0
    contacts = False
    for _ in range(400):
        _, rewards, _, _, infos = envs.step(actions)
        assert np.allclose(rewards, infos["rewards"].sum(axis=1))
        contacts |= bool((infos["rewards"] < -0.1).any())
    assert contacts, "robots that drive straight on reach a wall"


def test_arrays_are_the_same_without_copies() -> None:
    envs = pr.VectorEnv("chase_exact", 3, agents=["evader_1"], copy=False)
    observations, _ = envs.reset(seed=1)
    before = observations.copy()
    again, rewards, *_ = envs.step(np.ones((3, 2), dtype=np.float32))
    assert again is observations and not np.array_equal(before, again)
    assert envs.step(np.ones((3, 2), dtype=np.float32))[1] is rewards


def test_a_function_may_compute_the_rewards() -> None:
    proximity: list[int] = []
    earlier: list[NDArray[np.float32]] = []

    def approach(step: Any) -> NDArray[np.float64]:
        assert step.events["escape"].shape == (2, 2) and step.dt == 0.05
        earlier.append(step.before)
        result: NDArray[np.float64] = step.observations[:, :, proximity[0]] + 10.0 * step.truncated[:, None]
        return result

    envs = pr.VectorEnv("chase_exact", 2, agents=["evader"], set=SHORT, reward=approach)
    proximity.append(envs.entries[0].index("exit_1.proximity"))
    observations, _ = envs.reset(seed=1)
    total = np.zeros(2)
    for _ in range(20):
        before = observations
        observations, rewards, _, truncations, infos = envs.step(np.ones((2, 2, 2), dtype=np.float32))
        total += rewards
        assert np.array_equal(earlier[-1], before)
        if not truncations.any():
            assert np.allclose(rewards, observations[:, :, proximity[0]].sum(axis=1))
    # The last observations are those of the ended episodes.
    finals = np.stack(list(infos["final_obs"]))
    assert np.allclose(rewards, finals[:, :, proximity[0]].sum(axis=1) + 20.0)
    assert np.allclose(infos["return"], total)


def test_the_reward_of_the_documentation_pays_for_arriving_and_not_for_staying() -> None:
    page = Path(__file__).parents[2] / "docs/how-to/environments.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
    (code,) = [block for block in blocks if "def progress" in block]
    names: dict[str, Any] = {"pr": pr}
    exec(compile(code, page.name, "exec"), names)
    envs = pr.VectorEnv(
        "hello", 1, agents=["robot"], observation="state+path", ticks_per_action=10, reward=names["progress"], seed=1
    )
    ahead, left = (envs.entries[0].index(f"path.bearing_{name}") for name in ("cos", "sin"))
    observations, _ = envs.reset()
    rewards: list[float] = []
    ended = False
    while not ended:
        actions = np.array([[max(observations[0, ahead], 0.0), observations[0, left]]], dtype=np.float32)
        observations, reward, terminations, truncations, infos = envs.step(actions)
        rewards.append(float(reward[0]))
        ended = bool(terminations[0] or truncations[0])
    assert infos["outcome"][0] == ["escaped"]
    # To stop anywhere on the way earns less.
    sums = np.cumsum(rewards)
    assert sums[-1] > 2.0 and sums[:-1].max() < sums[-1] - 0.5


def test_an_action_of_several_ticks_is_that_of_as_many_steps() -> None:
    settings = {"rules.time_limit": 1.1}  # 22 ticks: the sixth action is cut short
    several, single = (
        pr.VectorEnv(
            "chase_exact",
            2,
            agents=["evader"],
            observation="state+path",
            seed=4,
            ticks_per_action=ticks,
            set=settings,
            reward={"time": -1.0},
        )
        for ticks in (4, 1)
    )
    assert np.array_equal(several.reset()[0], single.reset()[0])
    for step in range(6):
        actions = several.action_space.sample()
        observations, rewards, _, ends, infos = several.step(actions)
        total = np.zeros(2)
        for _ in range(4 if step < 5 else 2):
            expected, reward, _, expected_ends, _ = single.step(actions)
            total += reward
        assert np.array_equal(observations, expected)
        assert np.allclose(rewards, total)
        assert np.array_equal(ends, expected_ends) and ends.all() == (step == 5)
    assert infos["length"].tolist() == [22, 22]
    assert [several.digest(i) for i in range(2)] == [single.digest(i) for i in range(2)]


def test_ways_lead_to_the_exit() -> None:
    envs = pr.VectorEnv("chase_exact", 1, agents=["evader_1"], observation="path", ticks_per_action=4)
    names = envs.entries[0]
    proximity, ahead, left = (names.index(f"path.{name}") for name in ("proximity", "bearing_cos", "bearing_sin"))
    observations, _ = envs.reset(seed=1)
    first = 1 / observations[0, proximity] - 1
    for _ in range(50):
        actions = np.array([[max(observations[0, ahead], 0.0), 2 * observations[0, left]]], dtype=np.float32)
        observations, *_ = envs.step(actions.clip(-1, 1))
    # 10 s at 0.45 m/s.
    assert 3.5 < first - (1 / observations[0, proximity] - 1) < 5.0


def test_the_action_zero_is_evader_potential_and_others_are_not() -> None:
    options: dict[str, Any] = {"agents": ["evader_1"], "observation": "state+potential", "seed": 3}
    twist = pr.VectorEnv("chase_exact", 1, **options)
    tune = pr.VectorEnv("chase_exact", 1, action="tune", **options)
    action = [twist.entries[0].index(f"potential.{name}") for name in ("speed", "turn")]
    driven, tuned = twist.reset()[0], tune.reset()[0]
    for _ in range(40):
        # Actions have less digits than the commands of the evader.
        assert np.allclose(driven, tuned, atol=1e-3)
        driven = twist.step(driven[:, action])[0]
        tuned = tune.step(np.zeros((1, 2), dtype=np.float32))[0]
    for _ in range(40):
        driven = twist.step(driven[:, action])[0]
        tuned = tune.step(np.ones((1, 2), dtype=np.float32))[0]
    assert not np.allclose(driven, tuned, atol=1e-2)


@pytest.mark.parametrize("scenario,agents", [("hello", ["robot"]), ("chase_exact", ["evader"])])
def test_the_residual_zero_is_evader_potential(scenario: str, agents: list[str]) -> None:
    # The tuned evader with default parameters, to the last bit.
    digests = set()
    for action in ("tune", "residual"):
        envs = pr.VectorEnv(scenario, 1, agents=agents, action=action, set={"rules.time_limit": 40})
        envs.reset(seed=7)
        ended = False
        while not ended:
            _, _, terminations, truncations, infos = envs.step(np.zeros(envs.action_space.shape, dtype=np.float32))
            ended = bool(terminations[0] or truncations[0])
        digests.add(envs.digest(0))
    assert len(digests) == 1
    if scenario == "hello":
        # The process of the kind has another phase of its perturbation.
        run = pr.run(scenario, seed=envs.episode(0).seed, in_process=True)
        assert infos["outcome"][0] == ["escaped"] == list(run.outcome.values())
        assert run.time == pytest.approx(infos["length"][0] * 0.05, rel=0.02)


def test_a_residual_is_added_to_the_action_of_evader_potential() -> None:
    options: dict[str, Any] = {"agents": ["evader_1"], "observation": "state+potential", "seed": 3}
    twist = pr.VectorEnv("chase_exact", 1, **options)
    residual = pr.VectorEnv("chase_exact", 1, action="residual", **options)
    action = [twist.entries[0].index(f"potential.{name}") for name in ("speed", "turn")]
    added, corrected = twist.reset()[0], residual.reset()[0]
    for step in range(60):
        correction = np.array([[-0.25, 0.5 * np.sin(step / 5)]], dtype=np.float32)
        # The sums of the last bit of an observation.
        assert np.allclose(added, corrected, atol=1e-4)
        added = twist.step((added[:, action] + correction).clip(-1, 1))[0]
        corrected = residual.step(correction)[0]


def test_a_policy_of_residuals_steers_as_the_environment(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx", reason="the package onnx is not installed")
    correction = np.array([-0.25, 0.125], dtype=np.float32)
    envs = pr.VectorEnv("chase_exact", 1, agents=["evader"], action="residual", ticks_per_action=4, seed=5)
    entries = len(envs.entries[0])
    node = onnx.helper.make_node("Gemm", ["observation", "weight", "correction"], ["action"])
    values = {"weight": np.zeros((entries, 2), dtype=np.float32), "correction": correction}
    sizes = {"observation": entries, "action": 2}
    ends = {name: onnx.helper.make_tensor_value_info(name, 1, ["batch", size]) for name, size in sizes.items()}
    constants = [onnx.numpy_helper.from_array(value, name) for name, value in values.items()]
    graph = onnx.helper.make_graph([node], "constant", [ends["observation"]], [ends["action"]], constants)
    model = onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", 17)], ir_version=8)
    scenario = tmp_path / "chase.toml"
    text = (Path(__file__).parents[2] / "scenarios/chase_exact.toml").read_text()
    scenario.write_text(text.replace("maps/city.toml", "builtin:city"))
    (tmp_path / "constant.onnx").write_bytes(model.SerializeToString())
    envs.reset()
    seed = int(envs.seeds[0])
    ended = False
    while not ended:
        _, _, terminations, truncations, _ = envs.step(np.broadcast_to(correction, (1, 2, 2)))
        ended = bool(terminations[0] or truncations[0])
    params = {"model": "constant.onnx", "action": "residual", "ticks_per_action": 4}
    process = {"kind": "policy", "team": "evader", "params": params}
    run = pr.run(scenario, seed=seed, set={"processes.evader_potential": process}, in_process=True)
    assert run.digest == envs.digest(0)


def test_invalid_arguments_are_refused() -> None:
    for arguments, text in [
        ({"agents": ["evader_9"]}, "evader_1"),
        ({"agents": "evader"}, "list of names"),
        ({"agents": ["evader"], "observation": "lidar"}, "state, scan, belief"),
        ({"agents": ["evader"], "observation": "scan"}, "no range scan"),
        ({"agents": ["evader"], "action": "pull"}, "one of twist, tune, residual"),
        ({"agents": ["police"], "action": "tune"}, "police_1 is no evader"),
        ({"agents": ["police"], "action": "residual"}, "police_1 is no evader"),
        ({"agents": ["evader"], "reward": {"escapes": 1.0}}, "expected one of escape, caught"),
        ({"agents": ["evader"], "threads": 0}, "threads = 0"),
        ({"agents": ["evader"], "ticks_per_action": 0}, "ticks_per_action = 0"),
        ({"agents": ["evader"], "set": {"rules.time_limit": -1}}, "time_limit"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            pr.VectorEnv("chase", 1, **arguments)  # type: ignore[arg-type]
    envs = pr.VectorEnv("chase_exact", 2, agents=["evader"])
    with pytest.raises(pr.Error, match="reset"):
        envs.step(np.zeros((2, 2, 2), dtype=np.float32))
    envs.reset()
    with pytest.raises(pr.InvalidInput, match="shape"):
        envs.step(np.zeros((2, 2), dtype=np.float32))
    with pytest.raises(pr.InvalidInput, match="finite"):
        envs.step(np.full((2, 2, 2), np.nan, dtype=np.float32))
    with pytest.raises(pr.InvalidInput, match="instance 2"):
        envs.digest(2)


def test_without_a_record_episodes_are_the_same_and_cannot_be_executed_again() -> None:
    for action in ("twist", "tune"):
        recorded, other = (
            pr.VectorEnv("chase_exact", 2, agents=["evader_1"], action=action, seed=3, set=SHORT, record=record)
            for record in (True, False)
        )
        assert np.array_equal(recorded.reset()[0], other.reset()[0])
        for _ in range(20):
            actions = recorded.action_space.sample()
            results = recorded.step(actions), other.step(actions)
            assert np.array_equal(results[0][0], results[1][0])
        assert results[1][4]["length"].tolist() == [20, 20]
        for use in (other.digest, other.episode, lambda i, other=other: other.save_log(i, "no.mcap")):
            for i in (0, 2):
                with pytest.raises(pr.InvalidInput, match="record no actions"):
                    use(i)


def test_without_gymnasium_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "protean_robotics._gymnasium", raising=False)
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ImportError, match=r"protean-robotics\[gym\]"):
        _ = pr.VectorEnv


@pr.planner
def wanders(robot: pr.Robot, rng: np.random.Generator) -> tuple[float, float]:
    return 0.7 * robot.v_max, rng.normal(scale=0.5)


def test_planners_in_python_drive_the_other_robots() -> None:
    others = {"police": wanders}
    envs = pr.VectorEnv("chase_exact", 2, agents=["evader"], seed=3, set=SHORT, planners=others, threads=2)
    envs.reset()
    actions = np.random.default_rng(1).uniform(-1, 1, (20, *envs.action_space.shape)).astype(np.float32)
    for step in actions:
        *_, truncations, _ = envs.step(step)
    assert truncations.all()
    for i in range(2):
        run = run_of("chase_exact", envs.agents, envs.episode(i), set=SHORT, planners=others)
        assert run.digest == envs.digest(i)
    with pytest.raises(pr.InvalidInput, match="planners: .*guard"):
        pr.VectorEnv("chase_exact", agents=["evader"], planners={"guard": wanders})
