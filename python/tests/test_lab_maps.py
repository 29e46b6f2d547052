"""Scenarios of published maps and streets."""

import hashlib
import os
import random
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")

import protean_robotics as pr
from protean_robotics.lab import maps
from protean_robotics.lab.maps.world import Cells, of_grid

MAP = "type octile\nheight 4\nwidth 6\nmap\n@@@@@@\n@..G.@\n@.TWS@\n@@@@.@\n"
SCEN = (
    "version 1\n0\tmaps/room.map\t6\t4\t1\t1\t4\t3\t5.0\n"
    "0\tmaps/room.map\t6\t4\t1\t1\t4\t1\t3.0\n0\tmaps/room.map\t6\t4\t1\t2\t4\t1\t4.0\n"
)
OSM = """<?xml version="1.0"?>
<osm version="0.6">
 <node id="1" lat="48.0000" lon="16.0000"/>
 <node id="2" lat="48.0000" lon="16.0010"/>
 <node id="3" lat="48.0005" lon="16.0010"/>
 <node id="4" lat="49.0000" lon="17.0000"/>
 <way id="7"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="99"/><tag k="highway" v="residential"/></way>
 <way id="8"><nd ref="1"/><nd ref="4"/><tag k="power" v="line"/></way>
</osm>"""
GRAPHML = """<?xml version="1.0"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
 <key id="d0" for="node" attr.name="x" attr.type="string"/>
 <key id="d1" for="node" attr.name="y" attr.type="string"/>
 <key id="d2" for="edge" attr.name="geometry" attr.type="string"/>
 <graph edgedefault="directed">
  <node id="a"><data key="d0">0</data><data key="d1">0</data></node>
  <node id="b"><data key="d0">60</data><data key="d1">40</data></node>
  <edge source="a" target="b"><data key="d2">LINESTRING (0 0, 60 0, 60 40)</data></edge>
 </graph>
</graphml>"""
YAML = "image: a.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
#: Rooms, two corridors wide, and problems between them.
GRID = (
    "type octile\nheight 10\nwidth 14\nmap\n@@@@@@@@@@@@@@\n@......@.....@\n@......@.....@\n@............@\n"
    "@......@.....@\n@@.@@@@@.@@@@@\n@..TT........@\n@............@\n@......WW....@\n@@@@@@@@@@@@@@\n"
)
PROBLEMS = "version 1\n0\tgrid.map\t14\t10\t1\t1\t12\t8\t20\n0\tgrid.map\t14\t10\t12\t1\t1\t8\t20\n"


def image(side: int) -> str:
    """A free image with this side (pixels)."""
    return f"P2 {side} {side} 255\n" + "254 " * side * side


def made(name: str, text: str, **sizes: float) -> maps.Imported:
    """Imports a file of the current folder."""
    Path(name).write_text(text)
    return maps.scenario(Path(name), **sizes)


def world(imported: maps.Imported) -> pr.Map:
    """The world of an imported file."""
    Path("world.toml").write_text(imported.map)
    return pr.Map("world.toml")


FILES = {
    "room.map": MAP,
    "room.map.scen": SCEN,
    "grid.map": GRID,
    "grid.map.scen": PROBLEMS,
    "a.osm": OSM,
    "a.graphml": GRAPHML,
    "a.yaml": YAML,
    "a.pgm": image(12),
}
#: Digests of the scenarios and maps that the importer in Rust made, which version 0.2.0 had.
DIGESTS = {
    "room.map": "e8da1b97b14b6fda",
    "room.map.scen": "a6c5ba1be8b4e396",
    "grid.map": "07b10b3d0fa814f5",
    "grid.map.scen": "12cc69803263e83f",
    "a.osm": "d451d34ed73b9481",
    "a.graphml": "83b77bd87826ebc3",
    "a.yaml": "22940988e962eb62",
}


@pytest.mark.parametrize("name", DIGESTS)
def test_files_become_the_scenarios_of_the_importer_in_rust(name: str) -> None:
    for file, text in FILES.items():
        Path(file).write_text(text)
    found = maps.scenario(Path(name))
    digest = hashlib.sha256((found.scenario + found.map_path + found.map).encode()).hexdigest()
    assert digest[:16] == DIGESTS[name]


