#pragma once
// A whole object as six relief textures, one for each face of a box along the world's axes (3.4.3
// of Clua 2004; Oliveira, Bishop and McAllister 2000). Each is an orthographic picture of all of
// the object from its side, so a point hidden from one face may be seen from another. An eye
// outside of the box sees the one, two or three faces before whose planes it lies. Each is
// pre-warped and mapped, or marched by slices (6.5), and the nearer of two at a pixel is taken.
//
// A point in a hollow may be on no face, wherever the eye is: unseen_pixels() finds such.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "scenes/relief/make_relief.h"
#include "scenes/relief/warp/march_relief.h"

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
/// A face has few texels, far apart, of a surface that is steep to it, and a warp makes combs of
/// them. A texel is steep if the cosine between its normal and the way out of the face is below
/// kSteepCosine. A view leaves it out if a seen face has its point with a normal that is not steep
/// to that face. Every normal has a cosine of .577 and more to one of the faces.
ReliefBox draw_relief_box(ReliefMaker& maker, const BoxForm& form, ThreadPool& pool);
inline constexpr double kSteepCosine = 0.5;

std::size_t bytes_of(const ReliefBox& box);

/// The faces that an eye sees: it lies before their plane, and not so near to it that texels would
/// be stretched without bounds (warped_extent()). Bit i: face i.
unsigned faces_seen(const ReliefBox& box, glm::dvec3 eye);

/// Kept from one view of a box to the next: the seen faces, without the texels that are left out.
struct BoxMemory {
  unsigned seen = 0;
  bool marches = false;
  std::array<std::optional<BoxFace>, kBoxFaces> left;
  WarpedRelief warped;
};
std::size_t bytes_of(const BoxMemory& memory);

/// How faces are seen.
struct BoxRule {
  WarpRule warp{};
  std::optional<MarchSettings> march{};  ///< in place of the warp
};

/// Lays all faces that are seen over an RGBA16F picture with depth in alpha, first the one whose
/// plane is farthest from the eye. A pixel of a later face is written if it is nearer by more than
/// kHasTexels of its texels: of a surface on two faces the first shows. `shown`, if any, gets for
/// each pixel the last face that was written there; other pixels keep their value. `memory` serves
/// one box.
void draw_box(const ReliefBox& box, const CameraMatrices& camera, const BoxRule& rule,
              BoxMemory& memory, Image& picture, ThreadPool& pool,
              std::vector<std::uint8_t>* shown = nullptr);

/// For each pixel of a drawn picture, which faces have its point: by_unseen if only faces that the
/// eye does not see; by_seen if the pixel is not nearer than `far_m`. A face has a point if one of
/// the four texels about it shows a point within kHasTexels texels, and the rounding of the depth
/// to a half.
enum class FacePoint : std::uint8_t { by_seen, by_unseen, by_none };
std::vector<FacePoint> unseen_pixels(const ReliefBox& box, const CameraMatrices& camera,
                                     const Image& drawn, float far_m, ThreadPool& pool);
inline constexpr double kHasTexels = 2.0;

/// Whether a face has a point of the world, but for `away_m`.
bool has_point(const BoxFace& face, glm::dvec3 point, double away_m);

}  // namespace softfocus
