//! Speed against error: what Glassbox measures about itself, on any scene.
//!
//! A [`Report`] has a [`Section`] for each [`Part`] that is asked for:
//!
//! | part | what is set against what |
//! |---|---|
//! | [`kernels`] | rays a second against errors of `t`, of barycentrics, and leaks; builders: time against quality |
//! | [`sampling`] | the picture's error against seconds and rays, for each way to choose samples |
//! | [`features`] | what each system costs unused, on but absent, and used; what it changes |
//! | [`stability`] | the hard cases: figures and verdicts |
//!
//! and one more, of what edits cost, where [`Options::editing`] brings the figures of that benchmark.
//!
//! Sections are data: sentences, [`Table`]s, [`Plot`]s and pictures. [`write_report`] makes files of them. Times are
//! medians of rounds in which everything that is compared takes turns, so that what else the machine does meets all
//! alike; everything that is not a time follows from the seed.
//!
//! Apart from reports: [`performance`], a scene's picture timed with each builder.

mod document;
mod editing;
pub mod features;
mod fit;
pub mod kernels;
mod machine;
mod pareto;
pub mod performance;
mod plot;
pub mod sampling;
mod section;
pub mod stability;
mod subject;
mod table;
mod timing;

pub use document::{is_report_file, write_report};
pub use machine::Machine;
pub use plot::{Axis, Dash, Marker, Plot, Series};
pub use section::{Options, Part, Report, Section, Watch, run};
pub use subject::Subject;
pub use table::{Cell, Table};