def test_a_map_of_cells_is_the_same_world_with_its_first_row_on_top() -> None:
    found = made("room.map", MAP, cell=0.5)
    assert found.map_path == "maps/room.toml"
    assert 'map = "maps/room.toml"' in found.scenario
    free = world(found)
    for row, cells in enumerate(MAP.splitlines()[4:]):
        for column, cell in enumerate(cells):
            clearance = free.clearance((0.5 * (column + 0.5), 0.5 * (3.5 - row)))
            assert (clearance >= 0.2) == (cell in ".GS"), (column, row)
    assert abs(free.resolution - 0.125) < 1e-12


def test_free_cells_that_are_cut_off_become_obstacles() -> None:
    free = world(made("a.map", "type octile\nheight 1\nwidth 12\nmap\n..@.........\n"))
    assert free.clearance((1.0, 0.5)) < 0.1
    assert free.clearance((4.5, 0.5)) >= 0.4


def test_problems_become_robots_on_the_map_beside_them() -> None:
    Path("room.map").write_text(MAP)
    found = made("room.map.scen", SCEN).scenario
    # The second problem begins where the first does.
    for part in (
        "start = { x = 1.5, y = 2.5, theta = 0.0 }",
        "center = [4.5, 0.5]",
        "start = { x = 1.5, y = 1.5, theta = 0.0 }",
        "center = [4.5, 2.5]",
    ):
        assert part in found
    assert "robot_3" not in found
    Path("room.map").unlink()
    with pytest.raises(pr.InvalidInput, match=r"room.map.scen refers to maps/room.map: .*cannot be read"):
        made("room.map.scen", SCEN)


def test_streets_are_free_corridors() -> None:
    # 0.0010° of longitude at 48° are 74 m, 0.0005° of latitude 56 m.
    for name, text, corners in (
        ("a.osm", OSM, [(-37.2, -27.8), (37.2, -27.8), (37.2, 27.8)]),
        ("a.graphml", GRAPHML, [(-30.0, -20.0), (30.0, -20.0), (30.0, 20.0)]),
    ):
        free = world(made(name, text, street=6.0))
        for start, end in zip(np.array(corners), np.array(corners[1:]), strict=False):
            for share in (0.0, 0.3, 0.7, 1.0):
                assert 1.9 <= free.clearance(start + share * (end - start)) < 4.5
        assert free.clearance((corners[0][0], corners[2][1])) <= 0.0


@pytest.mark.parametrize("crs", ["epsg:4326", "EPSG:4326", "{'init': 'epsg:4326'}", "WGS84", ""])
def test_degrees_are_told_by_the_coordinate_system_of_a_graph(crs: str) -> None:
    text = f"""<graphml><graph><data key="crs">{crs}</data>
        <node id="a"><data key="x">16.0</data><data key="y">48.0</data></node>
        <node id="b"><data key="x">16.001</data><data key="y">48.0005</data></node>
        <edge source="a" target="b"/></graph></graphml>"""
    if crs:
        bounds = world(made("a.graphml", text)).bounds
        # 0.0010° of longitude at 48° are 74 m.
        assert abs(bounds[1][0] - bounds[0][0] - 82.4) < 2.0
    else:
        # They are metres then, and the streets one point.
        with pytest.raises(pr.InvalidInput, match="or the `crs` of degrees"):
            made("a.graphml", text)


def test_a_second_writing_of_the_same_streets_has_the_same_cells() -> None:
    plain = maps.read(_written("a.graphml", GRAPHML))[0].cells.occupied
    for line in (
        "LINESTRING (60 40, 60 0, 0 0)",
        "linestring z ( 0 0 5 ,60 0 5.5 ,60 40 1e3 )\n",
        "LINESTRINGZM (0 0 -1 2, 60 0 -1 2, 60 40 -1 2)",
        "MULTILINESTRING M ((60 0 7, 60 40 7), (60 0 7, 0 0 7), EMPTY)",
    ):
        for ends in ('source="a" target="b"', 'source="b" target="a"'):
            text = GRAPHML.replace("LINESTRING (0 0, 60 0, 60 40)", line).replace('source="a" target="b"', ends)
            other = "\ufeff" + text.replace("\n", "\r\n")
            assert np.array_equal(maps.read(_written("a.graphml", other))[0].cells.occupied, plain), text
    plain = maps.read(_written("a.osm", OSM))[0].cells.occupied
    more = "<way id='9' action='delete'><nd ref='1'/><nd ref='4'/><tag k='highway' v='primary'/></way>"
    unused = "<way id='10'><nd ref='1'/><nd ref='4'/><tag k='disused' v='yes'/><tag k='highway' v='primary'/></way>"
    for other in (
        OSM.replace('<nd ref="2"/><nd ref="3"/>', '<nd ref="2" lat="48" lon="16.001"/><nd ref="3"/>'),
        OSM.replace("</osm>", more + unused + "<node id='5' visible='false'/></osm>"),
        OSM.replace(
            '<nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="99"/>', '<nd ref="3"/><nd ref="2"/><nd ref="1"/>'
        ),
    ):
        assert np.array_equal(maps.read(_written("a.osm", other))[0].cells.occupied, plain), other


