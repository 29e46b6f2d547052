"""Names of environments for ``gymnasium.make``: "protean/chase-v0" and others."""

from gymnasium.envs.registration import register, registry

#: Agents by built-in scenario: those with events that rewards count.
_AGENTS = {
    "chase": ["evader_1"],
    "chase_exact": ["evader_1"],
    "chase_layouts": ["evader_1"],
    "chase_popup": ["evader_1"],
    "chase_reach_avoid": ["evader_1"],
    "hello": ["robot"],
    "popup": ["scout"],
    "popup_city": ["courier_4"],
    "single_lane": ["eastbound", "westbound"],
}

for _scenario, _agents in _AGENTS.items():
    _name = f"protean/{_scenario}-v0"
    # The package may be imported anew.
    if _name not in registry:
        register(
            _name,
            entry_point="protean_robotics:Env",
            vector_entry_point="protean_robotics:VectorEnv",
            kwargs={"scenario": _scenario, "agents": _agents},
        )
