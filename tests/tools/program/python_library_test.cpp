// The package for Python (tools/python) against the program: the same bits from the same arrays.

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "raster/shaders/glsl/glsl.h"
#include "tests/support/run_program.h"
#include "tests/support/skip.h"

using namespace softfocus;

#ifdef SOFTFOCUS_LIBRARY
namespace {

// A Python that has NumPy, or nothing. Debian's first: another may stand before it without.
std::string python_with_numpy() {
  for (const char* name : {"/usr/bin/python3", "python3"}) {
    if (std::system((std::string{name} + " -c 'import numpy' 2>/dev/null").c_str()) == 0)
      return name;
  }
  return {};
}

/// What the package of tools/python needs to be found, with the library and the program of this
/// build.
std::string package_python(const std::string& python) {
  return "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" SOFTFOCUS_TEST_DATA
         "/../../tools/python SOFTFOCUS_LIBRARY=" SOFTFOCUS_LIBRARY
         " SOFTFOCUS_PROGRAM=" SOFTFOCUS_PROGRAM " " +
         python;
}

/// Runs a script with these words; what it wrote if it failed.
std::string failure_of(const std::string& python, const std::string& script,
                       const std::vector<std::string>& words, const std::string& module = "") {
  const TemporaryDirectory folder;
  write_file(folder.file("script.py"), script);
  std::string command = package_python(python) + module + " " + folder.file("script.py");
  for (const std::string& word : words) command.append(" ").append(word);
  command += " >" + folder.file("said") + " 2>&1";
  if (std::system(command.c_str()) == 0) return {};
  return "failed: " + read_file(folder.file("said"));
}

const std::string kHead = R"py(import sys, numpy as np, softfocus
r = np.random.default_rng(1)
def error(call, *words, **options):
    try: call(*words, **options)
    except ValueError as said: return str(said)
    raise AssertionError("no error")
)py";

}  // namespace
#endif

TEST_CASE("softfocus.refocus() gives what the program writes, to the bit") {
#ifdef SOFTFOCUS_LIBRARY
  const std::string python = python_with_numpy();
  if (python.empty()) return skip("numpy", "no python3 with NumPy");
  const TemporaryDirectory folder;
  const std::string colour = folder.file("colour.npy"), depth = folder.file("depth.npy"),
                    theirs = folder.file("theirs.npy");
  struct Pair {
    std::string arrays;  // colour c, depth d
    std::vector<std::string> options;
    std::string settings;
  };
  for (const Pair& pair :
       {Pair{
            "c = r.random((48, 64, 3)).astype('f4'); d = (1 + 5 * r.random((48, 64))).astype('f4')",
            {"--focus", "2.5", "--f-number", "1.4", "--fov", "30"},
            "focus_m=2.5, f_number=1.4, fov_y_degrees=30"},
        Pair{"c = r.integers(0, 256, (40, 30, 3), dtype='u1'); "
             "d = (1 + 5 * r.random((40, 30))).astype('f2')",
             {"--focus", "2", "--sensor", "full-frame", "--method", "two-pass", "--profile",
              "llvmpipe", "--coc-scale", "9"},
             "focus_m=2, coc_scale=9, method='two-pass', profile='llvmpipe'"},
        Pair{"c = r.random((48, 64, 4)).astype('f2')[:, ::-1]; "
             "d = np.asfortranarray((1 + 5 * r.random((48, 64))).astype('f4'))",
             {"--focus", "3", "--blur-at-infinity", "7", "--method", "auto"},
             "focus_m=3, blur_at_infinity_px=7, method='auto'"}}) {
    CAPTURE(pair.arrays);
    const std::string arrays = kHead + pair.arrays + "\n";
    CHECK(failure_of(python, arrays + "np.save(sys.argv[1], c[..., :3]); np.save(sys.argv[2], d)",
                     {colour, depth}) == "");
    std::vector<std::string> words{"refocus",          colour,  depth, "-o", theirs,
                                   "--depth-encoding", "metres"};
    words.insert(words.end(), pair.options.begin(), pair.options.end());
    const ProgramRun run = run_program(words);
    CHECK(tells_depth_alone(run.err));
    REQUIRE(run.status == 0);
    CHECK(failure_of(python,
                     arrays + "ours = softfocus.refocus(c, d, dtype='f2', " + pair.settings +
                         ")\nassert (ours == np.load(sys.argv[1])[..., :3]).all()\n"
                         "out = np.zeros(c.shape[:2] + (3,), c.dtype)\n"
                         "assert softfocus.refocus(c, d, out=out, " +
                         pair.settings + ") is out and out.mean() > 0",
                     {theirs}) == "");
  }
  CHECK(failure_of(python, kHead + R"py(
c = np.ones((8, 9, 3)); d = np.ones((8, 9), 'f4')
assert softfocus.refocus(c, d, threads=1).dtype == np.float32
assert "disc-layers" in error(softfocus.refocus, c, d, method="disc-layer")
assert "colour is (8, 9)" in error(softfocus.refocus, d, d)
assert "depth is int64" in error(softfocus.refocus, c, d.astype("i8"))
assert "the result is int16" in error(softfocus.refocus, c, d, dtype="i2")
assert "f_number" in error(softfocus.refocus, c, d, f_number=-1)
read_only = np.ones((8, 9, 3), "f4")
read_only.flags.writeable = False
assert "cannot be written" in error(softfocus.refocus, c, d, out=read_only)
assert "cannot be written" in error(softfocus.refocus, c, d, out=np.lib.stride_tricks.as_strided(
    np.ones(3, "f4"), (8, 9, 3), (0, 0, 4)))
assert "the result is list" in error(softfocus.refocus, c, d, out=[1])
assert "one of the two" in error(softfocus.refocus, c, d, out=np.ones((8, 9, 3), "f4"), dtype="f4")
assert "threads is -1" in error(softfocus.refocus, c, d, threads=-1)
assert "zero" in error(softfocus.refocus, c, d, method="two-pass\0x")
assert (softfocus.refocus(c.astype(">f4"), d.astype(">f4")) == softfocus.refocus(c, d)).all()
assert len(softfocus.methods()) > 20 and all(softfocus.methods().values())
assert "llvmpipe" in softfocus.profiles()
)py",
                   {}) == "");
