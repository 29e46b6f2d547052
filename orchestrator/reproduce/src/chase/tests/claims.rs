//! Tests of the claims as data.

use std::collections::BTreeSet;

use super::super::list;
use super::{Evidence, evidence};
use crate::claim::{Claim, Verdict};

fn claim(claims: &[Claim], id: &str) -> Claim {
    claims.iter().find(|claim| claim.id == id).unwrap().clone()
}

#[test]
fn every_statement_and_every_value_of_the_figures_is_a_claim() {
    for evidence in [evidence(), Evidence::default()] {
        let claims = list(&evidence);
        assert_eq!(claims.len(), 2 * 9 + 12 + 6);
        let ids: BTreeSet<&str> = claims.iter().map(|claim| claim.id.as_str()).collect();
        assert_eq!(ids.len(), claims.len());
        for claim in &claims {
            let has_data = claim.verdict != Verdict::NoData;
            assert_eq!(has_data, claim.ours.n > 0, "{claim:?}");
            assert_eq!(has_data, claim.ours.interval.is_some(), "{claim:?}");
        }
    }
}

#[test]
fn a_claim_has_the_number_that_decides() {
    let claims = list(&evidence());
    // 35 % of 200 games against 3 of 10.
    let value = claim(&claims, "chase.fig3.particle_filter.0.8");
    assert_eq!(value.published.value, Some(0.3));
    assert_eq!((value.ours.value, value.ours.n), (Some(0.35), 200));
    assert_eq!(value.verdict, Verdict::Confirmed);
    // 5 % at 1.5 times the speed is none of the paper's.
    let missing = claim(&claims, "chase.fig2.rrt_star_line.1.5");
    assert_eq!((missing.verdict, missing.ours.n), (Verdict::NoData, 0));
    let order = claim(&claims, "chase.a.ours");
    assert!(order.ours.text.ends_with(", the least of 8"), "{order:?}");
    let crossing = claim(&claims, "chase.e.ours");
    assert_eq!(crossing.ours.text, "1.0× … 1.5×");
    assert_eq!(crossing.details.len(), 2);
    let rise = claim(&claims, "chase.f2.ours");
    assert!(rise.ours.interval.unwrap().low > 0.0);
    let found = claim(&claims, "chase.g.paper");
    assert_eq!((found.ours.value, found.ours.n), (Some(0.325), 40));
}