def _written(name: str, text: str) -> Path:
    Path(name).write_bytes(text.encode())
    return Path(name)


@pytest.mark.parametrize("side", [1, 2, 5, 8])
def test_open_maps_are_accepted_from_a_small_side_on(side: int) -> None:
    row = "." * side + "\n"
    Path("a.pgm").write_text(image(side))
    for name, text in (
        ("a.map", f"type octile\nheight {side}\nwidth {side}\nmap\n" + row * side),
        ("a.yaml", YAML.replace("resolution: 1", "resolution: 0.1")),
    ):
        if side < 5:
            with pytest.raises(pr.InvalidInput, match="m² of free space"):
                made(name, text)
        else:
            assert "[teams.police]" in made(name, text).scenario


def test_the_largest_part_and_its_rectangles_are_exact() -> None:
    generator = np.random.default_rng(1)
    for _ in range(40):
        shape = generator.integers(1, 12, 2)
        cells = Cells(generator.random(shape) < 0.4, 0.5, (-1.0, 2.0))
        if cells.occupied.all():
            continue
        found = of_grid(Path("a"), cells, 0.5)
        covered = np.zeros(shape, dtype=int)
        for (x0, y0), (x1, y1) in found.rectangles:
            columns, rows = (
                slice(*(round((v - o) / 0.5) for v in ends)) for ends, o in (((x0, x1), -1.0), ((y0, y1), 2.0))
            )
            covered[rows, columns] += 1
        assert np.array_equal(covered, found.cells.occupied)
        assert (found.cells.occupied | ~cells.occupied).all()


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.map", "type octile\nheight x\n", 'a.map, line 2: "x": expected height'),
        ("a.map", "octile\n", 'line 1: "octile": expected type octile'),
        ("a.map", "type octile\nheight 1\nwidth 2\nmap\n.x\n", 'line 5: ".x": expected 2 of the characters'),
        ("a.map", "type octile\nheight 2\nwidth 1\nmap\n.\n", "1 rows of cells: expected 2 rows"),
        ("a.map", "type octile\nheight 99999\nwidth 99999\nmap\n", "99999 × 99999 cells: expected at most 25000000"),
        ("a.map", "type octile\nheight 1\nwidth 1\nmap\n@\n", "no free cell"),
        ("a.scen", "version 2\n", "expected version 1"),
        ("a.scen", "version 1\n", "no problem"),
        ("a.scen", "version 1\n0 m 1 1 0 0 0\n", "line 2"),
        ("a.scen", "version 1\n0 m 1 1 0 0 0 1 1\n", "positions on the map"),
        ("a.osm", "<osm>", "a.osm: "),
        ("a.osm", "<gpx/>", "an element <gpx>: expected <osm>"),
        ("a.osm", "<osm/>", "no street"),
        ("a.osm", "<osm>\n<node id='1' lat='x' lon='2'/></osm>", "line 2"),
        ("a.osm", "<!DOCTYPE osm [<!ENTITY a 'aa'>]>\n<osm>&a;</osm>", "without a document type"),
        ("a.graphml", "<a/>", "no <graph>"),
        ("a.graphml", "<graph>\n<node id='a'/></graph>", "line 2"),
        ("a.graphml", GRAPHML.replace(">60<", ">1e7<"), "streets on 10000.0 km × 0.0 km: expected a smaller part"),
        ("a.txt", "", "unknown kind of file: expected .yaml, .yml, .map"),
        ("a.yaml", "image: none.pgm\n", "resolution"),
    ],
)
def test_broken_files_are_explained(name: str, text: str, expected: str) -> None:
    with pytest.raises(pr.InvalidInput) as raised:
        made(name, text)
    assert expected in str(raised.value)
    with pytest.raises(pr.InvalidInput, match=r"none.map: cannot be read"):
        maps.scenario(Path("none.map"))


