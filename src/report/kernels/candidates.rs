//! The kernels that are compared.

use super::Kernel;
use super::embree::{self, Embree};
use super::exact::Exact;
use super::moller_trumbore::MollerTrumbore;
use super::obvhs_trees::{Binary, Wide};
use super::ours::OursWide;
use super::tests_of_triangles::{ObvhsTest, Watertight};
use glam::Vec3;
use std::rc::Rc;

type Build = Box<dyn Fn(&[[Vec3; 3]]) -> Box<dyn Kernel>>;

/// A kernel that can be made for any triangles.
pub(super) struct Candidate {
    /// Whose tree, and how it is walked.
    pub traversal: String,
    /// The triangle test.
    pub test: &'static str,
    /// The library's version and file, of a kernel that was found on the machine.
    pub library: Option<String>,
    build: Build,
}

impl Candidate {
    fn new<K: Kernel + 'static>(
        traversal: &str,
        test: &'static str,
        build: impl Fn(&[[Vec3; 3]]) -> K + 'static,
    ) -> Self {
        Self {
            traversal: traversal.to_owned(),
            test,
            library: None,
            build: Box::new(move |triangles| Box::new(build(triangles))),
        }
    }

    /// Makes the kernel, its tree included.
    pub fn build(&self, triangles: &[[Vec3; 3]]) -> Box<dyn Kernel> {
        (self.build)(triangles)
    }

    /// Traversal and test.
    pub fn name(&self) -> String {
        format!("{}, {}", self.traversal, self.test)
    }

    /// Whether it is one of Glassbox's own traversals.
    pub fn is_ours(&self) -> bool {
        self.traversal.starts_with(OURS)
    }
}

const OURS: &str = "Glassbox";
const WATERTIGHT: &str = "watertight";
const MOLLER_TRUMBORE: &str = "Möller–Trumbore";
const OBVHS: &str = "obvhs";
const F64: &str = "f64";

/// Ours first.
pub(super) fn candidates() -> Vec<Candidate> {
    let (binary, wide) = ("obvhs Bvh2", "obvhs CwBvh");
    let mut all = vec![
        Candidate::new("Glassbox wide", WATERTIGHT, OursWide::build),
        Candidate::new(binary, WATERTIGHT, Binary::<Watertight>::build),
        Candidate::new(binary, MOLLER_TRUMBORE, Binary::<MollerTrumbore>::build),
        Candidate::new(binary, OBVHS, Binary::<ObvhsTest>::build),
        Candidate::new(binary, F64, Binary::<Exact>::build),
        Candidate::new(wide, WATERTIGHT, Wide::<Watertight>::build),
        Candidate::new(wide, MOLLER_TRUMBORE, Wide::<MollerTrumbore>::build),
        Candidate::new(wide, OBVHS, Wide::<ObvhsTest>::build),
        Candidate::new(wide, F64, Wide::<Exact>::build),
    ];
    if let Ok(Some(library)) = embree::find() {
        let (library, name) = (Rc::new(library), "Embree");
        for (test, robust) in [("default", false), ("robust", true)] {
            let of = library.clone();
            let mut candidate = Candidate::new(
                &format!("{name} {}", library.version()),
                test,
                move |triangles: &[[Vec3; 3]]| Embree::build(of.clone(), triangles, robust),
            );
            candidate.library = Some(library.describe());
            all.push(candidate);
        }
    }
    all
}
