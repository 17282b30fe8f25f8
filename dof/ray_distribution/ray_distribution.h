#pragma once
// Ray distribution buffer, after Shinya 1994: each pixel keeps the nearest thing that it sees
// through each of K points of the lens, and is their mean.
//
//   plane k   of the buffer is what the lens sees from its point u_k of the unit disc. A pixel
//             p with the signed radius r goes to the cell
//               Q = p + (round(r u_x), round(r u_y))
//             and stays there if no pixel of a smaller r comes: the nearest wins
//   result    out(Q) = mean of the cells of Q, over all planes, that a pixel reaches
//
// Neighbours whose radii differ by at most half a pixel belong to one surface. Where they land two
// cells apart, the nearer of them also takes the cell between.
//
// A lens also sees what the picture does not show. Shinya leaves such cells out of the mean,
// which ends a blurred thing hard where it hides something. Here a pixel near an edge has a
// hidden one behind it, guessed from what is farther around it (behind.h). It goes to the cell
// that its own radius gives, if no visible pixel is there. Cells that nothing reaches are left
// out. The picture's border is repeated for up to 64 pixels.
//
// K is 32 up to a largest radius of 1.5 pixels, 64 up to 6, 128 up to 32, then 256. Points come
// in pairs u and -u: point i of K/2 has the radius sqrt((i + 1/2) / (K/2)) and the angle 180
// degrees times the fraction of 0.618034 i.
//
// A plane is made and added to the sums at once, for 32 rows at a time: the buffer never exists
// as a whole. Neighbours mostly go the same way, so rows move in whole vectors.
//
// Known failures: a bright pixel becomes K dots when they lie apart, from a radius of about 8
// on, and an edge becomes K steps; what is hidden is a smooth guess, so no texture shows through
// a thin near thing; a circle below half a pixel is none; a surface whose radius changes by more
// than half a pixel from pixel to pixel tears.

#include <vector>

#include "dof/dof.h"

namespace softfocus {

/// A point of the unit disc.
struct LensPoint {
  float u, v;
};
/// The points for a picture's largest radius, in the order of their planes.
std::vector<LensPoint> distribution_points(float largest_px);

/// A Method's apply (dof.h).
void ray_distribution(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
