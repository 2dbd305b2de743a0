//! Every number of the chosen ray.

use super::super::says::Says;
use super::none_chosen_ui;
use crate::editor::action::Action;
use crate::editor::inspection::Inspected;
use crate::inspect::{Names, color_text, cost_text, metres};
use crate::scene::SceneId;
use crate::trace::{LightSample, RayHit, RayTree, TracedRay};
use bevy::ecs::world::World;
use bevy_egui::egui::{Grid, Label, RichText, Ui};
use glam::Vec3;

pub(super) fn detail_ui(ui: &mut Ui, world: &mut World, inspected: &mut Inspected, rays: &RayTree) {
    let chosen = inspected.ray().and_then(|index| {
        let ray = rays.rays.get(index as usize)?;
        Some((index, ray))
    });
    let Some((index, ray)) = chosen else {
        none_chosen_ui(ui, inspected, rays);
        return;
    };
    ui.horizontal_wrapped(|ui| {
        let title = format!("{} ray {index}", ray.kind.name());
        ui.label(RichText::new(title).strong());
        if let Some(parent) = ray.parent {
            let says = "Chooses the ray that met the surface where this one starts";
            if ui.small_button("Parent").says(says).clicked() {
                inspected.choose_ray(Some(parent), true);
            }
        }
        if let Some(hit) = &ray.hit {
            let says = "Selects the object that was hit";
            if ui.small_button("Select object").says(says).clicked() {
                world.write_message(Action::Select(vec![SceneId(hit.object)]));
            }
        }
    });
    let names = world.resource::<Names>();
    let lines = figures(ray, rays, names);
    ui.spacing_mut().interact_size.y = 0.0;
    Grid::new("figures of a ray")
        .num_columns(2)
        .spacing([10.0, 1.0])
        .striped(true)
        .show(ui, |ui| {
            for (name, says, value) in lines {
                ui.weak(name).says(says);
                ui.add(Label::new(RichText::new(value).monospace().size(11.0)).selectable(true));
                ui.end_row();
            }
        });
}

type Figure = (&'static str, &'static str, String);

fn exact(v: Vec3) -> String {
    let [x, y, z] = v.to_array();
    format!("{x} {y} {z}")
}

fn figures(ray: &TracedRay, rays: &RayTree, names: &Names) -> Vec<Figure> {
    let sample = rays.samples.get(ray.sample as usize);
    let mut lines: Vec<Figure> = vec![
        (
            "sample",
            "Which of the pixel's samples",
            sample.map_or_else(String::new, |sample| sample.index.to_string()),
        ),
        ("end", "What became of it", ray.end.name().into()),
        (
            "depth",
            "Surfaces between the camera and its start",
            ray.depth.to_string(),
        ),
        ("origin", "Where it starts, in metres", exact(ray.origin)),
        (
            "direction",
            "Of any length: that of a ray to a light reaches to it",
            exact(ray.direction),
        ),
    ];
    if let Some(from) = ray.from {
        lines.push(("from", "The object that it leaves", names.of(from)));
    }
    if let Some(t) = metres(ray) {
        lines.push(("t", "Metres to where it ended", t.to_string()));
    }
    if ray.time != 0.0 {
        lines.push((
            "time",
            "When it is shot, in the shutter's 0 to 1",
            ray.time.to_string(),
        ));
    }
    if let Some(hit) = &ray.hit {
        of_hit(&mut lines, hit, names);
    }
    if let Some(light) = &ray.light {
        of_light(&mut lines, light, names);
        lines.push((
            "transmitted",
            "The part of the light that arrives",
            exact(ray.transmittance),
        ));
    }
    for crossing in &ray.crossings {
        lines.push((
            "crosses",
            "A surface on the way that lets light through: object, triangle, opacity d",
            format!(
                "{} {} at t {} d {}",
                names.of(crossing.object),
                crossing.triangle,
                crossing.t,
                crossing.opacity
            ),
        ));
    }
    if ray.chance != 1.0 {
        lines.push((
            "chance",
            "The probability with which the path went this way, or with which so faint a light is asked for",
            ray.chance.to_string(),
        ));
    }
    if ray.count != 1 {
        lines.push((
            "one of",
            "So many rays share what arrives where it starts",
            ray.count.to_string(),
        ));
    }
    lines.extend([
        (
            "in",
            "The radiance that comes back along it to its start",
            exact(ray.radiance),
        ),
        (
            "weight",
            "What its radiance is multiplied by on its way into its parent's",
            exact(ray.weight),
        ),
        (
            "out",
            "Its part of its parent's radiance",
            exact(ray.carried),
        ),
        (
            "adds",
            "What it put into the sample's value by itself",
            exact(ray.added),
        ),
        (
            "cost",
            "Of the walk that traces pictures, through the wide form of the trees",
            cost_text(&ray.cost),
        ),
    ]);
    lines
}

fn of_hit(lines: &mut Vec<Figure>, hit: &RayHit, names: &Names) {
    let [u, v] = hit.barycentric;
    lines.extend([
        ("hits", "The object", names.of(hit.object)),
        (
            "triangle",
            "Index into the mesh's triangles",
            hit.triangle.to_string(),
        ),
        (
            "u, v",
            "Barycentric weights of the triangle's second and third corner",
            format!("{u} {v}"),
        ),
        ("position", "In the world, in metres", exact(hit.position)),
        (
            "face normal",
            "Of the triangle, turned to the viewer",
            exact(hit.geometric_normal),
        ),
        ("normal", "That shading used", exact(hit.normal)),
        ("material", "Which one", names.of_material(hit.material)),
        (
            "kd",
            "Diffuse colour, texture included",
            color_text(hit.diffuse),
        ),
        ("ks", "Highlight's colour", color_text(hit.specular)),
        ("km", "Part that is mirrored", color_text(hit.mirror)),
        ("shininess", "s", hit.shininess.to_string()),
        ("opacity", "d, map included", hit.opacity.to_string()),
    ]);
    if hit.emission != Vec3::ZERO {
        lines.push(("ke", "Its own light", color_text(hit.emission)));
    }
}

fn of_light(lines: &mut Vec<Figure>, light: &LightSample, names: &Names) {
    let [u, v] = light.place;
    lines.extend([
        ("light", "Which one", names.of(light.id)),
        ("place", "Where on the light, in 0 to 1", format!("{u} {v}")),
        (
            "density",
            "How likely that place is, as a multiple of that of an even choice",
            light.density.to_string(),
        ),
        (
            "distance",
            "Metres to that place",
            light.distance.to_string(),
        ),
        (
            "n·l",
            "Between the normal and the light's direction",
            light.n_dot_l.to_string(),
        ),
        (
            "r·v",
            "Between the light's mirror direction and the viewer",
            light.r_dot_v.to_string(),
        ),
        (
            "arriving",
            "If nothing is in the way, before the surface's cosine",
            exact(light.arriving),
        ),
        (
            "reflected",
            "What leaves towards the viewer if nothing is in the way",
            exact(light.reflected),
        ),
    ]);
}
