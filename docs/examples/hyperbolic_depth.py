#!/usr/bin/env python3
"""For an engine whose depth is a buffer of its own and hyperbolic: gives it colour and depth of a
picture that softfocus has drawn, and plays the engine.

    hyperbolic_depth.py give IN.npy REPORT.json DEPTH FOLDER
    hyperbolic_depth.py play FOLDER REPORT.json DEPTH NOW.npy [HALVES]

IN.npy is from `softfocus render --show pinhole`, REPORT.json from `render --json`: the camera's near
and far distance, the lens. `give` writes FOLDER/colour.npy (height x width x 3, float16, linear) and
FOLDER/depth.npy (height x width), top row first. `play` is what the engine does with them: it makes
metres of the depth and runs the two-pass filter of dof/two_pass, in binary32 in the order of its GLSL;
halves are stored truncated, as Mesa's llvmpipe does. NOW.npy is for `softfocus compare`.

DEPTH is one of
    d24             a whole number 0 to 2^24 - 1, in uint32: near is 0
    d16             the same to 2^16 - 1, in uint16
    float           binary32: near is 0, far is 1
    float-reversed  binary32: near is 1, far is 0
    metres          binary32, not hyperbolic: to check the engine by

HALVES is what the engine makes of the metres before it uses them, by default nothing:
    nearest         rounds them to the nearest half
    truncated       stores them into an RGBA16F texture, where llvmpipe truncates

Needs NumPy.
"""

import json
import math
import pathlib
import sys

import numpy
from numpy import float16, float32

STEPS = {"d24": 2**24 - 1, "d16": 2**16 - 1}
TYPES = {"d24": numpy.uint32, "d16": numpy.uint16}


def hyperbolic(metres, near, far, kind):
    """What a projection matrix leaves in the depth buffer, computed in binary64 and rounded once."""
    z = metres.astype(numpy.float64)
    if kind == "metres":
        return z.astype(float32)
    if kind == "float-reversed":
        return (near * (far - z) / (z * (far - near))).astype(float32)
    depth = numpy.clip(far * (z - near) / (z * (far - near)), 0.0, 1.0)
    if kind == "float":
        return depth.astype(float32)
    return numpy.rint(depth * STEPS[kind]).astype(TYPES[kind])


def metres(depth, near, far, kind):
    """The inverse as a shader computes it: binary32 throughout."""
    if kind == "metres":
        return depth
    near, far = float32(near), float32(far)
    if kind == "float-reversed":
        return (near * far) / (near + depth * (far - near))
    # A texture unit gives 0 to 1: the exact quotient, rounded once.
    share = (depth / STEPS[kind]).astype(float32) if kind in STEPS else depth
    return (near * far) / (far - share * (far - near))


def truncated_to_half(values):
    """float32 to the nearest half that is not larger in magnitude."""
    with numpy.errstate(over="ignore"):
        halves = values.astype(float16)
    too_large = numpy.abs(halves.astype(float32)) > numpy.abs(values)
    return (halves.view(numpy.uint16) - too_large.astype(numpy.uint16)).view(float16)


def shifted(values, by, axis):
    """Each pixel's neighbour `by` pixels on; the picture's edges repeat outwards."""
    size = values.shape[axis]
    return values.take(numpy.clip(numpy.arange(size) + by, 0, size - 1), axis)


def filtered(colour, depth, lens, axis):
    """One pass of dof/two_pass/two_pass.frag with dof/weights.glsl, along an axis."""
    focus, largest, leak = (float32(lens[name]) for name in ("focus_m", "max_coc_px", "leak"))
    one, zero = float32(1), float32(0)
    radius = numpy.abs(float32(lens["radius_at_infinity_px"]) * (depth - focus) / depth)
    radius = numpy.where(radius < largest, radius, largest)
    wide = numpy.where(radius > one, radius, one)
    intensity = one / (wide * wide)
    receiver_leakage = numpy.minimum(leak * radius, one)
    beyond_focus = depth > focus
    weights = intensity
    colours = colour * intensity[..., None]
    for distance in range(1, math.ceil(largest)):
        for by in (-distance, distance):
            reach = numpy.clip(shifted(radius, by, axis) - float32(distance), zero, one)
            weight = reach * shifted(intensity, by, axis)
            weight = weight * numpy.where(shifted(beyond_focus, by, axis), receiver_leakage, one)
            colours = colours + shifted(colour, by, axis) * weight[..., None]
            weights = weights + weight
    return truncated_to_half(colours / weights[..., None])


def give(picture, camera, kind, folder):
    rgba = numpy.load(picture)
    folder.mkdir(exist_ok=True)
    numpy.save(folder / "colour.npy", rgba[..., :3])
    numpy.save(folder / "depth.npy",
               hyperbolic(rgba[..., 3], camera["near_m"], camera["far_m"], kind))


def play(folder, report, kind, output, halves):
    camera = report["camera"]
    depth = metres(numpy.load(folder / "depth.npy"), camera["near_m"], camera["far_m"], kind)
    if halves == "nearest":
        depth = depth.astype(float16).astype(float32)
    elif halves == "truncated":
        depth = truncated_to_half(depth).astype(float32)
    picture = numpy.load(folder / "colour.npy")
    for axis in (1, 0):  # along the rows, then along the columns
        picture = filtered(picture.astype(float32), depth, report["lens"], axis)
    numpy.save(output, picture)


def main(command=None, source=None, report=None, kind=None, target=None, halves=None):
    kinds = ("d24", "d16", "float", "float-reversed", "metres")
    if kind not in kinds or halves not in (None, "nearest", "truncated") or not target:
        sys.exit(__doc__)
    report = json.loads(pathlib.Path(report).read_text())
    if command == "give":
        give(source, report["camera"], kind, pathlib.Path(target))
    elif command == "play":
        play(pathlib.Path(source), report, kind, target, halves)
    else:
        sys.exit(__doc__)


main(*sys.argv[1:])
