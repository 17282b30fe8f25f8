"""A scene for `softfocus render`: a .toml with camera, lens and lamps, beside a .glb by Blender."""

import json
import math
import os
import shlex

import bpy

# Versions of Blender lack some.
GLTF = {
    "export_format": "GLB",
    "check_existing": False,
    "use_active_scene": True,
    "use_renderable": True,
    "export_apply": True,
    "export_gn_mesh": True,
    "export_animations": False,
    "export_current_frame": True,
    "export_skins": False,  # applied
    "export_cameras": False,
    "export_lights": False,
}


MOST_LIGHTS = 64  # of a scene file


def vector(numbers):
    return "[" + ", ".join(f"{number:.7g}" for number in numbers) + "]"


def colour(channels, times=1.0):
    return vector(min(max(channel * times, 0.0), 1000.0) for channel in channels)


def place(point):
    """glTF's axes: y is up."""
    return vector((point[0], point[2], -point[1]))


def background(world, warnings):
    """The world's colour, as light."""
    nodes = world.node_tree.nodes if world and world.node_tree else []
    node = next((node for node in nodes if node.type == "BACKGROUND"), None)
    if not node:
        return colour(world.color if world else (0.0, 0.0, 0.0))
    if node.inputs["Color"].is_linked or node.inputs["Strength"].is_linked:
        warnings.append("the world has one colour, and no texture")
    return colour(node.inputs["Color"].default_value[:3], node.inputs["Strength"].default_value)


def light(lamp, seen, warnings):
    """A lamp without falloff, as bright at the point in focus as Blender's is there."""
    data, position = lamp.data, lamp.matrix_world.translation
    backwards = lamp.matrix_world.to_3x3().col[2].normalized()  # to where it does not shine
    way = position - seen
    square_m2 = max(way.length_squared, 1e-6)
    watts_per_m2 = data.energy
    if data.type == "AREA":  # in Cycles of a quarter of its watts over its area, whatever the direction
        watts_per_m2 *= max(backwards.dot(way.normalized()), 0.0) / (4.0 * square_m2)
    elif data.type != "SUN":
        watts_per_m2 /= 4.0 * math.pi * square_m2
    if data.type in ("AREA", "SPOT"):
        warnings.append(f"{lamp.name} shines in all directions")
    if data.type == "SUN":
        where = f'kind = "directional"\ndirection = {place(backwards)}'
    else:
        where = f'kind = "point"\nposition = {place(position)}'
    return f"[[light]]\n{where}\ncolour = {colour(data.color, watts_per_m2 / math.pi)}\n"


def export_scene(scene, lens, path):
    """Writes PATH, a .toml, and the .glb beside it. Returns the words of `softfocus render` and sentences."""
    model = os.path.splitext(path)[0] + ".glb"
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    bpy.ops.export_scene.gltf(filepath=model, **{key: value for key, value in GLTF.items() if key in known})

    warnings = []
    world = lens.camera.matrix_world
    eye, axes = world.translation, world.to_3x3()
    forwards = -axes.col[2].normalized()
    seen = eye + forwards * lens.focus_m
    data = lens.camera.data
    if data.shift_x or data.shift_y:
        warnings.append("the camera's shift is left out")
    if lens.anamorphic != 1.0:
        warnings.append("accumulation has no anamorphic lens")
    things = bpy.context.view_layer.objects
    lamps = [thing for thing in things if thing.type == "LIGHT" and not thing.hide_render]
    if len(lamps) > MOST_LIGHTS:
        warnings.append(f"of {len(lamps)} lamps {MOST_LIGHTS} shine")
    sky = background(scene.world, warnings)
    words = ["--method", "accumulation", "--jitter", "--size", f"{lens.width}x{lens.height}"]
    words += lens.aperture_words("accumulation")
    with open(path, "w", encoding="utf-8") as file:
        file.write(
            f"""# softfocus render {shlex.quote(os.path.basename(path))} -o out.png {' '.join(words)}
title = {json.dumps(scene.name)}
background = {sky}
ambient_light = {sky}

[camera]
position = {place(eye)}
target = {place(seen)}
up = {place(axes.col[1].normalized())}
fov_degrees = {lens.fov_y_degrees:.7g}
near_m = {data.clip_start:.7g}
far_m = {data.clip_end:.7g}

[lens]
focal_length_mm = {lens.focal_length_mm:.7g}
f_number = {lens.f_number:.7g}
focus_m = {lens.focus_m:.7g}
max_coc_px = 1024

[[object]]
shape = "model"
file = {json.dumps(os.path.basename(model))}

"""
            + "\n".join(light(lamp, seen, warnings) for lamp in lamps[:MOST_LIGHTS])
        )
    return words, warnings