@pytest.mark.parametrize(
    "line",
    [
        "",
        "LINESTRING",
        "LINESTRING EMPTY",
        "LINESTRING (0 0)",
        "LINESTRING (0 0, 60)",
        "LINESTRING (0 0, 60 x)",
        "LINESTRING (0 0, 60 inf)",
        "LINESTRING (0 0, 60 40",
        "LINESTRING (0 0, 60 40))",
        "LINESTRING (0 0,, 60 40)",
        "LINESTRING (0 0, 60 40) EMPTY",
        "LINESTRING X (0 0, 60 40)",
        "LINESTRING (0 0 0 0 0, 60 40 0 0 0)",
        "MULTILINESTRING EMPTY",
        "MULTILINESTRING (EMPTY)",
        "MULTILINESTRING (0 0, 60 40)",
        "MULTILINESTRING ((0 0, 60 40)",
        "MULTILINESTRING ((0 0, 60 40) (60 40, 0 0))",
        "POINT (0 0)",
        "{'type': 'LineString'}",
    ],
)
def test_a_line_of_an_edge_that_cannot_be_read_is_an_error(line: str) -> None:
    with pytest.raises(pr.InvalidInput) as raised:
        made("a.graphml", GRAPHML.replace("LINESTRING (0 0, 60 0, 60 40)", line))
    assert f'line 9: "{line}": expected LINESTRING' in str(raised.value)


def test_a_way_needs_the_places_of_its_nodes_that_exist() -> None:
    node = '<node id="2" lat="48.0000" lon="16.0010"/>'
    with pytest.raises(pr.InvalidInput, match='line 7: "deleted node 2": expected a node of the way'):
        made("a.osm", OSM.replace(node, '<node id="2" visible="false"/>'))
    with pytest.raises(pr.InvalidInput, match="`out geom`"):
        made("a.osm", OSM.replace("<node", "<center"))


def test_xml_that_takes_a_parser_much_time_is_refused() -> None:
    for count in (256, 257, 200_000):
        attributes = "".join(f" a{i}='>'" for i in range(count))
        with pytest.raises(pr.InvalidInput) as raised:
            made("a.osm", f"<osm>\n<node{attributes}/></osm>")
        limit = "a.osm, line 2: \"node a0='>'" in str(raised.value) and "at most 256 attributes" in str(raised.value)
        assert limit == (count > 256)
    nested = "".join(f"<osm xmlns:n{i}='u{i}'>" for i in range(4000))
    with pytest.raises(pr.InvalidInput, match="declarations `xmlns`"):
        made("a.osm", nested)


def test_a_name_keeps_all_but_its_extension() -> None:
    text = "type octile\nheight 9\nwidth 9\nmap\n" + ".........\n" * 9
    for name, stem in (("planet_10.068,48.135.map", "planet_10.068_48.135"), ('münchen "ost".map', "münchen__ost_")):
        found = made(name, text)
        assert found.map_path == f"maps/{stem}.toml"
        world(found)


def test_a_file_with_a_part_replaced_is_imported_or_refused() -> None:
    generator = random.Random(1)
    words = ["NaN", "inf", "-1", "1e308", "99999999999999999999", "\n", "\t", "<", "/>", "\0", "é", "&a;", ""]
    Path("room.map").write_text(MAP)
    for _ in range(200):
        name, text = generator.choice(
            [("b.map", MAP), ("b.scen", SCEN), ("b.graphml", GRAPHML), ("b.osm", OSM), ("b.yaml", YAML)]
        )
        at = generator.randrange(len(text))
        changed = text[:at] + generator.choice(words) + text[at + generator.randrange(12) :]
        try:
            found = made(name, changed)
        except pr.InvalidInput:
            continue
        world(found)


