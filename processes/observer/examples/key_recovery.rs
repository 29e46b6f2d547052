//! How many goals a key takes to be recovered, by generator, speed and noise.

#[path = "../tests/all/drive.rs"]
mod drive;

use drive::{DT, Drive, Place};
use generators::{AnySource, Emission, Key, KeyKind, Source as _};
use kit::planner::Planner;
use nalgebra::Point2;
use observer::knowledge::{CatKind, CatKnowledge, ChebyshevForm, ChebyshevKnowledge};
use observer::layout::{Layout, Slot};
use observer::legs::Legs;
use observer::moment::{Look, Moment, Seen};
use observer::predictors::Predictor;
use observer::predictors::key::{Finder, KeyHunter};
use rand::SeedableRng as _;
use sim_backend::blur::BlurredMap;
use sim_backend::grid::{Grid, GridFrame};
use sim_backend::pose::Pose2;
use tracking::params::SensorParams;
use tracking::sighting::gaussian_pair;
use tracking::space::Space;
use tracking::watch::Watch;

struct Found {
    after: Option<usize>,
    made_out: f64,
    wrong: bool,
}

fn watch<P: Planner, F: Finder + 'static>(
    mut drive: Drive<P>,
    layout: &Layout,
    finder: F,
    noise: f64,
    seed: u64,
    most: usize,
) -> Found {
    let frame = GridFrame {
        width: 10,
        height: 10,
        resolution: 0.1,
        origin: Point2::new(0.0, 0.0),
    };
    let map = BlurredMap::new(&Grid::filled(frame, true), 0.1).unwrap();
    let (space, who) = (Space::new(&map), Watch::new(&SensorParams::default()));
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut legs = Legs::new(0.05);
    let mut hunter = KeyHunter::new(layout.clone(), finder, 0.05, 0.03);
    let mut found = Found {
        after: None,
        made_out: 0.0,
        wrong: false,
    };
    for tick in 0_u64..40_000 {
        let pose = drive.pose();
        let ((x, y), (turn, _)) = (gaussian_pair(&mut rng), gaussian_pair(&mut rng));
        let look = Look {
            time: tick as f64 * DT,
            dt: DT,
            seen: Some(Seen {
                position: Point2::new(pose.x + noise * x, pose.y + noise * y),
                heading: pose.theta + noise * turn,
                sigma: noise,
                heading_sigma: noise,
            }),
            visibility: 1.0,
        };
        let goal = legs.observe(&look);
        hunter.observe(&Moment {
            look,
            goal,
            goals_lost: legs.take_lost(),
            space: &space,
            watch: &who,
        });
        drive.tick();
        let reached = drive
            .reports
            .iter()
            .filter(|r| r.waypoint.number > 0)
            .count();
        if hunter.key_recovered() && found.after.is_none() {
            found.after = Some(reached);
            found.made_out = f64::from(hunter.goals_observed()) / reached as f64;
            let ahead: Vec<_> = hunter.upcoming().take(40).collect();
            let count = drive.reports.len();
            while drive.reports.len() < count + 45 {
                drive.tick();
            }
            let real: Vec<_> = drive.reports[count.saturating_sub(3)..]
                .iter()
                .map(|r| r.waypoint.point)
                .collect();
            let missing = ahead
                .iter()
                .take(35)
                .filter(|a| !real.iter().any(|r| (*r - **a).norm() < 1e-3))
                .count();
            found.wrong = missing > 2;
            return found;
        }
        if reached >= most {
            break;
        }
    }
    found.made_out = f64::from(hunter.goals_observed()) / most as f64;
    found
}

const OCTAGON: [[f64; 2]; 8] = [
    [5.0, 0.0],
    [0.0, 5.0],
    [0.0, 10.0],
    [5.0, 15.0],
    [10.0, 15.0],
    [15.0, 10.0],
    [15.0, 5.0],
    [10.0, 0.0],
];

