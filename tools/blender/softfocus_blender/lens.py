"""The lens of Blender's camera, as softfocus's options."""

import math
from typing import NamedTuple

import bpy


class Lens(NamedTuple):
    """Lengths in Blender's units, which Blender's own lens takes for metres."""

    camera: bpy.types.Object
    width: int
    height: int
    focus_m: float
    f_number: float
    focal_length_mm: float
    fov_y_degrees: float
    blades: int  # 0: round
    turn_degrees: float
    anamorphic: float  # height over width

    def words(self):
        numbers = zip(("focus", "f-number", "focal-length", "fov"), self[3:7])
        return [f"--{name}={number:.7g}" for name, number in numbers]

    def aperture_words(self, method):
        """The shape of the aperture, as far as a method has one."""
        blades = ["--aperture-blades", str(self.blades)] if self.blades else []
        if method == "accumulation":
            return blades
        if method != "scatter-aperture":
            return []
        turn = ["--aperture-turn", f"{self.turn_degrees:.7g}"] if self.blades else []
        return blades + turn + ["--anamorphic", f"{self.anamorphic:.7g}"]

    def is_round(self):
        return self.blades == 0 and self.anamorphic == 1.0


def focus_distance(camera):
    """Along the axis, as Cycles and EEVEE have it."""
    dof = camera.data.dof
    if dof.focus_object is None:
        return dof.focus_distance
    place = dof.focus_object.matrix_world.translation
    bone = dof.focus_object.pose and dof.focus_object.pose.bones.get(dof.focus_subtarget)
    if bone:
        place = dof.focus_object.matrix_world @ bone.head
    axis = camera.matrix_world.to_3x3().col[2].normalized()
    return abs(axis.dot(camera.matrix_world.translation - place))


def read_lens(scene):
    """Raises ValueError, a sentence, for a camera whose picture has no depth of field of a thin lens."""
    camera, render = scene.camera, scene.render
    if camera is None or camera.type != "CAMERA":
        raise ValueError("The scene has no camera")
    data = camera.data
    if data.type == "ORTHO":
        raise ValueError("The camera is orthographic: a lens needs a perspective one")
    if data.type != "PERSP":
        raise ValueError("The camera is panoramic: a lens needs a perspective one")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        raise ValueError("The pixels are not square: set both aspects of the output's format to 1")
    width = render.resolution_x * render.resolution_percentage // 100
    height = render.resolution_y * render.resolution_percentage // 100
    fits_width = data.sensor_fit == "HORIZONTAL" or (data.sensor_fit == "AUTO" and width >= height)
    # AUTO has the sensor's width along the longer side.
    sensor_mm = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    tangent = sensor_mm / (2.0 * data.lens) * (height / width if fits_width else 1.0)
    blades = data.dof.aperture_blades if data.dof.aperture_blades >= 3 else 0
    # Blender has the middle of a blade at the right, we a corner above.
    turn = math.degrees(data.dof.aperture_rotation) + (180.0 / blades if blades else 0.0) - 90.0
    # Below 1 Blender makes the aperture wider, we make it lower.
    wider = min(data.dof.aperture_ratio, 1.0)
    return Lens(
        camera,
        width,
        height,
        focus_distance(camera),
        data.dof.aperture_fstop * wider,
        data.lens,
        math.degrees(2.0 * math.atan(tangent)),
        blades,
        math.remainder(turn, 360.0),
        min(max(data.dof.aperture_ratio, 1.0 / 16.0), 16.0),
    )
