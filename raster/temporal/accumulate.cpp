#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "raster/temporal/accumulate.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "raster/images/image.h"
#include "raster/temporal/split_texels.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// Beyond any colour of halves: what is not below is not finite.
inline constexpr float kMostLight = 0x1p18f;
inline constexpr int kBoxPixels = 9;

/// A row of the result. Planes begin with pixel -1.
struct AccumulateRow {
  const float* apart[3][3];  ///< Y, Co and Cg of the rows above, of and below the row
  const float* now[3];
  const float* old[4];
  AccumulateSettings settings;
  int width;
  float* result[3];  ///< planes, up to whole vectors
  float* frames;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/temporal/accumulate.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Rows that a thread takes at a time; it splits one above and one below once more.
constexpr int kAccumulateRows = 32;

/// Planes of a row in the ring: red, green, blue and depth, then Y, Co and Cg.
constexpr int kAccumulatePlanes = 7;

[[maybe_unused]] bool fit_each_other(const ConstImageView& now, const ConstImageView& old,
                                     const ImageView& result, const ImageView& frames) {
  const auto fits = [&](const ConstImageView& image, Format format) {
    return image.format == format && image.width == now.width && image.height == now.height;
  };
  return fits(now, Format::rgba16f) && fits(old, Format::rgba16f) &&
         fits(result, Format::rgba16f) && fits(frames, Format::r32f);
}

/// A thread's memory: the frame's rows in a ring, a row of the old, and rows of the result.
struct AccumulateScratch {
  std::vector<float> rows, old, result;
};

struct AccumulateWork {
  const AccumulateSettings& settings;
  const ConstImageView& now;
  const ConstImageView& old;
  const ImageView& result;
  const ImageView& frames;
  const Profile& profile;
  Isa isa;
};

void accumulate_band(const AccumulateWork& work, int first, int end, AccumulateScratch& scratch) {
  const int width = work.now.width, height = work.now.height;
  const std::ptrdiff_t plane = plane_floats(width);
  scratch.rows.resize(static_cast<std::size_t>(3 * kAccumulatePlanes * plane));
  scratch.old.resize(static_cast<std::size_t>(4 * plane));
  scratch.result.resize(static_cast<std::size_t>(4 * plane));
  const auto place = [&](int y) {
    return scratch.rows.data() + (y + 3) % 3 * kAccumulatePlanes * plane;
  };
  const auto split = [&](int y) {
    split_texels(work.now, std::clamp(y, 0, height - 1), 4, place(y), work.isa);
    SOFTFOCUS_KERNEL(work.isa, take_apart)(place(y), plane, width + 2, place(y) + 4 * plane);
  };
  AccumulateRow row_work{};
  row_work.settings = work.settings;
  row_work.width = width;
  for (int c = 0; c < 3; ++c) row_work.result[c] = scratch.result.data() + c * plane;
  row_work.frames = scratch.result.data() + 3 * plane;
  for (int c = 0; c < 4; ++c) row_work.old[c] = scratch.old.data() + c * plane;
  split(first - 1);
  split(first);
  for (int y = first; y < end; ++y) {
    split(y + 1);
    split_texels(work.old, y, 4, scratch.old.data(), work.isa);
    for (int c = 0; c < 3; ++c) {
      row_work.now[c] = place(y) + c * plane;
      for (int j = 0; j < 3; ++j) row_work.apart[c][j] = place(y - 1 + j) + (4 + c) * plane;
    }
    SOFTFOCUS_KERNEL(work.isa, accumulate_row)(row_work);
    const float* const planes[] = {row_work.result[0], row_work.result[1], row_work.result[2],
                                   place(y) + 3 * plane + 1};
    join_texels(planes, width, work.profile.half_store, row<std::uint16_t>(work.result, y).data(),
                work.isa);
    std::copy_n(row_work.frames, width, row<float>(work.frames, y).data());
  }
}

}  // namespace