def test_a_file_reads_no_file_outside_its_folder_without_permission(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "secret.map").write_text(MAP)
    (outside / "secret.pgm").write_text(image(12))
    folder = tmp_path / "in"
    folder.mkdir()
    for name, text, other in (
        ("a.scen", SCEN.replace("maps/room.map", "OTHER"), outside / "secret.map"),
        ("a.yaml", YAML.replace("a.pgm", "OTHER"), outside / "secret.pgm"),
    ):
        link = folder / "link"
        link.unlink(missing_ok=True)
        link.symlink_to(other)
        for path in (str(other), "../" * 20 + str(other)[1:], "link"):
            file = folder / name
            file.write_text(text.replace("OTHER", path))
            with pytest.raises(pr.InvalidInput) as raised:
                maps.scenario(file)
            assert f"{name} refers to {path}: path leads out of" in str(raised.value)
            assert maps.scenario(file, allow_outside=True).map


def test_the_command_writes_scenarios_that_check_and_run() -> None:
    for file, text in FILES.items():
        Path(file).write_text(text)
    command = os.environ.get("PROTEAN_PROGRAM") or str(Path(sys.executable).with_name("protean"))

    def protean(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([command, *words], capture_output=True, text=True, check=False)

    for name in ("a.yaml", "grid.map", "grid.map.scen", "a.osm"):
        # Maps with one name need a folder each.
        file = f"own/{name}/chase.toml"
        created = protean("new", file, "--from", name)
        assert created.returncode == 0, created.stderr
        assert f"protean run {file}" in created.stderr
        checked = protean("check", file)
        assert checked.returncode == 0, checked.stderr
        assert len(checked.stdout.splitlines()) == 1
        assert pr.run(file, in_process=True, set={"rules.time_limit": 2}, out=f"{name}.mcap").digest
    again = protean("new", "own/grid.map/chase.toml", "--from", "grid.map")
    assert again.returncode == 2
    assert "--force" in again.stderr
    Path("bad.map").write_text("type octile\nheight 2\n")
    refused = protean("new", "x.toml", "--from", "bad.map")
    assert refused.returncode == 2
    assert refused.stderr.startswith("error: bad.map, line 3")
    assert not Path("x.toml").exists()


#: Four crossings around a block, in the two forms of the header.
PATROL = "4\n60\n60\n0.1\n{offset}\n" + "".join(
    f"{vertex}\n{column}\n{row}\n2\n{first}\nN\n{cost}\n{second}\nE\n{other}\n\n"
    for vertex, column, row, first, cost, second, other in (
        (0, 10, 10, 1, 40, 3, 40),
        (1, 10, 50, 0, 40, 2, 45),
        (2, 50, 50, 1, 45, 3, 40),
        (3, 50, 10, 2, 40, 0, 40),
    )
)


def test_patrol_graphs_become_patrols_with_and_without_a_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    old = made("old.graph", PATROL.format(offset=""))
    assert "nodes = [\n    [1.0, 1.0],\n    [1.0, 5.0],\n    [5.0, 5.0],\n    [5.0, 1.0],\n]" in old.scenario
    assert "edges = [\n    [0, 1],\n    [0, 3],\n    [1, 2],\n    [2, 3],\n]" in old.scenario
    assert "lengths = [\n    4.0,\n    4.0,\n    4.5,\n    4.0,\n]" in old.scenario
    assert "obstacles = [\n]" in old.map
    # With an offset, on the map beside it: free but for one pixel in its middle.
    pixels = ["254"] * 60 * 60
    pixels[30 * 60 + 30] = "0"
    Path("a.pgm").write_text("P2 60 60 255\n" + " ".join(pixels))
    Path("new.yaml").write_text(YAML.replace("resolution: 1", "resolution: 0.1").replace("[0, 0, 0]", "[-3, -3, 0]"))
    new = made("new.graph", PATROL.format(offset="-3\n-3"))
    assert "nodes = [\n    [-2.0, -2.0],\n" in new.scenario
    assert new.map.count("shape.rectangle") == 1
    for name, text in (("new", new), ("old", old)):
        Path("maps").mkdir(exist_ok=True)
        Path(text.map_path).write_text(text.map)
        Path(f"{name}.toml").write_text(text.scenario)
        run = pr.run(f"{name}.toml", set={"rules.time_limit": 30})
        assert len(run.summary["patrols"][0]["nodes"]) == 4


@pytest.mark.parametrize("text", ["", "2 9 9 1 0 1 1 0", PATROL.format(offset="")[:-12], "1 9 9 nan 0 0 0 0"])
def test_a_text_that_is_no_patrol_graph_is_named(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(pr.InvalidInput, match="bad.graph: no patrol graph: expected the vertices"):
        made("bad.graph", text)
