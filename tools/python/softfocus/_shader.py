"""A user's fragment shader on arrays."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy

from ._calls import Context, encoded, library, struct

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_FRAGMENT = 1
_FORMATS = {"uint8": 2, "float16": 4, "float32": 6}


_Source = struct(
    "softfocus_shader_source",
    "int stage",
    "text text",
    "pointer words",
    "size word_count",
    "text name convention",
    "pointer defines",
    "size define_count",
    "pointer read_include user",
)
_Texels = struct(
    "softfocus_texels", "int width height format", "pointer first", "step row_bytes", "int slices", "step slice_bytes"
)
_Sampler = struct("softfocus_sampler", "int filter wrap_u wrap_v compare wrap_w")
_Pass = struct("softfocus_pass", "pointer targets", "int target_count", "text profile", "long budget")


def _texels_of(array: NDArray[Any]) -> Any:
    *slices, height, width, _ = array.shape
    return _Texels(
        ctypes.sizeof(_Texels),
        width,
        height,
        _FORMATS[str(array.dtype)],
        array.ctypes.data,
        array.strides[-3],
        *slices,
    )


class Shader:
    """A fragment shader, compiled once: GLSL, plain or as Shadertoy, three.js, libretro and
    gl-transitions have it. Raises ValueError with the shader's file and line.

    The first row of textures and results has the smallest gl_FragCoord.y.
    """

    _FILTERS = {"nearest": 1, "bilinear": 2, "trilinear": 3}
    _WRAPS = {"repeat": 1, "mirror": 2, "clamp": 3}

    def __init__(self, text: str, name: str = "shader", *, convention: str | None = None, threads: int = 0):
        """`name` is for errors; without a convention it is recognised by the text."""
        self._handle = ctypes.c_void_p()
        self._context = Context(threads)
        source = _Source(
            ctypes.sizeof(_Source),
            _FRAGMENT,
            encoded(text),
            name=encoded(name),
            convention=encoded(convention) if convention else None,
        )
        self._context.call("compile_shader", ctypes.byref(source), ctypes.byref(self._handle))

    def __del__(self) -> None:
        if self._handle:
            library().softfocus_free_shader(self._handle)

    def __reduce__(self) -> Any:
        return self._context.__reduce__()

    def uniforms(self) -> list[str]:
        """The names of all uniforms and textures."""
        names: list[str] = []
        with self._context.lock:
            while name := library().softfocus_uniform_name(self._handle, ctypes.c_size_t(len(names))):
                names.append(name.decode())
        return names

    def set(self, name: str, numbers: ArrayLike) -> None:
        """A uniform: its numbers in order, matrices column by column."""
        values = numpy.atleast_1d(numpy.asarray(numbers, numpy.float64)).ravel()
        self._context.call(
            "set_uniform",
            self._handle,
            encoded(name),
            values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)),
            ctypes.c_size_t(values.size),
        )

    def set_texture(
        self, name: str, texels: NDArray[Any], *, filter: str = "bilinear", wrap: str = "repeat"
    ) -> None:
        """An array (h, w, 4) of uint8, float16 or float32; (n, h, w, 4) for a sampler3D, sampler2DArray
        or samplerCube. `filter` is nearest, bilinear or trilinear; `wrap` repeat, mirror or clamp."""
        pixels = numpy.ascontiguousarray(texels)
        if pixels.ndim not in (3, 4) or pixels.shape[-1] != 4 or str(pixels.dtype) not in _FORMATS:
            raise ValueError(
                f"{name} is {pixels.dtype} {pixels.shape}; {', '.join(_FORMATS)} of (h, w, 4) would do"
            )
        if filter not in self._FILTERS or wrap not in self._WRAPS:
            raise ValueError(
                f"{name}: one of {', '.join(self._FILTERS)} and one of {', '.join(self._WRAPS)} would do"
            )
        edge = self._WRAPS[wrap]
        sampler = _Sampler(ctypes.sizeof(_Sampler), self._FILTERS[filter], edge, edge, 0, edge)
        self._context.call(
            "set_texture",
            self._handle,
            encoded(name),
            ctypes.byref(_texels_of(pixels)),
            ctypes.byref(sampler),
        )

    def run(self, width: int, height: int, *, profile: str = "ieee") -> NDArray[numpy.float32]:
        """The shader's first output, (height, width, 4)."""
        result = numpy.zeros((height, width, 4), numpy.float32)
        target = _texels_of(result)
        targets = (ctypes.c_void_p * 1)(ctypes.addressof(target))
        where = _Pass(ctypes.sizeof(_Pass), ctypes.addressof(targets), 1, encoded(profile))
        self._context.call("run_shader", self._handle, ctypes.byref(where))
        return result
