#import bevy_pbr::forward_io::VertexOutput

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> heat: f32;

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    return vec4(vec3(1.0, 0.3, 0.05) * heat, 1.0);
}
