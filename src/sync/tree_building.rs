//! Where trees of meshes are built.

use super::mesh_data::{MeshCopy, MeshFault};
use super::meshes::MeshResult;
use crate::bvh::BuildOptions;
use bevy::app::App;
use bevy::asset::AssetId;
use bevy::ecs::resource::Resource;
use bevy::mesh::Mesh;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;

/// When trees of meshes are built.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TreeBuilding {
    /// On threads of their own; no frame waits but for the tree over the objects. Objects keep the mesh that they had until the new one's tree is there,
    /// and those that had none appear with it: see [`Traced::pending`](super::Traced).
    #[default]
    InBackground,
    /// Within the frame that notices the edit, on the current rayon pool.
    AtOnce,
}

/// Runs a frame that waits for all trees, those of its own edits included: after it
/// [`Traced`](super::Traced) is what the entities are.
pub fn finish(app: &mut App) {
    let before = app.world().get_resource::<TreeBuilding>().copied();
    app.insert_resource(TreeBuilding::AtOnce);
    app.update();
    app.insert_resource(before.unwrap_or_default());
}

/// The thread that builds the tree over the objects while the frame waits: what is done in parallel
/// there would wait for the tracer's threads elsewhere, and they are busy until a pass ends.
#[derive(Resource, Default)]
pub(super) struct TopLevelThread(Option<ThreadPool>);

impl TopLevelThread {
    /// Does the work there, or here where the system has no thread to give.
    pub fn run<R: Send>(&mut self, work: impl FnOnce() -> R + Send) -> R {
        if self.0.is_none() {
            let pool = ThreadPoolBuilder::new().num_threads(1);
            self.0 = pool.thread_name(|_| "top level".into()).build().ok();
        }
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// A mesh with its tree.
pub(super) struct Built {
    pub id: AssetId<Mesh>,
    /// What it was built with.
    pub options: BuildOptions,
    pub mesh: MeshResult,
}

/// The threads that build trees, once there is something to build. Of their own, because the
/// tracer's are busy until a pass over the picture ends.
pub(super) struct TreeThreads {
    pool: Option<ThreadPool>,
    sender: Sender<Built>,
    /// One system uses it; the lock lets the resource be shared.
    receiver: Mutex<Receiver<Built>>,
}

impl Default for TreeThreads {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Self {
            pool: None,
            sender,
            receiver: Mutex::new(receiver),
        }
    }
}

impl TreeThreads {
    /// Builds a mesh's tree: on one of the threads, or here where the system has none to give.
    pub fn build(&mut self, id: AssetId<Mesh>, copy: MeshCopy, options: BuildOptions) {
        let sender = self.sender.clone();
        let work = move || {
            // A panic would be a bug; it must not take the app with it, nor keep it waiting.
            let built = catch_unwind(AssertUnwindSafe(|| copy.build(&options)));
            let broken = |_| Err(MeshFault::Broken("its tree could not be built".into()));
            let mesh = built.unwrap_or_else(broken).map(Arc::new);
            // Nobody receives it where the app has ended.
            let _ = sender.send(Built { id, options, mesh });
        };
        if self.pool.is_none() {
            // Half of the cores: the picture goes on being traced meanwhile.
            let threads = available_parallelism().map_or(1, |n| n.get().div_ceil(2));
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(|i| format!("trees {i}"));
            self.pool = pool.build().ok();
        }
        match &self.pool {
            Some(pool) => pool.spawn(work),
            None => work(),
        }
    }

    /// What has been built since this was asked last.
    pub fn finished(&self) -> Vec<Built> {
        self.receiver().try_iter().collect()
    }

    /// Waits for `count` trees.
    pub fn finish(&self, count: usize) -> Vec<Built> {
        self.receiver().iter().take(count).collect()
    }

    fn receiver(&self) -> std::sync::MutexGuard<'_, Receiver<Built>> {
        self.receiver.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