fn row(name: &str, most: usize, all: &[Found]) {
    let mut counts: Vec<_> = all.iter().map(|f| f.after.unwrap_or(999)).collect();
    counts.sort_unstable();
    let within = counts.iter().filter(|&&c| c < most).count();
    let made_out = all.iter().map(|f| f.made_out).sum::<f64>() / all.len() as f64;
    println!(
        "{name}: {within}/{} within {most}; median {} max {}; made out {:.2}; wrong {} {:?}",
        all.len(),
        counts[counts.len() / 2],
        counts[counts.len() - 1],
        made_out,
        all.iter().filter(|f| f.wrong).count(),
        counts
    );
}

fn main() {
    let keys: u64 = std::env::args().nth(1).map_or(20, |n| n.parse().unwrap());
    let which = std::env::args().nth(2).unwrap_or_default();
    for (alpha, v_max, omega_max) in [(1.0, 1.0, 5.2), (1.7, 1.8, 12.0)] {
        for kind in [
            KeyKind::CatF64,
            KeyKind::Cat64,
            KeyKind::CatP,
            KeyKind::Keyed,
        ] {
            for noise in [0.0, 0.005, 0.01] {
                let name = format!("{kind} alpha {alpha} noise {noise}");
                if !name.contains(&which) {
                    continue;
                }
                let generator = match kind {
                    KeyKind::CatF64 => CatKind::CatF64,
                    KeyKind::Cat64 => CatKind::Cat64,
                    _ => CatKind::CatP,
                };
                let knowledge = CatKnowledge {
                    contour: OCTAGON.to_vec(),
                    t_max: 120.0,
                    alpha,
                    generator,
                    ..CatKnowledge::default()
                };
                let layout = knowledge.layout().unwrap();
                let place = Place {
                    bounds: [[-2.0, -2.0], [17.0, 17.0]],
                    obstacles: vec![],
                    start: Pose2::new(5.0, 0.0, 2.356),
                    radius: 0.22,
                    v_max,
                    omega_max,
                    range: Some(0.5),
                };
                let all: Vec<_> = (1..=keys).map(|seed| {
                    let key = Key::from_seed(kind, seed);
                    let drive = Drive::<patrol_awg::process::PatrolAwgPlanner>::new(&place, &format!("mission = {{ contour = {OCTAGON:?}, t_max = 120.0, alpha = {alpha}, key = \"{key}\" }}"));
                    watch(drive, &layout, knowledge.finder(), noise, seed, 240)
                }).collect();
                row(&name, 120, &all);
            }
        }
    }
    for (kind, form) in [
        (KeyKind::ChebP(Emission::Arcsine), ChebyshevForm::Arcsine),
        (KeyKind::ChebP(Emission::Raw), ChebyshevForm::Raw),
        (KeyKind::Keyed, ChebyshevForm::Arcsine),
    ] {
        for noise in [0.0, 0.005, 0.01] {
            let name = format!("{kind} coverage noise {noise}");
            if !name.contains(&which) {
                continue;
            }
            let knowledge = ChebyshevKnowledge {
                rectangle: [0.15, 0.15, 9.85, 9.85],
                form,
            };
            let layout = knowledge.layout().unwrap();
            let place = Place {
                bounds: [[0.0, 0.0], [10.0, 10.0]],
                obstacles: vec![],
                start: Pose2::new(5.0, 5.0, 0.0),
                radius: 0.1,
                v_max: 1.0,
                omega_max: 5.0,
                range: None,
            };
            let all: Vec<_> = (1..=keys)
                .map(|seed| {
                    let key = Key::from_seed(kind, seed);
                    let drive = Drive::<coverage_chebyshev::ChebyshevPlanner>::new(
                        &place,
                        &format!("key = \"{key}\""),
                    );
                    watch(drive, &layout, knowledge.finder(), noise, seed, 120)
                })
                .collect();
            row(&name, 31, &all);
        }
    }
    let _ = (Slot::Fixed(Point2::origin()), |mut s: AnySource| {
        s.next_unit()
    });
}
