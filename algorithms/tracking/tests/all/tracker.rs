//! A team's perception over several opponents.

use std::sync::Arc;

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::pose::Pose2;
use nalgebra::Point2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tracking::params::{HeadingModel, PerceptionParams};
use tracking::particle_filter::MotionLimits;
use tracking::space::Space;
use tracking::tracker::{Perception, PerceptionError, TargetSetup, TargetTruth, Track};

const LIMITS: MotionLimits = MotionLimits {
    v_max: 0.5,
    v_reverse_max: 0.05,
    omega_max: 1.0,
};
const DT: f64 = 0.05;

/// An 8 m × 6 m room with a wall across it from the bottom to y = 1.
fn map() -> BlurredMap {
    let frame = GridFrame {
        width: 160,
        height: 120,
        resolution: 0.05,
        origin: Point2::new(-4.0, -3.0),
    };
    let mut free = Grid::filled(frame, true);
    for row in 0..frame.height {
        for col in 0..frame.width {
            let p = frame.center(col, row);
            let wall = p.x.abs() > 3.8 || p.y.abs() > 2.8;
            free.cells[frame.index(col, row)] = !(wall || (p.x.abs() < 0.2 && p.y < 1.0));
        }
    }
    BlurredMap::new(&free, 0.15).unwrap()
}

fn space(map: &BlurredMap) -> Arc<Space> {
    Arc::new(Space::new(map))
}

fn setup(robot: usize, start: Option<Pose2>) -> TargetSetup {
    TargetSetup {
        robot,
        limits: LIMITS,
        start,
        rng: ChaCha8Rng::seed_from_u64(robot as u64),
    }
}

fn bits(track: &Track) -> Vec<u32> {
    track
        .particles()
        .flat_map(|p| [p.x, p.y, p.theta, p.weight])
        .map(f32::to_bits)
        .collect()
}

fn police() -> [Pose2; 2] {
    [Pose2::new(3.0, 0.0, 3.0), Pose2::new(2.0, -2.0, 3.0)]
}

/// Drives robot 7 along the visible side with the given headings reported as its truth.
fn run(params: &PerceptionParams, heading: f64, others: &[usize]) -> Perception {
    let mut targets = vec![setup(7, Some(Pose2::new(1.0, -2.0, 0.0)))];
    targets.extend(others.iter().map(|&robot| setup(robot, None)));
    let mut perception = Perception::new(params, space(&map()), targets).unwrap();
    for tick in 0..80 {
        let y = -2.0 + 0.02 * f64::from(tick);
        let mut truths = vec![TargetTruth {
            robot: 7,
            pose: Pose2::new(1.0, y, heading),
        }];
        for &robot in others {
            truths.push(TargetTruth {
                robot,
                pose: Pose2::new(-2.0, 0.0, 0.0),
            });
        }
        perception.update(&police(), &truths, DT).unwrap();
    }
    perception
}

#[test]
fn true_headings_do_not_reach_the_belief() {
    let params = PerceptionParams::default();
    let (a, b) = (run(&params, 1.5, &[]), run(&params, -2.0, &[]));
    assert_eq!(a.tracks()[0].sighting(), b.tracks()[0].sighting());
    assert_eq!(bits(&a.tracks()[0]), bits(&b.tracks()[0]));
    // A sensor that measures headings does distinguish them.
    let mut params = PerceptionParams::default();
    params.sensor.heading = HeadingModel::Exact;
    let (a, b) = (run(&params, 1.5, &[]), run(&params, -2.0, &[]));
    assert_ne!(bits(&a.tracks()[0]), bits(&b.tracks()[0]));
    assert!((a.tracks()[0].belief().mean.theta - 1.5).abs() < 0.1);
}

/// FNV-1a over all outputs of perception. A change of these numbers on another machine, or at another
/// vector width or optimisation level, breaks replay; a change of the algorithm may change them.
#[test]
fn the_bits_are_the_same_everywhere() {
    let mut params = PerceptionParams::default();
    params.filter.particles = 5000;
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut eat = |word: u64| hash = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    for track in run(&params, 0.0, &[3]).tracks() {
        for word in bits(track) {
            eat(word.into());
        }
        let belief = track.belief();
        for value in [
            belief.effective_sample_size,
            belief.mean.x,
            belief.mean.y,
            belief.mean.theta,
            belief.covariance_xy,
        ] {
            eat(value.to_bits());
        }
        eat(track.sighting().visibility.to_bits());
    }
    assert_eq!(hash, 17_555_872_898_124_615_489);
}

#[test]
fn the_heading_is_learned_from_the_motion() {
    let perception = run(&PerceptionParams::default(), 0.0, &[]);
    let belief = perception.tracks()[0].belief();
    let error = (belief.mean.theta - core::f64::consts::FRAC_PI_2).abs();
    assert!(belief.seen && error < 0.5, "{belief:?}");
    assert!(
        (belief.mean.position() - Point2::new(1.0, -0.42)).norm() < 0.1,
        "{belief:?}"
    );
}

#[test]
fn a_belief_does_not_depend_on_the_other_opponents() {
    let params = PerceptionParams::default();
    let (alone, among) = (run(&params, 0.0, &[]), run(&params, 0.0, &[1, 9]));
    assert_eq!(bits(&alone.tracks()[0]), bits(&among.tracks()[0]));
    assert!(!among.tracks()[1].belief().seen);
    assert_eq!(among.tracks()[1].belief().unseen_for, f64::INFINITY);
}

