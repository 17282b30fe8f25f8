// Stages `reprojection` and `temporal`: what a frame takes from the frame before, on both sides.

#include <array>

#include "raster/images/image.h"
#include "raster/temporal/accumulate.h"
#include "raster/temporal/forward_reproject.h"
#include "raster/temporal/frame_passes.h"
#include "raster/temporal/refresh.h"
#include "raster/temporal/reproject.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/temporal_on_gl.h"

namespace softfocus {
namespace {

/// Colours over depths in patches, some of them without.
Image patches(int width, int height, unsigned seed, bool any_bits) {
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto patch = (i / 4 / 7 + static_cast<std::size_t>(y) / 5) % 4;
      const float value = i % 4 < 3 ? random.between(0.0f, 2.0f)
                                    : static_cast<float>(patch) + random.between(0.0f, 0.1f);
      values[i] = any_bits && random.below(24) == 0
                      ? static_cast<std::uint16_t>(random.word())
                      : float_to_half(value, HalfRounding::nearest_even);
    }
  }
  return image;
}

/// Whole pixels, parts of pixels, and a few far away.
Image motions(int width, int height, unsigned seed, bool any_bits) {
  RandomNumbers random{seed};
  Image image = make_image(Format::rg16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      const int kind = random.below(8);
      const float px = kind == 0  ? random.between(-100.0f, 100.0f)
                       : kind < 4 ? static_cast<float>(random.below(5) - 2)
                                  : random.between(-3.0f, 3.0f);
      value = any_bits && random.below(24) == 0 ? static_cast<std::uint16_t>(random.word())
                                                : float_to_half(px, HalfRounding::nearest_even);
    }
  }
  return image;
}

/// Counts in alpha, none in a fourth of the pixels.
Image with_counts(Image image, unsigned seed) {
  RandomNumbers random{seed};
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 3; i < values.size(); i += 4) {
      const int count = random.below(4) == 0 ? 0 : 1 + random.below(40);
      values[i] = float_to_half(static_cast<float>(count), HalfRounding::nearest_even);
    }
  }
  return image;
}

Image counts(int width, int height, unsigned seed) {
  RandomNumbers random{seed};
  Image image = make_image(Format::r32f, width, height);
  for (int y = 0; y < height; ++y) {
    for (float& value : row<float>(image, y)) value = random.between(1.0f, 30.0f);
  }
  return image;
}

struct TemporalCase {
  int width;
  int height;
  bool any_bits = false;
};

void reverse_both(const Bench& bench, Tally& tally, const ReprojectSettings& settings,
                  const TemporalCase& what) {
  const auto [width, height, any_bits] = what;
  // Drivers take the larger of NaN and a number in two ways.
  const Image depths = patches(width, height, 81, false);
  const Image before = patches(width, height, 82, any_bits);
  const Image velocity = motions(width, height, 83, any_bits);
  const Image frames = counts(width, height, 84);
  const GlTexture gl_depths = upload(depths), gl_velocity = upload(velocity);
  const GlTexture gl_before = upload(before), gl_frames = upload(frames);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTarget& target = reverse_reproject_on_gl(
      passes, settings, {gl_depths, gl_velocity, gl_before, gl_frames, 0, width, height});
  Image emulated = make_image(Format::rgba16f, width, height);
  reverse_reproject(settings, {depths, velocity, before, frames}, emulated, bench.profile,
                    bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void forward_both(const Bench& bench, Tally& tally, const TemporalCase& what) {
  const auto [width, height, any_bits] = what;
  const Image before = patches(width, height, 85, any_bits);
  const Image velocity = motions(width, height, 86, any_bits);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTarget& scattered =
      forward_reproject_on_gl(passes, upload(before), upload(velocity), width, height);
  const GlTarget& filled = fill_holes_on_gl(passes, scattered.colour[0], width, height);
  Image emulated = make_image(Format::rgba16f, width, height), whole = emulated;
  forward_reproject(before, velocity, emulated, bench.profile, bench.pool);
  fill_holes(emulated, whole, bench.profile, bench.pool);
  add_pictures(tally, read_colour(scattered, 0), emulated, "scattered");
  add_pictures(tally, read_colour(filled, 0), whole, "filled");
}

void refresh_both(const Bench& bench, Tally& tally, int groups, int turn,
                  const TemporalCase& what) {
  const auto [width, height, any_bits] = what;
  const Image drawn = patches(width, height, 87, any_bits);
  const Image found = with_counts(patches(width, height, 88, any_bits), 89);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTarget& target =
      refresh_on_gl(passes, groups, turn, upload(drawn), upload(found), width, height);
  Image emulated = make_image(Format::rgba16f, width, height);
  Image frames = make_image(Format::r32f, width, height);
  refresh(groups, turn, drawn, found, emulated, frames, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated, "picture");
  add_pictures(tally, read_colour(target, 1), frames, "frames");
}

/// A whole frame, by each of its passes in turn.
void frame_both(const Bench& bench, Tally& tally, const FrameEffect& effect,
                const TemporalCase& what) {
  const auto [width, height, any_bits] = what;
  const Image drawn = patches(width, height, 93, false);
  const Image velocity = motions(width, height, 94, any_bits);
  const Image before = patches(width, height, 95, any_bits);
  const Image frames = counts(width, height, 96);
  const GlTexture gl_drawn = upload(drawn), gl_velocity = upload(velocity);
  const GlTexture gl_before = upload(before), gl_frames = upload(frames);
  EffectPasses passes{bench.gl, bench.shaders};
  constexpr int kTurn = 2;
  const GlTarget& target = make_frame_on_gl(
      passes, effect, {gl_drawn, gl_velocity, gl_before, gl_frames, kTurn, width, height});
  Image picture = make_image(Format::rgba16f, width, height), between = picture;
  Image counted = make_image(Format::r32f, width, height);
  make_frame(effect, {drawn, velocity, before, frames, kTurn}, {picture, counted, between},
             bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), picture, "picture");
  if (target.colour.size() > 1) add_pictures(tally, read_colour(target, 1), counted, "frames");
}

void accumulate_both(const Bench& bench, Tally& tally, const AccumulateSettings& settings,
                     const TemporalCase& what) {
  const auto [width, height, any_bits] = what;
  const Image now = patches(width, height, 90, any_bits);
  const Image old = with_counts(patches(width, height, 91, any_bits), 92);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTarget& target =
      accumulate_on_gl(passes, settings, upload(now), upload(old), width, height);
  Image emulated = make_image(Format::rgba16f, width, height);
  Image frames = make_image(Format::r32f, width, height);
  accumulate(settings, now, old, emulated, frames, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated, "picture");
  add_pictures(tally, read_colour(target, 1), frames, "frames");
}

}  // namespace

