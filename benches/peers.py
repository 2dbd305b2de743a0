#!/usr/bin/env python3
"""Time and error of one scene, by Glassbox and, where they are installed, by Mitsuba 3 and by Blender's Cycles on the same
machine in turns.

    python3 -m venv v && v/bin/pip install numpy OpenEXR mitsuba bpy # and LLVM's library, for Mitsuba's fast variant
    v/bin/python benches/peers.py target/release/glassbox model.obj [--size 800] [--threads 2] [--runs 5]

The scene is a model scaled to a cube of edge 1, matt, all of one grey, under one square lamp of radiance 10 that faces down and
is not seen itself; direct light only, a box filter, no denoiser. Seconds are those of a picture alone, neither loading nor
trees nor files; of Cycles those in which it looks through the scene for changes too, which cannot be told apart. Errors are the
root of the mean squared difference to the mean of two of the renderer's own pictures of 1024 samples a pixel, less what that is
off by itself, which the difference of the two tells. Last come lines of Glassbox with an error as its goal instead of a number
of samples, which then go where they lower it most; all lines take turns.
"""
import argparse, functools, json, os, subprocess, sys, tempfile, time
import numpy as np
import OpenEXR

EYE, UP, FIELD_OF_VIEW = np.array([-0.964, 1.026, -2.649]), np.array([0.117, 0.94, 0.321]), 50.0
CORNER, EDGES, RADIANCE, GREY = (-0.2, 0.55, -0.2), ((0.4, 0.0, 0.0), (0.0, 0.0, 0.4)), 10.0, 0.8


def triangles(path):
    """The corners of an OBJ's triangles, polygons as fans, scaled to the unit cube about the origin."""
    vertices, faces = [], []
    for line in open(path, errors="replace"):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [corner - 1 if corner > 0 else len(vertices) + corner for corner in corners]
            faces += [[corners[0], corners[i], corners[i + 1]] for i in range(1, len(corners) - 1)]
    corners = np.array(vertices)[np.array(faces)]
    low, high = corners.min((0, 1)), corners.max((0, 1))
    return (corners - 0.5 * (low + high)) / (high - low).max()


def write_glassbox(folder, corners, size):
    with open(os.path.join(folder, "model.obj"), "w") as out:
        out.writelines("v %.9g %.9g %.9g\n" % tuple(corner) for corner in corners.reshape(-1, 3))
        out.write("o model\n")
        out.writelines(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(len(corners)))
    back = EYE / np.linalg.norm(EYE)
    right = np.cross(UP, back)
    right /= np.linalg.norm(right)
    m = np.stack([right, np.cross(back, right), back], 1)
    w = 0.5 * np.sqrt(max(0.0, 1.0 + np.trace(m)))
    turn = [(m[2, 1] - m[1, 2]) / (4 * w), (m[0, 2] - m[2, 0]) / (4 * w), (m[1, 0] - m[0, 1]) / (4 * w), w]

    def tuple_of(numbers):
        return "(" + ", ".join("%.9g" % number for number in numbers) + ")"

    def entity(number, at, rotation, components):
        transform = f"(translation: {tuple_of(at)}, rotation: {tuple_of(rotation)}, scale: (1.0, 1.0, 1.0))"
        return (f'{number}: (components: {{"glassbox::scene::SceneId": ({number}), '
                f'"bevy_transform::components::transform::Transform": {transform}, {components}}}),\n')

    still = (0, 0, 0, 1)
    grey = f"(red: {GREY}, green: {GREY}, blue: {GREY}, alpha: 1.0)"
    black = "(red: 0.0, green: 0.0, blue: 0.0, alpha: 1.0)"
    edges = ", ".join(tuple_of(edge) for edge in EDGES)
    entities = entity(1, EYE, turn, '"glassbox::scene::SceneCamera": (projection: Perspective(fov_y: %.9g))'
                      % np.radians(FIELD_OF_VIEW))
    entities += entity(2, (0, 0, 0), still, f'"glassbox::scene::ParallelogramLamp": (corner: {tuple_of(CORNER)}, '
                       f'edges: ({edges}), intensity: {RADIANCE}, visible: false)')
    entities += entity(3, (0, 0, 0), still, '"glassbox::scene::MeshSource": File(path: "model.obj", name: "model"), '
                       f'"glassbox::scene::Phong": (diffuse: {grey}, specular: {black}, mirror: {black})')
    scene = os.path.join(folder, "scene.scn.ron")
    with open(scene, "w") as out:
        out.write('(resources: {"glassbox::io::FileVersion": (2), "glassbox::scene::RenderSettings": '
                  f"(size: ({size}, {size}))}}, entities: {{{entities}}})")
    return scene


