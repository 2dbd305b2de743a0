//! The table of hard cases: what each demands, and what runs it.

use super::{
    Effort, Outcome, angles, edits, environment, errors, far, hairball, inherited_motion, light,
    maps, motion_and_lens, rays, rooms, transparency, trees,
};

/// A row of the table of hard cases.
pub(super) struct Case {
    pub number: u32,
    pub name: &'static str,
    /// What it must do to pass.
    pub passes: &'static str,
    pub run: fn(&Effort) -> Outcome,
}

/// All of them.
pub(super) static CASES: &[Case] = &[
    case(
        1,
        "closed meshes, random rays from inside",
        "0 leaks",
        rays::leaks_anywhere,
    ),
    case(
        2,
        "the same, aimed at edges",
        "0 leaks",
        rays::leaks_at_edges,
    ),
    case(
        3,
        "the same, aimed at vertices",
        "0 leaks",
        rays::leaks_at_vertices,
    ),
    case(
        4,
        "1–3 around (148376, 1234, -223423)",
        "0 leaks",
        rays::leaks_far_away,
    ),
    case(
        5,
        "direction components -0.0, 0.0, 1e-9, 1e-38",
        "both oracles agree",
        rays::signed_zeros,
    ),
    case(
        6,
        "axis-parallel rays, target 1e-5 wide at 1e4",
        "0 misses",
        rays::thin_targets,
    ),
    case(
        7,
        "rays in the plane of a triangle or a box's face",
        "no NaN; a triangle's own plane is a miss",
        rays::in_planes,
    ),
    case(
        8,
        "scales 2^-20 … 2^20 and 1e-6 … 1e6",
        "same bits; both oracles agree",
        rays::scales,
    ),
    case(
        9,
        "offsets 1e2 … 1e6",
        "t within its running bound",
        rays::offsets,
    ),
    case(
        10,
        "a teapot in a stadium, 1e6 : 1",
        "0 misses, no cliff in work",
        rays::stadium,
    ),
    case(
        11,
        "slivers, aspect 1e6",
        "hits as f64 says, t within its running bound",
        rays::slivers,
    ),
    case(
        12,
        "degenerate triangles",
        "counted, never hit",
        rays::degenerate,
    ),
    case(
        13,
        "NaN or infinite vertices, indices out of range",
        "left out and counted, the rest intact; an error",
        rays::not_finite,
    ),
    case(14, "NaN or infinite rays", "a miss", rays::not_numbers),
    case(
        15,
        "nothing: no object, an empty mesh; one triangle",
        "clean background",
        rays::nothing,
    ),
    case(
        16,
        "1e5 identical, 1e5 collinear triangles",
        "bounded depth and work, the right hits; four times as many are less than 9 times the work",
        trees::heaps,
    ),
    case(
        17,
        "trees deeper than every stack",
        "0 lost hits",
        trees::deep,
    ),
    case(
        18,
        "a light 0.01° above a plane",
        "0 dark pixels",
        light::acne,
    ),
    case(
        19,
        "contact shadow, gap 1e-4 of the scene",
        "0 light under the object",
        light::contact,
    ),
    case(
        20,
        "a light of each kind in the receiver's plane",
        "0, finite",
        light::in_the_plane,
    ),
    case(
        21,
        "the shading point on a light of each kind, or 1e-45 from it",
        "finite",
        light::on_the_light,
    ),
    case(
        22,
        "rays spawned from triangles of size e^±8",
        "0 self-hits",
        rays::spawned,
    ),
    case(
        23,
        "coplanar surfaces, any threads, any tree",
        "identical bit for bit",
        light::coplanar,
    ),
    case(
        24,
        "a transparent pair sharing an edge",
        "exactly 1 layer",
        transparency::shared_edge,
    ),
    case(
        25,
        "64 transparent layers",
        "the product, 1e-5 relative",
        transparency::layers,
    ),
    case(
        26,
        "two parallel mirrors, depth 50",
        "the geometric series, 1e-5 relative",
        transparency::mirrors,
    ),
    case(
        27,
        "a coarse smooth sphere: its terminator",
        "the loss stays below sin of the largest angle between normals",
        light::terminator,
    ),
    case(
        28,
        "instances: sheared, mirrored, 1e-4 … 1e4, singular",
        "both oracles agree; singular is an error",
        rays::instances,
    ),
    case(
        29,
        "random edits and undo against a fresh build",
        "identical",
        edits::edits,
    ),
    case(
        30,
        "motion across the view; a closed shutter",
        "coverage within 2/spp; identical",
        motion_and_lens::motion,
    ),
    case(
        31,
        "a shadow ray that ends on its own light",
        "never shadowed",
        light::own_light,
    ),
    case(
        32,
        "environment: poles, seam",
        "no jump",
        environment::environment,
    ),
    case(
        33,
        "aperture 0; focus at infinity",
        "the pinhole's rays; parallel rays",
        motion_and_lens::lens,
    ),
    case(
        34,
        "samples, depth, size of 0, 1 and 2^31",
        "a clear error, or it works",
        motion_and_lens::limits,
    ),
    case(
        35,
        "hairball of long thin triangles",
        "0 wrong outside the band",
        hairball::hairball,
    ),
    case(
        36,
        "rays from hits in closed rooms, to 148376 m, and in panes there",
        "0 pixels see the outside; no ray starts there, in panes thinner than 6 steps of f32 one in a thousand at most",
        rooms::closed,
    ),
    case(
        37,
        "lamps close up: a panel, a segment, a point 1 mm to 10 cm above a floor",
        "the light within 2 %; told / true error 0.5 to 2 at 16, 64, 256 spp, of light in one pixel 3 on average",
        errors::near_lamps,
    ),
    case(
        38,
        "motion of a parent, a grandparent, a camera's parent, a lamp",
        "bit for bit as if it were its own",
        inherited_motion::inherited,
    ),
    case(
        39,
        "800 sheets against 400: across a ray, slanted, turned, in one place",
        "at most 2.2 times the visits",
        transparency::sheets,
    ),
    case(
        40,
        "a white cut-out over white, bilinear and mipmaps",
        "white within 1e-6",
        maps::cut_outs,
    ),
    case(
        41,
        "suns of 0° … 180° on floors",
        "E kd/π within 1e-3 facing, 3e-3 on slopes",
        angles::suns,
    ),
    case(
        42,
        "a scene at 1e4 … 1e6 m against the same at 0",
        "the same bits where positions are f32; else within half a step of f32 there",
        far::far,
    ),
    case(
        43,
        "spots of 0.01° … 80°, tilted",
        "the lit area, 1 % relative",
        angles::spots,
    ),
    case(
        44,
        "infinite, negative texels and no numbers, in every map",
        "the largest finite number and 0; a note for each picture",
        maps::not_light,
    ),
    case(
        45,
        "sheets of opacity 0, or cut out whole, before a soft shadow and its light",
        "the picture without them, bit for bit",
        transparency::invisible,
    ),
    case(
        46,
        "stop at 5 %: rare bright specks",
        "|z| < 3; no error of 0.00 % is told",
        errors::rare_features,
    ),
    case(
        47,
        "pictures that cannot be written: size, format, folder, space",
        "refused before a ray is traced",
        maps::unwritable,
    ),
    case(
        48,
        "closed rooms whose walls are objects of their own",
        "measured and stated for sheets; 0 through walls of 10 cm that fill the corners",
        rooms::of_objects,
    ),
];

const fn case(
    number: u32,
    name: &'static str,
    passes: &'static str,
    run: fn(&Effort) -> Outcome,
) -> Case {
    Case {
        number,
        name,
        passes,
        run,
    }
}
