//! Tests of hops, steps and stages.

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
        upstream: if reads_beliefs {
            vec![PERCEPTION]
        } else {
            Vec::new()
        },
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

/// Adds tick 0 with all processes; the pursuer sends its command at this time after the origin.
fn chase(chain: &mut Chain, command: u64) {
    let at = |after: u64| PERIOD + after;
    chain.take(TopicId::WorldState, &state(0, 0, 0));
    let belief = stamp(0, PERCEPTION, [at(100), at(110), at(300), at(310)]);
    chain.take(
        TopicId::Sightings,
        &stamp(0, PERCEPTION, [at(100), at(110), at(290), at(295)]),
    );
    chain.take(TopicId::Belief, &belief);
    chain.take(
        TopicId::Commands,
        &stamp(0, EVADER, [at(50), at(60), at(90), at(95)]),
    );
    let begun = [at(350), at(360), at(command - 5), at(command)];
    chain.take(TopicId::Commands, &stamp(0, PURSUER, begun));
}

fn detail(chain: &Chain) -> &Detail {
    chain.detail.as_ref().unwrap()
}

fn settle(mut chain: Chain) -> (Chain, Answers, Vec<Passage>) {
    chain.settle();
    let (answers, passages) = (detail(&chain).answers, detail(&chain).passages.clone());
    (chain, answers, passages)
}

#[test]
fn the_stages_of_a_tick_add_up_to_the_whole() {
    let mut chain = Chain::new(&processes()).with_detail(Some(PERIOD));
    chase(&mut chain, 500);
    chain.take(
        TopicId::WorldState,
        &state(1, 2 * PERIOD - 60, 2 * PERIOD - 50),
    );
    let (chain, answers, passages) = settle(chain);
    assert_eq!((answers.ticks, answers.in_time, answers.late), (1, 1, 0));
    let passage = passages[0];
    assert_eq!(passage.stages, [20, 90, 200, 50, 140, PERIOD - 560, 10]);
    assert_eq!(passage.stages.iter().sum::<u64>(), passage.whole_ns);
    assert_eq!(passage.reaction_ns, 500);
    let turn = |name: &str| detail(&chain).turns.get(name).unwrap().percentiles().max;
    assert_eq!(turn("perception wakes up"), 0.08);
    assert_eq!(turn("pursuer wakes up"), 0.04);
    assert_eq!(turn("pursuer computes"), 0.135);
    assert_eq!(turn("perception writes"), 0.02, "until its last message");
    assert_eq!(
        detail(&chain)
            .period
            .get(TICK_JITTER)
            .unwrap()
            .percentiles()
            .max,
        0.0
    );
}

#[test]
fn in_lock_step_the_simulator_does_not_wait_for_a_clock() {
    let mut chain = Chain::new(&processes()).with_detail(None);
    chase(&mut chain, 500);
    chain.take(TopicId::WorldState, &state(1, PERIOD + 530, PERIOD + 540));
    let (chain, _, passages) = settle(chain);
    assert_eq!(passages[0].stages, [20, 90, 200, 50, 140, 0, 40]);
    assert!(chain.stages.get(Stage::Wait.name()).is_none());
}

#[test]
fn a_command_after_its_tick_is_late_and_traced_to_the_tick_that_received_it() {
    let mut chain = Chain::new(&processes()).with_detail(Some(PERIOD));
    chase(&mut chain, PERIOD + 100);
    // The simulator received the evader's command in the first turn, the pursuer's in the second.
    chain.take(TopicId::WorldState, &state(1, 2 * PERIOD - 60, PERIOD + 97));
    chain.take(
        TopicId::WorldState,
        &state(2, 3 * PERIOD - 60, 3 * PERIOD - 50),
    );
    let (_, answers, passages) = settle(chain);
    assert_eq!(
        (answers.late, answers.unanswered),
        (1, 1),
        "tick 1 has no answer"
    );
    assert_eq!((passages[0].late_ticks, passages[0].tick), (1, 0));
    assert_eq!(passages[0].stages.iter().sum::<u64>(), passages[0].whole_ns);
}

#[test]
fn a_planner_without_the_beliefs_of_the_tick_is_traced_to_the_state() {
    let mut chain = Chain::new(&processes()).with_detail(Some(PERIOD));
    let at = |after: u64| PERIOD + after;
    chain.take(TopicId::WorldState, &state(0, 0, 0));
    chain.take(
        TopicId::Commands,
        &stamp(0, PURSUER, [at(50), at(60), at(90), at(95)]),
    );
    chain.take(
        TopicId::Belief,
        &stamp(0, PERCEPTION, [at(70), at(80), at(200), at(210)]),
    );
    chain.take(
        TopicId::WorldState,
        &state(1, 2 * PERIOD - 60, 2 * PERIOD - 50),
    );
    let (chain, answers, passages) = settle(chain);
    assert_eq!(answers.without_beliefs, 1);
    assert_eq!(passages[0].stages[..3], [20, 0, 0]);
    assert!(chain.stages.get(Stage::Perception.name()).is_none());
}

