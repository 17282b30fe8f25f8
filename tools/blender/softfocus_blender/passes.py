"""Colour and depth of a render, and the picture that `softfocus refocus` makes of them.

Arrays have the lowest row first, as Blender's images and PFM files do.
"""

import contextlib
import json
import os
import struct
import tempfile

import bpy
import numpy

from . import softfocus


@contextlib.contextmanager
def changed(*settings):
    """Sets attributes, (owner, name, value), and puts back the old ones. A version may lack some."""
    settings = [setting for setting in settings if hasattr(setting[0], setting[1])]
    kept = [(owner, name, getattr(owner, name)) for owner, name, _ in settings]
    try:
        for owner, name, value in settings:
            setattr(owner, name, value)
        yield
    finally:
        for owner, name, value in kept:
            setattr(owner, name, value)


def render_sharp(scene, view_layer):
    """Renders the whole picture without Blender's own lens, with depth."""
    view_layer.use_pass_z = True
    render = scene.render
    names = ("use_border", "use_compositing", "use_sequencer", "use_multiview", "use_stamp")
    with changed((scene.camera.data.dof, "use_dof", False), *((render, name, False) for name in names)):
        bpy.ops.render.render(scene=scene.name)


def read_exr(path, names):
    """Channels of an OpenEXR file of floats in rows that are not compressed."""
    with open(path, "rb") as file:
        data = file.read()
    at, attributes = 8, {}

    def text():
        nonlocal at
        start, at = at, data.index(0, at) + 1
        return data[start : at - 1].decode()

    while data[at]:
        name, _ = text(), text()
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    if data[5] & 0b11010 or attributes["compression"] != b"\0":
        raise ValueError("Blender wrote its passes in tiles, parts or compressed")
    left, low, right, high = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, high - low + 1
    starts, start, channels = {}, 0, attributes["channels"]
    while channels[0]:
        name, channels = channels.split(b"\0", 1)
        starts[name.decode()] = start
        start += width * (2 if channels[0] == 1 else 4)  # halves, or floats and whole numbers
        channels = channels[16:]
    missing = [name for name in names if name not in starts]
    if missing:
        raise ValueError(f"The last render has no {missing[0]}: Render and Refocus makes one that has")
    # Behind the table of the rows' places each has 8 bytes of its own, and then its channels.
    first = at + 1 + 8 * height
    rows = numpy.frombuffer(data, "u1", height * (start + 8), first).reshape(height, start + 8)[::-1, 8:]
    return [rows[:, starts[name] : starts[name] + 4 * width].copy().view("<f4") for name in names]


def read_passes(scene, view_layer):
    """The last render's colour, multiplied by its alpha, (h, w, 4), and depth, (h, w)."""
    render = next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)
    if render is None:
        raise ValueError("There is no render yet")
    settings = scene.render.image_settings
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        path = os.path.join(folder, "passes.exr")
        with changed(
            (settings, "media_type", "MULTI_LAYER_IMAGE"),  # since Blender 5
            (settings, "file_format", "OPEN_EXR_MULTILAYER"),
            (settings, "color_mode", "RGBA"),
            (settings, "color_depth", "32"),
            (settings, "exr_codec", "NONE"),
            (settings, "use_exr_interleave", True),  # one part; since Blender 5
        ):
            render.save_render(path, scene=scene)
        layer = view_layer.name
        *colour, depth = read_exr(path, [f"{layer}.Combined.{c}" for c in "RGBA"] + [f"{layer}.Depth.Z"])
    return numpy.dstack(colour), depth


def write_pfm(path, picture):
    height, width = picture.shape[:2]
    with open(path, "wb") as file:
        file.write(b"%s\n%d %d\n-1\n" % (b"PF" if picture.ndim == 3 else b"Pf", width, height))
        picture.astype("<f4").tofile(file)


def refocused(rgba, depth, lens, method, options=()):
    """What `softfocus refocus` makes of an EXR of these passes, to the bit."""
    height, width = depth.shape
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        colours, depths, result = (os.path.join(folder, name) for name in ("c.pfm", "d.pfm", "r.pfm"))
        write_pfm(depths, depth)

        def run(picture, *words):
            write_pfm(colours, picture)
            said = softfocus.run(
                ["refocus", colours, depths, "-o", result, "--depth-encoding", "blender-z", "--json"]
                + [*lens.words(), *options, *words]
            )
            with open(result, "rb") as file:
                pixels = file.read()[-12 * width * height :]
            return numpy.frombuffer(pixels, "<f4").reshape(height, width, 3), json.loads(said.stdout)

        shape = lens.aperture_words(method)
        out = numpy.ones_like(rgba)
        out[..., :3], report = run(rgba[..., :3], "--method", method, *shape)
        if (rgba[..., 3] < 1.0).any():
            if method == "auto":  # for alpha what it picked for the colour
                shape = ["--max-coc", str(report["max_coc_px"])]
            alpha = numpy.clip(rgba[..., 3], 0.0, 1.0)
            out[..., 3] = run(alpha, "--method", report["method"], *shape)[0][..., 0]
    return out


def show(context, name, rgba):
    """As an image of linear light, in the image editors that are open."""
    height, width = rgba.shape[:2]
    image = bpy.data.images.get(name)
    if image is None:
        image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True)
    if tuple(image.size) != (width, height):
        image.scale(width, height)
    image.alpha_mode = "PREMUL"
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
    return image
