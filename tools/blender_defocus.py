"""Runs inside Blender: its Defocus node over pictures that softfocus drew.

blender -b --python tools/blender_defocus.py -- FOLDER MAX_RADIUS RUNS SCENE ...

For each scene FOLDER/SCENE.npy is the colour, RGBA16F, and FOLDER/SCENE-radius.npy the
magnitude of the circle of confusion in pixels, binary32. Writes FOLDER/SCENE-blender.npy and
prints a line "milliseconds SCENE WITH WITHOUT": medians of the compositor's time with the
node, and of the same without it.

The node gets our circles and not a depth ("use Z-buffer" is off): what is compared is the
filter, not two lens equations. Its preview, which leaves most samples out, is off.
"""

import statistics
import sys
import time

import bpy
import numpy

COMPARED_BY = "Non-Color"  # values go through unchanged


def load(name, rgb):
    height, width = rgb.shape[:2]
    picture = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True)
    picture.colorspace_settings.name = COMPARED_BY
    rgba = numpy.ones((height, width, 4), numpy.float32)
    rgba[..., :3] = rgb
    picture.pixels.foreach_set(rgba[::-1].ravel())  # Blender's first row is the lowest
    picture.update()
    return picture


def composite(scene, path):
    start = time.perf_counter()
    bpy.ops.render.render()
    seconds = time.perf_counter() - start
    bpy.data.images["Render Result"].save_render(path)
    return 1000.0 * seconds


def main(folder, max_radius_px, runs, names):
    scene = bpy.context.scene
    scene.use_nodes = True
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.resolution_percentage = 100
    for name in names:
        picture = numpy.load(f"{folder}/{name}.npy").astype(numpy.float32)
        radius = numpy.load(f"{folder}/{name}-radius.npy")
        height, width = picture.shape[:2]
        scene.render.resolution_x, scene.render.resolution_y = width, height

        tree = scene.node_tree
        tree.nodes.clear()
        colour = tree.nodes.new("CompositorNodeImage")
        colour.image = load(name, picture[..., :3])
        circles = tree.nodes.new("CompositorNodeImage")
        circles.image = load(name + "-radius", radius[..., None])
        one_channel = tree.nodes.new("CompositorNodeSepRGBA")
        defocus = tree.nodes.new("CompositorNodeDefocus")
        defocus.use_preview = False
        defocus.use_zbuffer = False
        defocus.z_scale = 1.0
        defocus.blur_max = max_radius_px
        result = tree.nodes.new("CompositorNodeComposite")
        path = f"{folder}/{name}-blender.exr"

        tree.links.new(colour.outputs[0], result.inputs[0])
        without = [composite(scene, path) for _ in range(runs)]
        tree.links.clear()
        tree.links.new(circles.outputs[0], one_channel.inputs[0])
        tree.links.new(colour.outputs[0], defocus.inputs[0])
        tree.links.new(one_channel.outputs[0], defocus.inputs[1])
        tree.links.new(defocus.outputs[0], result.inputs[0])
        with_node = [composite(scene, path) for _ in range(runs)]

        saved = bpy.data.images.load(path)
        saved.colorspace_settings.name = COMPARED_BY
        blurred = numpy.empty(width * height * 4, numpy.float32)
        saved.pixels.foreach_get(blurred)
        blurred = blurred.reshape(height, width, 4)[::-1].copy()
        blurred[..., 3] = picture[..., 3]
        numpy.save(f"{folder}/{name}-blender.npy", blurred.astype(numpy.float16))
        print(f"milliseconds {name} {statistics.median(with_node)} {statistics.median(without)}",
              flush=True)


arguments = sys.argv[sys.argv.index("--") + 1:]
main(arguments[0], float(arguments[1]), int(arguments[2]), arguments[3:])
