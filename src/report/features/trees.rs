//! The tree is a feature too (S5, S6, S10): the same picture, sooner.

use super::{Specimen, effort, rounds};
use crate::bvh::{BuildOptions, Builder};
use crate::report::timing::take_turns;
use crate::report::{Options, Table};
use glam::UVec2;
use std::hint::black_box;

/// The time of the plain scene with each builder; a picture that differs is a failure.
pub(super) fn measure(options: &Options, failures: &mut Vec<String>) -> Table {
    let (side, spp) = effort(options);
    let builders = [
        ("none", Builder::None),
        ("median", Builder::Median),
        ("SAH", Builder::Sah),
        ("PLOC", Builder::Ploc),
    ];
    let mut plain = Specimen::plain();
    plain.settings.size = UVec2::splat(side);
    plain.settings.spp = spp;
    let specimens = builders.map(|(_, builder)| {
        plain.rebuilt(&BuildOptions {
            builder,
            ..BuildOptions::default()
        })
    });
    let times = take_turns(builders.len(), rounds(options).div_ceil(2), |i| {
        black_box(specimens[i].picture());
    });
    let expected = specimens[0].picture();
    let mut table = Table::new(
        "trees",
        "S5, S6, S10: the same picture of a thousand triangles through each builder's tree",
        &["builder", "ms", "time / without a tree", "picture"],
    );
    for (i, (name, _)) in builders.iter().enumerate() {
        let same = specimens[i].picture() == expected;
        if !same {
            failures.push(format!("builder {name} gives another picture"));
        }
        table.push([
            (*name).into(),
            (1e3 * times[i]).into(),
            (times[i] / times[0]).into(),
            (if same { "identical" } else { "differs" }).into(),
        ]);
    }
    table
}