void add_temporal_cases(std::vector<Case>& cases) {
  constexpr TemporalCase kSmall{61, 43}, kAnyBits{64, 48, true}, kLarge{512, 512}, kOne{1, 1};
  const auto add = [&](const char* stage, const char* name, bool quick, bool slow_too,
                       const std::function<void(const Bench&, Tally&)>& run) {
    cases.push_back({stage, name, quick, slow_too, run});
  };
  const auto add_reverse = [&](const char* name, bool quick, bool slow_too,
                               const ReprojectSettings& settings, const TemporalCase& what) {
    add("reprojection", name, quick, slow_too,
        [=](const Bench& bench, Tally& tally) { reverse_both(bench, tally, settings, what); });
  };
  add_reverse("reverse-61x43", true, true, {}, kSmall);
  add_reverse("reverse-own-61x43", true, true, {0.3f, false}, kSmall);
  add_reverse("reverse-any-depth", false, true, {0.0f, true}, kSmall);
  add_reverse("reverse-cubic-61x43", true, true, {0.3f, true, true}, kSmall);
  add_reverse("reverse-cubic-512x512", false, false, {0.0f, true, true}, kLarge);
  add_reverse("reverse-cubic-any-bits", true, true, {0.0f, false, true}, kAnyBits);
  add_reverse("reverse-any-bits", true, true, {}, kAnyBits);
  add_reverse("reverse-512x512", false, false, {}, kLarge);
  add_reverse("reverse-one-pixel", true, true, {}, kOne);
  const auto add_forward = [&](const char* name, bool quick, bool slow_too,
                               const TemporalCase& what) {
    add("reprojection", name, quick, slow_too,
        [=](const Bench& bench, Tally& tally) { forward_both(bench, tally, what); });
  };
  add_forward("forward-61x43", true, true, kSmall);
  add_forward("forward-any-bits", true, true, kAnyBits);
  add_forward("forward-512x512", false, false, kLarge);
  add_forward("forward-one-pixel", true, true, kOne);
  const auto add_refresh = [&](const char* name, bool quick, bool slow_too, int groups, int turn,
                               const TemporalCase& what) {
    add("reprojection", name, quick, slow_too,
        [=](const Bench& bench, Tally& tally) { refresh_both(bench, tally, groups, turn, what); });
  };
  add_refresh("refresh-61x43", true, true, 4, 1, kSmall);
  add_refresh("refresh-512x512", false, false, 16, 5, kLarge);
  const auto add_average = [&](const char* name, bool quick, bool slow_too,
                               const AccumulateSettings& settings, const TemporalCase& what) {
    add("temporal", name, quick, slow_too,
        [=](const Bench& bench, Tally& tally) { accumulate_both(bench, tally, settings, what); });
  };
  add_average("no-box-61x43", true, true, {0.1f, HistoryBox::none}, kSmall);
  add_average("extent-61x43", true, true, {0.05f, HistoryBox::extent}, kSmall);
  add_average("variance-61x43", true, true, {0.1f, HistoryBox::variance, 1.25f}, kSmall);
  add_average("variance-512x512", false, false, {}, kLarge);
  add_average("extent-any-bits", true, true, {0.1f, HistoryBox::extent}, kAnyBits);
  add_average("variance-any-bits", true, true, {}, kAnyBits);
  add_average("one-pixel", true, true, {}, kOne);
  const auto add_frame = [&](const char* name, bool quick, bool slow_too, const FrameEffect& effect,
                             const TemporalCase& what) {
    add("temporal", name, quick, slow_too,
        [=](const Bench& bench, Tally& tally) { frame_both(bench, tally, effect, what); });
  };
  using enum UnseenPixels;
  add_frame("frame-average", false, true, TemporalAa{}, kSmall);
  add_frame("frame-refresh", false, true, Refresh{}, kSmall);
  add_frame("frame-reverse-drawn", false, true, Reproject{}, kSmall);
  add_frame("frame-reverse-filled", true, true, Reproject{.holes = filled}, kSmall);
  add_frame("frame-reverse-black", false, true, Reproject{.holes = black}, kSmall);
  add_frame("frame-forward-drawn", false, true, Reproject{.forward = true}, kSmall);
  add_frame("frame-forward-filled", false, true, Reproject{.forward = true, .holes = filled},
            kSmall);
  add_frame("frame-forward-black", false, true, Reproject{.forward = true, .holes = black}, kSmall);
  add_frame("frame-any-bits", true, true, Reproject{.holes = filled}, kAnyBits);
}

}  // namespace softfocus
