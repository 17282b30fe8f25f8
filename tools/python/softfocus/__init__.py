"""Depth of field, shaders on an emulated GPU and comparison of pictures, with the same bits on every
machine.

    import softfocus
    blurred = softfocus.refocus(colour, depth, focus_m=2.5, f_number=1.4)
    picture = softfocus.render("figures", size="640x480")
    print(softfocus.compare(blurred, picture)["flip"])

Pictures are NumPy arrays (height, width, channels), rows from the top: uint8 along the sRGB curve, or
float16 or float32 of linear light. OpenCV's order is `bgr[..., ::-1]`, which copies nothing.
"""

from ._calls import methods, profiles, refocus
from ._program import compare, program, render, run
from ._shader import Shader

__all__ = ["Shader", "compare", "methods", "profiles", "program", "refocus", "render", "run"]
__version__ = "0.1.0"
