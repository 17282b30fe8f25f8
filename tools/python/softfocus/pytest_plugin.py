"""Golden images in pytest: the fixture `softfocus_compare`.

    def test_sky(softfocus_compare):
        softfocus_compare(my_renderer.frame(0), max_flip=0.01)

The picture is held against `goldens/test_file/test_sky.npy` beside the test's file (of a class
`Class.test_sky`, of `test_sky[dusk]` `test_sky-dusk`), or a .png of that name. `pytest
--softfocus-accept` writes what is missing or differs, as .npy. Without a tolerance all bits must be
equal; `@pytest.mark.softfocus(max_flip=0.01)` gives one to a whole test, class or module. Options are
those of `softfocus compare`.
"""

from __future__ import annotations

import hashlib
import pathlib
import re
from typing import Any, Callable

import numpy
import pytest

from ._program import compare

_used = pytest.StashKey[set]()


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("softfocus")
    group.addoption(
        "--softfocus-accept", action="store_true", help="write golden pictures that are missing or differ"
    )
    parser.addini("softfocus_goldens", "folder of golden pictures (goldens beside each test)", default="")


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_used] = set()
    config.addinivalue_line(
        "markers", "softfocus(**tolerance): options of `softfocus compare` for softfocus_compare"
    )


def _file_name(request: pytest.FixtureRequest, name: str | None) -> str:
    """Of a class, a test, its parameters and a picture's own name: no two alike."""
    test = re.sub(r"\[(.*)\]$", r"-\1", request.node.name)
    words = [request.cls.__qualname__] if request.cls else []
    words += [test] + ([name] if name is not None else [])
    whole = ".".join(words)
    plain = re.sub(r"[^A-Za-z0-9._+-]", "_", whole)
    changed = plain != whole or len(plain) > 100
    return plain[:100] + ("~" + hashlib.sha256(whole.encode()).hexdigest()[:8] if changed else "")


def _golden_of(request: pytest.FixtureRequest, name: str | None) -> pathlib.Path:
    """The golden's file, or where its .npy would be."""
    chosen = request.config.getini("softfocus_goldens")
    folder = request.config.rootpath / chosen if chosen else request.path.parent / "goldens"
    plain = folder / request.path.stem / _file_name(request, name)
    there = [plain.with_name(plain.name + extension) for extension in (".npy", ".png")]
    return next((file for file in there if file.exists()), there[0])


def _tolerance(request: pytest.FixtureRequest, given: dict[str, Any]) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for marker in reversed(list(request.node.iter_markers("softfocus"))):
        if marker.args:
            pytest.fail("the marker softfocus takes options by name: softfocus(max_flip=0.01)")
        options.update(marker.kwargs)
    return {**options, **given}


def _said(found: dict[str, Any]) -> str:
    words = f"{found['differing']} of {found['values']} values differ"
    for key, before in (("max_error", ", at most by "), ("flip", "; mean FLIP ")):
        if isinstance(found.get(key), (int, float)):
            words += f"{before}{found[key]:.4g}"
    return words


@pytest.fixture
def softfocus_compare(request: pytest.FixtureRequest) -> Callable[..., None]:
    """softfocus_compare(picture, name=None, **tolerance): fails unless the picture is as its golden.

    A test with several pictures gives each a name.
    """
    accepts = request.config.getoption("--softfocus-accept")
    used = request.config.stash[_used]

    def check(picture: Any, name: str | None = None, **tolerance: Any) -> None:
        __tracebackhide__ = True
        picture = numpy.asarray(picture)
        options = _tolerance(request, tolerance)
        golden = _golden_of(request, name)
        plain = golden.with_suffix("")
        if plain in used:
            pytest.fail(f"{plain.name} was compared before: a test's pictures need a name each")
        used.add(plain)
        got = plain.with_name(plain.name + ".got.npy")
        difference = plain.with_name(plain.name + ".diff.png")
        for stale in (got, difference):
            stale.unlink(missing_ok=True)
        why = "there is none yet"
        if golden.exists():
            try:
                found = compare(picture, golden, **options)
                if found["passes"]:
                    return
                why = _said(found)
            except ValueError as error:
                why = str(error)
        compare(picture, picture, **options)  # what can be no golden, or no option, ends here
        golden.parent.mkdir(parents=True, exist_ok=True)
        if accepts:
            numpy.save(plain.with_name(plain.name + ".npy"), picture, allow_pickle=False)
            if golden.suffix == ".png":
                golden.unlink()
            return
        numpy.save(got, picture, allow_pickle=False)
        shown = ""
        if golden.exists():
            try:
                compare(picture, golden, diff=difference)
                shown = f", differences in {difference.name}"
            except ValueError:
                pass  # of another size
        pytest.fail(
            f"{golden}: {why}. The picture is in {got.name}{shown}; --softfocus-accept takes it.",
            pytrace=False,
        )

    return check
