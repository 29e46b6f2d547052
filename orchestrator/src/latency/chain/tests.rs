//! What the stages of a tick are.

use super::*;

const SIMULATOR: u32 = 0;
const PERCEPTION: u32 = 1;
const PURSUER: u32 = 2;
const EVADER: u32 = 3;
const PERIOD: u64 = 1_000_000;

fn processes() -> Vec<ProcessInfo> {
    [
        (SIMULATOR, "simulator", false),
        (PERCEPTION, "perception", false),
        (PURSUER, "pursuer", true),
        (EVADER, "evader", false),
    ]
    .map(|(index, kind, reads_beliefs)| ProcessInfo {
        index,
        name: kind.to_owned(),
        kind: kind.to_owned(),
        reads_beliefs,
    })
    .to_vec()
}

fn stamp(tick: u64, source: u32, clocks: [u64; 4]) -> Stamp {
    Stamp {
        tick,
        source,
        begun_ns: clocks[0],
        received_ns: clocks[1],
        computed_ns: clocks[2],
        sent_ns: clocks[3],
        ..Stamp::default()
    }
}

fn state(tick: u64, begun: u64, received: u64) -> Stamp {
    let origin = PERIOD * (tick + 1);
    Stamp {
        origin_ns: origin,
        ..stamp(tick, SIMULATOR, [begun, received, origin + 10, origin + 20])
    }
}

/// Tick 0 with everybody; the pursuer's command is sent at this time after the origin.
fn chase(chain: &mut Chain, command: u64) {
    let at = |after: u64| PERIOD + after;
    chain.message(Role::State, &state(0, 0, 0));
    let belief = stamp(0, PERCEPTION, [at(100), at(110), at(300), at(310)]);
    chain.message(
        Role::Sighting,
        &stamp(0, PERCEPTION, [at(100), at(110), at(290), at(295)]),
    );
    chain.message(Role::Belief, &belief);
    chain.message(
        Role::Command,
        &stamp(0, EVADER, [at(50), at(60), at(90), at(95)]),
    );
    let begun = [at(350), at(360), at(command - 5), at(command)];
    chain.message(Role::Command, &stamp(0, PURSUER, begun));
}

#[test]
fn the_stages_of_a_tick_add_up_to_the_whole() {
    let mut chain = Chain::new(&processes(), Some(PERIOD));
    chase(&mut chain, 500);
    chain.message(Role::State, &state(1, 2 * PERIOD - 60, 2 * PERIOD - 50));
    let (answers, passages) = chain.finish();
    assert_eq!((answers.ticks, answers.in_time, answers.late), (1, 1, 0));
    let passage = passages[0];
    assert_eq!(passage.stages, [20, 90, 200, 50, 140, PERIOD - 560, 10]);
    assert_eq!(passage.stages.iter().sum::<u64>(), passage.whole_ns);
    assert_eq!(passage.reaction_ns, 500);
    let turn = |name: &str| chain.turns.get(name).unwrap().percentiles().max;
    assert_eq!(turn("perception wakes up"), 0.08);
    assert_eq!(turn("pursuer wakes up"), 0.04);
    assert_eq!(turn("pursuer computes"), 0.135);
    assert_eq!(turn("perception writes"), 0.02, "until its last message");
    assert_eq!(
        chain.period.get(TICK_JITTER).unwrap().percentiles().max,
        0.0
    );
}

#[test]
fn in_lock_step_the_simulator_does_not_wait_for_a_clock() {
    let mut chain = Chain::new(&processes(), None);
    chase(&mut chain, 500);
    chain.message(Role::State, &state(1, PERIOD + 530, PERIOD + 540));
    let (_, passages) = chain.finish();
    assert_eq!(passages[0].stages, [20, 90, 200, 50, 140, 0, 40]);
    assert!(chain.stages.get(Stage::Wait.name()).is_none());
}

#[test]
fn a_command_that_comes_after_its_tick_is_late_and_found_where_it_was_taken() {
    let mut chain = Chain::new(&processes(), Some(PERIOD));
    chase(&mut chain, PERIOD + 100);
    // The first turn took the evader's command, the second the pursuer's.
    chain.message(Role::State, &state(1, 2 * PERIOD - 60, PERIOD + 97));
    chain.message(Role::State, &state(2, 3 * PERIOD - 60, 3 * PERIOD - 50));
    let (answers, passages) = chain.finish();
    assert_eq!(
        (answers.late, answers.unanswered),
        (1, 1),
        "nobody answered tick 1"
    );
    assert_eq!((passages[0].late_ticks, passages[0].tick), (1, 0));
    assert_eq!(passages[0].stages.iter().sum::<u64>(), passages[0].whole_ns);
}

#[test]
fn a_planner_without_the_beliefs_of_the_tick_is_followed_to_the_state() {
    let mut chain = Chain::new(&processes(), Some(PERIOD));
    let at = |after: u64| PERIOD + after;
    chain.message(Role::State, &state(0, 0, 0));
    chain.message(
        Role::Command,
        &stamp(0, PURSUER, [at(50), at(60), at(90), at(95)]),
    );
    chain.message(
        Role::Belief,
        &stamp(0, PERCEPTION, [at(70), at(80), at(200), at(210)]),
    );
    chain.message(Role::State, &state(1, 2 * PERIOD - 60, 2 * PERIOD - 50));
    let (answers, passages) = chain.finish();
    assert_eq!(answers.without_beliefs, 1);
    assert_eq!(passages[0].stages[..3], [20, 0, 0]);
    assert!(chain.stages.get(Stage::Perception.name()).is_none());
}

#[test]
fn clocks_that_are_missing_make_no_stages() {
    let mut chain = Chain::new(&processes(), Some(PERIOD));
    chain.message(Role::State, &state(0, 0, 0));
    chain.message(Role::Command, &stamp(0, EVADER, [0, 0, 0, PERIOD + 50]));
    chain.message(Role::Command, &stamp(0, 77, [1, 2, 3, PERIOD + 60]));
    chain.message(Role::State, &state(1, 2 * PERIOD, 2 * PERIOD));
    let (answers, passages) = chain.finish();
    assert_eq!((answers.in_time, passages.len()), (1, 0));
}