#[test]
fn missing_clock_readings_give_no_stages() {
    let mut chain = Chain::new(&processes()).with_detail(Some(PERIOD));
    chain.take(TopicId::WorldState, &state(0, 0, 0));
    chain.take(TopicId::Commands, &stamp(0, EVADER, [0, 0, 0, PERIOD + 50]));
    chain.take(TopicId::Commands, &stamp(0, 77, [1, 2, 3, PERIOD + 60]));
    chain.take(TopicId::WorldState, &state(1, 2 * PERIOD, 2 * PERIOD));
    let (_, answers, passages) = settle(chain);
    assert_eq!((answers.in_time, passages.len()), (1, 0));
}

/// Returns `stamp` with the clock readings of a message that was computed at once.
fn output(tick: u64, source: u32, received_ns: u64, sent_ns: u64) -> Stamp {
    stamp(tick, source, [0, received_ns, received_ns, sent_ns])
}

fn sent_state(tick: u64, received_ns: u64, sent_ns: u64) -> Stamp {
    Stamp {
        origin_ns: sent_ns,
        ..output(tick, SIMULATOR, received_ns, sent_ns)
    }
}

fn only(measured: &BTreeMap<String, Percentiles>, name: &str) -> (u64, f64) {
    let p = measured
        .get(name)
        .unwrap_or_else(|| panic!("{name} missing in {measured:?}"));
    (p.count, p.max)
}

#[test]
fn a_tick_with_beliefs_is_measured_hop_by_hop() {
    let mut chain = Chain::new(&processes());
    let base = 1_000_000;
    chain.take(TopicId::WorldState, &sent_state(5, base - 700, base));
    chain.take(
        TopicId::Sightings,
        &output(5, PERCEPTION, base + 1_000, base + 4_000),
    );
    chain.take(
        TopicId::Belief,
        &output(5, PERCEPTION, base + 1_000, base + 5_000),
    );
    chain.take(
        TopicId::Belief,
        &output(5, PERCEPTION, base + 1_000, base + 6_000),
    );
    chain.take(
        TopicId::Commands,
        &output(5, PURSUER, base + 8_000, base + 9_000),
    );
    chain.take(
        TopicId::Commands,
        &output(5, EVADER, base + 500, base + 800),
    );
    chain.take(
        TopicId::WorldState,
        &sent_state(6, base + 12_000, base + 12_500),
    );
    let measured = chain.percentiles();
    assert_eq!(only(&measured, "simulator to perception"), (1, 1.0));
    assert_eq!(only(&measured, "perception step"), (1, 5.0));
    assert_eq!(only(&measured, "perception to pursuer"), (1, 2.0));
    assert_eq!(only(&measured, "pursuer step"), (1, 1.0));
    assert_eq!(only(&measured, "simulator to evader"), (1, 0.5));
    assert_eq!(only(&measured, "evader step"), (1, 0.3));
    assert_eq!(only(&measured, "pursuer to simulator"), (1, 3.0));
    assert_eq!(only(&measured, WHOLE), (1, 12.0));
    assert_eq!(only(&measured, "simulator step"), (2, 0.7));
}

#[test]
fn without_beliefs_pursuers_answer_the_state() {
    let mut chain = Chain::new(&processes());
    chain.take(TopicId::WorldState, &sent_state(0, 0, 1_000));
    chain.take(TopicId::Commands, &output(0, PURSUER, 3_000, 4_000));
    let measured = chain.percentiles();
    assert_eq!(only(&measured, "simulator to pursuer"), (1, 2.0));
    assert!(!measured.contains_key(WHOLE) && !measured.contains_key("simulator step"));
}

#[test]
fn missing_or_reversed_clock_readings_are_ignored() {
    let mut chain = Chain::new(&processes());
    chain.take(TopicId::WorldState, &sent_state(3, 0, 5_000));
    chain.take(TopicId::Commands, &output(3, EVADER, 4_000, 0));
    chain.take(TopicId::Commands, &output(9, EVADER, 4_000, 5_000));
    chain.take(TopicId::Commands, &output(3, 77, 6_000, 7_000));
    let measured = chain.percentiles();
    assert_eq!(measured.keys().collect::<Vec<_>>(), ["evader step"]);
}

#[test]
fn late_messages_of_a_tick_that_is_still_kept_count() {
    let mut chain = Chain::new(&processes());
    for tick in 0..WINDOW {
        chain.take(
            TopicId::WorldState,
            &sent_state(tick, 0, 1_000 * (tick + 1)),
        );
    }
    chain.take(TopicId::Commands, &output(2, EVADER, 3_500, 3_600));
    chain.take(TopicId::WorldState, &sent_state(WINDOW, 0, 1_000_000));
    chain.take(TopicId::Commands, &output(0, EVADER, 1_500, 1_600));
    let measured = chain.percentiles();
    assert_eq!(only(&measured, "simulator to evader"), (1, 0.5));
}
