#include "dof/two_pass/two_pass_stream.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "dof/two_pass/two_pass.h"
#include "dof/two_pass/two_pass_strip.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

DofSettings settings(float max_coc) {
  return {.coc = {15.0f, 2.0f}, .max_coc_px = max_coc, .leak = 1.0f};
}

Image filtered(const Image& scene, const DofSettings& of, ThreadPool& pool) {
  Image result = make_image(scene.format, scene.width, scene.height);
  two_pass({scene, of, {}}, result, pool);
  return result;
}

// Streams a picture. Notes how many rows had come out when each went in.
Image streamed(TwoPassStream& stream, const Image& scene, ThreadPool& pool,
               std::vector<int>* out_after = nullptr) {
  Image result = make_image(scene.format, scene.width, scene.height);
  int out = 0;
  const RowSink sink = [&](std::span<const std::uint16_t> finished) {
    REQUIRE(out < scene.height);
    std::ranges::copy(finished, row<std::uint16_t>(result, out++).begin());
  };
  for (int y = 0; y < scene.height; ++y) {
    put_row(stream, row<std::uint16_t>(scene, y), pool, sink);
    if (out_after != nullptr) out_after->push_back(out);
  }
  end_rows(stream, pool, sink);
  CHECK(out == scene.height);
  return result;
}

}  // namespace

TEST_CASE("the streamed two-pass filter gives the whole picture's bits") {
  struct Size {
    int width, height;
  };
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    for (const Size size : {Size{1, 1}, {5, 60}, {60, 5}, {131, 33}, {300, 150}}) {
      const Image scene = random_scene_image(size.width, size.height, 1);
      for (const float max_coc : {0.0f, 1.0f, 3.5f, 16.0f, 90.0f}) {
        TwoPassStream stream(size.width, settings(max_coc), {}, isa);
        INFO(std::string{isa_name(isa)}, ", ", size.width, "x", size.height, ", max_coc ", max_coc);
        CHECK(equal(streamed(stream, scene, pool), filtered(scene, settings(max_coc), pool)));
      }
    }
  }
}

TEST_CASE("a stream takes one picture after the other") {
  ThreadPool pool(1);
  TwoPassStream stream(50, settings(8.0f), {}, pool.isa());
  for (const int height : {40, 7, 90}) {
    const Image scene = random_scene_image(50, height, static_cast<unsigned>(height));
    CHECK(equal(streamed(stream, scene, pool), filtered(scene, settings(8.0f), pool)));
  }
}

TEST_CASE("a stream without rows gives no rows") {
  ThreadPool pool(1);
  for (const float max_coc : {0.0f, 8.0f}) {
    TwoPassStream stream(50, settings(max_coc), {}, pool.isa());
    int out = 0;
    end_rows(stream, pool, [&](std::span<const std::uint16_t>) { ++out; });
    CHECK(out == 0);
  }
}

TEST_CASE("a row comes out of a stream within its reach and a group of rows") {
  const float max_coc = 9.0f;  // taps reach 8 rows
  for (const Isa isa : available_isas()) {
    ThreadPool pool(1, isa);
    const Image scene = random_scene_image(20, 100, 3);
    TwoPassStream stream(20, settings(max_coc), {}, isa);
    std::vector<int> out_after;
    streamed(stream, scene, pool, &out_after);
    for (int in = 1; in <= 100; ++in) {
      const int out = out_after[static_cast<std::size_t>(in - 1)];
      CHECK(out <= std::max(in - 8, 0));
      CHECK(out >= in - 8 - (lanes_of(isa) - 1));
    }
  }
}

TEST_CASE("a stream has the memory that it says, whatever the picture's height") {
  for (const Isa isa : available_isas()) {
    ThreadPool pool(1, isa);
    TwoPassStream stream(200, settings(16.0f), {}, isa);
    const std::size_t said = two_pass_stream_bytes(200, settings(16.0f), isa);
    CHECK(stream_bytes(stream) == said);
    streamed(stream, random_scene_image(200, 500, 4), pool);
    CHECK(stream_bytes(stream) == said);
  }
}
