"""softfocus.h by ctypes: the structs and the calls that are no shader's."""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
import threading
from typing import TYPE_CHECKING, Any

import numpy

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray

HALF, FLOAT, SRGB8 = 1, 2, 4
TYPES = {"float16": HALF, "float32": FLOAT, "uint8": SRGB8}


_TYPES = {
    "size": ctypes.c_size_t,
    "step": ctypes.c_ssize_t,
    "int": ctypes.c_int32,
    "long": ctypes.c_uint64,
    "double": ctypes.c_double,
    "text": ctypes.c_char_p,
    "pointer": ctypes.c_void_p,
}


def struct(name: str, *fields: str) -> type[ctypes.Structure]:
    """A struct of softfocus.h, of lines "TYPE FIELD...". The first field is its size."""
    named = [("struct_size", ctypes.c_size_t)]
    for line in fields:
        kind, *words = line.split()
        named += [(word, _TYPES[kind]) for word in words]
    return type(name, (ctypes.Structure,), {"_fields_": named})


_COLOURS = ("pointer red green blue", "step pixel_bytes row_bytes")
_DEPTHS = ("pointer depth", "step depth_pixel_bytes depth_row_bytes", "int colour_type depth_type")
Picture = struct(
    "softfocus_picture",
    "int width height",
    *_COLOURS,
    *_DEPTHS,
    "pointer objects radii_px behind transparent opacity",
    "int behind_count transparent_count",
)
Target = struct("softfocus_target", *_COLOURS, *_DEPTHS)
Settings = struct(
    "softfocus_settings",
    "text method profile",
    "double focal_length_mm f_number focus_m sensor_width_mm sensor_height_mm fov_y_degrees coc_scale",
    "double blur_at_infinity_px max_radius_px leak budget max_error",
)


@functools.lru_cache(maxsize=None)
def library() -> ctypes.CDLL:
    """The file that SOFTFOCUS_LIBRARY names, or the one in this package, or the installed one."""
    own = os.path.join(os.path.dirname(__file__), "libsoftfocus.so.0")
    named = os.environ.get("SOFTFOCUS_LIBRARY") or (own if os.path.exists(own) else None)
    loaded = ctypes.CDLL(named or ctypes.util.find_library("softfocus") or "libsoftfocus.so.0")
    loaded.softfocus_open.argtypes = [ctypes.c_void_p, ctypes.c_int]
    loaded.softfocus_close.argtypes = [ctypes.c_void_p]
    loaded.softfocus_init_settings.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
    loaded.softfocus_refocus.argtypes = [ctypes.c_void_p] * 5
    loaded.softfocus_message.argtypes = [ctypes.c_void_p]
    loaded.softfocus_free_shader.argtypes = [ctypes.c_void_p]
    for name in ("method", "profile"):
        for what in ("name", "summary"):
            getattr(loaded, f"softfocus_{name}_{what}").argtypes = [ctypes.c_size_t]
            getattr(loaded, f"softfocus_{name}_{what}").restype = ctypes.c_char_p
    loaded.softfocus_message.restype = loaded.softfocus_uniform_name.restype = ctypes.c_char_p
    return loaded


def encoded(text: str) -> bytes:
    """Text for C, where a zero would end it."""
    if "\0" in text:
        raise ValueError(f"{text!r} has a zero in it")
    return text.encode()


class Context:
    """softfocus_context: threads, and the memory that methods work in. One call at a time."""

    def __init__(self, threads: int = 0):
        self.handle = ctypes.c_void_p()
        if not isinstance(threads, int) or not 0 <= threads <= 256:
            raise ValueError(f"threads is {threads!r}; 1 to 256, or 0 for all, would do")
        if library().softfocus_open(ctypes.byref(self.handle), threads) != 0:
            raise MemoryError("softfocus_open")
        self.process, self.lock = os.getpid(), threading.Lock()

    def __del__(self) -> None:
        if getattr(self, "process", None) == os.getpid():
            library().softfocus_close(self.handle)

    def __reduce__(self) -> Any:
        raise TypeError("a softfocus context or shader cannot be copied; make another")

    def call(self, name: str, *arguments: Any) -> None:
        if self.process != os.getpid():
            raise RuntimeError("a softfocus context or shader does not outlive fork(); make another")
        with self.lock:
            if getattr(library(), "softfocus_" + name)(self.handle, *arguments) != 0:
                raise ValueError(library().softfocus_message(self.handle).decode())


_kept = threading.local()


def _context(threads: int) -> Context:
    """The thread's own, kept from call to call: it has memory for pictures of a size."""
    kept = getattr(_kept, "context", None)
    if kept is None or _kept.threads != threads or kept.process != os.getpid():
        _kept.context, _kept.threads = Context(threads), threads
    return _kept.context


def _listed(kind: str) -> dict[str, str]:
    found: dict[str, str] = {}
    while name := getattr(library(), f"softfocus_{kind}_name")(len(found)):
        found[name.decode()] = getattr(library(), f"softfocus_{kind}_summary")(len(found)).decode()
    return found


def methods() -> dict[str, str]:
    """The names of all depth-of-field methods on a picture, with a summary each."""
    return _listed("method")