#else
  skip("", "a build without the shared library");
#endif
}

TEST_CASE("softfocus.Shader runs a shader on arrays, and tells its errors by file and line") {
#ifdef SOFTFOCUS_LIBRARY
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string python = python_with_numpy();
  if (python.empty()) return skip("numpy", "no python3 with NumPy");
  CHECK(failure_of(python, kHead + R"py(
text = """#version 330
uniform sampler2D p;
uniform vec2 gain;
out vec4 c;
void main() { c = texelFetch(p, ivec2(gl_FragCoord.xy), 0) * gain.y; }
"""
shader = softfocus.Shader(text, "mine.frag")
assert sorted(shader.uniforms()) == ["gain", "p"]
picture = r.random((5, 7, 4)).astype("f4")
shader.set("gain", [0, 0.5])
shader.set_texture("p", picture)
assert (shader.run(7, 5) == picture * np.float32(0.5)).all()
assert "gain" in error(shader.set, "gain", 1)
assert "(h, w, 4) would do" in error(shader.set_texture, "p", picture[..., :3])
assert "nearest, bilinear" in error(shader.set_texture, "p", picture, filter="linear")
edge = softfocus.Shader(text.replace("texelFetch(p, ivec2(gl_FragCoord.xy), 0)",
                   "texture(p, vec2(1.2))"))
edge.set("gain", [0, 1])
edge.set_texture("p", picture, filter="nearest", wrap="clamp")
assert (edge.run(1, 1)[0, 0] == picture[-1, -1]).all()
import copy, os
try: copy.copy(shader)
except TypeError as said: assert "cannot be copied" in str(said)
else: raise AssertionError("copied")
child = os.fork()
if child == 0:
    try: shader.run(1, 1)
    except RuntimeError: os._exit(0)
    os._exit(1)
assert os.waitpid(child, 0)[1] == 0
assert error(softfocus.Shader, "void main() {\n  wrong;\n}", "mine.frag").startswith("mine.frag:2: ")
)py",
                   {}) == "");
#else
  skip("", "a build without the shared library");
#endif
}

TEST_CASE("softfocus.render() and compare() are the program's, and so is python -m softfocus") {
#ifdef SOFTFOCUS_LIBRARY
  const std::string python = python_with_numpy();
  if (python.empty()) return skip("numpy", "no python3 with NumPy");
  const TemporaryDirectory folder;
  const std::string theirs = folder.file("theirs.npy");
  REQUIRE(run_program({"render", "figures", "--size", "48x36", "-o", theirs, "--method",
                       "accumulation", "--samples", "8"})
              .status == 0);
  CHECK(failure_of(python, kHead + R"py(
picture = softfocus.render("figures", size="48x36", method="accumulation", samples=8)
assert (picture == np.load(sys.argv[1])).all() and picture.shape == (36, 48, 4)
same = softfocus.compare(picture, sys.argv[1])
assert same["passes"] and same["equal"]
other = softfocus.compare(softfocus.render("figures", size="48x36"), picture, max_flip=0.5)
assert other["passes"] and not other["equal"] and 0 < other["flip"] < 0.5
assert (softfocus.render("figures", size=(48, 36), method="accumulation", samples=8) == picture).all()
assert not softfocus.compare(picture * 2, picture)["passes"]
assert "not for this call" in error(softfocus.render, "figures", output="x.npy")
assert "did you mean 'figures'?" in error(softfocus.render, "figurs")
assert "one size" in error(softfocus.compare, picture, picture[1:])
)py",
                   {theirs}) == "");
  const std::string command =
      package_python(python) + " -m softfocus --version | grep -q softfocus";
  CHECK(std::system(command.c_str()) == 0);
#else
  skip("", "a build without the shared library");
