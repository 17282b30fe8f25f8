#include "tools/gl/shadows_on_gl.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/texel.h"
#include "scenes/shadows/volumes/face_bands.h"

namespace softfocus {
namespace {

std::vector<glm::uvec4> texels_of_faces(const SeenFaces& of, bool negated) {
  std::vector<glm::uvec4> texels;
  texels.reserve(5 * of.faces.size());
  for (const VolumeFace& face : of.faces) {
    const auto [a, b, c] = corners_of(face, of);
    std::uint32_t is_finite = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (face.corners[i] < of.first_far) is_finite |= 1u << i;
    }
    const std::int32_t times = negated ? -face.times : face.times;
    texels.push_back(texel_of_doubles(a.x, a.y));
    texels.push_back(texel_of_doubles(a.z, b.x));
    texels.push_back(texel_of_doubles(b.y, b.z));
    texels.push_back(texel_of_doubles(c.x, c.y));
    texels.emplace_back(words_of(c.z), is_finite, static_cast<std::uint32_t>(times));
  }
  return texels;
}

std::vector<glm::uvec4> texels_of_samples(std::span<const glm::dvec3> samples) {
  std::vector<glm::uvec4> texels;
  texels.reserve(2 * samples.size());
  for (const glm::dvec3& sample : samples) {
    texels.push_back(texel_of_doubles(sample.x, sample.y));
    texels.push_back(texel_of_doubles(sample.z, 0.0));
  }
  return texels;
}

void add_rectangle(const Cells& columns, int y_begin, int y_end, const ShadowView& view,
                   float number, std::vector<ListedVertex>& vertices) {
  if (columns.begin >= columns.end || y_begin >= y_end) return;
  const auto corner = [&](int x, int y) {
    const glm::dvec2 place{2.0 * x / view.width - 1.0, 2.0 * y / view.height - 1.0};
    return ListedVertex{glm::vec2{place}, number};
  };
  const ListedVertex a = corner(columns.begin, y_begin), b = corner(columns.end, y_begin);
  const ListedVertex c = corner(columns.end, y_end), d = corner(columns.begin, y_end);
  vertices.insert(vertices.end(), {a, b, c, a, c, d});
}

// In strips of a few rows: side faces are long and thin.
std::vector<ListedVertex> rectangles_of(const SeenFaces& faces, VolumeCount count,
                                        const PixelSpace& space, const ShadowView& view) {
  const int strips_down = (view.height + kSampleBlockSize - 1) / kSampleBlockSize;
  std::vector<ListedVertex> vertices;
  for (std::size_t i = 0; i < faces.faces.size(); ++i) {
    const Outline outline = outline_of(faces.faces[i], faces, count, space, view);
    const Extremes rows = rows_of(outline);
    const Cells of_rows = cells_within(rows.low - kReach, rows.high + kReach, 1, view.height);
    const Cells strips =
        cells_within(rows.low - kReach, rows.high + kReach, kSampleBlockSize, strips_down);
    for (int strip = strips.begin; strip < strips.end; ++strip) {
      const int y = strip * kSampleBlockSize;
      const Extremes columns = columns_of(outline, y - kReach, y + kSampleBlockSize + kReach);
      add_rectangle(cells_within(columns.low - kReach, columns.high + kReach, 1, view.width),
                    std::max(y, of_rows.begin), std::min(y + kSampleBlockSize, of_rows.end), view,
                    static_cast<float>(i), vertices);
    }
  }
  return vertices;
}

}  // namespace

GlVolumes make_gl_volumes(const GlContext& context, const Shaders& shaders,
                          const ShadowVolumes& volumes, const VolumeCounts& of,
                          const ShadowView& view, glm::dvec3 eye, VolumeCount count) {
  require_doubles(context, "a shadow volume");
  const PixelSpace space = pixel_space(view, eye);
  // Corners at infinity: one for each finite one, or one in all.
  const std::size_t finite = volumes.light.w == 0.0 ? of.corners.size() - 1 : of.corners.size() / 2;
  const SeenFaces faces{
      {volumes.faces.data(), of.faces}, of.corners, static_cast<std::uint32_t>(finite)};
  const bool by_pass = count == VolumeCount::z_pass;
  // z-fail counts what leaves a volume, z-pass what enters one.
  const bool negated = (space.facing > 0.0) != by_pass;
  return {link_program(context, shaders, "listed.vert", "volume.frag",
                       by_pass ? "#define Z_PASS\n" : ""),
          upload_list(texels_of_faces(faces, negated)),
          upload_words(texels_of_samples(of.samples), 2 * view.width, view.height),
          upload_listed(rectangles_of(faces, count, space, view)),
          make_target(std::array{Format::r32f}, view.width, view.height, false)};
}

