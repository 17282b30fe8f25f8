#pragma once
// A whole object as six relief textures, one for each face of a box along the world's axes (3.4.3
// of Clua 2004; Oliveira, Bishop and McAllister 2000). Each is an orthographic picture of all of
// the object from its side, so what is hidden from one face may be seen from another. From a point
// outside of the box one, two or three faces are seen: those that the point lies before. Each is
// pre-warped and mapped, and of two at a pixel the nearer is taken.
//
// What lies in a hollow is seen by no face, wherever the eye is: unseen_pixels() finds it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "scenes/relief/make_relief.h"
#include "scenes/relief/map_relief.h"

namespace softfocus {

inline constexpr std::size_t kBoxFaces = 6;
/// The side of the object that each face shows.
inline constexpr std::array<std::string_view, kBoxFaces> kBoxFaceNames{"+x", "-x", "+y",
                                                                       "-y", "+z", "-z"};

struct BoxFace {
  ReliefTexture texture;
  ReliefExtent extent;
  /// Of each texel that is steep to this face: the faces that have its point and to which it is not
  /// steep. Bit i: face i.
  std::vector<std::uint8_t> better;
};

struct ReliefBox {
  std::array<std::optional<BoxFace>, kBoxFaces> faces;  ///< none if nothing is seen from there
};

struct BoxForm {
  int texels = 256;    ///< of the longest side of the object's box, 4 to kMostReliefSize
  int depth_bits = 8;  ///< or 16
  bool with_normals = false;
};

/// Texels are squares of one size on all faces, but for what rounding to whole ones takes. The
/// highlights are those of eyes twice the object's radius before the faces.
///
/// A face shows what is steep to it by few texels far apart, of which a warp makes combs. So in a
/// view a texel whose normal and the way out of the face have a cosine below kSteepCosine is left
/// out, if a seen face to which it is not steep has its point, too, with such a normal. Every
/// normal has a cosine of .577 and more to one of the faces.
ReliefBox draw_relief_box(ReliefMaker& maker, const BoxForm& form, ThreadPool& pool);
inline constexpr double kSteepCosine = 0.5;

std::size_t bytes_of(const ReliefBox& box);

/// The faces that an eye sees: it lies before their plane, and not so near to it that texels would
/// be stretched without bounds (warped_extent()). Bit i: face i.
unsigned faces_seen(const ReliefBox& box, glm::dvec3 eye);

/// What is kept from one view of a box to the next: of the faces that are seen, what is left of
/// them.
struct BoxMemory {
  unsigned seen = 0;
  std::array<std::optional<BoxFace>, kBoxFaces> left;
  WarpedRelief warped;
};
std::size_t bytes_of(const BoxMemory& memory);

/// Lays all faces that are seen over an RGBA16F picture with depth in alpha, the one that the eye
/// sees from farthest away before its plane first. A pixel of a later one is written if it is
/// nearer by more than kHasTexels of its texels: of one surface on two faces the first shows.
/// `shown`, if any, gets for each pixel the last face that was written there, and keeps what else
/// it has. `memory` serves one box.
void draw_box(const ReliefBox& box, const CameraMatrices& camera, const WarpRule& rule,
              BoxMemory& memory, Image& picture, ThreadPool& pool,
              std::vector<std::uint8_t>* shown = nullptr);

/// Of each pixel of a drawn picture: which faces have its point; by_seen if it is not nearer than
/// `far_m`. A face has a point if one of the four texels about it shows a point within kHasTexels
/// texels, and what a half rounds off the depth. by_unseen: only faces that the eye does not see.
enum class FacePoint : std::uint8_t { by_seen, by_unseen, by_none };
std::vector<FacePoint> unseen_pixels(const ReliefBox& box, const CameraMatrices& camera,
                                     const Image& drawn, float far_m, ThreadPool& pool);
inline constexpr double kHasTexels = 2.0;

/// Whether a face has a point of the world, but for `away_m`.
bool has_point(const BoxFace& face, glm::dvec3 point, double away_m);

}  // namespace softfocus
