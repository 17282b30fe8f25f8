#pragma once
// How the faces of an OBJ model lie to one another: which are there twice, and which are turned
// against their neighbours. Places are positions by number, equal ones alike.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/models/obj_text.h"

namespace softfocus {

/// The place of each position; 0 and -0 are one.
std::vector<std::uint32_t> number_places(const ObjText& obj);

/// Faces whose places are those of a face before, in the same or the reverse order, from any corner
/// on. Linear but for sorting those that have their lowest place in common.
std::vector<std::uint32_t> doubled_faces(const ObjText& obj,
                                         std::span<const std::uint32_t> place_of);

/// Which triangles, by their corners' places, to turn so that two that share an edge with no third
/// run through it in opposite directions. Of a piece that hangs together by such edges the fewer
/// are turned; of halves, the one without the piece's first. A piece with one side only, as
/// Moebius's, keeps some edges where it does not fit. Linear but for sorting the edges of a place.
std::vector<bool> triangles_to_turn(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    ThreadPool& pool);

}  // namespace softfocus
