#include "dof/methods/importance_ordered.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "dof/one_pass/one_pass.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

DofSettings settings(float radius_at_infinity, float max_coc) {
  return {.coc = {radius_at_infinity, 2.0f}, .max_coc_px = max_coc};
}

Image refined(const Image& scene, const DofSettings& settings, float budget, BlockOrder order,
              ThreadPool& pool) {
  Image result = random_scene_image(scene.width, scene.height, 99);
  refine({scene, settings, {}}, budget, order, result, pool);
  return result;
}

Image one_passed(const Image& scene, const DofSettings& settings, ThreadPool& pool) {
  Image result = make_image(Format::rgba16f, scene.width, scene.height);
  one_pass({scene, settings, {}}, result, pool);
  return result;
}

// A wall of stripes behind the focus, with a sharp board before it and a blurred bar over both.
Image stage_image(int width, int height) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool bar = y > height * 3 / 5 && y < height * 7 / 10;
      const bool board = x > width / 4 && x < width / 2 && y > height / 3;
      const float stripe = (x / 5 + y / 9) % 2 == 0 ? 1.0f : 0.1f;
      const glm::vec4 texel = bar     ? glm::vec4{0.2f, 0.9f, 0.1f, 1.0f}
                              : board ? glm::vec4{0.8f, 0.2f * stripe, 0.1f, 2.0f}
                                      : glm::vec4{stripe, 0.5f, stripe, 6.0f};
      store_texel(image, x, y, texel, {});
    }
  }
  return image;
}

double squared_error(const Image& a, const Image& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const glm::vec4 p = load_texel(a, x, y), q = load_texel(b, x, y);
      for (int c = 0; c < 3; ++c) sum += std::pow(static_cast<double>(p[c] - q[c]), 2.0);
    }
  }
  return sum;
}

bool equal_block(const Image& a, const Image& b, int left, int top) {
  for (int y = top; y < std::min(top + kBlockHeight, a.height); ++y) {
    for (int x = left; x < std::min(left + kBlockWidth, a.width); ++x) {
      if (load_texel(a, x, y) != load_texel(b, x, y)) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("importance-ordered: with all work spent it is one-pass, to the bit") {
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    const Image scene = random_scene_image(77, 53, 1);
    for (const float max_coc : {0.5f, 3.0f, 17.5f}) {
      const DofSettings lens = settings(20.0f, max_coc);
      const Image expected = one_passed(scene, lens, pool);
      for (const BlockOrder order : {BlockOrder::importance, BlockOrder::rows}) {
        CHECK(equal(refined(scene, lens, 1.0f, order, pool), expected));
      }
    }
  }
}

TEST_CASE("importance-ordered: a block is one-pass's to the bit, or rough") {
  const Image scene = stage_image(150, 117);
  const DofSettings lens = settings(12.0f, 12.0f);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    const Image exact = one_passed(scene, lens, pool);
    const Image rough = refined(scene, lens, 0.0f, BlockOrder::importance, pool);
    for (const float budget : {0.1f, 0.5f, 0.99f}) {
      const Image some = refined(scene, lens, budget, BlockOrder::importance, pool);
      int neither = 0, exact_blocks = 0, rough_blocks = 0;
      for (int y = 0; y < scene.height; y += kBlockHeight) {
        for (int x = 0; x < scene.width; x += kBlockWidth) {
          const bool is_exact = equal_block(some, exact, x, y);
          const bool is_rough = equal_block(some, rough, x, y);
          exact_blocks += is_exact;
          rough_blocks += is_rough;
          neither += !is_exact && !is_rough;
        }
      }
      CHECK(neither == 0);
      CHECK(exact_blocks > 0);
      CHECK(rough_blocks > 0);
    }
  }
}

TEST_CASE("importance-ordered: blocks by themselves are the oracle's, to the bit") {
  const Image scene = random_scene_image(83, 41, 3);
  const DofSettings lens = settings(14.0f, 9.5f);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(3, isa);
    Image expected = make_image(Format::rgba16f, 83, 41);
    one_pass_oracle({scene, lens, {}}, expected, pool);
    Image result = random_scene_image(83, 41, 98);
    const Image untouched = result;
    const std::array blocks{OnePassBlock{0, 0, 9}, OnePassBlock{5, 5, 9}, OnePassBlock{2, 3, 12}};
    one_pass_blocks({scene, lens, {}}, blocks, result, pool);
    int wrong = 0;
    for (int row = 0; row * kBlockHeight < 41; ++row) {
      for (int column = 0; column * kBlockWidth < 83; ++column) {
        const bool listed = std::any_of(
            blocks.begin(), blocks.end(),
            [&](const OnePassBlock& block) { return block.column == column && block.row == row; });
        wrong += !equal_block(result, listed ? expected : untouched, column * kBlockWidth,
                              row * kBlockHeight);
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("importance-ordered: the error falls with the budget, faster than row by row") {
  ThreadPool pool(2);
  const Image scene = stage_image(200, 160);
  const DofSettings lens = settings(12.0f, 12.0f);
  const Image exact = one_passed(scene, lens, pool);
  double before = squared_error(refined(scene, lens, 0.0f, BlockOrder::importance, pool), exact);
  CHECK(before < 0.1 * squared_error(scene, exact));
  for (const float budget : {0.05f, 0.1f, 0.2f, 0.3f, 0.5f, 0.7f}) {
    const auto error = [&](BlockOrder order) {
      return squared_error(refined(scene, lens, budget, order, pool), exact);
    };
    INFO("budget ", budget);
    const double by_importance = error(BlockOrder::importance);
    CHECK(by_importance < before);
    CHECK(by_importance < error(BlockOrder::rows));
    CHECK(by_importance < error(BlockOrder::random));
    before = by_importance;
  }
}

TEST_CASE("importance-ordered: what is exact at one budget is exact at every larger one") {
  ThreadPool pool(2);
  const Image scene = stage_image(120, 96);
  const DofSettings lens = settings(12.0f, 12.0f);
  const Image exact = one_passed(scene, lens, pool);
  Image before = refined(scene, lens, 0.0f, BlockOrder::importance, pool);
  for (const float budget : {0.1f, 0.3f, 0.6f, 0.9f}) {
    const Image now = refined(scene, lens, budget, BlockOrder::importance, pool);
    for (int y = 0; y < 96; y += kBlockHeight) {
      for (int x = 0; x < 120; x += kBlockWidth) {
        if (equal_block(before, exact, x, y)) CHECK(equal_block(now, exact, x, y));
      }
    }
    before = now;
  }
}

TEST_CASE("importance-ordered: the same bits for any number of threads" *
          doctest::test_suite("threads")) {
  const Image scene = stage_image(203, 101);
  for (const float budget : {0.0f, 0.3f}) {
    ThreadPool one(1);
    const Image expected =
        refined(scene, settings(14.0f, 12.0f), budget, BlockOrder::importance, one);
    for (const int threads : {2, 3}) {
      ThreadPool pool(threads);
      CHECK(equal(refined(scene, settings(14.0f, 12.0f), budget, BlockOrder::importance, pool),
                  expected));
    }
  }
}

TEST_CASE("importance-ordered: a budget outside 0 to 1 is refused") {
  const Image scene = stage_image(8, 8);
  Image result = make_image(Format::rgba16f, 8, 8);
  for (const float budget : {-0.1f, 1.1f, std::nanf("")}) {
    DofSettings lens = settings(1.0f, 1.0f);
    lens.budget = budget;
    CHECK(input_error({scene, lens, {}}, result) != nullptr);
  }
}
