//! What rays add up to.

use super::super::Which;
use super::{Bench, SIZE};
use crate::film::{Sum, render};
use crate::trace::RayTree;
use bevy::math::{UVec2, Vec3};

#[test]
fn the_rays_add_up_to_what_the_film_added_bit_for_bit() {
    for scene in ["cornell-box", "spheres", "showcase"] {
        let mut bench = Bench::open(scene);
        let pixel = [SIZE.x / 2, SIZE.y / 2];
        for which in [Which::First, Which::All] {
            bench.ray().which = which;
            bench.shoot(pixel);
            bench.wait();
            let ray = bench.ray();
            let rays = ray.rays().unwrap();
            let addition = ray.addition();
            let said = addition.says_of_rays(rays);
            assert!(
                !said.is_fault && said.text.contains("bit for bit"),
                "{said:?}"
            );
            let film = film_of(rays);
            let said = addition.says_of_film(rays, Some(film));
            assert!(
                !said.is_fault && said.text.contains("bit for bit"),
                "{said:?}"
            );
        }
    }
}

fn film_of(rays: &RayTree) -> (Sum, u32) {
    let mut sum = Sum::default();
    for sample in &rays.samples {
        sum.add(sample.value);
    }
    (sum, rays.samples.len() as u32)
}

#[test]
fn a_picture_of_one_pixel_has_the_sum_that_the_rays_have() {
    let mut bench = Bench::open("cornell-box");
    bench.ray().which = Which::All;
    bench.shoot([300, 240]);
    bench.wait();
    let ray = bench.ray();
    let (world, settings) = ray.traced_with().unwrap();
    let shot = ray.shot().unwrap();
    let film = render(world, &shot.camera, settings, &|_, _| {}).film;
    let pixel = UVec2::new(300, 240);
    let sum = film.sum(pixel.x, pixel.y);
    let count = film.count(pixel.x, pixel.y);
    let rays = ray.rays().unwrap();
    let said = ray.addition().says_of_film(rays, Some((sum, count)));
    assert!(said.text.starts_with("the film added the same"), "{said:?}");
    // One more would not be.
    let mut other = sum;
    other.add(Vec3::X);
    let said = ray.addition().says_of_film(rays, Some((other, count)));
    assert!(
        said.is_fault && said.text.contains("ANOTHER SUM"),
        "{said:?}"
    );
    for (film, part) in [
        (None, "another picture"),
        (Some((Sum::default(), 0)), "no sample"),
        (Some((sum, rays.samples.len() as u32 + 1)), "their mean"),
    ] {
        let said = ray.addition().says_of_film(rays, film);
        assert!(!said.is_fault && said.text.contains(part), "{said:?}");
    }
}
