//! Where trees are built: those of meshes, and the one over the objects.

use super::mesh_data::{MeshCopy, MeshFault};
use super::meshes::MeshResult;
use crate::bvh::{Aggregate, BuildOptions};
use bevy::app::App;
use bevy::asset::AssetId;
use bevy::ecs::resource::Resource;
use bevy::mesh::Mesh;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;
use std::time::Duration;

/// When trees are built, and large pictures made textures.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TreeBuilding {
    /// On threads of their own; no frame waits but 2 ms for the tree over the objects. Objects keep the mesh, materials the
    /// textures and the surroundings the sky that they had until the new one is there; objects that had no mesh appear with
    /// it, and materials that are new are without their large textures until then. What is edited while
    /// the tree over the objects is built shows in a later frame: see [`Traced::pending`](super::Traced). Where
    /// objects come or go meanwhile, the scene is shown as it was when that tree was begun.
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

/// The thread that builds the tree over the objects: what is done in parallel elsewhere would wait for
/// the tracer's threads, and they are busy until a pass ends. Over some thousand objects the tree takes
/// milliseconds, over all triangles ([`Levels::One`](crate::bvh::Levels::One)) it may take seconds.
#[derive(Resource, Default)]
pub(super) struct TopLevelThread {
    pool: Option<ThreadPool>,
    /// What is under way. One system uses it; the lock lets the resource be shared.
    under_way: Option<Mutex<Receiver<std::thread::Result<TopLevel>>>>,
}

/// The tree over the objects, and the number of the objects' list that it is over.
type TopLevel = (u64, Aggregate);

impl TopLevelThread {
    /// Whether a tree is being built that [`finished`](Self::finished) has not given yet.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// Begins a tree there, or builds it here where the system has no thread to give.
    pub fn start(&mut self, work: impl FnOnce() -> TopLevel + Send + 'static) {
        let (sender, receiver) = channel();
        self.under_way = Some(Mutex::new(receiver));
        let work = move || {
            // Nobody receives it where another one is wanted meanwhile.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
        };
        if self.pool.is_none() {
            let pool = ThreadPoolBuilder::new().num_threads(1);
            self.pool = pool.thread_name(|_| "top level".into()).build().ok();
        }
        match &self.pool {
            Some(pool) => pool.spawn(work),
            None => work(),
        }
    }

    /// The tree that is being built, if it is there before so long.
    pub fn finished(&mut self, wait: Duration) -> Option<TopLevel> {
        let receiver = self.under_way.as_mut()?;
        let receiver = receiver.get_mut().unwrap_or_else(PoisonError::into_inner);
        let built = match receiver.recv_timeout(wait) {
            Err(RecvTimeoutError::Timeout) => return None,
            built => built.ok(),
        };
        self.under_way = None;
        // A panic would be a bug, and is the frame's own.
        built.map(|built| built.unwrap_or_else(|panic| resume_unwind(panic)))
    }

    /// Lets go of the tree that is being built.
    pub fn forget(&mut self) {
        self.under_way = None;
    }
}

/// A mesh with its tree.
pub(super) struct Built {
    pub id: AssetId<Mesh>,
    /// What it was built with.
    pub options: BuildOptions,
    pub mesh: MeshResult,
}

/// Builds the tree of a mesh, copied there: on one of the threads, or here where the system has none to give.
pub(super) fn build_tree(
    threads: &mut Threads<Built>,
    id: AssetId<Mesh>,
    options: BuildOptions,
    copy: impl FnOnce() -> Result<MeshCopy, MeshFault> + Send + 'static,
) {
    threads.run(move || {
        // A panic would be a bug; it must not take the app with it, nor keep it waiting.
        let built = catch_unwind(AssertUnwindSafe(|| copy()?.build(&options)));
        let broken = |_| Err(MeshFault::Broken("its tree could not be built".into()));
        let mesh = built.unwrap_or_else(broken).map(Arc::new);
        Built { id, options, mesh }
    });
}

/// Threads for what would hold a frame, once there is something to do. Of their own, because the
/// tracer's are busy until a pass over the picture ends.
pub(super) struct Threads<T> {
    pool: Option<ThreadPool>,
    sender: Sender<T>,
    /// One system uses it; the lock lets the resource be shared.
    receiver: Mutex<Receiver<T>>,
}

impl<T> Default for Threads<T> {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Self {
            pool: None,
            sender,
            receiver: Mutex::new(receiver),
        }
    }
}

impl<T: Send + 'static> Threads<T> {
    /// Does this on one of the threads, or here where the system has none to give.
    pub fn run(&mut self, work: impl FnOnce() -> T + Send + 'static) {
        let sender = self.sender.clone();
        let work = move || {
            // Nobody receives it where the app has ended.
            let _ = sender.send(work());
        };
        if self.pool.is_none() {
            // Half of the cores: the picture goes on being traced meanwhile.
            let threads = available_parallelism().map_or(1, |n| n.get().div_ceil(2));
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(|i| format!("behind {i}"));
            self.pool = pool.build().ok();
        }
        match &self.pool {
            Some(pool) => pool.spawn(work),
            None => work(),
        }
    }

    /// What has been done since this was asked last.
    pub fn finished(&self) -> Vec<T> {
        self.receiver().try_iter().collect()
    }

    /// Waits for so many.
    pub fn finish(&self, count: usize) -> Vec<T> {
        self.receiver().iter().take(count).collect()
    }

    fn receiver(&self) -> std::sync::MutexGuard<'_, Receiver<T>> {
        self.receiver.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
