//! The editor over the scene of an app of its own: whose cameras draw, and whose changes are steps.

use super::document::adopt;
use super::history::OnlyWithin;
use super::schedule::EditorUpdate;
use super::viewport::EditorCamera;
use crate::scene::{NotTraced, Projection as SceneProjection, SceneCamera, SceneId};
use crate::view::{draws_handles, height_of};
use bevy::app::{App, Plugin, PostUpdate};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Camera3d, Projection, RenderTarget};
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::event::Event;
use bevy::ecs::query::{Changed, Or, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Commands, Local, Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::picking::PickingSettings;
use bevy::window::{PrimaryWindow, WindowRef};

/// Whether the editor is on, in an app with [`EditorPlugins`](super::EditorPlugins). Off, the app's
/// own cameras draw the window, and neither keys nor pointer are the editor's.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Editing(pub bool);

impl Default for Editing {
    fn default() -> Self {
        Self(true)
    }
}

/// The editor was switched on or off: what came and went meanwhile, it has not heard of.
#[derive(Event, Clone, Copy, Debug)]
pub(super) struct Switched {
    /// Whether it is on now.
    pub on: bool,
}

/// Run condition: the editor is on. What shall rest beneath it is given `.run_if(not(in_editor))`.
pub fn in_editor(editing: Option<Res<Editing>>) -> bool {
    editing.is_some_and(|editing| editing.0)
}

/// Makes the editor a guest.
pub(super) struct EmbedPlugin;

impl Plugin for EmbedPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Editing>()
            .init_resource::<OnlyWithin>()
            .add_systems(EditorUpdate, adopt_scene)
            .add_systems(
                PostUpdate,
                (
                    share_cameras.before(crate::sync::SyncSystems),
                    rest_picking,
                    rest_cameras.before(bevy::camera::CameraUpdateSystems),
                ),
            );
    }
}

/// Once the app has spawned its scene, that is what was opened.
fn adopt_scene(world: &mut World, mut done: Local<bool>) {
    if *done {
        return;
    }
    let mut ids = world.query::<&SceneId>();
    if !ids.iter(world).any(|id| !id.is_unassigned()) {
        return;
    }
    *done = true;
    adopt(world, "Untitled", None);
}

/// A click in the editor is none in the app: its observers hear of no pointer meanwhile.
fn rest_picking(
    editing: Res<Editing>,
    picking: Option<ResMut<PickingSettings>>,
    mut before: Local<Option<bool>>,
) {
    let Some(mut picking) = picking else { return };
    if editing.0 && before.is_none() {
        *before = Some(picking.is_hover_enabled);
        picking.is_hover_enabled = false;
    } else if !editing.0
        && let Some(before) = before.take()
    {
        picking.is_hover_enabled = before;
    }
}

/// What the app's camera and ours had in common last.
#[derive(Component, Clone, PartialEq)]
struct SharedProjection(SceneProjection);

type AppCamera = (With<Camera3d>, Without<EditorCamera>, Without<NotTraced>);
type AppCameras<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Projection,
        Option<&'static mut SceneCamera>,
        Option<&'static SharedProjection>,
        Option<&'static RenderLayers>,
    ),
    (AppCamera, Edited),
>;
type WindowCameras<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut Camera,
        &'static RenderTarget,
        Option<&'static RenderLayers>,
        Option<&'static Rests>,
    ),
    Without<NotTraced>,
>;
type Edited = Or<(Changed<Projection>, Changed<SceneCamera>)>;

fn scene_projection(projection: &Projection) -> Option<SceneProjection> {
    match projection {
        Projection::Perspective(p) => Some(SceneProjection::Perspective { fov_y: p.fov }),
        Projection::Orthographic(p) => Some(SceneProjection::Orthographic {
            height: height_of(p),
        }),
        Projection::Custom(_) => None,
    }
}

