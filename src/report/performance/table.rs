//! The performance test's figures as a table, as JSON and as comma-separated values.

use super::{MOST_WITHOUT_TREE, Performance, PerformanceColumn, title};
use crate::inspect::{builder_name, counted};
use serde_json::json;
use std::fmt::Write;

/// A row of the table: its name, and its cell for a builder.
type Row = (&'static str, fn(&PerformanceColumn) -> String);

/// The rows of the table.
const ROWS: [Row; 10] = [
    ("Triangles", |column| column.triangles.to_string()),
    ("Time to create", |column| milliseconds(column.build_ms)),
    ("Time to render, min", |column| milliseconds(column.least())),
    ("Time to render, mean", |column| milliseconds(column.mean())),
    ("Time to render, sigma", |column| {
        milliseconds(column.sigma())
    }),
    ("Time to render, median", |column| {
        milliseconds(column.median())
    }),
    ("Time to render, max", |column| milliseconds(column.most())),
    ("Million rays/s, median", |column| {
        format!("{:.3}", column.mrays_per_s())
    }),
    ("BVH levels", |column| column.levels.to_string()),
    ("Max triangles per leaf", |column| {
        column.largest_leaf.to_string()
    }),
];

fn milliseconds(value: f64) -> String {
    format!("{value:.2} ms")
}

impl Performance {
    /// The rows of the table: a name, and a cell for each builder.
    pub fn rows(&self) -> impl Iterator<Item = (&'static str, Vec<String>)> + '_ {
        ROWS.iter()
            .map(|(name, cell)| (*name, self.columns.iter().map(cell).collect()))
    }

    /// What was rendered, and how: one line.
    pub fn caption(&self) -> String {
        format!(
            "{}x{}, {} spp, {}, {} a builder, taking turns",
            self.size.x,
            self.size.y,
            self.spp,
            counted(self.threads as u64, "thread"),
            counted(self.test.runs.into(), "rendering")
        )
    }

    /// Why there is no column without a tree; `None` where there is one, or none was asked for.
    pub fn left_out_text(&self) -> Option<String> {
        let count = self.left_out?;
        Some(format!(
            "Without a tree: left out, {count} triangles are more than {MOST_WITHOUT_TREE}"
        ))
    }

    /// A table in GitHub's Markdown with a line above it that says what was rendered.
    pub fn markdown(&self) -> String {
        let scene = &self.test.scene;
        let mut text = format!("**{scene}**: {}\n\n", self.caption());
        let mut line = |name: &str, cells: &[String]| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
        };
        let titles = self.columns.iter().map(|column| title(column.builder));
        line("", &titles.map(str::to_owned).collect::<Vec<_>>());
        line("---", &vec!["---:".to_owned(); self.columns.len()]);
        for (name, cells) in self.rows() {
            line(name, &cells);
        }
        if let Some(why) = self.left_out_text() {
            text += &format!("\n{why}.\n");
        }
        text
    }

    /// The figures of [`Self::csv`] as JSON: what was rendered, and an object for each builder.
    pub fn json(&self) -> serde_json::Value {
        let column = |column: &PerformanceColumn| {
            json!({
                "builder": builder_name(column.builder),
                "triangles": column.triangles,
                "build_ms": column.build_ms,
                "render_ms": column.render_ms,
                "render_mean_ms": column.mean(),
                "render_sigma_ms": column.sigma(),
                "render_median_ms": column.median(),
                "rays": column.rays,
                "mrays_per_s": column.mrays_per_s(),
                "levels": column.levels,
                "largest_leaf": column.largest_leaf,
            })
        };
        json!({
            "scene": self.test.scene,
            "size": [self.size.x, self.size.y],
            "spp": self.spp,
            "threads": self.threads,
            "builders": self.columns.iter().map(column).collect::<Vec<_>>(),
            "left_out_triangles": self.left_out,
        })
    }

    /// Comma-separated values with a header: a line for each builder, with all digits, each
    /// rendering's time in the last column with spaces between them.
    pub fn csv(&self) -> String {
        let mut text = "builder,triangles,build ms,render min ms,render mean ms,render sigma ms,\
                        render median ms,render max ms,Mray/s,levels,largest leaf,width,height,spp,\
                        threads,renders ms\n"
            .to_owned();
        for column in &self.columns {
            let times: Vec<String> = column.render_ms.iter().map(f64::to_string).collect();
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                builder_name(column.builder),
                column.triangles,
                column.build_ms,
                column.least(),
                column.mean(),
                column.sigma(),
                column.median(),
                column.most(),
                column.mrays_per_s(),
                column.levels,
                column.largest_leaf,
                self.size.x,
                self.size.y,
                self.spp,
                self.threads,
                times.join(" ")
            );
        }
        text
    }
}
