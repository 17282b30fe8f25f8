// The example in Python against the program: the same bits from the same arrays.

#include <doctest/doctest.h>

#include <cstdlib>
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

/// Whether a command of these words, the second in quotes, ends well.
bool done(const std::string& program, const std::string& quoted,
          const std::vector<std::string>& words) {
  std::string command = program + " \"" + quoted + '"';
  for (const std::string& word : words) command.append(1, ' ').append(word);
  return std::system(command.c_str()) == 0;
}
}  // namespace
#endif

TEST_CASE("shade.py runs a shader on an array, and tells its errors by file and line") {
#ifdef SOFTFOCUS_LIBRARY
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const std::string python = python_with_numpy();
  if (python.empty()) return skip("numpy", "no python3 with NumPy");
  const TemporaryDirectory folder;
  const std::string picture = folder.file("picture.npy"), result = folder.file("result.npy"),
                    shader = folder.file("mine.frag");
  const std::string library = "SOFTFOCUS_LIBRARY=" SOFTFOCUS_LIBRARY " " + python + " -B";
  const std::string script = SOFTFOCUS_TEST_DATA "/../../docs/examples/embedding/shade.py";
  const std::string make =
      "import sys, numpy as n; n.save(sys.argv[1], n.random.default_rng(1).random((5, 7, 4), "
      "'f4'))";
  REQUIRE(done(python + " -c", make, {picture}));
  write_file(shader,
             "#version 330\nuniform sampler2D p;\nuniform vec2 gain;\nout vec4 c;\n"
             "void main() { c = texelFetch(p, ivec2(gl_FragCoord.xy), 0) * gain.y; }\n");
  REQUIRE(done(library, script, {shader, picture, result, "gain=0,0.5"}));
  CHECK(done(python + " -c",
             "import sys, numpy as n; a, b = [n.load(f) for f in sys.argv[1:]]; "
             "sys.exit(not (a * n.float32(0.5) == b).all())",
             {picture, result}));
  CHECK(!done(library, script, {shader, picture, result, "gain=1", "2>/dev/null"}));
  CHECK(done(library + " -c",
             "import sys; sys.path.insert(0, sys.argv[1]); import shade\n"
             "try: shade.Shader('void main() {\\n  wrong;\\n}', 'mine.frag')\n"
             "except ValueError as e: assert str(e).startswith('mine.frag:2: '), e\n"
             "else: sys.exit(1)",
             {SOFTFOCUS_TEST_DATA "/../../docs/examples/embedding"}));
#else
  skip("", "a build without the shared library");
#endif
}

TEST_CASE("refocus.py gives what the program writes, to the bit") {
#ifdef SOFTFOCUS_LIBRARY
  const std::string python = python_with_numpy();
  if (python.empty()) return skip("numpy", "no python3 with NumPy");
  const TemporaryDirectory folder;
  const std::string colour = folder.file("colour.npy"), depth = folder.file("depth.npy"),
                    theirs = folder.file("theirs.npy"), ours = folder.file("ours.npy");
  const std::string library = "SOFTFOCUS_LIBRARY=" SOFTFOCUS_LIBRARY " " + python;
  const std::string script = SOFTFOCUS_TEST_DATA "/../../docs/examples/embedding/refocus.py";
  const std::string python_line = python + " -c";
  const std::string save = "; import sys; np.save(sys.argv[1], c); np.save(sys.argv[2], d)";
  const std::string random = "import numpy as np; r = np.random.default_rng(1); ";
  struct Pair {
    std::string arrays;  // colour c, depth d
    std::vector<std::string> options;
    std::vector<std::string> settings;
  };
  for (const Pair& pair :
       {Pair{
            "c = r.random((48, 64, 3)).astype('f4'); d = (1 + 5 * r.random((48, 64))).astype('f4')",
            {"--focus", "2.5", "--f-number", "1.4", "--fov", "30", "--method", "two-pass"},
            {"focus_m=2.5", "f_number=1.4", "fov_y_degrees=30"}},
        Pair{"c = r.integers(0, 256, (40, 30, 3), dtype='u1'); "
             "d = (1 + 5 * r.random((40, 30))).astype('f2')",
             {"--focus", "2", "--sensor", "full-frame", "--method", "disc-layers", "--profile",
              "llvmpipe", "--coc-scale", "9"},
             {"focus_m=2", "coc_scale=9", "method=disc-layers", "profile=llvmpipe"}},
        Pair{"c = r.random((48, 64, 3)).astype('f2'); "
             "d = np.asfortranarray((1 + 5 * r.random((48, 64))).astype('f4'))",
             {"--focus", "3", "--blur-at-infinity", "7", "--method", "auto"},
             {"focus_m=3", "blur_at_infinity_px=7", "method=auto"}}}) {
    CAPTURE(pair.arrays);
    std::string make = random;
    REQUIRE(done(python_line, make.append(pair.arrays).append(save), {colour, depth}));
    std::vector<std::string> words{"refocus",          colour,  depth, "-o", theirs,
                                   "--depth-encoding", "metres"};
    words.insert(words.end(), pair.options.begin(), pair.options.end());
    const ProgramRun run = run_program(words);
    CHECK(tells_depth_alone(run.err));
    REQUIRE(run.status == 0);
    words = {colour, depth, ours};
    words.insert(words.end(), pair.settings.begin(), pair.settings.end());
    REQUIRE(done(library, script, words));
    CHECK(read_file(ours) == read_file(theirs));
  }
  CHECK(!done(library, script, {colour, depth, ours, "method=none", "2>/dev/null"}));
  CHECK(!done(library, script, {depth, depth, ours, "2>/dev/null"}));
  CHECK(!done(library, script, {colour, depth, ours, "focus=2", "2>/dev/null"}));
  const std::string call =
      "import sys; sys.path.insert(0, sys.argv[1]); import numpy as n, refocus as r; "
      "c = n.ones((8, 9, 3), 'f4'); d = n.ones((8, 9), 'f4'); ";
  const std::vector<std::string> at{SOFTFOCUS_TEST_DATA "/../../docs/examples/embedding"};
  CHECK(done(library + " -B -c", call + "r.refocus(c, d, method='disc-layers')", at));
  CHECK(done(library + " -B -c",
             call + "\ntry: r.refocus(c, d, fnumber=2)\n"
                    "except ValueError as e: assert 'f_number' in str(e)\nelse: sys.exit(1)",
             at));
#else
  skip("", "a build without the shared library");
#endif
}