#[test]
fn unseen_opponents_are_believed_outside_the_field_of_view() {
    let perception = run(&PerceptionParams::default(), 0.0, &[3]);
    let track = &perception.tracks()[1];
    assert!(!track.sighting().is_seen());
    let field = perception.space().field();
    let seen = track
        .particles()
        .filter(|p| {
            let at = Point2::new(f64::from(p.x), f64::from(p.y));
            police()
                .iter()
                .any(|o| field.visibility(o.position(), at) > 0.5)
        })
        .count();
    assert!(
        seen * 20 < track.particles().len(),
        "{seen} particles in plain view"
    );
}

#[test]
fn opponents_out_of_the_game_keep_their_belief() {
    let mut perception = run(&PerceptionParams::default(), 0.0, &[3]);
    let before = bits(&perception.tracks()[0]);
    let hidden = TargetTruth {
        robot: 3,
        pose: Pose2::new(-2.0, 0.0, 0.0),
    };
    let tracks = perception.update(&police(), &[hidden], DT).unwrap();
    assert!(!tracks[0].is_active() && tracks[1].is_active());
    assert_eq!((tracks[0].robot(), tracks[1].robot()), (7, 3));
    assert_eq!(bits(&tracks[0]), before);
}

#[test]
fn a_changed_map_changes_what_is_seen() {
    let mut perception = run(&PerceptionParams::default(), 0.0, &[]);
    let truth = [TargetTruth {
        robot: 7,
        pose: Pose2::new(1.0, 1.5, 0.0),
    }];
    assert!(
        perception.update(&police()[..1], &truth, DT).unwrap()[0]
            .sighting()
            .is_seen()
    );
    let old = map();
    let mut free = Grid {
        frame: *old.frame(),
        cells: Vec::new(),
    };
    free.cells.extend(old.occupied().cells.iter().map(|&o| !o));
    for col in 80..160 {
        for row in 76..80 {
            free.cells[row * 160 + col] = false;
        }
    }
    perception.set_map(space(&BlurredMap::new(&free, 0.15).unwrap()));
    let tracks = perception.update(&police()[..1], &truth, DT).unwrap();
    assert!(!tracks[0].sighting().is_seen());
}

#[test]
fn bad_set_ups_and_updates_are_refused_by_name() {
    let mut params = PerceptionParams::default();
    params.filter.particles = 0;
    let error = Perception::new(&params, space(&map()), Vec::new()).unwrap_err();
    assert!(
        error.to_string().starts_with("`filter.particles` is 0"),
        "{error}"
    );

    let mut bad = setup(4, None);
    bad.limits.v_max = f64::NAN;
    let error =
        Perception::new(&PerceptionParams::default(), space(&map()), vec![bad]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "opponent 4: v_max = NaN: expected a finite number ≥ 0"
    );

    let mut perception = Perception::new(
        &PerceptionParams::default(),
        space(&map()),
        vec![setup(4, None)],
    )
    .unwrap();
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = perception.update(&[], &[], dt).unwrap_err();
        assert!(matches!(error, PerceptionError::TimeStep { .. }));
    }
    let unknown = TargetTruth {
        robot: 5,
        pose: Pose2::default(),
    };
    assert_eq!(
        perception.update(&[], &[unknown], DT).unwrap_err(),
        PerceptionError::UnknownTarget { robot: 5 }
    );
    // Invalid poses are not seen and see nothing.
    let nowhere = Pose2 {
        x: f64::NAN,
        y: f64::INFINITY,
        theta: f64::NAN,
    };
    let truth = TargetTruth {
        robot: 4,
        pose: nowhere,
    };
    let tracks = perception.update(&[nowhere], &[truth], DT).unwrap();
    assert!(!tracks[0].sighting().is_seen() && tracks[0].belief().mean.is_finite());
}

#[test]
fn an_intruder_whose_start_is_unknown_is_believed_out_of_view_and_found() {
    let targets = vec![setup(4, None)];
    let mut perception =
        Perception::new(&PerceptionParams::default(), space(&map()), targets).unwrap();
    let truth = TargetTruth {
        robot: 4,
        pose: Pose2::new(-3.0, -2.0, 0.0),
    };
    let mut observer = Pose2::new(3.0, -2.0, 3.0);
    perception.update(&[observer], &[truth], DT).unwrap();
    // Share of the weight that stands in view.
    let in_view = |perception: &Perception, observer: &Pose2| {
        let (track, field) = (&perception.tracks()[0], perception.space().field());
        let (mut seen, mut all) = (0.0, 0.0);
        for p in track.particles() {
            let at = Point2::new(f64::from(p.x), f64::from(p.y));
            all += p.weight;
            if field.visibility(observer.position(), at) >= 0.9 {
                seen += p.weight;
            }
        }
        seen / all
    };
    assert_eq!(in_view(&perception, &observer), 0.0);
    let belief = perception.tracks()[0].belief();
    assert!(!belief.seen && belief.mean.x < 0.0, "{belief:?}");
    assert!(belief.covariance_xx + belief.covariance_yy > 1.0);
    // It drives up its side of the wall, and sees round the end of it.
    for _ in 0..120 {
        observer.x = (observer.x - 0.025).max(0.5);
        observer.y = (observer.y + 0.03).min(2.0);
        perception.update(&[observer], &[truth], DT).unwrap();
        // Particles that come into view weigh little until the next resampling.
        let share = in_view(&perception, &observer);
        assert!(
            perception.tracks()[0].belief().seen || share < 0.1,
            "{share}"
        );
    }
    observer = Pose2::new(-1.0, 2.0, 3.0);
    perception.update(&[observer], &[truth], DT).unwrap();
    let belief = perception.tracks()[0].belief();
    let error = (belief.mean.position() - truth.pose.position()).norm();
    assert!(belief.seen && error < 0.5, "{belief:?}");
}
