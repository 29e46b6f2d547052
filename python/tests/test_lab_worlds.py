"""The chasing game in random offices and forests."""

import math
import random
from pathlib import Path

import numpy as np
import pytest

ndimage = pytest.importorskip("scipy.ndimage")

from protean_robotics.lab import worlds
from protean_robotics.lab.results import Cell, Results

#: Pitch of the raster (m), and radius of a robot with half of it.
PITCH, REACH = 0.05, 0.105 + 0.025


def free(shapes: list[worlds.Shape]) -> np.ndarray:
    """Places of a raster of the square within the wall at which a robot touches no shape."""
    x, y = np.meshgrid(*[np.arange(-8.0 + REACH, 8.0 - REACH, PITCH)] * 2)
    free = np.ones_like(x, dtype=bool)
    for shape in shapes:
        ((kind, value),) = shape.items()
        a, b = value["center"]
        if kind == "circle":
            free &= np.hypot(x - a, y - b) > value["radius"] + REACH
        else:
            w, h = value["half_extents"]
            free &= np.hypot(np.maximum(abs(x - a) - w, 0), np.maximum(abs(y - b) - h, 0)) > REACH
    return free


@pytest.mark.parametrize("make", [worlds.office, worlds.forest])
def test_every_place_can_be_reached(make: worlds.Maker) -> None:
    for seed in range(20):
        places, parts = ndimage.label(free(make(random.Random(seed))))
        assert parts == 1, seed
        assert 0.5 < (places > 0).mean() < 0.9


def test_an_office_has_two_doors_for_three_walls() -> None:
    # Of 24 walls 15 are in the tree, the others are open by half: 19.5 doors, each of which makes a wall two pieces.
    counts = [len(worlds.office(random.Random(seed))) - 24 for seed in range(100)]
    assert min(counts) >= 15 and max(counts) <= 24
    assert abs(np.mean(counts) - 19.5) < 0.5


def test_trees_stand_apart() -> None:
    discs = [shape["circle"] for shape in worlds.forest(random.Random(1))]
    assert len(discs) == 60
    for i, one in enumerate(discs):
        assert max(map(abs, one["center"])) + one["radius"] <= 7.501
        for other in discs[:i]:
            assert math.dist(one["center"], other["center"]) >= one["radius"] + other["radius"] + 0.499


def test_a_layout_depends_on_its_number_alone(tmp_path: Path) -> None:
    assert worlds.main(["make", "office", str(tmp_path / "a"), "--layouts", "3"]) == 0
    assert worlds.main(["make", "office", str(tmp_path / "b"), "--layouts", "1", "--first", "3"]) == 0
    third = [(tmp_path / folder / "maps/office_3.toml").read_text() for folder in "ab"]
    assert third[0] == third[1] != (tmp_path / "a/maps/office_2.toml").read_text()
    text = (tmp_path / "b/office.toml").read_text()
    assert text.partition("[grid]")[0].split("[parameters.layout")[-1] in (tmp_path / "a/office.toml").read_text()


def test_no_layout_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert worlds.main(["make", "forest", str(tmp_path), "--layouts", "0"]) == 2
    assert capsys.readouterr().err == "error: `layouts` is 0: expected 1 or more\n"


def test_tactics_are_compared_layout_by_layout() -> None:
    # The second tactic lets fewer escape in nine layouts of ten.
    cells = tuple(Cell(case, (1.5, f"l{n}")) for case in ("nearest", "cut_off") for n in range(1, 11))
    escapes = [2] * 10 + [1] * 9 + [2]
    rows = {(i, 1): {"outcome": "decided", "escaped": n, "evaders": 2} for i, n in enumerate(escapes)}
    results = Results(Path(), "office", "Title", "", "1", ("relative_speed", "layout"), cells, rows, {})
    assert worlds.judge([results]).splitlines() == [
        "Title: 20 games, 0 failed",
        "office 1.5 nearest: 100 % (72 … 100), 20 of 20",
        "office 1.5 cut_off: 55 % (34 … 74), 11 of 20",
        "office 1.5 nearest − cut_off: +45 points (+11 … +66), more in 9 games, fewer in 0, p = 0.0039",
    ]
