//! Tables: as Markdown and on a terminal with three digits, as CSV with all of them.

use std::fmt::Write;

/// A table with a name for its file.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The file's name without its extension.
    pub file: String,
    /// What it holds, for people.
    pub title: String,
    /// Names of the columns, with their units.
    pub columns: Vec<String>,
    /// A cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// What stands in a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A measured figure.
    Number(f64),
    /// A counted one.
    Count(u64),
    /// Nothing was measured.
    Empty,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

impl Cell {
    fn short(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => digits(*number, 3),
            Self::Count(count) => count.to_string(),
            Self::Empty => "–".to_owned(),
        }
    }

    fn of_field(field: &str) -> Self {
        match (field, field.parse(), field.parse()) {
            ("", ..) => Self::Empty,
            (_, Ok(count), _) => Self::Count(count),
            (_, _, Ok(number)) => Self::Number(number),
            _ => Self::Text(field.to_owned()),
        }
    }

    fn exact(&self) -> String {
        match self {
            Self::Text(text) if text.contains([',', '"', '\n', '\r']) => {
                format!("\"{}\"", text.replace('"', "\"\""))
            }
            Self::Text(text) => text.clone(),
            Self::Number(number) => number.to_string(),
            Self::Count(count) => count.to_string(),
            Self::Empty => String::new(),
        }
    }
}

impl Table {
    /// An empty table.
    pub fn new(file: &str, title: &str, columns: &[&str]) -> Self {
        Self {
            file: file.to_owned(),
            title: title.to_owned(),
            columns: columns.iter().map(|&column| column.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push<const N: usize>(&mut self, row: [Cell; N]) {
        debug_assert_eq!(N, self.columns.len(), "{}: a cell a column", self.title);
        self.rows.push(row.into());
    }

    /// GitHub's Markdown: words to the left, figures to the right.
    pub fn markdown(&self) -> String {
        let escape = |text: &str| text.replace('|', "\\|").replace('\n', " ");
        let mut text = String::new();
        let names: Vec<String> = self.columns.iter().map(|name| escape(name)).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {} |", names.join(" | "));
        let rules: Vec<&str> = (0..self.columns.len())
            .map(|column| if self.is_words(column) { "---" } else { "---:" })
            .collect();
        let _ = writeln!(text, "| {} |", rules.join(" | "));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|cell| escape(&cell.short())).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text
    }

    /// Columns side by side, for a terminal.
    pub fn plain(&self) -> String {
        let mut lines = vec![self.columns.clone()];
        lines.extend((self.rows.iter()).map(|row| row.iter().map(Cell::short).collect()));
        let width = |column: usize| {
            let cells = lines.iter().map(|line| line[column].chars().count());
            cells.max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let mut text = String::new();
        for line in &lines {
            let cells: Vec<String> = (line.iter().zip(&widths).enumerate())
                .map(|(column, (cell, &width))| {
                    if self.is_words(column) {
                        format!("{cell:width$}")
                    } else {
                        format!("{cell:>width$}")
                    }
                })
                .collect();
            let _ = writeln!(text, "{}", cells.join("  ").trim_end());
        }
        text
    }

    /// Comma-separated values with a header (RFC 4180).
    pub fn csv(&self) -> String {
        let header = self.columns.iter().map(|name| Cell::Text(name.clone()));
        let mut text = line(&header.collect::<Vec<_>>());
        for row in &self.rows {
            text += &line(row);
        }
        text
    }

    /// Reads a header, then rows of as many fields, a line each (RFC 4180, but for line breaks within fields). The error
    /// names the line.
    pub fn from_csv(file: &str, title: &str, text: &str) -> Result<Self, String> {
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty());
        let (_, header) = lines.next().ok_or("is empty; a header is the least")?;
        let mut table = Self::new(file, title, &[]);
        table.columns = fields(header);
        for (number, line) in lines {
            let row: Vec<Cell> = fields(line)
                .iter()
                .map(|field| Cell::of_field(field))
                .collect();
            if row.len() != table.columns.len() {
                let (found, wanted) = (row.len(), table.columns.len());
                return Err(format!(
                    "line {}: {found} fields instead of {wanted}",
                    number + 1
                ));
            }
            table.rows.push(row);
        }
        Ok(table)
    }

    fn is_words(&self, column: usize) -> bool {
        (self.rows.iter()).any(|row| matches!(row[column], Cell::Text(_)))
    }
}

/// The fields of a line; quotes keep commas together, and two of them are one.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        let last = fields.len() - 1;
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                fields[last].push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            _ => fields[last].push(character),
        }
    }
    fields
}

fn line(cells: &[Cell]) -> String {
    let cells: Vec<String> = cells.iter().map(Cell::exact).collect();
    cells.join(",") + "\n"
}

/// A number with so many significant digits; very large and very small ones with a power of ten.
pub(super) fn digits(number: f64, count: usize) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    if !number.is_finite() {
        return number.to_string();
    }
    let scientific = format!("{number:.*e}", count - 1);
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse().ok());
    let exponent: i32 = exponent.unwrap_or(0);
    if (-3..6).contains(&exponent) {
        let decimals = (count as i32 - 1 - exponent).max(0) as usize;
        format!("{number:.decimals$}")
    } else {
        scientific
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits_in_a_table_and_all_of_them_in_a_file() {
        for (number, text) in [
            (0.0, "0"),
            (1.0 / 3.0, "0.333"),
            (12345.0, "12345"),
            (0.00999999, "0.0100"),
            (1.5e-7, "1.50e-7"),
            (2.0e9, "2.00e9"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(digits(number, 3), text);
        }
        let mut table = Table::new("a", "A", &["name", "value"]);
        table.push(["x, \"y\"".into(), 0.1234567.into()]);
        table.push(["z|".into(), Cell::Empty]);
        assert_eq!(table.csv(), "name,value\n\"x, \"\"y\"\"\",0.1234567\nz|,\n");
        assert_eq!(
            table.markdown(),
            "| name | value |\n| --- | ---: |\n| x, \"y\" | 0.123 |\n| z\\| | – |\n"
        );
        assert_eq!(
            table.plain(),
            "name    value\nx, \"y\"  0.123\nz|          –\n"
        );
    }
}