/// The app's cameras are the scene's: they can be listed, moved and looked through. A field of view
/// that is edited in the editor is the app's, and the other way round.
fn share_cameras(mut commands: Commands, mut cameras: AppCameras) {
    for (entity, own, ours, shared, layers) in &mut cameras {
        if draws_handles(layers) {
            continue;
        }
        let Some(theirs) = scene_projection(own) else {
            continue;
        };
        let Some(mut ours) = ours else {
            let camera = SceneCamera {
                projection: theirs,
                ..SceneCamera::default()
            };
            commands
                .entity(entity)
                .insert((camera, SharedProjection(theirs)));
            continue;
        };
        let wanted = match shared {
            Some(shared) if shared.0 != ours.projection => ours.projection,
            _ => theirs,
        };
        if let (Projection::Perspective(own), SceneProjection::Perspective { fov_y }) =
            (own, wanted)
            && own.fov != fov_y
        {
            let mut own = own.clone();
            own.fov = fov_y;
            commands.entity(entity).insert(Projection::Perspective(own));
        }
        if ours.projection != wanted {
            ours.projection = wanted;
        }
        if shared.is_none_or(|shared| shared.0 != wanted) {
            commands.entity(entity).insert(SharedProjection(wanted));
        }
    }
}

/// On a camera of the app that would draw if the editor did not.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
struct Rests;

/// The app's cameras of the window rest while the editor is on.
fn rest_cameras(
    mut commands: Commands,
    editing: Res<Editing>,
    windows: Query<(), With<PrimaryWindow>>,
    mut cameras: WindowCameras,
) {
    for (entity, mut camera, target, layers, rests) in &mut cameras {
        let in_window = match target {
            RenderTarget::Window(WindowRef::Primary) => true,
            RenderTarget::Window(WindowRef::Entity(window)) => windows.contains(*window),
            _ => false,
        };
        if !in_window || draws_handles(layers) {
            continue;
        }
        if editing.0 && camera.is_active {
            camera.is_active = false;
            commands.entity(entity).insert(Rests);
        } else if !editing.0 && rests.is_some() {
            camera.is_active = true;
            commands.entity(entity).remove::<Rests>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::app::Update;
    use bevy::ecs::observer::{ObserverSystemExt, On};
    use bevy::ecs::schedule::common_conditions::not;

    /// Who has heard of a frame, or of a signal.
    #[derive(Resource, Default, Debug, PartialEq)]
    struct Heard(Vec<&'static str>);

    #[derive(Event)]
    struct Signal;

    #[test]
    fn systems_and_observers_run_or_rest_while_the_editor_is_on_as_the_run_condition_says() {
        let mut app = App::new();
        let hears = |name| move |mut heard: ResMut<Heard>| heard.0.push(name);
        app.init_resource::<Heard>()
            .add_systems(
                Update,
                (
                    hears("editor's").run_if(in_editor),
                    hears("game's").run_if(not(in_editor)),
                )
                    .chain(),
            )
            .add_observer(
                (|_: On<Signal>, mut heard: ResMut<Heard>| heard.0.push("game's observer"))
                    .run_if(not(in_editor)),
            );
        let mut frame = |editing: Option<bool>| {
            if let Some(editing) = editing {
                app.insert_resource(Editing(editing));
            }
            app.update();
            app.world_mut().trigger(Signal);
            std::mem::take(&mut app.world_mut().resource_mut::<Heard>().0)
        };
        let of_game = ["game's", "game's observer"];
        assert_eq!(frame(None), of_game, "there is no editor");
        for _ in 0..2 {
            assert_eq!(frame(Some(true)), ["editor's"]);
            assert_eq!(frame(Some(false)), of_game);
        }
    }

    #[test]
    fn the_apps_picking_rests_while_the_editor_is_on_and_is_what_it_was_after() {
        for was_on in [true, false] {
            let mut app = App::new();
            app.init_resource::<Editing>()
                .insert_resource(PickingSettings {
                    is_hover_enabled: was_on,
                    ..PickingSettings::default()
                })
                .add_systems(PostUpdate, rest_picking);
            let hears = |app: &mut App, editing| {
                app.insert_resource(Editing(editing));
                app.update();
                app.world().resource::<PickingSettings>().is_hover_enabled
            };
            let heard = [true, true, false, false, true, false].map(|on| hears(&mut app, on));
            let expected = [false, false, was_on, was_on, false, was_on];
            assert_eq!(heard, expected);
        }
    }
}