def profiles() -> dict[str, str]:
    """The names of all arithmetics, such as "llvmpipe", with a summary each."""
    return _listed("profile")


def _place(pixels: Any, colour: NDArray[Any], depth: NDArray[Any] | None) -> Any:
    """Tells a struct where arrays lie. Any strides will do: slices, flipped and Fortran arrays."""
    row_bytes, pixel_bytes, channel_bytes = colour.strides
    red = colour.ctypes.data
    pixels.struct_size = ctypes.sizeof(pixels)
    pixels.red, pixels.green, pixels.blue = red, red + channel_bytes, red + 2 * channel_bytes
    pixels.pixel_bytes, pixels.row_bytes = pixel_bytes, row_bytes
    pixels.colour_type = TYPES[str(colour.dtype)]
    if depth is not None:
        pixels.depth = depth.ctypes.data
        pixels.depth_row_bytes, pixels.depth_pixel_bytes = depth.strides
        pixels.depth_type = TYPES[str(depth.dtype)]
    return pixels


def _known(name: str, array: NDArray[Any], types: list[str]) -> NDArray[Any]:
    """The array in this machine's order of bytes, from float64 rounded to float32."""
    array = numpy.asarray(array)
    if array.dtype.newbyteorder("=") == numpy.float64:
        array = array.astype(numpy.float32)
    elif not array.dtype.isnative:
        array = array.astype(array.dtype.newbyteorder("="))
    if str(array.dtype) not in types:
        raise ValueError(f"{name} is {array.dtype}; {', '.join(types)} or float64 would do")
    return array


def _check_result(out: Any, shape: tuple[int, ...]) -> None:
    fits = isinstance(out, numpy.ndarray) and str(out.dtype) in TYPES and out.ndim == 3
    if not fits or out.shape[:2] != shape or out.shape[2] < 3:
        what = f"{out.dtype} {out.shape}" if isinstance(out, numpy.ndarray) else type(out).__name__
        raise ValueError(f"the result is {what}; {', '.join(TYPES)} of (h, w, 3) would do")
    overlaps = any(step == 0 and size > 1 for step, size in zip(out.strides, out.shape))
    if not out.flags.writeable or overlaps:
        raise ValueError("the result cannot be written to; an array of its own would do")


def refocus(
    colour: NDArray[Any],
    depth: NDArray[Any],
    *,
    focus_m: float = 2.0,
    f_number: float = 2.0,
    focal_length_mm: float = 50.0,
    fov_y_degrees: float = 0.0,
    sensor_width_mm: float = 36.0,
    sensor_height_mm: float = 24.0,
    blur_at_infinity_px: float = 0.0,
    coc_scale: float = 1.0,
    max_radius_px: float = 0.0,
    method: str = "disc-layers",
    max_error: float = 0.02,
    leak: float = 1.0,
    budget: float = 0.25,
    profile: str = "ieee",
    dtype: DTypeLike | None = None,
    out: NDArray[Any] | None = None,
    threads: int = 0,
) -> NDArray[Any]:
    """The picture as a lens makes it: `softfocus refocus` on arrays, without a copy of them.

    colour   (h, w, 3 or more): red, green, blue; others are not read
    depth    (h, w), metres along the camera's axis, float16 or float32; infinity is the horizon
    focus_m, f_number, focal_length_mm   the lens
    sensor_width_mm, sensor_height_mm    of which the picture is the largest part of its shape; or
    fov_y_degrees                        the vertical field of view; or
    blur_at_infinity_px                  the radius of what is infinitely far, in place of lens and sensor
    coc_scale, max_radius_px             exaggerate circles; cut them (0: none)
    method   of methods(), or "auto": the cheapest with a mean FLIP of max_error
    leak, budget                         of some methods; docs/methods.md
    profile  of profiles()
    dtype    of the result (that of colour); or `out`, (h, w, 3 or more), to write to
    threads  0: all

    Raises ValueError for what cannot be.
    """
    colour = _known("colour", colour, list(TYPES))
    depth = _known("depth", depth, ["float16", "float32"])
    if colour.ndim != 3 or colour.shape[2] < 3 or depth.shape != colour.shape[:2]:
        raise ValueError(
            f"colour is {colour.shape} and depth {depth.shape}; (h, w, 3) and (h, w) would do"
        )
    if out is None:
        out = numpy.empty((*depth.shape, 3), colour.dtype if dtype is None else dtype)
    elif dtype is not None:
        raise ValueError("dtype is that of out; one of the two would do")
    _check_result(out, depth.shape)
    context = _context(threads)
    settings = Settings()
    library().softfocus_init_settings(ctypes.byref(settings), ctypes.sizeof(settings))
    chosen = locals()
    for name in [field for field, _ in Settings._fields_ if field in chosen]:
        value = chosen[name]
        setattr(settings, name, encoded(value) if isinstance(value, str) else value)
    picture = _place(Picture(), colour, depth)
    picture.height, picture.width = depth.shape
    target = _place(Target(), out, None)
    context.call("refocus", ctypes.byref(picture), ctypes.byref(settings), ctypes.byref(target), None)
    return out
