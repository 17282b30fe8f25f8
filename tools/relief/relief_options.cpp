// The options of softfocus relief, whatever its action reads of them.

#include "tools/relief/relief_options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <type_traits>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/half.h"
#include "raster/numbers/parameter_text.h"
#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/height_relief.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "tools/cli/errors.h"
#include "tools/files/findings.h"
#include "tools/options/parameter_options.h"
#include "tools/options/scene_options.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {
namespace {

constexpr std::array kReliefParts{Choice<ReliefPart>{"image", ReliefPart::image},
                                  Choice<ReliefPart>{"depth", ReliefPart::depth},
                                  Choice<ReliefPart>{"normals", ReliefPart::normals},
                                  Choice<ReliefPart>{"faces", ReliefPart::faces},
                                  Choice<ReliefPart>{"unseen", ReliefPart::unseen}};

constexpr std::array kTurnSchedules{Choice<TurnSchedule>{"serial", TurnSchedule::serial},
                                    Choice<TurnSchedule>{"split", TurnSchedule::split},
                                    Choice<TurnSchedule>{"slices", TurnSchedule::slices},
                                    Choice<TurnSchedule>{"own-thread", TurnSchedule::own_thread}};

}  // namespace

void add_relief_options(CLI::App& parser, const std::shared_ptr<ReliefOptions>& options) {
  // The help ends in the range and, if it is within, the struct's own value.
  const auto number = [&](const char* name, const char* type, const char* text, double least,
                          double most, auto& value) {
    constexpr bool kIsWhole = std::is_integral_v<std::remove_reference_t<decltype(value)>>;
    const auto preset = static_cast<double>(value);
    const Parameter of{name, text, least, most, preset, "", type, "", kIsWhole ? 1 : 0};
    add_parameter(parser, of, is_allowed(of, preset) ? plain_number(preset) : "", value);
  };
  const auto choice = [&](const char* name, const char* type, const std::string& help,
                          const auto& table, auto named, auto value) {
    add_value(parser, name, type, help, [=, &table](const std::string& text) {
      for (const auto& entry : table) {
        if (entry.name != text) continue;
        (*options).*value = entry.*named;
        return;
      }
      refuse_name(name, text, names_in(table));
    });
    offer(parser, name, [&table] { return names_in(table); });
  };
  begin_group(parser, "Relief");
  add_value(parser, "--texels", "WxH", "Texels of the relief, 4 to 4096 a side (default: 256x256)",
            [options](const std::string& text) {
              options->texels = parse_size("--texels", text);
              for (const int side : {options->texels.width, options->texels.height}) {
                if (side < 4 || side > kMostReliefSize) {
                  throw UsageError("--texels '" + text + "': each side has 4 to 4096 texels");
                }
              }
            });
  add_choice(parser, "--depth-bits", "Bits of a depth (default: 8)", {"8", "16"},
             [options](std::size_t place) { options->depth_bits = place == 0 ? 8 : 16; });
  choice("--projection", "NAME",
         "Of the relief's camera: " + names_of(kReliefProjections) + " (default: orthographic)",
         kReliefProjections, &NamedProjection::projection, &ReliefOptions::projection);
  add_flag(parser, "--normals", "Keep normals, too", options->normals);
  add_flag(parser, "--unlit", "Keep unlit colours, normals and materials, so that warp has --light",
           options->unlit);
  add_flag(parser, "--traced",
           "By a ray a texel, where Embree is built in; says how it differs from a drawn one",
           options->traced);
  begin_group(parser, "Height field");
  add_flag(parser, "--height-field", "make: INPUT is a grey picture of heights, of any kind",
           options->height_field);
  add_text(parser, "--colour", "FILE", "Its colours, a picture of its size (default: lit white)",
           options->colour);
  number("height", "M",
         "Metres of a height of 1, or of the largest whole number, if the longer side of the field "
         "has one",
         1e-6, 1e6, options->height_m);
  add_value(parser, "--empty", "VALUE",
            "Texels of this height are empty, as those are that are transparent or no number",
            [options](const std::string& text) {
              options->empty_height = static_cast<float>(
                  parse_number("--empty", text, -3e38, 3e38, "a number as the file has it"));
            });
  begin_group(parser, "View");
  number("yaw", "DEGREES", "The eye goes to the right about the middle", -180.0, 180.0,
         options->yaw_degrees);
  number("pitch", "DEGREES", "And up", -89.0, 89.0, options->pitch_degrees);
  number("distance", "D", "From the middle, in diagonals of the relief's box", 0.6, 1e4,
         options->distance);
  add_value(parser, "--light", "X,Y,Z",
            "An unlit relief is lit from there, in white (default: as it was made)",
            [options](const std::string& text) { options->light = parse_towards(text); });
  add_scene_path(parser, options->scene_path);
  add_size(parser, options->size);
  add_frame(parser, options->frame);
  begin_group(parser, "Output");
  add_text(
      parser, "-o,--output", "FILE",
      "The relief of make; the picture of show, warp and box; of box, with %d in the name, six "
      "reliefs; of turn, with %d, every measured frame beside the redrawn one",
      options->output);
  add_format_option(parser, options->format);
  choice("--show", "PART",
         "What of a relief is shown: image, depth or normals; of a box: image, faces or unseen",
         kReliefParts, &Choice<ReliefPart>::value, &ReliefOptions::part);
  begin_group(parser, "Warp");
  choice("--resampling", "NAME",
         "How texels are moved: " + names_of(kResamplings) + " (default: intertwined)",
         kResamplings, &NamedResampling::resampling, &ReliefOptions::resampling);
  add_flag(parser, "--fixed", "Places in integers of 1/256 texel", options->fixed);
  number("join", "TEXELS",
         "Neighbours that come farther apart are not joined, a hole stays; by default all are", 2.0,
         WarpRule::kJoinAll, options->join_texels);
  number("slices", "N", "box, turn --box: a pixel's ray is followed through N slices; no warp", 1,
         kMostSlices, options->slices);
  number("bisections", "N", "And on between the last two slices, by N halvings", 0, kMostBisections,
         options->bisections);
  begin_group(parser, "Turn");
  number("turns", "N", "Full turns", 1, 100, options->turns);
  number("cache", "MB", "Of stale reliefs that are kept, in millions of bytes", 0.0, 1e5,
         options->cache_mb);
  number("frames", "N", "Frames of a full turn", 4, 10000, options->frames);
  number("every", "N", "Errors are measured every N frames", 1, 10000, options->every);
  number("tolerance", "TEXELS", "The critical point's error that renews a relief", 1.0, 1e4,
         options->tolerance);
  number("regions", "N", "By the mean of N x N critical points; of 1, the largest step", 1,
         kMostRegions, options->regions);
  number("texels-per-pixel", "K", "Of a relief when it is drawn", 0.1, 4.0,
         options->texels_per_pixel);
  number("zoom", "Z", "The object so many times as large in the picture", 0.01, 10.0,
         options->zoom);
  add_flag(parser, "--box", "Six faces, drawn once, in place of an impostor", options->box);
  add_flag(parser, "--moving-light",
           "The scene's lights turn against the eye; reliefs are unlit, and lit each frame",
           options->moving_light);
  add_flag(parser, "--light-pixels",
           "With --moving-light: pixels are lit after the warp, in place of texels before it",
           options->lights_pixels);
  number("approach", "F",
         "In place of a turn the eye comes straight nearer, from F times the distance", 1.0, 100.0,
         options->approach);
  number("levels", "N",
         "Reliefs have N resolutions, each half the one before; the first has --texels-per-pixel",
         1, kMostReliefLevels, options->levels);
  add_flag(parser, "--no-sprites", "Warp every frame, whatever Schaufler's test says",
           options->no_sprites);
  begin_group(parser, "Schedule of a turn");
  choice("--schedule", "NAME",
         "Who works when: " + names_of(kTurnSchedules) +
             " (default: split, in the frame by all threads)",
         kTurnSchedules, &Choice<TurnSchedule>::value, &ReliefOptions::schedule);
  add_choice(
      parser, "--aside",
      "What slices or the own thread do: draw reliefs, or warp them, too (default: renewals)",
      {"renewals", "warps"}, [options](std::size_t place) { options->warps_aside = place == 1; });
  number("update-frames", "N",
         "What begins in a frame is shown N frames later; without, when it is done", 1,
         kMostUpdateFrames, options->update_frames);
  number("slice-ms", "X",
         "Of slices without --update-frames: pieces are done until a frame took so long", 0.01, 1e4,
         options->slice_ms);
  add_flag(parser, "--predict", "Work for the eye that will be, if it goes on as it goes",
           options->predicts);
  begin_group(parser, "Rival");
  add_value(parser, "--rival", "octahedral",
            "Turn an octahedral impostor atlas instead of an impostor",
            [options](const std::string& text) {
              if (text != "octahedral") refuse_name("--rival", text, {"octahedral"});
              options->rival = true;
            });
  number("views", "N", "Of the atlas, N x N", 2, kMostOctahedralViews, options->views);
  add_flag(parser, "--hemisphere", "All views of the atlas are from above", options->hemisphere);
  number("parallax", "N", "Steps from the texel that a ray meets to its depth", 0,
         kMostParallaxSteps, options->parallax);
  begin_group(parser, "Run");
  number("runs", "N", "bench times each N times", 1, 1000, options->runs);
  add_json_option(parser, options->json);
  add_pool_options(parser, options->pool, "the pictures are the same");
}

