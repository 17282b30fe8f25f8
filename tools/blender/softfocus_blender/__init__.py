"""Depth of field of softfocus in Blender: a panel among the render properties.

    bpy.ops.softfocus.refocus()                        # renders, and makes the image "Softfocus"
    bpy.ops.softfocus.export(filepath="scene.toml")    # for `softfocus render`
"""

import os
import shlex
import tempfile
import textwrap

import bpy
import numpy
from bpy.props import BoolProperty, EnumProperty, StringProperty

try:
    from . import softfocus  # in the zip
except ImportError:
    import softfocus

from . import passes, scene_file
from .lens import read_lens

bl_info = {
    "name": "Softfocus",
    "description": "Depth of field by every method of softfocus, and scenes for its renderer",
    "author": "softfocus",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Softfocus",
    "category": "Render",
}


class Settings(bpy.types.PropertyGroup):
    method: EnumProperty(
        name="Method",
        items=[(name, name, summary) for name, summary in softfocus.methods().items()]
        + [("auto", "auto", "the cheapest that should be good enough")],
        default="disc-layers",
    )
    unmix_edges: BoolProperty(
        name="Unmix edges",
        description="Take pixels on an edge apart into their two surfaces",
        default=True,
    )


def telling(execute):
    """What is raised becomes the operator's report."""

    def told(self, context):
        try:
            return execute(self, context)
        except (ValueError, RuntimeError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return told


class Refocus(bpy.types.Operator):
    """Render without Blender's own lens, and give the picture the camera's depth of field"""

    bl_idname = "softfocus.refocus"
    bl_label = "Render and Refocus"
    # A button without them would take those of the last call.
    render: BoolProperty(description="Or take the last render", default=True, options={"SKIP_SAVE"})
    filepath: StringProperty(description="Also written, in the output's format", options={"SKIP_SAVE"})

    @telling
    def execute(self, context):
        scene, settings = context.scene, context.scene.softfocus
        lens = read_lens(scene)
        if self.render:
            passes.render_sharp(scene, context.view_layer)
        colour, depth = passes.read_passes(scene, context.view_layer)
        height, width = depth.shape
        if (width, height) != (lens.width, lens.height):
            raise ValueError(f"The last render has {width}x{height} pixels, not {lens.width}x{lens.height}")
        options = ["--unmix-edges"] if settings.unmix_edges else []
        result = passes.refocused(colour, depth, lens, settings.method, options)
        image = passes.show(context, "Softfocus", result)
        if self.filepath:
            image.save_render(bpy.path.abspath(self.filepath), scene=scene)
        return {"FINISHED"}


class Export(bpy.types.Operator):
    """Write the scene for `softfocus render`: a .toml and a .glb"""

    bl_idname = "softfocus.export"
    bl_label = "Export Scene"
    filepath: StringProperty(subtype="FILE_PATH")
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def invoke(self, context, event):
        self.filepath = bpy.path.ensure_ext(os.path.splitext(bpy.data.filepath)[0] or "scene", ".toml")
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    @telling
    def execute(self, context):
        path = bpy.path.ensure_ext(bpy.path.abspath(self.filepath), ".toml")
        words, warnings = scene_file.export_scene(context.scene, read_lens(context.scene), path)
        for warning in warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"softfocus render {shlex.quote(path)} -o out.png {' '.join(words)}")
        return {"FINISHED"}


class Truth(bpy.types.Operator):
    """Draw the exported scene from many points of the lens, with softfocus's own shading"""

    bl_idname = "softfocus.truth"
    bl_label = "Render Truth"

    @telling
    def execute(self, context):
        with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
            scene, picture = os.path.join(folder, "scene.toml"), os.path.join(folder, "picture.npy")
            words, _ = scene_file.export_scene(context.scene, read_lens(context.scene), scene)
            softfocus.run(["render", scene, "-o", picture, *words])
            rgba = numpy.load(picture)[::-1].astype("f4")
        rgba[..., 3] = 1.0  # was depth
        passes.show(context, "Softfocus Truth", rgba)
        return {"FINISHED"}


class Panel(bpy.types.Panel):
    bl_idname = "RENDER_PT_softfocus"
    bl_label = "Softfocus"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    def draw(self, context):
        layout, settings = self.layout, context.scene.softfocus
        text = layout.column(align=True)

        def tell(sentence):
            letter_px = 7 * context.preferences.system.ui_scale
            for line in textwrap.wrap(sentence, max(int(context.region.width / letter_px) - 5, 10)):
                text.label(text=line)

        try:
            lens = read_lens(context.scene)
        except ValueError as error:
            return tell(str(error))
        tell(f"{lens.focal_length_mm:.4g} mm, f/{lens.f_number:.3g}, focus at {lens.focus_m:.4g} m")
        tell(f"{lens.fov_y_degrees:.3g}° from top to bottom")
        if not lens.is_round():
            alone = "" if settings.method == "scatter-aperture" else " (scatter-aperture alone)"
            tell(f"{lens.blades or 'no'} blades, ratio {lens.anamorphic:.3g}{alone}")
        layout.prop(settings, "method", text="")
        layout.prop(settings, "unmix_edges")
        layout.operator("softfocus.refocus")
        layout.operator("softfocus.refocus", text="Refocus Last Render").render = False
        layout.operator("softfocus.export")
        layout.operator("softfocus.truth")


CLASSES = (Settings, Refocus, Export, Truth, Panel)


def register():
    if not os.access(softfocus.program(), os.X_OK):  # unpacking an add-on loses that
        os.chmod(softfocus.program(), 0o755)
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.softfocus = bpy.props.PointerProperty(type=Settings)


def unregister():
    del bpy.types.Scene.softfocus
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