class Glassbox:
    def __init__(self, program, folder, corners, size, threads):
        self.program, self.threads = program, threads
        self.scene, self.picture = write_glassbox(folder, corners, size), os.path.join(folder, "picture.exr")
        self.name = "Glassbox"

    def render(self, spp, seed, *how):
        words = [self.program, "render", self.scene, "-o", self.picture, "--spp", str(spp), "--seed", str(seed), *how]
        words += ["--threads", str(self.threads), "--stats", self.picture + ".json", "--quiet"]
        subprocess.run(words, check=True)
        seconds = json.load(open(self.picture + ".json"))["render_ms"] / 1e3
        return OpenEXR.File(self.picture).channels()["RGB"].pixels.astype("f4"), seconds


class Mitsuba:
    def __init__(self, folder, corners, size, threads):
        import drjit as dr, mitsuba as mi

        def works(variant):
            """A variant may be there without the library that it compiles with."""
            try:
                mi.set_variant(variant)
                return np.array(mi.TensorXf([1.0, 2.0]) + 1.0)[1] == 3.0
            except Exception as error:
                print(f"Mitsuba without {variant}: {error}", file=sys.stderr)
                return False

        variant = next(filter(works, [name for name in ("llvm_ad_rgb", "scalar_rgb") if name in mi.variants()]))
        dr.set_thread_count(threads)
        mesh = mi.Mesh("model", 3 * len(corners), len(corners))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = corners.reshape(-1).astype("f4")
        parameters["faces"] = np.arange(3 * len(corners), dtype="u4")
        parameters.update()
        file = os.path.join(folder, "model.ply")
        mesh.write_ply(file)
        first, second = map(np.array, EDGES)
        to_world = np.eye(4)
        to_world[:3, 0], to_world[:3, 1] = first / 2, second / 2
        normal = np.cross(first, second)
        to_world[:3, 2], to_world[:3, 3] = normal / np.linalg.norm(normal), np.array(CORNER) + (first + second) / 2
        transform = mi.ScalarTransform4f
        film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                "component_format": "float32"}
        lamp = {"type": "area", "radiance": {"type": "rgb", "value": RADIANCE}}
        matt = {"type": "twosided", "matt": {"type": "diffuse", "reflectance": {"type": "rgb", "value": GREY}}}
        self.scene = mi.load_dict({
            "type": "scene",
            "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
            "sensor": {"type": "perspective", "fov": FIELD_OF_VIEW, "fov_axis": "y", "film": film,
                       "to_world": transform().look_at(EYE.tolist(), [0, 0, 0], UP.tolist()),
                       "sampler": {"type": "multijitter"}},
            "model": {"type": "ply", "filename": file, "face_normals": True, "bsdf": matt},
            "lamp": {"type": "rectangle", "to_world": transform(to_world), "emitter": lamp}})
        self.dr, self.mi, self.name = dr, mi, f"Mitsuba {mi.__version__} {variant}"

    def render(self, spp, seed):
        start = time.perf_counter()
        picture = self.mi.render(self.scene, spp=spp, seed=seed)
        # What it returns is a promise.
        self.dr.eval(picture)
        self.dr.sync_thread()
        seconds = time.perf_counter() - start
        return np.array(picture), seconds


