//! The figures as tables: for a terminal, as Markdown, as comma-separated values.

use super::super::table::aligned;
use super::BuilderFigures;

/// Names of the columns.
const COLUMNS: [&str; 16] = [
    "builder",
    "triangles",
    "levels",
    "nodes",
    "leaves",
    "largest leaf",
    "SAH cost",
    "EPO",
    "wide nodes",
    "children each",
    "triangles/block",
    "bytes",
    "bytes/triangle",
    "build ms",
    "closest Mray/s",
    "occlusion Mray/s",
];

impl BuilderFigures {
    fn cells(&self) -> [String; 16] {
        let rate = |rate: Option<f64>| rate.map_or_else(|| "-".into(), |rate| format!("{rate:.3}"));
        [
            self.builder.to_owned(),
            self.triangles.to_string(),
            self.levels.to_string(),
            self.nodes.to_string(),
            self.leaves.to_string(),
            self.largest_leaf.to_string(),
            format!("{:.2}", self.sah_cost),
            format!("{:.3}", self.epo),
            self.wide_nodes.to_string(),
            format!("{:.2}", self.children_per_wide_node),
            format!("{:.2}", self.triangles_per_block),
            self.bytes.to_string(),
            format!("{:.1}", self.bytes_per_triangle),
            format!("{:.2}", self.build_ms),
            rate(self.rates.and_then(|rates| rates.closest_mrays_per_s)),
            rate(self.rates.and_then(|rates| rates.occlusion_mrays_per_s)),
        ]
    }
}

/// Header and rows; without the rates where none was measured.
fn cells(rows: &[BuilderFigures]) -> Vec<Vec<String>> {
    let measured = rows.iter().any(|row| row.rates.is_some());
    let columns = if measured { 16 } else { 14 };
    let header = COLUMNS.map(String::from);
    std::iter::once(header)
        .chain(rows.iter().map(BuilderFigures::cells))
        .map(|line| line[..columns].to_vec())
        .collect()
}

impl BuilderFigures {
    /// A table for a terminal.
    pub fn table(rows: &[Self]) -> String {
        aligned(&cells(rows))
    }
}

/// The table in Markdown, and below it both histograms: a column for each builder.
pub fn markdown(rows: &[BuilderFigures]) -> String {
    let mut text = String::new();
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let table = cells(rows);
    for (i, cells) in table.iter().enumerate() {
        text += &line(cells);
        if i == 0 {
            text += &format!("|---|{}\n", "---:|".repeat(cells.len() - 1));
        }
    }
    for (title, first, histogram) in [
        ("Leaves by their triangles", "triangles", true),
        ("Leaves by their depth", "depth", false),
    ] {
        text += &format!("\n{title}:\n\n");
        let names: Vec<String> = rows.iter().map(|row| row.builder.to_owned()).collect();
        text += &format!("| {first} | {} |\n", names.join(" | "));
        text += &format!("|---:|{}\n", "---:|".repeat(names.len()));
        let of = |row: &BuilderFigures, bin: usize| {
            let bins = if histogram {
                &row.leaf_sizes
            } else {
                &row.depths
            };
            bins.get(bin).copied().unwrap_or(0)
        };
        let most = rows
            .iter()
            .map(|row| row.leaf_sizes.len().max(row.depths.len()))
            .max()
            .unwrap_or(0);
        for bin in 0..most {
            let counts: Vec<u32> = rows.iter().map(|row| of(row, bin)).collect();
            if counts.iter().all(|&count| count == 0) {
                continue;
            }
            let counts: Vec<String> = counts.iter().map(u32::to_string).collect();
            let bin = if histogram && bin == crate::bvh::LARGEST_LEAF_BIN {
                format!("{bin} and more")
            } else {
                bin.to_string()
            };
            text += &format!("| {bin} | {} |\n", counts.join(" | "));
        }
    }
    text
}

/// The table as comma-separated values, the histograms as two more columns of numbers with spaces
/// between them.
pub fn csv(rows: &[BuilderFigures]) -> String {
    let join = |bins: &[u32]| {
        bins.iter()
            .map(u32::to_string)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mut text = format!(
        "{},leaves by triangles,leaves by depth\n",
        COLUMNS.join(",")
    );
    for row in rows {
        let cells = row.cells().join(",");
        text += &format!("{cells},{},{}\n", join(&row.leaf_sizes), join(&row.depths));
    }
    text
}
