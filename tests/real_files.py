#!/usr/bin/env python3
"""Opens models that people have made, and compares what `glassbox check` finds in them with trimesh.

    python3 tests/real_files.py GLASSBOX [FOLDER]      (pip: trimesh, numpy, networkx, pillow)

Gets packages by their names into FOLDER, once: Debian's assimp-testmodels and qt3d5-examples, five crates, one npm
package. Of the files that trimesh opens with triangles, as many have to open here with the same area (1 %) and the
same bounds (1 % of the size) as WANTED says. Each one that does not is listed with both figures.

trimesh knows no skins: a model that one deforms at rest lies elsewhere there (assimp's simple_skin).
What it finds is kept in FOLDER, so that a run that was stopped goes on, and a second one takes a tenth of the time.
"""
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import urllib.request

import numpy as np
import trimesh

WANTED = 0.97
DEBIAN = ["assimp-testmodels", "qt3d5-examples"]
CRATES = ["obj-rs", "easy-gltf", "kiss3d", "wavefront_obj", "gltf-json"]
NPM = ["@pmndrs/assets"]
ENDINGS = {".obj", ".gltf", ".glb", ".stl", ".ply"}
SECONDS = 60


def get(url):
    request = urllib.request.Request(url, headers={"User-Agent": "glassbox-tests"})
    with urllib.request.urlopen(request, timeout=120) as answer:
        return answer.read()


def unpack(data, folder):
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        archive.extractall(folder, filter="data")


def debian(name, folder):
    subprocess.run(["apt-get", "download", name], cwd=folder, check=True, capture_output=True)
    (package,) = folder.glob("*.deb")
    subprocess.run(["dpkg-deb", "-x", package, folder], check=True)


def crate(name, folder):
    letters = f"{name[:2]}/{name[2:4]}"
    lines = get(f"https://index.crates.io/{letters}/{name}").decode().splitlines()
    version = json.loads(lines[-1])["vers"]
    unpack(get(f"https://static.crates.io/crates/{name}/{name}-{version}.crate"), folder)


def npm(name, folder):
    about = json.loads(get(f"https://registry.npmjs.org/{name.replace('/', '%2f')}/latest"))
    unpack(get(about["dist"]["tarball"]), folder)


def fetch(folder):
    """Every model of every package; a package that cannot be had is named and left out."""
    for kind, names in [(debian, DEBIAN), (crate, CRATES), (npm, NPM)]:
        for name in names:
            place = folder / re.sub(r"\W+", "-", name).strip("-")
            if place.exists():
                continue
            # It is there when it is whole: one that could not be had is tried again.
            part = place.with_name(f"{place.name}.part")
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir(parents=True)
            try:
                kind(name, part)
                part.rename(place)
            except Exception as error:
                shutil.rmtree(part, ignore_errors=True)
                print(f"{name}: cannot be had here: {error}")
    files = (file for file in sorted(folder.rglob("*")) if file.suffix.lower() in ENDINGS)
    return [file for file in files if file.is_file()]


MEASURE = """
import sys, json, numpy as np, trimesh
scene = trimesh.load(sys.argv[1], force='scene', process=False)
meshes = [g for g in scene.dump() if getattr(g, 'faces', None) is not None and len(g.faces)]
used = [g.vertices[np.unique(g.faces)] for g in meshes]
print(json.dumps(dict(area=float(sum(g.area for g in meshes)), triangles=int(sum(len(g.faces) for g in meshes)),
    bounds=[np.vstack(used).min(0).tolist(), np.vstack(used).max(0).tolist()])))
"""


def measured(file):
    """What trimesh finds; None where it finds no triangles. In a process of its own: it may take any time and memory."""
    run = [sys.executable, "-c", MEASURE, str(file)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=SECONDS)
    try:
        found = json.loads(done.stdout.splitlines()[-1])
    except (ValueError, IndexError):
        return None
    return found if found["area"] > 0 else None


def theirs(files, folder):
    """The same of each file, in their order, of which only what is not known yet is measured."""
    kept = folder / f"trimesh-{trimesh.__version__}.jsonl"
    lines = kept.read_text().splitlines() if kept.exists() else []
    known = dict(json.loads(line) for line in lines)
    with kept.open("a") as out:
        for file in files:
            name = str(file.relative_to(folder))
            if name not in known:
                try:
                    known[name] = measured(file)
                except subprocess.TimeoutExpired:
                    print(f"{name}: trimesh takes longer than {SECONDS} s; left out")
                    continue
                print(json.dumps([name, known[name]]), file=out, flush=True)
            yield file, known[name]


def area_of_polygons(file):
    """Of an OBJ's faces, by Newell's normals. trimesh makes fans of polygons, which overlap where those are concave."""
    places, area = [], 0.0
    for line in file.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            places.append([float(word) for word in words[1:4]])
        if words[:1] == ["f"]:
            indices = [int(word.split("/")[0]) for word in words[1:]]
            corners = np.array([places[i - 1 if i > 0 else i] for i in indices])
            corners -= corners[0]
            area += 0.5 * np.linalg.norm(np.cross(corners, np.roll(corners, -1, axis=0)).sum(0))
    return area


def ours(glassbox, file):
    try:
        run = [glassbox, "check", "--json", str(file)]
        done = subprocess.run(run, capture_output=True, text=True, timeout=SECONDS)
        return json.loads(done.stdout)[0]
    except (subprocess.TimeoutExpired, ValueError, IndexError) as error:
        return {"error": f"no answer: {error}"}


def difference(found, expected):
    """Why the two are not the same; None where they are."""
    if found["error"]:
        return found["error"]
    area = expected["area"]
    if abs(found["area"] - area) > 0.01 * area:
        return f"area {found['area']:.6g}, not {area:.6g} ({found['triangles']} and {expected['triangles']} triangles)"
    bounds = np.array(expected["bounds"])
    size = np.linalg.norm(bounds[1] - bounds[0])
    if found["bounds"] is None or np.abs(np.array(found["bounds"]) - bounds).max() > 0.01 * size:
        return f"bounds {np.round(found['bounds'], 3).tolist()}, not {np.round(bounds, 3).tolist()}"
    return None


def main():
    glassbox = os.path.abspath(sys.argv[1])
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "target/real-files")
    compared = same = 0
    for file, expected in theirs(fetch(folder), folder):
        if expected is None:
            continue
        compared += 1
        found = ours(glassbox, file)
        why = difference(found, expected)
        if why is not None and file.suffix.lower() == ".obj" and not found["error"]:
            expected["area"] = area_of_polygons(file)
            why = difference(found, expected)
        same += why is None
        if why is not None:
            print(f"{file.relative_to(folder)}: {why}")
    share = same / max(compared, 1)
    print(f"{same} of {compared} files that trimesh opens are the same here: {share:.1%}; {WANTED:.0%} are wanted")
    sys.exit(share < WANTED)


if __name__ == "__main__":
    main()
