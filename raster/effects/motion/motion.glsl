// A motion in the picture from clip x, y and w at two instants. Beside raster/effects/motion/velocity.h.
float cut_motion(float px) { return px < 16384.0 ? (px > -16384.0 ? px : -16384.0) : 16384.0; }

vec2 motion_px(vec3 to, vec3 from, vec2 half_size_px, float least_w) {
  float to_w = to.z > least_w ? to.z : least_w;
  float from_w = from.z > least_w ? from.z : least_w;
  precise float x = (to.x / to_w - from.x / from_w) * half_size_px.x;
  precise float y = (to.y / to_w - from.y / from_w) * half_size_px.y;
  return vec2(cut_motion(x), cut_motion(y));
}
