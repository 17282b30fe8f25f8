#!/usr/bin/env python3
"""A fragment shader on a NumPy array, by the C interface of libsoftfocus and ctypes.

    shade.py SHADER.frag PICTURE.npy RESULT.npy [UNIFORM=NUMBER,...]

PICTURE.npy is height x width x 4, uint8, float16 or float32: every texture of the shader. RESULT.npy
is of the same shape, float32. The first row has the smallest gl_FragCoord.y. The library is found as
refocus.py finds it. Needs NumPy.
"""

import ctypes
import sys

import numpy
from refocus import find_library

FRAGMENT = 1
FORMATS = {"uint8": 2, "float16": 4, "float32": 6}


class Source(ctypes.Structure):
    """softfocus_shader_source."""

    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("stage", ctypes.c_int32),
        ("text", ctypes.c_char_p),
        ("words", ctypes.c_void_p),
        ("word_count", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        ("convention", ctypes.c_char_p),
        ("defines", ctypes.c_void_p),
        ("define_count", ctypes.c_size_t),
        ("read_include", ctypes.c_void_p),
        ("user", ctypes.c_void_p),
    ]


class Texels(ctypes.Structure):
    """softfocus_texels."""

    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("width", ctypes.c_int32),
        ("height", ctypes.c_int32),
        ("format", ctypes.c_int32),
        ("first", ctypes.c_void_p),
        ("row_bytes", ctypes.c_ssize_t),
        ("slices", ctypes.c_int32),
        ("slice_bytes", ctypes.c_ssize_t),
    ]


class Pass(ctypes.Structure):
    """softfocus_pass."""

    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("targets", ctypes.c_void_p),
        ("target_count", ctypes.c_int32),
        ("profile", ctypes.c_char_p),
        ("budget", ctypes.c_uint64),
    ]


def texels_of(array):
    *slices, height, width, _ = array.shape
    return Texels(ctypes.sizeof(Texels), width, height, FORMATS[str(array.dtype)],
                  array.ctypes.data, array.strides[-3], *slices)


class Shader:
    """A fragment shader, compiled once. Raises ValueError with the shader's file and line."""

    def __init__(self, text, name="shader"):
        self.library = ctypes.CDLL(find_library())
        self.library.softfocus_message.restype = ctypes.c_char_p
        self.library.softfocus_uniform_name.restype = ctypes.c_char_p
        self.context, self.shader = ctypes.c_void_p(), ctypes.c_void_p()
        if self.library.softfocus_open(ctypes.byref(self.context), 0) != 0:
            raise MemoryError("softfocus_open")
        source = Source(ctypes.sizeof(Source), FRAGMENT, text.encode(), name=name.encode())
        self.call("compile_shader", ctypes.byref(source), ctypes.byref(self.shader), on=())

    def __del__(self):
        self.library.softfocus_free_shader(self.shader)
        self.library.softfocus_close(self.context)

    def call(self, name, *arguments, on=None):
        on = (self.shader,) if on is None else on
        if getattr(self.library, "softfocus_" + name)(self.context, *on, *arguments) != 0:
            raise ValueError(self.library.softfocus_message(self.context).decode())

    def uniforms(self):
        """The names of all uniforms and textures."""
        names = []
        while name := self.library.softfocus_uniform_name(self.shader,
                                                          ctypes.c_size_t(len(names))):
            names.append(name.decode())
        return names

    def set(self, name, numbers):
        """A uniform: its numbers in order, matrices column by column."""
        values = numpy.atleast_1d(numpy.asarray(numbers, numpy.float64)).ravel()
        self.call("set_uniform", name.encode(),
                  values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)),
                  ctypes.c_size_t(values.size))

    def set_texture(self, name, array):
        """An array of shape (h, w, 4), bilinear, its edges repeated; (n, h, w, 4) for a sampler3D,
        sampler2DArray or samplerCube."""
        pixels = numpy.ascontiguousarray(array)
        self.call("set_texture", name.encode(), ctypes.byref(texels_of(pixels)), None)

    def run(self, width, height):
        """The shader's first output, of shape (height, width, 4), float32."""
        result = numpy.empty((height, width, 4), numpy.float32)
        target = texels_of(result)
        targets = (ctypes.c_void_p * 1)(ctypes.addressof(target))
        where = Pass(ctypes.sizeof(Pass), ctypes.addressof(targets), 1)
        self.call("run_shader", ctypes.byref(where))
        return result


def main(arguments):
    if len(arguments) < 3:
        sys.exit(__doc__)
    picture = numpy.load(arguments[1])
    if picture.ndim != 3 or picture.shape[2] != 4 or str(picture.dtype) not in FORMATS:
        sys.exit(f"{arguments[1]}: give (h, w, 4) of {', '.join(FORMATS)}")
    try:
        with open(arguments[0], encoding="utf-8") as file:
            shader = Shader(file.read(), arguments[0])
        chosen = dict(argument.split("=", 1) for argument in arguments[3:])
        for name, numbers in chosen.items():
            shader.set(name, [float(number) for number in numbers.split(",")])
        for name in shader.uniforms():
            try:
                shader.set_texture(name, picture)
            except ValueError:
                pass  # a number
        numpy.save(arguments[2], shader.run(picture.shape[1], picture.shape[0]))
    except ValueError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main(sys.argv[1:])
