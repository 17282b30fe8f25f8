#pragma once
// Which object each pixel of a picture shows.
//
// Two neighbours p and q, to the right or below, show one surface if the radius of their circles
// steps by no more than t pixels, or steps as it does before p or behind q:
//
//   |r_q - r_p| <= t,  or  |(r_q - r_p) - (r_p - r_p')| <= t,  or  |(r_q - r_p) - (r_q' - r_q)| <=
//   t
//
// p' and q' are the next pixels on the same line. The radius of a plane is linear in the picture
// (1 / depth is), so a plane is one surface at any slope. t is 3/4: a step of so much shows less
// than a pixel of what it hides. The number is a measure of defocus, as the layers are, not of
// metres: a gap of a metre is nothing far away.
//
//   without numbers  an object is a connected set of such neighbours, after the adjacent pixel
//                    difference of Barsky, Tobias, Chu and Horn 2005
//   with numbers     an object is a number. Neighbours of different numbers show two surfaces;
//                    of one number, t is 2: the number vouches for steeper ones

#include <cstdint>
#include <vector>

#include "dof/dof.h"
#include "dof/picture_planes.h"

namespace softfocus {

/// Bits of PictureObjects::links.
inline constexpr std::uint8_t kLinkedRight = 1, kLinkedDown = 2;

/// Arrays of pixels, row by row from the top.
struct PictureObjects {
  int width, height;
  /// Whether the neighbours to the right and below show the same surface.
  std::vector<std::uint8_t> links;
  /// The object: its number, or its first pixel's place if the picture came without numbers.
  std::vector<std::uint32_t> numbers;
  /// Of an object: the largest radius that it has, the farthest, in pixels.
  std::vector<float> farthest_px;

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// `radii` is a plane of `planes`; `given` are numbers as in DofInput, or empty.
PictureObjects find_objects(const Planes& planes, int radii, std::span<const std::uint16_t> given,
                            ThreadPool& pool);

}  // namespace softfocus
