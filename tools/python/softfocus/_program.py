"""What the program does that softfocus.h does not: scenes, and comparison."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from typing import TYPE_CHECKING, Any

import numpy

if TYPE_CHECKING:
    from numpy.typing import NDArray


def program() -> str:
    """The path of the program: what SOFTFOCUS_PROGRAM names, or the one in this package, or the one on
    the PATH. Raises FileNotFoundError."""
    own = os.path.join(os.path.dirname(__file__), "bin", "softfocus")
    found = os.environ.get("SOFTFOCUS_PROGRAM") or (own if os.path.exists(own) else shutil.which("softfocus"))
    if not found:
        raise FileNotFoundError("there is no program softfocus: it is in the wheel, or in build/ once built")
    return found


def _words(options: dict[str, Any]) -> list[str]:
    """f_number=2 is --f-number 2, True a flag, and a list an option of several words."""
    words = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        words.append("--" + name.rstrip("_").replace("_", "-"))
        if value is not True:
            values = value if isinstance(value, (list, tuple)) else [value]
            words += [str(one) for one in values]
    return words


def _run(words: list[str], fails_from: int = 1) -> str:
    run = subprocess.run([program(), *words], capture_output=True, text=True, check=False)
    if run.returncode >= fails_from:
        lines = [line for line in run.stderr.splitlines() if ": warning: " not in line]
        raise ValueError("\n".join(lines).removeprefix("softfocus: ") or f"status {run.returncode}")
    return run.stdout


def render(scene: str | os.PathLike[str], **options: Any) -> NDArray[numpy.float16]:
    """`softfocus render`: (h, w, 4), linear light and the depth in metres.

    `scene` is a name such as "figures", "random:7", or a file: .toml, .gltf, .glb, .obj. Options are
    those of the command line: render("figures", size="640x480", method="accumulation", samples=64).
    Raises ValueError.
    """
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        file = os.path.join(folder, "picture.npy")
        _run(["render", os.fspath(scene), "--output", file, "--quiet", *_words(options)])
        return numpy.load(file)


def compare(
    a: NDArray[Any] | str | os.PathLike[str], b: NDArray[Any] | str | os.PathLike[str], **options: Any
) -> dict[str, Any]:
    """`softfocus compare --json`: how far `a` is from `b`, which it should be. Arrays or files.

    The result has "equal", "flip_mean", "psnr_db", "ssim", ... and "passes": whether the tolerance
    among the options, such as max_flip=.01 or max_pixels="1%", is kept; without one, whether all bits
    are equal. Raises ValueError.
    """
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        files = []
        for name, picture in (("a", a), ("b", b)):
            if isinstance(picture, numpy.ndarray):
                files.append(os.path.join(folder, name + ".npy"))
                wide = picture.dtype == numpy.float64
                numpy.save(files[-1], picture.astype(numpy.float32) if wide else picture)
            else:
                files.append(os.fspath(picture))
        words = ["compare", *files, "--json", *_words(options)]
        run = subprocess.run([program(), *words], capture_output=True, text=True, check=False)
        if run.returncode > 1:
            raise ValueError(run.stderr.strip().removeprefix("softfocus: "))
        return {**json.loads(run.stdout), "passes": run.returncode == 0}
