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
    """f_number=2 is --f-number 2, True a flag, size=(640, 480) 640x480, and another list an option of
    several words."""
    words = []
    for name, value in options.items():
        if name in ("output", "json", "help", "quiet"):
            raise ValueError(f"{name} is not for this call; `python -m softfocus` has it")
        if value is None or (isinstance(value, (bool, numpy.bool_)) and not value):
            continue
        words.append("--" + name.rstrip("_").replace("_", "-"))
        if name == "size" and isinstance(value, (list, tuple)):
            value = "x".join(str(one) for one in value)
        if not isinstance(value, (bool, numpy.bool_)):
            words += [str(one) for one in (value if isinstance(value, (list, tuple)) else [value])]
    return words


def run(words: list[str], *, passes: tuple[int, ...] = (0,)) -> subprocess.CompletedProcess[str]:
    """The program with these words. Raises ValueError, with its sentence, if it ends with another status."""
    done = subprocess.run([program(), *words], capture_output=True, text=True, check=False)
    if done.returncode not in passes:
        lines = [line for line in done.stderr.splitlines() if ": warning: " not in line]
        said = "\n".join(lines).removeprefix("softfocus: ")
        raise ValueError(said or f"softfocus ended with status {done.returncode}")
    return done


def render(scene: str | os.PathLike[str], **options: Any) -> NDArray[numpy.float16]:
    """`softfocus render`: (h, w, 4), linear light and the depth in metres.

    `scene` is a name such as "figures", "random:7", or a file: .toml, .gltf, .glb, .obj. Options are
    those of the command line: render("figures", size="640x480", method="accumulation", samples=64).
    Raises ValueError.
    """
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        file = os.path.join(folder, "picture.npy")
        run(["render", os.fspath(scene), "--output", file, "--quiet", *_words(options)])
        return numpy.load(file)


def compare(
    a: NDArray[Any] | str | os.PathLike[str], b: NDArray[Any] | str | os.PathLike[str], **options: Any
) -> dict[str, Any]:
    """`softfocus compare --json`: how far `a` is from `b`, which it should be. Arrays or files.

    The result has "equal", "flip", "psnr_db", "ssim", ... and "passes": whether the tolerance
    among the options, such as max_flip=.01 or max_pixels="1%", is kept; without one, whether all bits
    are equal. Raises ValueError.
    """
    with tempfile.TemporaryDirectory(prefix="softfocus-") as folder:
        files = []
        for name, picture in (("a", a), ("b", b)):
            if isinstance(picture, numpy.ndarray):
                files.append(os.path.join(folder, name + ".npy"))
                native = picture.dtype.newbyteorder("=")
                kind = numpy.float32 if native == numpy.float64 else native
                numpy.save(files[-1], picture.astype(kind, copy=False), allow_pickle=False)
            else:
                files.append(os.fspath(picture))
        done = run(["compare", *files, "--json", *_words(options)], passes=(0, 1))
        return {**json.loads(done.stdout), "passes": done.returncode == 0}
