#pragma once
// What near things hide, as disc-layers (disc_layers.h) guesses it: a second picture, in which
// the pixels of something near show what lies behind its outline.
//
// r is a signed radius, negative before the focus. From a pixel P with r_P < -1 go left, right,
// up and down, as far as its circle reaches, until the next pixel S of the way lies farther than
// the one before, Q, by a step: r_S > r_Q + 1 + |r_Q| / 4. If S lies farther than P by such a
// step, it is a source. The nearest source gives P its depth. All sources of about that depth
// give their colours, weighed by 1 / distance^2.
//
// A second round takes pixels that found none, and takes those of the first for sources: so
// corners are reached. The two distances at right angles may be as long as the circle reaches.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"

namespace softfocus {

/// A block of 8x8 pixels knows what is in it.
inline constexpr int kDiscBlock = 8;

/// Likewise pixels of a row.
inline constexpr int kHiddenStrip = 16;

/// The picture behind near things. If it is empty, nothing is hidden.
struct HiddenPicture {
  /// Defined in strips where something is hidden. find_hidden_oracle() defines all of it:
  /// elsewhere it is the scene.
  ConstImageView picture;
  std::vector<std::uint8_t> rows;    ///< of a row: whether anything in it is hidden
  std::vector<std::uint8_t> blocks;  ///< of kDiscBlock: likewise
  std::vector<std::uint8_t> strips;  ///< of kHiddenStrip, row by row: likewise
  int block_columns = 0, block_rows = 0, strip_columns = 0;
  RowMemory<std::byte> memory;

  bool empty() const { return picture.width == 0; }
  const std::uint8_t* strips_of(int y) const {
    return strips.data() + std::ptrdiff_t{y} * strip_columns;
  }
  bool strip(int column, int y) const { return strips_of(y)[column] != 0; }
  void mark(int x, int y);  ///< as hidden
};
HiddenPicture find_hidden(const DofInput& input, ThreadPool& pool);

/// The oracle of find_hidden(), and its scalar form.
HiddenPicture find_hidden_oracle(const DofInput& input);

/// Nothing hidden in a picture of that size; and memory for `picture`, not initialised, in which
/// rows have room for whole vectors.
HiddenPicture nothing_hidden(int width, int height);
ImageView make_hidden_picture(HiddenPicture& hidden, int width, int height,
                              MemoryShelf* shelf = nullptr);

/// Whether anything is hidden in a rectangle of the picture or within a disc's reach of it.
bool hidden_near(const HiddenPicture& hidden, int x, int y, int width, int height);

}  // namespace softfocus
