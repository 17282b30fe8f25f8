"""Golden images in pytest: the fixture `softfocus_compare`.

    def test_sky(softfocus_compare):
        softfocus_compare(my_renderer.frame(0), max_flip=0.01)

The picture is held against `goldens/test_sky.npy` beside the test's file (of `test_sky[dusk]`
`test_sky-dusk.npy`), or a .png or .exr of that name. `pytest --softfocus-accept` writes what is
missing or differs. Without a tolerance all bits must be equal; `@pytest.mark.softfocus(max_flip=0.01)`
gives one to a whole test, class or module. Options are those of `softfocus compare`.
"""

from __future__ import annotations

import pathlib
import re
from typing import Any, Callable

import numpy
import pytest

from ._program import compare

_EXTENSIONS = (".npy", ".exr", ".png")


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("softfocus")
    group.addoption(
        "--softfocus-accept", action="store_true", help="write golden pictures that are missing or differ"
    )
    parser.addini("softfocus_goldens", "folder of golden pictures (goldens beside each test)", default="")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers", "softfocus(**tolerance): options of `softfocus compare` for softfocus_compare"
    )


def _golden_of(request: pytest.FixtureRequest, name: str | None) -> pathlib.Path:
    """The golden's file, or where its .npy would be."""
    chosen = request.config.getini("softfocus_goldens")
    folder = request.config.rootpath / chosen if chosen else request.path.parent / "goldens"
    plain = re.sub(r"[^A-Za-z0-9._]+", "-", name or request.node.name).strip("-.")
    there = [folder / (plain + extension) for extension in _EXTENSIONS]
    return next((file for file in there if file.exists()), there[0])


def _tolerance(request: pytest.FixtureRequest, given: dict[str, Any]) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for marker in reversed(list(request.node.iter_markers("softfocus"))):
        options.update(marker.kwargs)
    return {**options, **given}


@pytest.fixture
def softfocus_compare(request: pytest.FixtureRequest) -> Callable[..., None]:
    """softfocus_compare(picture, name=None, **tolerance): fails unless the picture is as its golden.

    A test with several pictures gives each a name.
    """
    accepts = request.config.getoption("--softfocus-accept")
    seen: set[pathlib.Path] = set()

    def check(picture: Any, name: str | None = None, **tolerance: Any) -> None:
        __tracebackhide__ = True
        picture = numpy.asarray(picture)
        golden = _golden_of(request, name)
        if golden in seen:
            pytest.fail(f"{golden.name} was compared before: a test's pictures need a name each")
        seen.add(golden)
        got, difference = golden.with_suffix(".got.npy"), golden.with_suffix(".diff.png")
        if golden.exists():
            options = _tolerance(request, tolerance)
            try:
                found = compare(picture, golden, **options)
            except ValueError as error:
                found, why = None, str(error)
            if found is not None and found["passes"]:
                got.unlink(missing_ok=True)
                difference.unlink(missing_ok=True)
                return
            if found is not None:
                why = (
                    f"{found['differing']} of {found['values']} values differ, by {found['max_error']:.3g}"
                    f" at most; mean FLIP {found['flip']:.4f}"
                )
        else:
            found, why = None, "there is none yet"
        golden.parent.mkdir(parents=True, exist_ok=True)
        if accepts:
            accepted = golden.with_suffix(".npy")
            numpy.save(accepted, picture)
            for stale in {golden, got, difference} - {accepted}:
                stale.unlink(missing_ok=True)
            return
        numpy.save(got, picture)
        if found is not None:
            compare(picture, golden, diff=difference)
        shown = f", differences in {difference.name}" if found is not None else ""
        pytest.fail(
            f"{golden}: {why}. The picture is in {got.name}{shown}; --softfocus-accept takes it.",
            pytrace=False,
        )

    return check
