// docs/examples/embedding/gl_renderer.cpp, which tests/embedding.cmake builds and runs: its
// texels before and after the two passes, held against the library.

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <vector>

#include "dof/dof.h"
#include "tests/support/skip.h"

using namespace softfocus;

TEST_CASE("the shaders in another renderer give the library's bits on llvmpipe") {
  const char* const file = std::getenv("SOFTFOCUS_GL_RENDERER_TEXELS");
  if (file == nullptr) return skip("", "the test of embedding programs runs it");
  constexpr int kWidth = 320, kHeight = 200;
  std::vector<std::uint16_t> sharp(4 * kWidth * kHeight), blurred(sharp.size());
  std::ifstream texels(file, std::ios::binary);
  for (auto* halves : {&sharp, &blurred}) {
    texels.read(reinterpret_cast<char*>(halves->data()),
                static_cast<std::streamsize>(2 * halves->size()));
  }
  REQUIRE(texels);
  REQUIRE(sharp != blurred);

  ThreadPool pool(2);
  const DofSettings settings{.coc = pixel_coc({85.0, 1.4, 4.0}, 30.0, kHeight, 2.0),
                             .max_coc_px = 8.0f};
  std::vector<std::uint16_t> result(sharp.size());
  apply(*find_method("two-pass"),
        {view_of(Format::rgba16f, sharp.data(), kWidth, kHeight), settings,
         find_profile("llvmpipe").value()},
        view_of(Format::rgba16f, result.data(), kWidth, kHeight), pool);
  CHECK(result == blurred);
}
