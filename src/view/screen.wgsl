// The traced picture and its depth over the viewport. It is encoded for the screen already, and read as
// linear light; what the main texture holds instead is converted to.
#import bevy_core_pipeline::fullscreen_vertex_shader::FullscreenVertexOutput
#ifdef LINEAR_TO_SRGB
#import bevy_render::color_operations::linear_to_srgb
#endif
#ifdef LINEAR_TO_OKLAB
#import bevy_render::color_operations::linear_rgb_to_oklab
#endif

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var depths: texture_2d<f32>;
// With m metres the depth that is written is x / m + y - z * m; the view is w times as wide as the picture.
@group(0) @binding(2) var<uniform> numbers: vec4<f32>;

struct Pixel {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

fn texel(place: vec2<f32>, size: vec2<u32>) -> vec2<i32> {
    let pixels = vec2<f32>(size);
    return vec2<i32>(clamp(place * pixels, vec2(0.0), pixels - 1.0));
}

@fragment
fn fragment(in: FullscreenVertexOutput) -> Pixel {
    let place = vec2((in.uv.x - 0.5) * numbers.w + 0.5, in.uv.y);
    var color = textureLoad(picture, texel(place, textureDimensions(picture)), 0).rgb;
    var metres = textureLoad(depths, texel(place, textureDimensions(depths)), 0).x;
    if place.x < 0.0 || place.x > 1.0 {
        // Beside a picture of the view before there is nothing yet.
        color = vec3(0.0);
        metres = 1e30;
    }
#ifdef LINEAR_TO_SRGB
    color = linear_to_srgb(color);
#endif
#ifdef LINEAR_TO_OKLAB
    color = linear_rgb_to_oklab(color);
#endif
    var pixel: Pixel;
    pixel.color = vec4(color, 1.0);
    // Farther than any number is the far plane, which is 0.
    pixel.depth = clamp(numbers.x / max(metres, 1e-6) + numbers.y - numbers.z * metres, 0.0, 1.0);
    return pixel;
}