void draw(const GlVolumes& volumes) {
  bind(volumes.target);
  constexpr std::array kNone{0.0f, 0.0f, 0.0f, 0.0f};
  glClearBufferfv(GL_COLOR, 0, kNone.data());
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glUseProgram(volumes.program);
  set_texture(volumes.program, "faces", 0, volumes.faces);
  set_texture(volumes.program, "samples", 1, volumes.samples);
  draw_listed(volumes.rectangles);
  glDisable(GL_BLEND);
}

namespace {

struct ShadowVertex {
  glm::vec2 position;
  float receiver;
};

std::vector<ShadowVertex> vertices_of(const MaskDraws& draws, std::uint8_t bit) {
  std::vector<ShadowVertex> vertices;
  for (const MaskDraws::Part& part : draws.parts) {
    for (const MaskTriangle& triangle : part.triangles) {
      if (triangle.bit != bit) continue;
      for (const glm::vec2& corner : triangle.corners) {
        vertices.push_back({corner, static_cast<float>(triangle.receiver)});
      }
    }
  }
  return vertices;
}

GlBuffer upload(const std::vector<ShadowVertex>& vertices) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  GlBuffer buffer{name};
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(ShadowVertex)),
               vertices.data(), GL_STATIC_DRAW);
  return buffer;
}

}  // namespace

GlShadows make_gl_shadows(const GlContext& context, const Shaders& shaders, const MaskDraws& draws,
                          int lights, int width, int height) {
  GlShadows made{
      width, height, link_program(context, shaders, "shadow.vert", "shadow.frag"), {}, {}};
  Image receivers = make_image(Format::r32f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto to = row<float>(receivers, y);
    for (std::size_t x = 0; x < to.size(); ++x) {
      const std::uint32_t receiver =
          draws.receivers[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x];
      to[x] = receiver == kShowsNone ? -1.0f : static_cast<float>(receiver);
    }
  }
  made.receivers = upload(receivers);
  for (int i = 0; i < lights; ++i) {
    const auto vertices = vertices_of(draws, static_cast<std::uint8_t>(1u << i));
    made.lights.push_back({upload(vertices), static_cast<GLsizei>(vertices.size()),
                           make_target(std::array{Format::r32f}, width, height, false)});
  }
  return made;
}

void draw(const GlShadows& shadows) {
  for (const GlShadows::OfLight& light : shadows.lights) {
    bind(light.target);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glUseProgram(shadows.program);
    set_texture(shadows.program, "receivers", 0, shadows.receivers);
    glBindBuffer(GL_ARRAY_BUFFER, light.vertices);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(ShadowVertex), nullptr);
    glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, sizeof(ShadowVertex),
                          // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset
                          reinterpret_cast<const void*>(sizeof(glm::vec2)));
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glDrawArrays(GL_TRIANGLES, 0, light.count);
    glDisableVertexAttribArray(0);
    glDisableVertexAttribArray(1);
  }
}

std::vector<std::uint8_t> read_mask(const GlShadows& shadows, std::span<const std::uint8_t> dark) {
  std::vector<std::uint8_t> mask{dark.begin(), dark.end()};
  for (std::size_t i = 0; i < shadows.lights.size(); ++i) {
    const Image drawn = read_colour(shadows.lights[i].target, 0);
    const auto bit = static_cast<std::uint8_t>(1u << i);
    for (int y = 0; y < shadows.height; ++y) {
      const auto from = row<float>(drawn, y);
      std::uint8_t* to =
          mask.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(shadows.width);
      for (std::size_t x = 0; x < from.size(); ++x) {
        if (from[x] != 0.0f) to[x] = static_cast<std::uint8_t>(to[x] | bit);
      }
    }
  }
  return mask;
}

}  // namespace softfocus
