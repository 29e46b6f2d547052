//! Simulated times for people.

/// Returns a simulated time (s) with two decimals, halves rounded up, without its unit.
///
/// ```
/// assert_eq!(recorder::time_text(42.55), "42.55");
/// assert_eq!(recorder::time_text(8.7), "8.70");
/// // A little less as a binary number.
/// assert_eq!(recorder::time_text(1.005), "1.01");
/// ```
pub fn time_text(time_s: f64) -> String {
    let hundredths = ((time_s * 1e6).round() / 1e4).round();
    format!("{:.2}", hundredths / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_is_rounded_as_a_decimal_number() {
        for milliseconds in 0..300_000_u32 {
            let hundredths = (milliseconds + 5) / 10;
            let expected = format!("{}.{:02}", hundredths / 100, hundredths % 100);
            assert_eq!(time_text(f64::from(milliseconds) / 1e3), expected);
            assert_eq!(time_text(f64::from(milliseconds) * 1e-3), expected);
        }
    }
}