#endif
}

TEST_CASE("pytest's fixture holds pictures against goldens, and takes new ones when asked") {
#ifdef SOFTFOCUS_LIBRARY
  const std::string python = python_with_numpy();
  if (python.empty()) return skip("numpy", "no python3 with NumPy");
  if (std::system((python + " -c 'import pytest' 2>/dev/null").c_str()) != 0) {
    return skip("pytest", "no pytest");
  }
  const TemporaryDirectory folder;
  const auto write_test = [&](const std::string& added) {
    write_file(folder.file("test_it.py"),
               "import numpy as np, pytest\n"
               "p = np.linspace(0, 1, 12 * 16 * 3, dtype='f4').reshape(12, 16, 3)\n"
               "def test_plain(softfocus_compare): softfocus_compare(p + np.float32(" +
                   added +
                   "))\n"
                   "@pytest.mark.softfocus(max_error=.1)\n"
                   "@pytest.mark.parametrize('k', [0, 1])\n"
                   "def test_marked(softfocus_compare, k): softfocus_compare(p * k + np.float32(" +
                   added +
                   "))\n"
                   "def test_two(softfocus_compare):\n"
                   "    softfocus_compare(p, 'one')\n"
                   "    softfocus_compare(p + np.float32(" +
                   added + "), 'other', max_error=1)\n");
  };
  const auto run = [&](const std::string& words) {
    const std::string command = "cd " + folder.path() + " && " + package_python(python) +
                                " -m pytest -q -p softfocus.pytest_plugin -p no:cacheprovider " +
                                words + " >" + folder.file("said") + " 2>&1";
    const bool passes = std::system(command.c_str()) == 0;
    return (passes ? "passes: " : "fails: ") + read_file(folder.file("said"));
  };
  write_test("0");
  const std::string first = run("");
  CHECK(first.starts_with("fails: "));
  CHECK(first.find("there is none yet") != std::string::npos);
  CHECK(first.find("4 failed") != std::string::npos);
  CHECK(run("--softfocus-accept").starts_with("passes: "));
  CHECK(run("").starts_with("passes: "));
  const std::string goldens = folder.path() + "/goldens/test_it/";
  CHECK(std::filesystem::exists(goldens + "test_marked-1.npy"));
  CHECK(!std::filesystem::exists(goldens + "test_plain.got.npy"));
  write_test("0.05");
  const std::string changed = run("");
  CHECK(changed.find("1 failed, 3 passed") != std::string::npos);
  CHECK(changed.find("576 of 576 values differ, at most by 0.05") != std::string::npos);
  CHECK(std::filesystem::exists(goldens + "test_plain.got.npy"));
  CHECK(std::filesystem::exists(goldens + "test_plain.diff.png"));
  CHECK(run("--softfocus-accept").starts_with("passes: "));
  CHECK(!std::filesystem::exists(goldens + "test_plain.got.npy"));
  CHECK(!std::filesystem::exists(goldens + "test_plain.diff.png"));
  CHECK(run("").starts_with("passes: "));

  // No two names are one file, whatever they are made of.
  write_file(folder.file("test_names.py"), R"py(import numpy as np, pytest
p = np.ones((4, 4, 3), "f4")
class TestA:
    def test_same(self, softfocus_compare): softfocus_compare(p)
class TestB:
    def test_same(self, softfocus_compare): softfocus_compare(p * 2)
@pytest.mark.parametrize("k", ["1", "-1", "+1", "a b", "a+b", "..", ".", "", "/"])
def test_words(softfocus_compare, k): softfocus_compare(p * (3 + len(k) + sum(map(ord, k))))
def test_nan(softfocus_compare): softfocus_compare(p * np.nan)
)py");
  CHECK(run("test_names.py --softfocus-accept").find("12 passed") != std::string::npos);
  CHECK(run("test_names.py").find("12 passed") != std::string::npos);
  write_file(folder.file("test_wrong.py"), R"py(import numpy as np, pytest
p = np.ones((4, 4, 3), "f4")
def test_option(softfocus_compare): softfocus_compare(p, max_flipp=1)
def test_type(softfocus_compare): softfocus_compare(p > 0)
@pytest.mark.softfocus(0.5)
def test_marker(softfocus_compare): softfocus_compare(p)
def test_twice(softfocus_compare):
    softfocus_compare(p)
    softfocus_compare(p)
)py");
  const std::string wrong = run("test_wrong.py --softfocus-accept");
  CHECK(wrong.find("4 failed") != std::string::npos);
  CHECK(wrong.find("--max-flip'?") != std::string::npos);
  CHECK(wrong.find("takes options by name") != std::string::npos);
  CHECK(wrong.find("need a name each") != std::string::npos);
  CHECK(!std::filesystem::exists(folder.path() + "/goldens/test_wrong/test_option.npy"));
  CHECK(!std::filesystem::exists(folder.path() + "/goldens/test_wrong/test_type.npy"));
#else
  skip("", "a build without the shared library");
#endif
}
