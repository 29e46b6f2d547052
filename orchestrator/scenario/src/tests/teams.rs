//! Teams of any name.

use robot::team::Role;

use super::*;

/// The small scenario with the guards and the thieves in place of the standard teams, and a table for each.
fn guards() -> String {
    let teams = "[teams.guards]\nrole = \"pursuer\"\nlimits = { omega_max = 1.5 }\n\
                 [teams.thieves]\nrole = \"evader\"\n";
    changed("[teams.police]\nlimits = { omega_max = 1.5 }\n", teams)
        .replace("team = \"police\"", "team = \"guards\"")
        .replace("team = \"evader\"", "team = \"thieves\"")
}

/// Returns the errors of the scenario with the guards after one change, which must contain every one of `wants`.
#[track_caller]
fn guards_refused(from: &str, to: &str, wants: &[&str]) {
    let text = guards();
    assert!(text.contains(from), "{from:?}");
    contains(&load(&text.replacen(from, to, 1)).unwrap_err(), wants);
}

#[test]
fn a_team_of_any_name_has_the_role_and_the_values_of_its_table() {
    let s = load(&guards()).unwrap();
    let [cop, thief] = &s.world.robots[..] else {
        panic!("{:?}", s.world.robots)
    };
    assert_eq!((cop.team.as_str(), cop.role()), ("guards", Role::Pursuer));
    assert_eq!(
        (thief.team.as_str(), thief.role()),
        ("thieves", Role::Evader)
    );
    assert_eq!(cop.model().omega_max, 1.5);
    assert!(cop.is_hostile_to(thief) && thief.is_hostile_to(cop));
    let of_team = s.processes.iter().find(|p| p.name == "evader_potential");
    assert_eq!(of_team.unwrap().robots, [1]);
    assert_eq!(
        load(&s.to_toml()).unwrap(),
        s,
        "the log has roles and opponents"
    );
    let truce = guards().replace("role = \"evader\"", "role = \"evader\"\nhostile_to = []");
    let s = load(&truce).unwrap();
    assert!(!s.world.robots[0].is_hostile_to(&s.world.robots[1]));
    assert_eq!(load(&s.to_toml()).unwrap(), s, "an empty list is kept");
    let set = ["teams.thieves.hostile_to=[\"guards\"]"];
    let s = load_with(&truce, &set).unwrap();
    assert!(s.world.robots[0].is_hostile_to(&s.world.robots[1]));
}

#[test]
fn the_standard_teams_need_no_table_and_are_written_as_before() {
    let text = load(GOOD).unwrap().to_toml();
    assert!(
        !text.contains("role") && !text.contains("hostile_to"),
        "{text}"
    );
    assert!(text.contains("team = \"police\"") && text.contains("team = \"evader\""));
}

#[test]
fn random_starts_keep_the_distance_of_opponents_from_hostile_teams_alone() {
    let start =
        "random_start = { robot_distance = 0.3, opponent_distance = 5.0, exit_distance = 0.0 }";
    let text = |hostile: &str| {
        guards()
            .replace("start = { x = 2.0, y = 0.0, theta = 0.0 }\nstart_jitter = { x = 0.1, y = 0.1, theta = 0.2 }", start)
            .replace("role = \"evader\"", &format!("role = \"evader\"\n{hostile}"))
    };
    let distances = |text: &str| -> Vec<f64> {
        let seeds = 0..20;
        let of = |seed| {
            let s = load_with(text, &[&format!("run.seed={seed}")]).unwrap();
            let [a, b] = [0, 1].map(|i| s.world.robots[i].start.position());
            (a - b).norm()
        };
        seeds.map(of).collect()
    };
    assert!(distances(&text("")).iter().all(|d| *d >= 5.0));
    assert!(distances(&text("hostile_to = []")).iter().any(|d| *d < 5.0));
}

#[test]
fn mistakes_in_teams_are_explained() {
    guards_refused(
        "role = \"pursuer\"\n",
        "",
        &[
            "team `guards` has no role",
            "(robots.cop.team)",
            "role = \"pursuer\", \"evader\" or \"neutral\" in [teams.guards], or a team: one of `thieves`,",
        ],
    );
    guards_refused(
        "role = \"pursuer\"",
        "role = \"police\"",
        &["`police` is not one of the choices", "(teams.guards.role)"],
    );
    guards_refused(
        "[teams.thieves]",
        "[teams.thieves]\nhostile_to = [\"gards\"]",
        &[
            "team `thieves` of role evader cannot be hostile to `gards`",
            "hostile_to",
            "a team of role pursuer: `guards`",
            "did you mean `guards`?",
        ],
    );
    guards_refused(
        "[teams.guards]",
        "[teams.guards]\nhostile_to = [\"guards\"]",
        &["team `guards` of role pursuer cannot be hostile to `guards`"],
    );
    guards_refused(
        "[[robots]]",
        "[teams.vans]\nrole = \"neutral\"\nhostile_to = [\"guards\"]\n[[robots]]\nname = \"van\"\nteam = \"vans\"\n\
         start = { x = -3.0, y = 1.0, theta = 0.0 }\n[[robots]]",
        &["no `hostile_to`: neutral robots have no opponents"],
    );
    guards_refused(
        "[[robots]]",
        "[[robots]]\nname = \"spy\"\nteam = \"guards\"\nrole = \"evader\"\nstart = { x = -3.0, y = 1.0, theta = 0.0 }\n[[robots]]",
        &["`role` differs within team `guards`, between `spy` and `cop`"],
    );
    guards_refused(
        "[teams.thieves]",
        "[teams.thiefs]\nrole = \"evader\"\n[teams.thieves]",
        &["no robot is in team `thiefs`", "did you mean `thieves`?"],
    );
    guards_refused(
        "team = \"guards\"",
        "team = \"the guards\"",
        &[
            "name not allowed",
            "value: \"the guards\"",
            "(robots.cop.team)",
        ],
    );
    guards_refused(
        "kind = \"evader_potential\"\nteam = \"thieves\"",
        "kind = \"evader_potential\"\nteam = \"thief\"",
        &["no robot is in team `thief`", "did you mean `thieves`?"],
    );
    refused(
        "[teams.police]",
        "[teams.police]\nrole = \"evader\"",
        &["`role` is out of range", "pursuer, the role of `police`"],
    );
    refused(
        "team = \"police\"",
        "team = \"polize\"",
        &["team `polize` has no role", "did you mean `police`?"],
    );
}
