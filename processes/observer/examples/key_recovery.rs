//! Number of goals from which a key is recovered, for a robot in the simulated world: by generator,
//! speed and noise. `cargo run -p observer --example key_recovery -- [keys] [part of a row's name]`

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../tests/all/drive.rs"]
mod drive;

use chaotic_maps::{Emission, Key, KeyKind};
use drive::{Found, OCTAGON, coverage, patrol, watch, workplace};
use metrics::quantile::quantile;
use observer::knowledge::{CatKind, CatKnowledge, ChebyshevForm, ChebyshevKnowledge};

const NOISES: [f64; 3] = [0.0, 0.005, 0.01];

fn row(name: &str, within: usize, all: &[Found]) {
    let mut after: Vec<f64> = all
        .iter()
        .filter_map(|found| Some(found.after? as f64))
        .collect();
    after.sort_by(f64::total_cmp);
    let made_out = all.iter().map(|found| found.made_out).sum::<f64>() / all.len() as f64;
    println!(
        "{name:32} within {within}: {:2} of {:2}; median {:?}, most {:?}; made out {made_out:.2}; wrong {}",
        after.iter().filter(|&&count| count < within as f64).count(),
        all.len(),
        quantile(&after, 0.5),
        after.last(),
        all.iter().filter(|found| found.wrong).count(),
    );
}

fn patrols(keys: u64, part: &str) {
    for (alpha, limits) in [(1.0, (1.0, 5.2)), (1.7, (1.8, 12.0))] {
        for (kind, generator) in [
            (KeyKind::CatF64, CatKind::CatF64),
            (KeyKind::Cat64, CatKind::Cat64),
            (KeyKind::CatP, CatKind::CatP),
            (KeyKind::Keyed, CatKind::CatP),
        ] {
            for noise in NOISES {
                let name = format!("{kind} width {alpha} noise {noise}");
                if !name.contains(part) {
                    continue;
                }
                let knowledge = CatKnowledge {
                    contour: OCTAGON.to_vec(),
                    alpha,
                    generator,
                    ..CatKnowledge::default()
                };
                let layout = knowledge.layout().expect("a sound octagon");
                let found = |seed| {
                    let drive = patrol(alpha, limits, &Key::from_seed(kind, seed).to_string());
                    let finder = knowledge.finder();
                    watch(drive, &layout, finder, (noise, seed), |_| false, 240)
                };
                row(&name, 120, &(1..=keys).map(found).collect::<Vec<_>>());
            }
        }
    }
}

fn coverages(keys: u64, part: &str) {
    for (kind, form) in [
        (KeyKind::ChebP(Emission::Arcsine), ChebyshevForm::Arcsine),
        (KeyKind::ChebP(Emission::Raw), ChebyshevForm::Raw),
        (KeyKind::Keyed, ChebyshevForm::Arcsine),
    ] {
        for noise in NOISES {
            let name = format!("{kind} coverage noise {noise}");
            if !name.contains(part) {
                continue;
            }
            let knowledge = ChebyshevKnowledge {
                form,
                ..ChebyshevKnowledge::default()
            };
            let found = |seed| {
                let place = workplace(&[], [5.0, 5.0]);
                let drive = coverage(&place, &Key::from_seed(kind, seed).to_string());
                let layout = drive.layout(&knowledge);
                let finder = knowledge.finder();
                watch(drive, &layout, finder, (noise, seed), |_| false, 120)
            };
            row(&name, 30, &(1..=keys).map(found).collect::<Vec<_>>());
        }
    }
}

fn main() {
    let mut args = std::env::args().skip(1);
    let keys = args.next().and_then(|n| n.parse().ok()).unwrap_or(20);
    let part = args.next().unwrap_or_default();
    patrols(keys, &part);
    coverages(keys, &part);
}
