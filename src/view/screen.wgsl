#import bevy_pbr::mesh_view_bindings::view

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> numbers: vec4<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var picture: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var picture_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(3) var depths: texture_2d<f32>;

struct Corner {
    @location(0) position: vec3<f32>,
}

// The corners are in clip space already.
@vertex
fn vertex(corner: Corner) -> @builtin(position) vec4<f32> {
    return vec4(corner.position.xy, 0.5, 1.0);
}

struct Pixel {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Pixel {
    let place = (position.xy - view.viewport.xy) / view.viewport.zw;
    if place.x < numbers.x {
        discard;
    }
    let size = vec2<f32>(textureDimensions(depths));
    let texel = vec2<i32>(clamp(place * size, vec2(0.0), size - 1.0));
    let metres = textureLoad(depths, texel, 0).x;
    var pixel: Pixel;
    pixel.color = vec4(textureSampleLevel(picture, picture_sampler, place, 0.0).rgb, 1.0);
    // Farther than any number is the far plane, which is 0.
    pixel.depth = clamp(numbers.y / max(metres, 1e-6) + numbers.z - numbers.w * metres, 0.0, 1.0);
    return pixel;
}