void accumulate(const AccumulateSettings& settings, const ConstImageView& now,
                const ConstImageView& old, const ImageView& result, const ImageView& frames,
                const Profile& profile, ThreadPool& pool) {
  assert(fit_each_other(now, old, result, frames));
  const AccumulateWork work{settings, now, old, result, frames, profile, pool.isa()};
  for_each_band_with<AccumulateScratch>(
      pool, now.height, kAccumulateRows,
      [&](int first, int end, auto& scratch) { accumulate_band(work, first, end, scratch); });
}

}  // namespace softfocus

#else  // the kernels

namespace {

struct ApartLanes {
  Floats v[3];
};

SOFTFOCUS_INLINE ApartLanes apart_lanes(Floats r, Floats g, Floats b) {
  const Floats sides = (r + b) * 0.25f, middle = g * 0.5f;
  return {{sides + middle, (r - b) * 0.5f, middle - sides}};
}

}  // namespace

/// `count` pixels, up to whole vectors.
void take_apart(const float* colours, std::ptrdiff_t plane, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    const ApartLanes apart =
        apart_lanes(load(colours + x), load(colours + plane + x), load(colours + 2 * plane + x));
    for (int c = 0; c < 3; ++c) store(to + c * plane + x, apart.v[c]);
  }
}

namespace {

template <HistoryBox box>
SOFTFOCUS_INLINE void accumulate_by(const AccumulateRow& row) {
  for (int x = 0; x < row.width; x += kLanes) {
    const Floats found[] = {load(row.old[0] + x + 1), load(row.old[1] + x + 1),
                            load(row.old[2] + x + 1)};
    const Floats n = load(row.old[3] + x + 1);
    const Floats light = absolute(found[0]) + absolute(found[1]) + absolute(found[2]);
    const Mask known = (n > 0.0f) & (light < kMostLight);
    Floats kept[] = {found[0], found[1], found[2]};
    if constexpr (box != HistoryBox::none) {
      ApartLanes inside = apart_lanes(found[0], found[1], found[2]);
      Mask is_cut = splat(0);
      for (int c = 0; c < 3; ++c) {
        Floats least = load(row.apart[c][0] + x), most = least;
        Floats sum = splat(0.0f), squares = sum;
        for (int j = 0; j < 3; ++j) {
          for (int i = 0; i < 3; ++i) {
            const Floats other = load(row.apart[c][j] + x + i);
            if constexpr (box == HistoryBox::extent) {
              least = select(other < least, other, least);
              most = select(other > most, other, most);
            } else {
              sum += other;
              squares += other * other;
            }
          }
        }
        if constexpr (box == HistoryBox::variance) {
          const Floats mean = sum / float{kBoxPixels};
          const Floats variance = squares / float{kBoxPixels} - mean * mean;
          const Floats reach =
              row.settings.deviations * square_root(select(variance > 0.0f, variance, splat(0.0f)));
          least = mean - reach;
          most = mean + reach;
        }
        const Floats own = inside.v[c];
        inside.v[c] = select(own < least, least, select(own > most, most, own));
        is_cut |= inside.v[c] != own;
      }
      const Floats rest = inside.v[0] - inside.v[2];
      kept[0] = select(is_cut, rest + inside.v[1], found[0]);
      kept[1] = select(is_cut, inside.v[0] + inside.v[2], found[1]);
      kept[2] = select(is_cut, rest - inside.v[1], found[2]);
    }
    const Floats more = n + 1.0f;
    const Floats mean_share = 1.0f / more;
    const Floats least_share = splat(row.settings.least_share);
    const Floats share = select(mean_share > least_share, mean_share, least_share);
    for (int c = 0; c < 3; ++c) {
      const Floats fresh = load(row.now[c] + x + 1);
      store(row.result[c] + x, select(known, kept[c] + share * (fresh - kept[c]), fresh));
    }
    const Floats most_frames = splat(kLongestHistory);
    store(row.frames + x,
          select(known, select(more < most_frames, more, most_frames), splat(1.0f)));
  }
}

}  // namespace

void accumulate_row(const AccumulateRow& row) {
  switch (row.settings.box) {
    case HistoryBox::none: return accumulate_by<HistoryBox::none>(row);
    case HistoryBox::extent: return accumulate_by<HistoryBox::extent>(row);
    case HistoryBox::variance: return accumulate_by<HistoryBox::variance>(row);
  }
}

#endif
