#!/usr/bin/python3
"""The add-on in Blender against the program: the bits of refocus, and the geometry of render.

    tests/tools/blender_test.py [PROGRAM LIBRARY [ZIP]]     default: those of build/

With ZIP, by tools/release, that is installed, and used with what is inside. Needs Blender 3.4 or later.
"""

import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def why_not(program, folder):
    if not shutil.which("blender"):
        return "no blender: apt-get install --no-install-recommends blender python3-numpy"
    picture = ["render", "figures", "--size", "1x1", "-o", f"{folder}/probe.exr"]
    return subprocess.run([program, *picture], capture_output=True, text=True).stderr.strip()


def start_blender(program, library, *add_on):
    """This file in a Blender without a user's settings."""
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        if why := why_not(program, folder):
            if "blender" in os.environ.get("SOFTFOCUS_REQUIRE", "").split(","):
                sys.exit(f"SOFTFOCUS_REQUIRE has blender, but: {why}")
            return print(f"skipped: the add-on in Blender ({why})")
        environment = {**os.environ, "TEST_PROGRAM": os.path.abspath(program)}
        environment |= {"PYTHONDONTWRITEBYTECODE": "1"}
        environment |= {f"BLENDER_USER_{name}": f"{folder}/{name}" for name in ("CONFIG", "SCRIPTS")}
        if not add_on:
            environment |= {"SOFTFOCUS_PROGRAM": os.path.abspath(program)}
            environment |= {"SOFTFOCUS_LIBRARY": os.path.abspath(library)}
        words = ["-b", "--factory-startup", "--python-exit-code", "1", "--python", __file__, "--", folder]
        words += map(os.path.abspath, add_on)
        run = subprocess.run(["blender", *words], env=environment, capture_output=True, text=True)
        if run.returncode != 0:
            said = [line for line in run.stdout.splitlines() if "Fra:" not in line and "INFO:" not in line]
            sys.exit("\n".join(said) + run.stderr)


def error_of(call, **options):
    try:
        call(**options)
    except RuntimeError as error:
        return str(error)
    raise AssertionError("no error")


def draw_scene():
    """Emitting cubes before a sky that is transparent, and one on a floor that slants."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True

    def add(name, size, place, colour, turn=(0.0, 0.0, 0.0)):
        bpy.ops.mesh.primitive_cube_add(size=1, location=place, rotation=turn, scale=size)
        thing = bpy.context.object
        thing.name = name
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        inputs = material.node_tree.nodes["Principled BSDF"].inputs
        inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        inputs["Emission" if "Emission" in inputs else "Emission Color"].default_value = (*colour, 1.0)
        inputs["Emission Strength"].default_value = 1.0
        thing.data.materials.append(material)
        return thing

    add("floor", (8, 8, 0.1), (0, 2, -0.6), (0.3, 0.4, 0.2), (0.1, 0.05, 0))
    add("near", (0.2, 0.3, 0.4), (-0.4, -1.2, 0), (0.9, 0.1, 0.1), (0.3, 0.2, 0.5))
    focus = add("focus", (0.5, 0.5, 0.9), (0.2, 0.3, 0.1), (0.9, 0.8, 0.1), (0, 0, 0.4))
    far = add("far", (0.7, 0.2, 2), (0.8, 3.5, 0.4), (0.1, 0.2, 1.0))
    far.shape_key_add(name="as it is")
    far.shape_key_add(name="bent").value = 1.0
    far.data.shape_keys.key_blocks["bent"].data[7].co.x += 1.0
    bpy.ops.object.camera_add(location=(0.3, -3.5, 0.8), rotation=(1.4, 0.1, 0.05))
    scene.camera = bpy.context.object
    scene.camera.scale = (2, 2, 2)  # which no lens sees
    camera = scene.camera.data
    camera.lens, camera.sensor_width, camera.sensor_height = 40.0, 30.0, 25.0
    camera.dof.use_dof, camera.dof.focus_object, camera.dof.aperture_fstop = True, focus, 0.4
    bpy.context.view_layer.update()
    return scene


def program(*words):
    run = subprocess.run([os.environ["TEST_PROGRAM"], *words], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout


def pixels_of(image):
    values = numpy.empty(4 * image.size[0] * image.size[1], "f4")
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def check_refocus(scene, folder):
    """The image has the bits of `softfocus refocus` of Blender's own multi-layer EXR."""
    settings, camera = scene.render.image_settings, scene.camera.data
    bpy.context.view_layer.use_pass_normal = scene.render.use_stamp = True
    scene.render.resolution_x, scene.render.resolution_y = 128, 96
    scene.render.resolution_percentage = 50
    fov = 2 * math.degrees(math.atan(30.0 / 80.0 * 48 / 64))
    axis = scene.camera.matrix_world.to_3x3().col[2].normalized()
    focus = axis.dot(scene.camera.location - bpy.data.objects["focus"].location)
    lens = f"--focus {focus:.7g} --f-number 0.4 --focal-length 40 --fov {fov:.7g}"
    shape = "--aperture-blades 5 --aperture-turn {:.7g} --anamorphic 2".format(30 + 36 - 90)
    for method, unmix, options in (
        ("disc-layers", True, "--unmix-edges"),
        ("scatter-aperture", False, shape),
        ("auto", False, ""),
    ):
        scene.softfocus.method, scene.softfocus.unmix_edges = method, unmix
        is_shaped = options == shape
        camera.dof.aperture_blades = 5 if is_shaped else 0
        camera.dof.aperture_rotation = math.radians(30) if is_shaped else 0
        camera.dof.aperture_ratio = 2 if is_shaped else 1
        settings.file_format, settings.color_depth = "PNG", "8"
        file = f"{folder}/view.png" if is_shaped else ""
        assert bpy.ops.softfocus.refocus(render=method == "disc-layers", filepath=file) == {"FINISHED"}
        assert not file or os.path.getsize(file) > 0
        assert camera.dof.use_dof and settings.file_format == "PNG" and settings.color_depth == "8"
        settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
        bpy.data.images["Render Result"].save_render(f"{folder}/passes.exr", scene=scene)
        words = f"-o {folder}/theirs.exr --format exr-float --no-layers --method {method} {lens} {options}".split()
        program("refocus", f"{folder}/passes.exr", *words, "--quiet")
        theirs = bpy.data.images.load(f"{folder}/theirs.exr")
        theirs.colorspace_settings.name = "Non-Color"
        ours = pixels_of(bpy.data.images["Softfocus"])
        assert ours.shape == (48, 64, 4) and 0 < ours[..., 3].min() + 0.1 < ours[..., 3].max()
        assert (ours == pixels_of(theirs)).all(), method
        bpy.data.images.remove(theirs)


