//! Tables on a terminal.

use std::fmt;
use std::io;

use comfy_table::{CellAlignment, ColumnConstraint, LineStyle, Table, TableStyle};
use terminal_size::{Width, terminal_size_of};

/// Table style with one rule, below the header.
const STYLE: TableStyle =
    TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// Importance of a column: on a narrow terminal, the column with the largest number is left out first; 0 stays.
pub type Importance = u8;

/// A table for people. On a terminal that is too narrow for it, it has fewer columns; elsewhere it has all of them. Cells
/// are neither wrapped nor cut.
#[derive(Debug, Clone)]
pub struct TerminalTable {
    table: Table,
    importance: Vec<Importance>,
}

impl TerminalTable {
    /// Creates a table with these columns: the first `texts` are left-aligned, the others right-aligned.
    pub fn new<T: Into<String>>(
        columns: impl IntoIterator<Item = (T, Importance)>,
        texts: usize,
    ) -> Self {
        let (header, importance): (Vec<String>, _) = columns
            .into_iter()
            .map(|(title, importance)| (title.into(), importance))
            .unzip();
        let mut table = Table::new();
        table.load_style(STYLE).set_header(header);
        for column in table.column_iter_mut().skip(texts) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        Self { table, importance }
    }

    /// Adds a row: a cell for every column.
    pub fn add_row<T: Into<String>>(&mut self, cells: impl IntoIterator<Item = T>) {
        let cells: Vec<String> = cells.into_iter().map(Into::into).collect();
        self.table.add_row(cells);
    }

    /// Returns the table as text, at most `width` characters wide if columns may be left out for that.
    pub fn within(&self, width: usize) -> String {
        let mut table = self.table.clone();
        let mut shown: Vec<usize> = (0..self.importance.len()).collect();
        while table.lines().any(|line| line.chars().count() > width) {
            let last = shown
                .iter()
                .copied()
                .max_by_key(|&i| (self.importance[i], i));
            let Some(last) = last.filter(|&i| self.importance[i] > 0) else {
                break;
            };
            shown.retain(|&i| i != last);
            if let Some(column) = table.column_mut(last) {
                column.set_constraint(ColumnConstraint::Hidden);
            }
        }
        let text = table.to_string();
        match self.importance.len() - shown.len() {
            0 => text,
            n => format!("{text}\n(a wider terminal shows {n} more)"),
        }
    }
}

impl fmt::Display for TerminalTable {
    /// Writes the table as wide as the terminal at stdout permits, and whole if stdout is no terminal.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = terminal_size_of(io::stdout());
        let width = width.map_or(usize::MAX, |(Width(columns), _)| usize::from(columns));
        f.write_str(&self.within(width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> TerminalTable {
        let columns = [
            ("topic", 0),
            ("messages", 1),
            ("first (s)", 3),
            ("last (s)", 3),
            ("lost", 2),
        ];
        let mut table = TerminalTable::new(columns, 1);
        table.add_row(["perception/belief", "1200", "0.00", "59.95", "0"]);
        table.add_row(["world/state", "1", "", "59.95", "12"]);
        table
    }

    #[test]
    fn the_least_important_columns_are_left_out_and_the_rest_is_whole() {
        let titles = |width: usize| {
            let text = table().within(width);
            let lines: Vec<&str> = text.lines().collect();
            assert!(
                lines.len() >= 4 && lines[2].starts_with(" perception/belief "),
                "{text}"
            );
            assert!(lines[3].starts_with(" world/state "), "{text}");
            lines[0]
                .split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(titles(usize::MAX), "topic messages first (s) last (s) lost");
        assert_eq!(titles(58), "topic messages first (s) lost");
        assert_eq!(titles(40), "topic messages lost");
        assert_eq!(titles(30), "topic messages");
        assert_eq!(titles(20), "topic");
        assert_eq!(titles(3), "topic");
    }

    #[test]
    fn a_table_says_that_columns_are_left_out() {
        assert!(
            table()
                .within(40)
                .ends_with("\n(a wider terminal shows 2 more)")
        );
        assert!(!table().within(80).contains("wider"));
    }
}
