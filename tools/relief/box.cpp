// softfocus relief box: an object as six faces, seen from somewhere.

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include "raster/images/texel.h"
#include "scenes/relief/impostors/relief_box.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {
namespace {

constexpr std::array<glm::vec3, kBoxFaces> kFaceColours{{{0.8f, 0.1f, 0.1f},
                                                         {0.5f, 0.1f, 0.4f},
                                                         {0.1f, 0.7f, 0.1f},
                                                         {0.5f, 0.5f, 0.1f},
                                                         {0.1f, 0.2f, 0.9f},
                                                         {0.1f, 0.6f, 0.7f}}};

struct BoxPictures {
  Image drawn, shown;
  std::vector<std::uint8_t> faces;  ///< of each pixel of `shown`
  std::vector<FacePoint> unseen;    ///< of `drawn`
  float far_m;
};

/// Paints the composed view: pixels by their face, or those that no seen face has in orange, that
/// none has in red.
Image painted(const BoxPictures& pictures, ReliefPart part) {
  Image picture = pictures.shown;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(x);
      const glm::vec4 shown = load_texel<Format::rgba16f>(picture, x, y);
      glm::vec3 colour{shown};
      if (part == ReliefPart::faces && shown.w < pictures.far_m) {
        const float light = (shown.x + shown.y + shown.z) / 3.0f;
        colour = kFaceColours[pictures.faces[at]] * (0.3f + 0.7f * light);
      }
      if (part == ReliefPart::unseen) {
        const glm::vec4 drawn = load_texel<Format::rgba16f>(pictures.drawn, x, y);
        const float grey = drawn.w < pictures.far_m ? 0.2f + 0.5f * drawn.y : 0.0f;
        colour = pictures.unseen[at] == FacePoint::by_none     ? glm::vec3{1.0f, 0.05f, 0.05f}
                 : pictures.unseen[at] == FacePoint::by_unseen ? glm::vec3{1.0f, 0.45f, 0.05f}
                                                               : glm::vec3{grey};
      }
      store_texel<Format::rgba16f>(picture, x, y, {colour, shown.w}, Profile{});
    }
  }
  return picture;
}

void print_box(const ReliefBox& box, const BoxPictures& pictures, glm::dvec3 eye, std::FILE* to) {
  const unsigned seen_faces = faces_seen(box, eye);
  for (std::size_t i = 0; i < kBoxFaces; ++i) {
    if (!box.faces[i]) continue;
    std::fprintf(to, "face %s: %dx%d texels, %lld of them filled%s\n",
                 std::string{kBoxFaceNames[i]}.c_str(), box.faces[i]->texture.width,
                 box.faces[i]->texture.height, static_cast<long long>(box.faces[i]->extent.filled),
                 (seen_faces >> i & 1u) != 0 ? "; seen" : "");
  }
  std::size_t seen = 0, lost = 0, gained = 0, unseen = 0, unhad = 0;
  for (std::size_t at = 0; at < pictures.unseen.size(); ++at) {
    const auto width = static_cast<std::size_t>(pictures.drawn.width);
    const int x = static_cast<int>(at % width), y = static_cast<int>(at / width);
    const bool is = load_texel<Format::rgba16f>(pictures.drawn, x, y).w < pictures.far_m;
    const bool looks = load_texel<Format::rgba16f>(pictures.shown, x, y).w < pictures.far_m;
    seen += is ? 1 : 0;
    lost += is && !looks ? 1 : 0;
    gained += !is && looks ? 1 : 0;
    unseen += pictures.unseen[at] != FacePoint::by_seen ? 1 : 0;
    unhad += pictures.unseen[at] == FacePoint::by_none ? 1 : 0;
  }
  std::fprintf(
      to,
      "%.2f MB; of %zu pixels %zu lost, %zu gained; %zu show what no seen face has, %zu what no "
      "face has\n",
      static_cast<double>(bytes_of(box)) / 1e6, seen, lost, gained, unseen, unhad);
}

/// Six files, numbered from 0 in the faces' order.
void write_faces(const ReliefBox& box, const std::string& of, const NumberedName& name) {
  for (const std::optional<BoxFace>& face : box.faces) {
    if (face) check_relief_size(face->texture, of);
  }
  for (std::size_t i = 0; i < kBoxFaces; ++i) {
    if (!box.faces[i]) continue;
    write_relief_output(name_at(name, static_cast<int>(i)), encode_relief(box.faces[i]->texture));
  }
}

}  // namespace

int show_box(const ReliefOptions& options) {
  const std::optional<NumberedName> name = numbered_name("-o", options.output);
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  const ReliefBox box = draw_relief_box(
      maker,
      {std::max(options.texels.width, options.texels.height), options.depth_bits, options.normals},
      pool);
  if (name) {
    write_faces(box, scene.name, *name);
    return kDone;
  }
  const Camera camera = camera_about(maker, scene, options);
  const auto [width, height] = options.size;
  const CameraMatrices matrices = camera_matrices(camera, 0.0, width, height);
  if (faces_seen(box, matrices.eye) == 0) {
    throw UsageError("--distance: the eye is in the object's box; a larger one would be right");
  }
  const glm::vec4 clear{0.0f, 0.0f, 0.0f, 65504.0f};
  BoxPictures pictures{make_image(Format::rgba16f, width, height), {}, {}, {}, clear.w};
  pictures.faces.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  prepared.depth = make_image(Format::r32f, width, height);
  prepared.pass.targets.colour[0] = &pictures.drawn;
  prepared.pass.targets.depth = &prepared.depth;
  record_scene(prepared, matrices, options.frame, prepared.pass);
  prepared.pass.clear_colour = clear;
  finish(prepared.pass, pool);
  pictures.shown = make_image(Format::rgba16f, width, height);
  clear_image(pictures.shown, clear, Profile{});
  BoxMemory memory;
  draw_box(box, matrices, box_rule(options), memory, pictures.shown, pool, &pictures.faces);
  pictures.unseen = unseen_pixels(box, matrices, pictures.drawn, clear.w, pool);
  print_box(box, pictures, matrices.eye, options.output == "-" ? stderr : stdout);
  write_relief_output(options.output, encode(painted(pictures, options.part), options.format));
  return kDone;
}

}  // namespace softfocus
