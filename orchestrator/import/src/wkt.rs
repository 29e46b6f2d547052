//! Lines in well-known text (OGC 06-103r4), as shapely and `PostGIS` write them.

use std::str::SplitWhitespace;

/// Description of a text that can be read.
pub const FORM: &str = "LINESTRING (x y, …) or MULTILINESTRING ((x y, …), …), also Z, M or ZM, with two or more points";

/// Reads a `LINESTRING` or the parts of a `MULTILINESTRING`, without heights and measures; `None` if the text is anything
/// else or has no point.
pub fn lines(text: &str) -> Option<Vec<Vec<[f64; 2]>>> {
    let mut spaced = text.to_ascii_uppercase();
    for mark in ["(", ")", ","] {
        spaced = spaced.replace(mark, &format!(" {mark} "));
    }
    let mut words = spaced.split_whitespace();
    let kind = words.next()?;
    // A space before the dimension is optional.
    let is_multi = match kind.trim_end_matches(['Z', 'M']) {
        "LINESTRING" => false,
        "MULTILINESTRING" => true,
        _ => return None,
    };
    let mut first = words.next()?;
    if ["Z", "M", "ZM"].contains(&first) {
        first = words.next()?;
    }
    let mut lines = Vec::new();
    if is_multi {
        let mut mark = first;
        // EMPTY has no mark.
        while mark == "(" && lines.is_empty() || mark == "," {
            let first = words.next()?;
            lines.push(line(first, &mut words)?);
            mark = words.next()?;
        }
        (mark == ")").then_some(())?;
    } else {
        lines.push(line(first, &mut words)?);
    }
    lines.retain(|line| !line.is_empty());
    (words.next().is_none() && !lines.is_empty()).then_some(lines)
}

/// Reads `(x y, …)` with at least two points, or `EMPTY`; the first word is given.
fn line(first: &str, words: &mut SplitWhitespace<'_>) -> Option<Vec<[f64; 2]>> {
    let mut points = Vec::new();
    let mut mark = first;
    while mark == "(" && points.is_empty() || mark == "," {
        let mut numbers = Vec::new();
        mark = loop {
            let word = words.next()?;
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                _ => break word,
            }
        };
        match numbers.as_slice() {
            [x, y] | [x, y, _] | [x, y, _, _] => points.push([*x, *y]),
            _ => return None,
        }
    }
    match mark {
        "EMPTY" => points.is_empty().then_some(points),
        ")" => (points.len() > 1).then_some(points),
        _ => None,
    }
}
