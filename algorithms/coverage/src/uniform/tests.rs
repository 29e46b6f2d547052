use super::*;
use crate::testing::mean_coverage;

#[test]
fn disc_coverage_at_equal_length_is_that_of_independent_goals() {
    // Means of 30 keys by an independent program; standard deviations of a key 0.01 to 0.02.
    let lengths = [250.0, 500.0, 1000.0, 2000.0];
    let rates = mean_coverage(30, &lengths, |key, workplace, parts| {
        let start = Point2::new(5.0, 5.0);
        let planner = UniformGoals::new(workplace, parts, start, [key; 32]);
        (Box::new(planner), start)
    });
    for (rate, expected) in rates.iter().zip([0.368, 0.566, 0.756, 0.875]) {
        assert!((rate - expected).abs() < 0.012, "{rates:?}");
    }
}
