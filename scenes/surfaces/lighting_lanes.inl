// light_point() in lanes.

namespace {

SOFTFOCUS_INLINE Floats whole_power(Floats x, int n) {
  Floats power = splat(1.0f);
  for (Floats square = x;; square *= square) {
    if ((n & 1) != 0) power *= square;
    n >>= 1;
    if (n == 0) return power;
  }
}

struct LitLanes {
  Vec3Lanes base, specular;
};

// As light_point(); without `shines`, no highlights.
SOFTFOCUS_INLINE LitLanes light_points(const Material& material, const glm::vec3& ambient_light,
                                       std::span<const Light> lights, bool shines,
                                       const Vec3Lanes& point, const Vec3Lanes& normal,
                                       const Vec3Lanes& towards_eye) {
  const float least = least_highlight(material.shininess);
  LitLanes lit{splat(ambient_light * material.ambient), splat(glm::vec3{0.0f})};
  for (const Light& light : lights) {
    const Vec3Lanes towards_light =
        light.kind == LightKind::point ? normalize(splat(light.position_or_direction) - point)
                                       : splat(::softfocus::normalize(light.position_or_direction));
    const Floats facing = dot(normal, towards_light);
    const Mask is_lit = facing > 0.0f;
    lit.base = select(is_lit, lit.base + light.colour * (material.diffuse * facing), lit.base);
    if (!shines) continue;
    const Floats highlight = dot(normal, normalize(towards_light + towards_eye));
    const Mask is_highlight = is_lit & (highlight >= least);
    // Other lanes take no time either: see least_highlight().
    const Floats power =
        whole_power(select(is_highlight, highlight, splat(1.0f)), material.shininess);
    lit.specular = select(is_highlight, lit.specular + light.colour * (material.specular * power),
                          lit.specular);
  }
  return lit;
}

}  // namespace