class Cycles:
    def __init__(self, folder, corners, size, threads):
        import bpy, mathutils
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        render, cycles = scene.render, scene.cycles
        render.engine, render.use_persistent_data = "CYCLES", True
        render.threads_mode, render.threads = "FIXED", threads
        render.resolution_x = render.resolution_y = size
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        self.picture = os.path.join(folder, "cycles.exr")
        cycles.device, cycles.pixel_filter_type = "CPU", "BOX"
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        cycles.max_bounces = cycles.sample_clamp_direct = 0
        model = bpy.data.meshes.new("model")
        model.from_pydata(corners.reshape(-1, 3).tolist(), [], np.arange(3 * len(corners)).reshape(-1, 3).tolist())
        matt = bpy.data.materials.new("matt")
        matt.use_nodes = True
        nodes, links = matt.node_tree.nodes, matt.node_tree.links
        nodes.clear()
        surface = nodes.new("ShaderNodeBsdfDiffuse")
        surface.inputs["Color"].default_value = (GREY, GREY, GREY, 1.0)
        links.new(surface.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        model.materials.append(matt)
        first, second = map(np.array, EDGES)
        lamp = bpy.data.lights.new("lamp", "AREA")
        lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", np.linalg.norm(first), np.linalg.norm(second)
        # Its energy is what a matt lamp sends out in watts: radiance times pi times area.
        lamp.energy = RADIANCE * np.pi * lamp.size * lamp.size_y
        camera = bpy.data.cameras.new("camera")
        camera.sensor_fit, camera.angle_y = "VERTICAL", np.radians(FIELD_OF_VIEW)
        back = EYE / np.linalg.norm(EYE)
        right = np.cross(UP, back)
        right /= np.linalg.norm(right)
        # A lamp shines and a camera looks along its -z.
        along = first / lamp.size
        behind = np.cross(second, first)
        behind /= np.linalg.norm(behind)
        for name, data, axes, place in (
                ("model", model, np.eye(3), np.zeros(3)),
                ("lamp", lamp, [along, np.cross(behind, along), behind], np.array(CORNER) + (first + second) / 2),
                ("camera", camera, [right, np.cross(back, right), back], EYE)):
            thing = bpy.data.objects.new(name, data)
            scene.collection.objects.link(thing)
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = np.stack(axes, 1), place
            thing.matrix_world = mathutils.Matrix(matrix.tolist())
            if name == "lamp":
                thing.visible_camera = False
            if name == "camera":
                scene.camera = thing
        self.bpy, self.scene, self.name = bpy, scene, f"Cycles {bpy.app.version_string}"

    def render(self, spp, seed):
        self.scene.cycles.samples, self.scene.cycles.seed = spp, seed
        # What is kept from picture to picture is the whole picture else.
        self.scene.update_tag()
        start = time.perf_counter()
        self.bpy.ops.render.render()
        seconds = time.perf_counter() - start
        self.bpy.data.images["Render Result"].save_render(self.picture, scene=self.scene)
        channels = OpenEXR.File(self.picture).channels()
        picture = next(iter(channels.values())).pixels
        return picture[..., :3].astype("f4"), seconds


class Line:
    """One renderer with so many samples, or with a goal."""

    def __init__(self, reference, render):
        self.reference, self.render = reference, render
        self.seconds, self.squares = [], []

    def run(self, seed):
        picture, seconds = self.render(seed)
        mean, own = self.reference
        self.seconds.append(seconds)
        self.squares.append(((picture - mean) ** 2).mean() - own)

    def figures(self):
        return np.median(self.seconds), np.sqrt(max(0.0, np.mean(self.squares)))


def reference(renderer):
    """The mean of two pictures, and its own mean squared error."""
    renderer.render(1, 0)
    first, second = (renderer.render(1024, seed)[0] for seed in (98, 99))
    return 0.5 * (first + second), 0.25 * ((first - second) ** 2).mean()


def main():
    options = argparse.ArgumentParser()
    options.add_argument("glassbox")
    options.add_argument("model")
    options.add_argument("--size", type=int, default=800)
    options.add_argument("--threads", type=int, default=os.cpu_count())
    options.add_argument("--runs", type=int, default=5)
    options = options.parse_args()
    corners = triangles(options.model)
    with tempfile.TemporaryDirectory() as folder:
        renderers = [Glassbox(options.glassbox, folder, corners, options.size, options.threads)]
        for peer in (Mitsuba, Cycles):
            try:
                renderers.append(peer(folder, corners, options.size, options.threads))
            # Whatever it lacks, the others are measured.
            except Exception as error:
                print(f"without {peer.__name__}: {error}", file=sys.stderr)
        references = []
        for renderer in renderers:
            references.append(reference(renderer))
            print(f"{renderer.name}: mean {references[-1][0].mean():.5f}", flush=True)
        lines, goals = {}, {}
        for spp in (1, 4, 16, 64):
            for renderer, known in zip(renderers, references):
                lines[spp, renderer.name] = Line(known, functools.partial(renderer.render, spp))
        ours = renderers[0]
        for goal in (0.02, 0.01, 0.005, 0.0025):
            to_goal = lambda seed, goal=goal: ours.render(4096, seed, "--error", str(goal))
            goals[goal] = Line(references[0], to_goal)
        for line in (*lines.values(), *goals.values()):
            # Mitsuba compiles for each number of samples.
            line.render(0)
        for run in range(options.runs):
            for line in (*lines.values(), *goals.values()):
                line.run(1 + run)
        for (spp, name), line in lines.items():
            seconds, error = line.figures()
            print(f"{spp:4} spp  {name:28} {seconds:8.4f} s  rmse {error:.5f}  "
                  f"{options.size ** 2 * spp / seconds / 1e6:7.1f} million samples/s")
        for goal, line in goals.items():
            seconds, error = line.figures()
            print(f"--error {goal:6}  {ours.name}   {seconds:8.4f} s  rmse {error:.5f}")


if __name__ == "__main__":
    main()
