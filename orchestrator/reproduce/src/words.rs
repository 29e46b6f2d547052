//! Formats of numbers on the page.

use statistics::Interval;

/// Formats a share: `63.5 %`.
pub fn share(value: f64) -> String {
    format!("{} %", tenths(100.0 * value))
}

/// Formats an interval of shares: `58.1 … 67.6 %`.
pub fn shares(interval: Interval) -> String {
    format!(
        "{} … {} %",
        tenths(100.0 * interval.low),
        tenths(100.0 * interval.high)
    )
}

/// Formats a share with its interval in whole percents: `64 % (58 … 69)`.
pub fn percent(value: f64, interval: Interval) -> String {
    let whole = |share: f64| format!("{:.0}", 100.0 * share);
    format!(
        "{} % ({} … {})",
        whole(value),
        whole(interval.low),
        whole(interval.high)
    )
}

/// Formats a difference of shares in points: `+12.5`.
pub fn points(value: f64) -> String {
    let text = tenths(100.0 * value);
    if text.starts_with('−') || text == "0.0" {
        text
    } else {
        format!("+{text}")
    }
}

/// Formats an interval of differences: `+3.1 … +21.4`.
pub fn point_range(interval: Interval) -> String {
    format!("{} … {}", points(interval.low), points(interval.high))
}

/// Formats a number with one digit after the point and a true minus.
fn tenths(value: f64) -> String {
    decimals(value, 1)
}

/// Formats a number with two digits after the point and a true minus.
pub fn hundredths(value: f64) -> String {
    decimals(value, 2)
}

/// Formats a number with these digits after the point and a true minus.
pub fn decimals(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().any(|c| c.is_ascii_digit() && c != '0') => format!("−{rest}"),
        Some(rest) => rest.to_owned(),
        None => text,
    }
}

/// Formats a p-value: `p = 0.023`, `p < 0.0001`.
pub fn p_value(p: f64) -> String {
    if p < 0.0001 {
        "p < 0.0001".to_owned()
    } else if p < 0.01 {
        format!("p = {p:.4}")
    } else {
        format!("p = {p:.2}")
    }
}

/// Formats a speed relative to the Police: `1.5×`.
pub fn ratio(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0');
    let text = text
        .strip_suffix('.')
        .map_or_else(|| text.to_owned(), |whole| format!("{whole}.0"));
    format!("{text}×")
}

/// Formats an interval of speeds, which may be open: `1.5× … 2.0×`, `above 1.2×`.
pub fn ratio_range(interval: Interval) -> String {
    match (interval.low.is_finite(), interval.high.is_finite()) {
        (true, true) => format!("{} … {}", ratio(interval.low), ratio(interval.high)),
        (true, false) => format!("above {}", ratio(interval.low)),
        (false, true) => format!("below {}", ratio(interval.high)),
        (false, false) => "open".to_owned(),
    }
}

/// Formats several speeds: `1.5×, 2.0× and 3.0×`.
pub fn ratios(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|&v| ratio(v)).collect();
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => words.concat(),
    }
}

/// Escapes text for a cell of a table.
pub fn in_table(text: &str) -> String {
    text.replace('\\', "\\\\")
        .replace('|', "\\|")
        .replace(['\n', '\r'], " ")
}

/// Returns a line with the experiment, seeds and program of results.
pub fn provenance(experiment: &str, seeds: &str, program: &str) -> String {
    format!("- `{experiment}`: seeds {seeds}, Protean {program}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_formatted() {
        assert_eq!(share(0.635), "63.5 %");
        assert_eq!(
            shares(Interval {
                low: 0.0,
                high: 0.2775
            }),
            "0.0 … 27.8 %"
        );
        assert_eq!(
            (points(0.125), points(-0.03)),
            ("+12.5".into(), "−3.0".into())
        );
        assert_eq!((points(0.0), points(-1e-9)), ("0.0".into(), "0.0".into()));
        assert_eq!(p_value(0.65), "p = 0.65");
        assert_eq!(p_value(0.0009), "p = 0.0009");
        assert_eq!(p_value(3e-6), "p < 0.0001");
        assert_eq!(
            (ratio(1.5), ratio(2.0), ratio(0.85)),
            ("1.5×".into(), "2.0×".into(), "0.85×".into())
        );
        assert_eq!(ratios(&[0.8, 0.9, 1.0]), "0.8×, 0.9× and 1.0×");
        assert_eq!(
            (ratios(&[2.0]), ratios(&[])),
            ("2.0×".into(), String::new())
        );
        assert_eq!(in_table("a|b\nc"), "a\\|b c");
    }
}
