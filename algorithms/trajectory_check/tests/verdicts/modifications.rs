//! Changing any number of a valid trajectory makes it invalid.

use proptest::prelude::*;
use trajectory_check::{Violation, check};

use crate::drive::{contract_of, finds};
use crate::valid::any_drive;

proptest! {
    #[test]
    fn no_number_of_any_sample_can_be_changed_unnoticed(
        samples in any_drive(), index in any::<prop::sample::Index>(), field in 0..6_usize,
        up in any::<bool>(), amount in 2e-3..1.0_f64,
    ) {
        let contract = contract_of(&samples);
        let mut forged = samples;
        let index = index.index(forged.len());
        let sample = &mut forged[index];
        let change = if up { amount } else { -amount };
        match field {
            0 => sample.x += change,
            1 => sample.y += change,
            2 => sample.theta += change,
            3 => sample.v += change,
            4 => sample.omega += 10.0 * change,
            _ => sample.t += change,
        }
        let report = check(&contract, &forged);
        prop_assert!(!report.is_valid(), "{field} of {index} by {change}");
    }

    #[test]
    fn no_number_can_be_swapped_for_nan(
        mut samples in any_drive(), index in any::<prop::sample::Index>(), field in 0..6_usize,
    ) {
        let contract = contract_of(&samples);
        let index = index.index(samples.len());
        let sample = &mut samples[index];
        let fields = [
            &mut sample.t, &mut sample.x, &mut sample.y,
            &mut sample.theta, &mut sample.v, &mut sample.omega,
        ];
        for (k, number) in fields.into_iter().enumerate() {
            if k == field {
                *number = f64::NAN;
            }
        }
        let named = |v: &Violation| matches!(v, Violation::NotFinite { index: at, .. } if *at == index);
        prop_assert!(finds(&contract, &samples, named));
    }
}