def check_export(scene, folder):
    """The program sees the exported scene's surfaces where Blender does."""
    camera = scene.camera.data
    for fit, width, height in (("AUTO", 64, 48), ("AUTO", 48, 64), ("VERTICAL", 48, 64), ("HORIZONTAL", 40, 64)):
        camera.sensor_fit = fit
        scene.render.resolution_x, scene.render.resolution_y = 2 * width, 2 * height
        assert bpy.ops.softfocus.export(filepath=f"{folder}/scene") == {"FINISHED"}
        words = ["--show", "pinhole", "--size", f"{width}x{height}", "-o", f"{folder}/seen.npy", "--quiet"]
        program("render", f"{folder}/scene.toml", *words)
        theirs = numpy.load(f"{folder}/seen.npy")[::-1].astype("f4")
        assert bpy.ops.softfocus.refocus() == {"FINISHED"}
        colour, depth = passes.read_passes(scene, bpy.context.view_layer)
        thing, seen = depth < 1e9, theirs[..., 3] < 0.99 * camera.clip_end
        assert thing.mean() > 0.5 and (thing != seen).mean() < 0.02
        error = abs(theirs[..., 3] / depth - 1)[thing & seen]
        assert numpy.percentile(error, 98) < 1e-3, error
        assert abs(theirs[..., :3] - colour[..., :3])[thing & seen].mean() < 0.02


def check_lamps(scene):
    """A grey floor under each kind of lamp is as bright as in Blender, in the middle."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=40, size=8, location=(50, 0, 0))
    floor = bpy.data.materials.new("grey")
    floor.use_nodes = True
    inputs = floor.node_tree.nodes["Principled BSDF"].inputs
    inputs["Specular" if "Specular" in inputs else "Specular IOR Level"].default_value = 0.0
    inputs["Base Color"].default_value, inputs["Roughness"].default_value = (0.5, 0.5, 0.5, 1.0), 1.0
    bpy.context.object.data.materials.append(floor)
    bpy.ops.object.camera_add(location=(50, 0, 5))
    scene.camera = bpy.context.object
    scene.camera.data.dof.focus_distance = 5.0
    scene.cycles.samples = 64
    for kind, watts in (("POINT", 100.0), ("SUN", 2.0), ("AREA", 60.0), ("SPOT", 120.0)):
        bpy.ops.object.light_add(type=kind, location=(50.5, 0.5, 3), rotation=(-0.2, 0, 0))
        lamp = bpy.context.object
        lamp.data.energy = watts
        bpy.ops.softfocus.refocus()
        bpy.ops.softfocus.truth()
        theirs, ours = [pixels_of(bpy.data.images["Softfocus" + name])[32, 20, 1] for name in ("", " Truth")]
        assert abs(ours / theirs - 1) < 0.1, (kind, ours, theirs)
        bpy.data.objects.remove(lamp)


def check_refusals(scene):
    refocus, camera = bpy.ops.softfocus.refocus, scene.camera.data
    scene.render.resolution_y += 2
    assert "The last render has 40x64 pixels" in error_of(refocus, render=False)
    scene.render.resolution_y -= 2
    scene.render.pixel_aspect_x = 2
    assert "pixels are not square" in error_of(refocus)
    scene.render.pixel_aspect_x = 1
    for kind, word in (("ORTHO", "orthographic"), ("PANO", "panoramic")):
        camera.type = kind
        assert word in error_of(refocus)
    camera.type = "PERSP"
    camera.dof.focus_object, camera.dof.focus_distance = None, 0.01
    assert "focal" in error_of(refocus, render=False)
    bpy.context.view_layer.name = "other"
    assert "other.Combined.R" in error_of(refocus, render=False)


if "bpy" not in sys.modules:
    build = ROOT / "build"
    sys.exit(start_blender(*(sys.argv[1:] or [build / "softfocus", build / "dof/libsoftfocus.so.0"])))

import bpy  # noqa: E402
import numpy  # noqa: E402

work, *zips = sys.argv[sys.argv.index("--") + 1 :]
if zips:
    bpy.ops.preferences.addon_install(filepath=zips[0])
    bpy.ops.preferences.addon_enable(module="softfocus_blender")
    from softfocus_blender import passes
else:
    sys.path[:0] = [str(ROOT / "tools/blender"), str(ROOT / "tools/python")]
    import softfocus_blender
    from softfocus_blender import passes

    softfocus_blender.register()
drawn = draw_scene()
check_refocus(drawn, work)
check_export(drawn, work)
check_lamps(drawn)
check_refusals(drawn)
