// A frame by rows has the bits of the whole one.

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "raster/images/image.h"
#include "scenes/frame/frame.h"
#include "scenes/frame/frame_rows.h"
#include "scenes/load/load_scene.h"
#include "scenes/scene.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/scene_texts.h"

using namespace softfocus;

namespace {

/// All rows, asked for a few at a time, and how many were drawn.
Image rows_of(const Shot& shot, ThreadPool& pool, int step, int& drawn) {
  Image whole = make_image(Format::rgba16f, shot.width, shot.height), band;
  FrameRows rows{shot, pool};
  drawn = 0;
  for (int y = 0; y < shot.height; y += band.height) {
    rows.make(std::min(step, shot.height - y), band,
              [&](const ConstImageView& of) { drawn += of.height; });
    std::memcpy(row<std::uint16_t>(whole, y).data(), band.bytes.data(), band.bytes.size());
  }
  return whole;
}

}  // namespace

TEST_CASE("a frame by rows: the bits of make_frame(), in every unit, by any number of rows") {
  for (const char* const name : {"figures", "cube-room", "sphere-world", "random:3"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    for (const char* const method : {"two-pass", "pinhole"}) {
      for (const char* const profile : {"ieee", "llvmpipe"}) {
        // Sides that are no whole tiles, and more rows than the circles.
        Shot shot = shot_of(scene, 2.0, 150, 333, find_method_choice(method));
        shot.profile = test::profile_named(profile);
        int step = 1;
        for (const Isa isa : available_isas()) {
          if (isa == Isa::scalar) continue;
          ThreadPool pool{2, isa};
          const std::string where = std::string{name} + " " + method + " " + profile;
          CAPTURE(where);
          REQUIRE(why_whole(shot, isa) == "");
          int drawn = 0;
          const Image rows = rows_of(shot, pool, step, drawn);
          CHECK(equal(rows, make_frame(shot, pool).picture));
          CHECK(drawn == shot.height);
          step = step * 7 + 30;
        }
      }
    }
  }
}

TEST_CASE("a frame by rows: smooth edges too, and none of a band before where nothing is drawn") {
  const Scene figures = load_scene("figures", scene_search_path({}));
  const Scene textured = load_scene("cube-room", scene_search_path({}));
  // In the upper half alone.
  const Scene ball = test::read(
      "background = [0.2, 0.4, 0.8]\n[camera]\nposition = [0, 0, 3]\ntarget = [0, 0, 0]\n"
      "[material.m]\ndiffuse = [1, 0.3, 0]\n[[object]]\nshape = \"sphere\"\nradius = 0.3\n"
      "position = [0, 0.8, 0]\nmaterial = \"m\"\n");
  ThreadPool pool{2, Isa::baseline};
  for (const Scene* scene : {&figures, &textured, &ball}) {
    for (const char* const method : {"two-pass", "pinhole"}) {
      for (const int height : {1, 2, 63, 65, 300}) {
        Shot shot = shot_of(*scene, 0.0, 90, height, find_method_choice(method));
        shot.samples = height == 65 ? 8 : 4;
        CAPTURE(method);
        CAPTURE(height);
        REQUIRE(why_whole(shot, Isa::baseline) == "");
        int drawn = 0;
        const Image rows = rows_of(shot, pool, 1 + height / 3, drawn);
        CHECK(equal(rows, make_frame(shot, pool).picture));
        shot.samples = 1;
        if (height > 2) CHECK_FALSE(equal(rows, make_frame(shot, pool).picture));
      }
    }
  }
}

TEST_CASE("a frame by rows: each band is told to be drawn, and then to be filtered") {
  const Scene scene = load_scene("figures", scene_search_path({}));
  ThreadPool pool{2, Isa::baseline};
  for (const bool filters : {false, true}) {
    const Shot shot =
        shot_of(scene, 0.0, 64, 200, find_method_choice(filters ? "two-pass" : "pinhole"));
    std::string told;  // the stages' first letters
    FrameRows rows{
        shot, pool, [&](FrameStage stage) {
          told += stage == FrameStage::drawing ? 'd' : stage == FrameStage::filtering ? 'f' : '.';
        }};
    Image band;
    rows.make(shot.height, band, {});  // four bands; last come the rows that waited for those below
    CHECK(told == (filters ? "d.dfdfdfdff." : "d.dddd."));
  }
}

TEST_CASE("a frame by rows: what needs the whole picture is told") {
  const Scene scene = load_scene("figures", scene_search_path({}));
  const auto why = [&](const auto& change, Isa isa = Isa::baseline) {
    Shot shot = shot_of(scene, 0.0, 64, 48, find_method_choice("two-pass"));
    change(shot);
    return why_whole(shot, isa);
  };
  CHECK(why([](Shot&) {}) == "");
  CHECK(why([](Shot&) {}, Isa::scalar) == "it is not drawn in lanes");
  CHECK(why([](Shot& shot) { shot.profile = test::profile_named("softpipe"); }) ==
        "it is not drawn in lanes");
  CHECK(why([](Shot& shot) { shot.method = find_method_choice("disc-layers"); }) ==
        "only two-pass and pinhole work by rows");
  CHECK(why([](Shot& shot) { shot.show = Show::depth; }) ==
        "only two-pass and pinhole work by rows");
  CHECK(why([](Shot& shot) { shot.supersample = 2; }) == "--supersample halves it");
  CHECK(why([](Shot& shot) { shot.lens->focus_at = {3, 3}; }) == "the focus is looked for in it");
  CHECK(why([](Shot& shot) { shot.layers = 2; }) == "layers are drawn together");
  CHECK(why([](Shot& shot) {
          shot.effects = {{find_effect("bloom"), {}}};
        }) == "effects are of the whole picture");
}
