//! What draws the window.

use bevy::ecs::system::{Res, SystemParam};
use bevy::ecs::world::World;
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice};

/// Pixels on a side of the largest picture that can be drawn; `None` where nothing draws.
pub(crate) fn largest_side(world: &World) -> Option<u32> {
    let device = world.get_resource::<RenderDevice>()?;
    Some(device.limits().max_texture_dimension_2d)
}

/// What Bevy draws with, for a system.
#[derive(SystemParam)]
pub struct Adapter<'w> {
    info: Option<Res<'w, RenderAdapterInfo>>,
    device: Option<Res<'w, RenderDevice>>,
}

impl Adapter<'_> {
    /// Pixels on a side of the largest picture that can be drawn; `None` where nothing draws.
    pub(super) fn largest_side(&self) -> Option<u32> {
        let device = self.device.as_ref()?;
        Some(device.limits().max_texture_dimension_2d)
    }

    /// Whether a processor draws, in software: each frame takes its time from the tracer.
    pub fn is_a_processor(&self) -> bool {
        let info = self.info.as_ref();
        info.is_some_and(|info| info.device_type == wgpu_types::DeviceType::Cpu)
    }
}