// Cameras of softfocus relief.

namespace {

/// Below this sine of an angle, a direction is along another.
constexpr double kLeastSine = 1e-6;

double length(glm::dvec3 v) { return std::sqrt(dot(v, v)); }

bool is_along(glm::dvec3 unit, glm::dvec3 v) {
  return length(cross(unit, v)) < kLeastSine * length(v);
}

/// To the right by yaw, then up by pitch: where the eye goes.
glm::dvec3 turned_view(glm::dvec3 towards_eye, glm::dvec3 right, glm::dvec3 up,
                       const ReliefOptions& options) {
  const glm::dvec3 lifted = turned_about(towards_eye, right, -options.pitch_degrees);
  return turned_about(lifted, up, options.yaw_degrees);
}

}  // namespace

glm::dvec3 turned_about(glm::dvec3 v, glm::dvec3 axis, double degrees) {
  const double cosine = exact_math::cos_degrees(degrees), sine = exact_math::sin_degrees(degrees);
  return v * cosine + cross(axis, v) * sine + axis * (dot(axis, v) * (1.0 - cosine));
}

glm::dvec3 turned_arm(const ReliefMaker& maker, const Scene& scene, const ReliefOptions& options) {
  const CameraMatrices camera = camera_matrices(scene.camera, options.frame, 1, 1);
  const glm::dvec3 back = camera.eye - maker.middle, up = normalize(scene.camera.up);
  if (length(back) < kLeastSine * maker.radius_m) {
    throw UsageError("'" + scene.name +
                     "': its eye is in the object's middle; another place of its camera would be "
                     "right");
  }
  // Straight above or below the middle it looks elsewhere, so its own right is one.
  const glm::dvec3 right = is_along(up, back)
                               ? glm::dvec3{camera.world_to_eye[0][0], camera.world_to_eye[1][0],
                                            camera.world_to_eye[2][0]}
                               : normalize(cross(up, back));
  const glm::dvec3 arm = turned_view(back, right, up, options);
  if (is_along(up, arm)) {
    throw UsageError("--pitch: the eye is straight above or below the middle of '" + scene.name +
                     "', where no side is up; a few degrees more or less would be right");
  }
  return arm;
}

