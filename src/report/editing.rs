//! What edits cost, where an editing benchmark has measured it.

use super::table::digits;
use super::{Cell, Section, Table};

/// Columns that the benchmark writes and that a finding is made of.
const EDIT: &str = "edit";
const SCENE: &str = "scene";
const PICTURE: &str = "picture p50 ms";
const FRAME: &str = "frame p95 ms";

/// The benchmark's table as a section. Of a table with other columns nothing is found, and it is shown as it is.
pub(super) fn section(table: Table) -> Section {
    Section {
        title: "Editing: what is redone, and how soon it is seen".into(),
        findings: finding(&table).into_iter().collect(),
        method: vec![
            "Figures of a benchmark of its own (`cargo bench --bench edits -- --csv FILE.csv`), as it wrote them: medians (p50) and \
             95th percentiles of the milliseconds from an edit, made while the picture before it is being rendered at 1280 × 720, \
             until the app's thread is free again (frame), until the first picture is developed, and until every pixel has a \
             sample (the longest of ten in place of a percentile); how many of forty the render under way took in; and what of \
             the tracer's world was made again."
                .into(),
        ],
        tables: vec![table],
        summary: Some(0),
        ..Section::default()
    }
}

fn finding(table: &Table) -> Option<String> {
    let column = |name: &str| table.columns.iter().position(|column| column == name);
    let (edit, scene) = (column(EDIT)?, column(SCENE)?);
    let (slowest, picture) = most(table, column(PICTURE)?)?;
    let (_, frame) = most(table, column(FRAME)?)?;
    let word = |row: usize, column: usize| match &table.rows[row][column] {
        Cell::Text(text) => text.clone(),
        _ => String::new(),
    };
    Some(format!(
        "Of {} edits, each kind in each scene, each is seen after at most {} ms in the median ({} in {}), and holds the app's thread up for at \
         most {} ms in 95 of 100 cases.",
        table.rows.len(),
        digits(picture, 2),
        word(slowest, edit),
        word(slowest, scene),
        digits(frame, 2),
    ))
}

/// The row with the largest figure of a column, and the figure.
fn most(table: &Table, column: usize) -> Option<(usize, f64)> {
    let figures = table.rows.iter().map(|row| match row[column] {
        Cell::Number(figure) => figure,
        Cell::Count(figure) => figure as f64,
        Cell::Text(_) | Cell::Empty => f64::NAN,
    });
    let known = figures.enumerate().filter(|(_, figure)| figure.is_finite());
    known.max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_edit_is_found_and_any_other_table_is_shown_as_it_is() {
        let text = "scene,edit,frame p50 ms,frame p95 ms,picture p50 ms\n\
                    knot,light move,0.5,1.5,12\n\
                    \"a, b\",mesh swap,2,3.27,80.6\n";
        let table = Table::from_csv("editing", "Edits", text).unwrap();
        let section = section(table);
        assert_eq!(
            section.findings,
            [
                "Of 2 edits, each kind in each scene, each is seen after at most 81 ms in the median (mesh swap in a, b), and holds the app's \
                 thread up for at most 3.3 ms in 95 of 100 cases."
            ]
        );
        let other = Table::from_csv("editing", "Edits", "a,b\n1,2\n").unwrap();
        let section = super::section(other);
        assert!(section.findings.is_empty());
        assert_eq!(section.tables[0].rows.len(), 1);
    }
}
