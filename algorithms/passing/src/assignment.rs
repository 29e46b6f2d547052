//! Assignment of robots to places at the least total cost.

/// Returns the column of each row so that the sum of the costs is least (Hungarian method); `None` if there are fewer
/// columns than rows, or only infinite sums.
pub fn assign(
    rows: usize,
    columns: usize,
    cost: impl Fn(usize, usize) -> f64,
) -> Option<Vec<usize>> {
    let (mut by_row, mut by_column) = (vec![0.0; rows], vec![0.0; columns]);
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    for first in 0..rows {
        // The shortest way from the row to a column without one, in costs reduced by the potentials.
        let mut least = vec![(f64::INFINITY, None); columns];
        let mut done = vec![false; columns];
        let (mut row, mut last) = (first, None);
        let end = loop {
            let open = (0..columns).filter(|&column| !done[column]);
            for column in open.clone() {
                let reduced = cost(row, column) - by_row[row] - by_column[column];
                if reduced < least[column].0 {
                    least[column] = (reduced, last);
                }
            }
            let next = open.min_by(|&a, &b| least[a].0.total_cmp(&least[b].0))?;
            let step = least[next].0;
            if !step.is_finite() {
                return None;
            }
            by_row[first] += step;
            for column in 0..columns {
                if done[column] {
                    by_column[column] -= step;
                    if let Some(row) = row_of[column] {
                        by_row[row] += step;
                    }
                } else {
                    least[column].0 -= step;
                }
            }
            done[next] = true;
            last = Some(next);
            match row_of[next] {
                Some(taken) => row = taken,
                None => break next,
            }
        };
        let mut column = end;
        loop {
            if let Some(before) = least[column].1 {
                row_of[column] = row_of[before];
                column = before;
            } else {
                row_of[column] = Some(first);
                break;
            }
        }
    }
    let column = |row: usize| row_of.iter().position(|&other| other == Some(row));
    (0..rows).map(column).collect()
}
