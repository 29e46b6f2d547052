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

/// Compares the errors of the scenario with the guards, each time with one part replaced, with the snapshot.
#[track_caller]
fn guards_refused(changes: &[(&str, &str)], errors: &Expect) {
    let texts = changes.iter().map(|(from, to)| {
        let text = guards();
        assert!(text.contains(from), "{from:?}");
        text.replacen(from, to, 1)
    });
    texts_refused(texts, errors);
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
        &[
            ("role = \"pursuer\"\n", ""),
            ("role = \"pursuer\"", "role = \"police\""),
            (
                "[teams.thieves]",
                "[teams.thieves]\nhostile_to = [\"gards\"]",
            ),
            (
                "[teams.guards]",
                "[teams.guards]\nhostile_to = [\"guards\"]",
            ),
            (
                "[[robots]]",
                "[teams.vans]\nrole = \"neutral\"\nhostile_to = [\"guards\"]\n[[robots]]\nname = \"van\"\nteam = \"vans\"\n\
         start = { x = -3.0, y = 1.0, theta = 0.0 }\n[[robots]]",
            ),
            (
                "[[robots]]",
                "[[robots]]\nname = \"spy\"\nteam = \"guards\"\nrole = \"evader\"\nstart = { x = -3.0, y = 1.0, theta = 0.0 }\n[[robots]]",
            ),
            (
                "[teams.thieves]",
                "[teams.thiefs]\nrole = \"evader\"\n[teams.thieves]",
            ),
            ("team = \"guards\"", "team = \"the guards\""),
            (
                "kind = \"evader_potential\"\nteam = \"thieves\"",
                "kind = \"evader_potential\"\nteam = \"thief\"",
            ),
        ],
        &expect![[r#"
            error: team `guards` has no role
              --> small.toml:21:8 (robots.cop.team)
               |
            21 | team = "guards"
               |        ^^^^^^^^
               = value: "guards"
               = expected: role = "pursuer", "evader" or "neutral" in [teams.guards], or a team: one of `thieves`, `neutral`, `police`, `evader`
            error: `police` is not one of the choices
              --> small.toml:16:8 (teams.guards.role)
               |
            16 | role = "police"
               |        ^^^^^^^^
               = value: "police"
               = expected: one of `neutral`, `pursuer`, `evader`
            error: team `thieves` of role evader cannot be hostile to `gards`
              --> small.toml:19:15 (robots.thief.hostile_to[0])
               |
            19 | hostile_to = ["gards"]
               |               ^^^^^^^
               = value: "gards"
               = expected: a team of role pursuer: `guards`
               = help: did you mean `guards`?
            error: team `guards` of role pursuer cannot be hostile to `guards`
              --> small.toml:16:15 (robots.cop.hostile_to[0])
               |
            16 | hostile_to = ["guards"]
               |               ^^^^^^^^
               = value: "guards"
               = expected: a team of role evader: `thieves`
            error: team `vans` of role neutral cannot be hostile to `guards`
              --> small.toml:22:15 (robots.van.hostile_to[0])
               |
            22 | hostile_to = ["guards"]
               |               ^^^^^^^^
               = value: "guards"
               = expected: no `hostile_to`: neutral robots have no opponents
            error: `role` differs within team `guards`, between `spy` and `cop`
              --> small.toml:16:8 (robots.cop.role)
               |
            16 | role = "pursuer"
               |        ^^^^^^^^^
               = value: "pursuer"
               = expected: `role` in [teams.guards], for all of its robots
            error: no robot is in team `thiefs`
              --> small.toml:18:1 (teams.thiefs)
               |
            18 | [teams.thiefs]
               | ^^^^^^^^^^^^^^
               = expected: a team: one of `guards`, `thieves`
               = help: did you mean `thieves`?
            error: name not allowed
              --> small.toml:22:8 (robots.cop.team)
               |
            22 | team = "the guards"
               |        ^^^^^^^^^^^^
               = value: "the guards"
               = expected: 1 to 48 of the characters a–z, A–Z, 0–9, _ and -
            error: no robot is in team `thief`
              --> small.toml:34:8 (processes.evader_potential.team)
               |
            34 | team = "thief"
               |        ^^^^^^^
               = value: "thief"
               = expected: one of `guards`, `thieves`
               = help: did you mean `thieves`?"#]],
    );
    refused(
        &[
            ("[teams.police]", "[teams.police]\nrole = \"evader\""),
            ("team = \"police\"", "team = \"polize\""),
        ],
        &expect![[r#"
            error: `role` is out of range
              --> small.toml:16:8 (robots.cop.role)
               |
            16 | role = "evader"
               |        ^^^^^^^^
               = value: evader
               = expected: pursuer, the role of `police`
            error: team `polize` has no role
              --> small.toml:19:8 (robots.cop.team)
               |
            19 | team = "polize"
               |        ^^^^^^^^
               = value: "polize"
               = expected: role = "pursuer", "evader" or "neutral" in [teams.polize], or a team: one of `neutral`, `police`, `evader`
               = help: did you mean `police`?"#]],
    );
}
