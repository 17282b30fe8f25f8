#!/usr/bin/env python3
"""Depth of field on NumPy arrays, by the C interface of libsoftfocus and ctypes.

    refocus.py COLOUR.npy DEPTH.npy RESULT.npy [SETTING=VALUE...]

COLOUR.npy is height x width x 3, linear light in float16 or float32, or sRGB in uint8. DEPTH.npy is
height x width, metres in float16 or float32. RESULT.npy is height x width x 4, float16, linear, with
the depth in the last channel: what `softfocus refocus -o RESULT.npy` writes by the same method, here
two-pass if none is named. SETTING is a field of softfocus_settings, such as focus_m=2.5 or
method=disc-layers.

The library is the file that SOFTFOCUS_LIBRARY names, or the installed one, or that of build/ in the
checkout that this file stands in. Needs NumPy.
"""

import ctypes
import ctypes.util
import difflib
import glob
import os
import sys

import numpy

HALF, FLOAT, SRGB8 = 1, 2, 4
TYPES = {"float16": HALF, "float32": FLOAT, "uint8": SRGB8}


class Picture(ctypes.Structure):
    """softfocus_picture."""

    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("width", ctypes.c_int32),
        ("height", ctypes.c_int32),
        ("red", ctypes.c_void_p),
        ("green", ctypes.c_void_p),
        ("blue", ctypes.c_void_p),
        ("pixel_bytes", ctypes.c_ssize_t),
        ("row_bytes", ctypes.c_ssize_t),
        ("depth", ctypes.c_void_p),
        ("depth_pixel_bytes", ctypes.c_ssize_t),
        ("depth_row_bytes", ctypes.c_ssize_t),
        ("colour_type", ctypes.c_int32),
        ("depth_type", ctypes.c_int32),
        ("objects", ctypes.c_void_p),
        ("radii_px", ctypes.c_void_p),
        ("behind", ctypes.c_void_p),
        ("transparent", ctypes.c_void_p),
        ("opacity", ctypes.c_void_p),
        ("behind_count", ctypes.c_int32),
        ("transparent_count", ctypes.c_int32),
    ]


class Target(ctypes.Structure):
    """softfocus_target."""

    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("red", ctypes.c_void_p),
        ("green", ctypes.c_void_p),
        ("blue", ctypes.c_void_p),
        ("pixel_bytes", ctypes.c_ssize_t),
        ("row_bytes", ctypes.c_ssize_t),
        ("depth", ctypes.c_void_p),
        ("depth_pixel_bytes", ctypes.c_ssize_t),
        ("depth_row_bytes", ctypes.c_ssize_t),
        ("colour_type", ctypes.c_int32),
        ("depth_type", ctypes.c_int32),
    ]


class Settings(ctypes.Structure):
    """softfocus_settings."""

    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("method", ctypes.c_char_p),
        ("profile", ctypes.c_char_p),
        ("focal_length_mm", ctypes.c_double),
        ("f_number", ctypes.c_double),
        ("focus_m", ctypes.c_double),
        ("sensor_width_mm", ctypes.c_double),
        ("sensor_height_mm", ctypes.c_double),
        ("fov_y_degrees", ctypes.c_double),
        ("coc_scale", ctypes.c_double),
        ("blur_at_infinity_px", ctypes.c_double),
        ("max_radius_px", ctypes.c_double),
        ("leak", ctypes.c_double),
        ("budget", ctypes.c_double),
        ("max_error", ctypes.c_double),
    ]


def find_library():
    named = os.environ.get("SOFTFOCUS_LIBRARY") or ctypes.util.find_library("softfocus")
    if named:
        return named
    checkout = os.path.join(os.path.dirname(os.path.abspath(__file__)), *[".."] * 3)
    built = glob.glob(os.path.join(checkout, "build*", "**", "libsoftfocus.so.*"), recursive=True)
    return min(built, key=len) if built else "libsoftfocus.so.0"


def load_library():
    library = ctypes.CDLL(find_library())
    library.softfocus_open.argtypes = [ctypes.c_void_p, ctypes.c_int]
    library.softfocus_close.argtypes = [ctypes.c_void_p]
    library.softfocus_message.argtypes = [ctypes.c_void_p]
    library.softfocus_message.restype = ctypes.c_char_p
    library.softfocus_init_settings.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    library.softfocus_refocus.argtypes = [ctypes.c_void_p] * 5
    return library


def place(pixels, colour, depth):
    """Tells a struct where arrays lie. Any strides will do: slices, flipped and Fortran arrays."""
    row_bytes, pixel_bytes, channel_bytes = colour.strides
    red = colour.ctypes.data
    pixels.struct_size = ctypes.sizeof(pixels)
    pixels.red, pixels.green, pixels.blue = red, red + channel_bytes, red + 2 * channel_bytes
    pixels.pixel_bytes, pixels.row_bytes = pixel_bytes, row_bytes
    pixels.depth = depth.ctypes.data
    pixels.depth_row_bytes, pixels.depth_pixel_bytes = depth.strides
    pixels.colour_type, pixels.depth_type = TYPES[str(colour.dtype)], TYPES[str(depth.dtype)]
    return pixels


def set_one(settings, name, value):
    names = [field for field, _ in Settings._fields_ if field != "struct_size"]
    if name not in names:
        near = difflib.get_close_matches(name, names, 1)
        meant = f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(names)}"
        raise ValueError(f"there is no setting '{name}'{meant}")
    setattr(settings, name, value.encode() if isinstance(value, str) else value)


def refocus(colour, depth, **chosen):
    """The picture as a lens makes it, float16 with the depth in its last channel.

    `chosen` are fields of softfocus_settings; method and profile are strings. Raises ValueError.
    """
    if colour.ndim != 3 or colour.shape[2] < 3 or depth.shape != colour.shape[:2]:
        raise ValueError(f"shapes {colour.shape} and {depth.shape}; give (h, w, 3) and (h, w)")
    for name, array in (("colour", colour), ("depth", depth)):
        if str(array.dtype) not in TYPES:
            raise ValueError(f"{name} is {array.dtype}; give one of {', '.join(TYPES)}")
    library = load_library()
    context = ctypes.c_void_p()
    if library.softfocus_open(ctypes.byref(context), 0) != 0:
        raise MemoryError("softfocus_open")
    try:
        settings = Settings()
        library.softfocus_init_settings(ctypes.byref(settings), ctypes.sizeof(settings))
        for name, value in chosen.items():
            set_one(settings, name, value)
        picture = place(Picture(), colour, depth)
        picture.height, picture.width = depth.shape
        result = numpy.empty(depth.shape + (4,), numpy.float16)
        target = place(Target(), result, result[..., 3])
        if library.softfocus_refocus(context, ctypes.byref(picture), ctypes.byref(settings),
                                     ctypes.byref(target), None) != 0:
            raise ValueError(library.softfocus_message(context).decode())
        return result
    finally:
        library.softfocus_close(context)


def number(text):
    try:
        return float(text)
    except ValueError:
        sys.exit(f"'{text}' is no number")


def main(arguments):
    if len(arguments) < 3:
        sys.exit(__doc__)
    chosen = {}
    for argument in arguments[3:]:
        name, _, value = argument.partition("=")
        chosen[name] = value if name in ("method", "profile") else number(value)
    try:
        result = refocus(numpy.load(arguments[0]), numpy.load(arguments[1]), **chosen)
    except ValueError as error:
        sys.exit(str(error))
    numpy.save(arguments[2], result)


if __name__ == "__main__":
    main(sys.argv[1:])
