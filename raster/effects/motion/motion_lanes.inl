// velocity.h for kLanes pixels at once.

struct ClipLanes {
  Floats x, y, w;
};

struct MotionLanes {
  Floats x, y;
};

SOFTFOCUS_INLINE Floats cut_motion_lanes(Floats px) {
  const Floats above = select(px > -kMostMotionPx, px, splat(-kMostMotionPx));
  return select(px < kMostMotionPx, above, splat(kMostMotionPx));
}

SOFTFOCUS_INLINE MotionLanes motion_px_lanes(const ClipLanes& to, const ClipLanes& from,
                                             const glm::vec2& half_size_px, Floats least_w) {
  const Floats to_w = select(to.w > least_w, to.w, least_w);
  const Floats from_w = select(from.w > least_w, from.w, least_w);
  return {cut_motion_lanes((to.x / to_w - from.x / from_w) * half_size_px.x),
          cut_motion_lanes((to.y / to_w - from.y / from_w) * half_size_px.y)};
}