glm::dvec3 relief_middle(const ReliefTexture& relief) {
  return relief_point(relief, 0.5 * (relief.width - 1), 0.5 * (relief.height - 1),
                      0.5 * last_depth(relief.depth_bits));
}

double relief_diagonal(const ReliefTexture& relief) {
  const glm::dvec3 across =
      relief_point(relief, relief.width - 1, relief.height - 1, last_depth(relief.depth_bits)) -
      relief_point(relief, 0, 0, 0);
  return std::sqrt(dot(across, across));
}

Camera camera_before(const ReliefTexture& relief, const ReliefOptions& options) {
  const glm::dvec3 right = normalize(relief.camera.a), up = normalize(relief.camera.b) * -1.0;
  const double diagonal = relief_diagonal(relief);
  Camera camera;
  camera.target = relief_middle(relief);
  camera.position = camera.target + turned_view(relief.camera.f * -1.0, right, up, options) *
                                        (options.distance * diagonal);
  camera.up = up;
  // The box fills the picture a diagonal and a half away.
  camera.near_m = 1e-3 * diagonal;
  camera.far_m = (options.distance + 2.0) * diagonal;
  return camera;
}

Camera camera_about(const ReliefMaker& maker, const Scene& scene, const ReliefOptions& options) {
  const double diagonal = 2.0 * maker.radius_m;
  Camera camera;
  camera.target = maker.middle;
  camera.position =
      maker.middle + normalize(turned_arm(maker, scene, options)) * (options.distance * diagonal);
  camera.up = scene.camera.up;
  camera.near_m = 1e-3 * diagonal;
  camera.far_m = (options.distance + 2.0) * diagonal;
  return camera;
}

