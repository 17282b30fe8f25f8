"""Runs inside Blender: draws cubes.toml with Cycles, colour and Z, into a multi-layer EXR.

blender -b --factory-startup --python-exit-code 1 --python tests/data/blender-cubes/cubes.py -- OUT.exr

One sample in the middle of a pixel, no light but the materials' own: what remains is where each
triangle lies, which two renderers agree on.
"""

import math
import pathlib
import sys

import bpy
from mathutils import Euler, Matrix, Vector

HERE = pathlib.Path(__file__).parent
WIDTH, HEIGHT = 240, 160
SKY = (0.15, 0.3, 0.6)


def emission(name, colour):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    shader = nodes.new("ShaderNodeEmission")
    links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    if isinstance(colour, tuple):
        shader.inputs["Color"].default_value = (*colour, 1.0)
    else:
        texture = nodes.new("ShaderNodeTexImage")
        texture.image, texture.interpolation = colour, "Closest"
        links.new(texture.outputs["Color"], shader.inputs["Color"])
    return material


def place(mesh, material, position=(0, 0, 0), rotation_degrees=(0, 0, 0)):
    mesh.materials.append(material)
    thing = bpy.data.objects.new(mesh.name, mesh)
    thing.location = position
    thing.rotation_euler = Euler([math.radians(angle) for angle in rotation_degrees], "XYZ")
    bpy.context.collection.objects.link(thing)


def plane(width, depth):
    mesh = bpy.data.meshes.new("plane")
    x, z = width / 2.0, depth / 2.0
    mesh.from_pydata([(-x, 0, z), (x, 0, z), (x, 0, -z), (-x, 0, -z)], [], [(0, 1, 2, 3)])
    corners = mesh.uv_layers.new()
    for corner, place_in_texture in zip(corners.data, [(0, 0), (1, 0), (1, 1), (0, 1)]):
        corner.uv = place_in_texture
    return mesh


def cube(size):
    mesh = bpy.data.meshes.new("cube")
    h = size / 2.0
    mesh.from_pydata([(x, y, z) for x in (-h, h) for y in (-h, h) for z in (-h, h)], [],
                     [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
                      (1, 5, 7, 3)])
    return mesh


def look(position, target, fov_degrees):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(fov_degrees)
    camera.clip_start, camera.clip_end = 0.1, 1000.0
    back = (Vector(position) - Vector(target)).normalized()
    right = Vector((0, 1, 0)).cross(back).normalized()
    axes = Matrix((right, back.cross(right), back)).transposed()
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = Matrix.Translation(position) @ axes.to_4x4()
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def main(path):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*SKY, 1.0)
    look((0.0, 0.45, 1.6), (0.0, 0.15, 0.0), 35.0)
    place(plane(6.0, 6.0), emission("floor", (0.35, 0.3, 0.2)))
    place(plane(1.6, 0.8), emission("wall", bpy.data.images.load(str(HERE / "fields.png"))), (0.0, 0.4, -1.2), (90, 0, 0))
    place(cube(0.3), emission("red", (0.7, 0.05, 0.05)), (0.0, 0.15, 0.0), (0, 30, 0))
    place(cube(0.12), emission("green", (0.05, 0.6, 0.1)), (-0.22, 0.3, 0.75), (20, 40, 10))
    place(cube(0.5), emission("yellow", (0.9, 0.75, 0.1)), (0.5, 0.25, -0.7), (0, -25, 0))

    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.cycles.filter_width = 0.01
    bpy.context.view_layer.use_pass_z = True
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "ZIP"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


main(sys.argv[sys.argv.index("--") + 1])