// softfocus relief make --height-field: heights out of a picture's file.

namespace {

[[noreturn]] void refuse_field(const std::filesystem::path& file, const std::string& why) {
  throw FileError("'" + file.string() + "': " + why);
}

/// The planes of heights and, behind them, of alpha. A grey picture may stand in three colours.
struct HeightPlanes {
  std::vector<std::size_t> planes;
  bool has_alpha;
};

HeightPlanes height_planes(const PictureFile& file) {
  const std::vector<ColourLayer> layers = colour_layers(file);
  if (layers.empty()) return {{0}, false};
  const ColourLayer& layer = layers[0];
  HeightPlanes found{{layer.red}, layer.alpha.has_value()};
  if (layer.green != layer.red) found.planes.insert(found.planes.end(), {layer.green, layer.blue});
  if (layer.alpha) found.planes.push_back(*layer.alpha);
  return found;
}

std::vector<std::uint32_t> read_field_colours(const std::filesystem::path& path, int width,
                                              int height) {
  const PictureFile file = open_picture_file(path);
  const std::vector<ColourLayer> layers = colour_layers(file);
  if (layers.empty()) refuse_field(path, "has no colour; it has " + plane_names(file));
  if (file.width != width || file.height != height) {
    refuse_field(path, "has " + size_text({file.width, file.height}) +
                           " pixels; the heights have " + size_text({width, height}));
  }
  const Image picture = read_colour(file, layers[0], false).image;
  std::vector<std::uint32_t> colours;
  colours.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* texels = row<std::uint16_t>(picture, y).data();
    for (int x = 0; x < width; ++x) {
      std::uint32_t colour = 0xFF000000u;
      for (int i = 0; i < 3; ++i) {
        colour |= std::uint32_t{linear_to_srgb8(half_to_float(texels[4 * x + i]))} << (8 * i);
      }
      colours.push_back(colour);
    }
  }
  return colours;
}

}  // namespace

ReliefTexture relief_of_height_file(const ReliefOptions& options) {
  const std::filesystem::path path = options.input;
  const PictureFile file = open_picture_file(path);
  if (file.width > kMostReliefSize || file.height > kMostReliefSize) {
    refuse_field(path, "has " + size_text({file.width, file.height}) +
                           " heights; each side has 1 to " + std::to_string(kMostReliefSize));
  }
  const HeightPlanes of = height_planes(file);
  const std::vector<PlaneValues> values = read_planes(file, of.planes, NAN);
  const std::size_t heights = of.planes.size() - (of.has_alpha ? 1 : 0);
  for (std::size_t i = 1; i < heights; ++i) {
    const bool is_grey =
        std::equal(values[0].begin(), values[0].end(), values[i].begin(),
                   [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); });
    if (!is_grey) refuse_field(path, "is in colour; heights are grey");
  }
  HeightField field{file.width, file.height, values[0]};
  const int longest = std::max(file.width, file.height);
  const double full = full_scale(file.planes[of.planes[0]].type);
  const auto texels_of_one = static_cast<float>(options.height_m * longest / full);
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    const float value = field.heights[i];
    const bool is_empty = (options.empty_height && value == *options.empty_height) ||
                          (of.has_alpha && !(values.back()[i] > 0.0f));
    field.heights[i] = is_empty ? NAN : value * texels_of_one;
  }
  if (!options.colour.empty()) {
    field.colours = read_field_colours(options.colour, file.width, file.height);
  }
  std::optional<ReliefTexture> relief =
      relief_of_heights(field, {1.0 / longest, options.depth_bits, options.normals});
  if (!relief) refuse_field(path, "has no height: all of its texels are empty");
  return std::move(*relief);
}

}  // namespace softfocus
