// softfocus apply: effects on a picture's file.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/effects/shader_on_picture.h"
#include "tools/files/whole_file.h"
#include "tools/options/effect_options.h"
#include "tools/options/parameter_options.h"
#include "tools/options/run_options.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/picture_notes.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/refocus/refocused.h"
#include "tools/refocus/report.h"

namespace softfocus {
namespace {

/// Contents of such a file, for help and messages.
constexpr const char* kVelocityFiles =
    "NPY of shape (height, width, 2), or EXR with a layer named Vector, velocity, motion or "
    "forward, or channels X and Y, or R and G alone";

/// How programs write a motion in pixels a frame. x goes to the right in all of them.
enum class VelocityEncoding : std::uint8_t {
  blender,  ///< X Y from the frame before, Z W to the next; x turned round, y up turned round
  nuke,     ///< u v of forward or backward, y up
  pixels,   ///< y down
};
constexpr std::array kVelocityEncodings{
    Choice<VelocityEncoding>{"blender", VelocityEncoding::blender},
    Choice<VelocityEncoding>{"nuke", VelocityEncoding::nuke},
    Choice<VelocityEncoding>{"pixels", VelocityEncoding::pixels}};

struct VelocityOptions {
  std::optional<std::string> file;
  std::optional<std::string> layer;
  std::optional<VelocityEncoding> encoding;  ///< none: as the names say
};

/// Channels of one layer, by the letter or word behind the last dot, in small letters.
struct VelocityLayer {
  std::string name;
  std::vector<std::pair<std::string, std::size_t>> channels{};

  std::optional<std::size_t> find(std::string_view channel) const {
    for (const auto& [word, plane] : channels) {
      if (word == channel) return plane;
    }
    return {};
  }
  /// The last part of its name, in small letters.
  std::string word() const { return lower_case(name.substr(name.rfind('.') + 1)); }
  bool speaks_of_motion() const {
    const std::string text = word();
    const auto has = [&](const char* part) { return text.find(part) != text.npos; };
    return !has("normal") && (has("vector") || has("veloc") || has("motion") || has("forward") ||
                              has("backward") || has("flow"));
  }
};

std::vector<VelocityLayer> velocity_layers(const PictureFile& file) {
  std::vector<VelocityLayer> layers;
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    const std::string& name = file.planes[i].name;
    const auto dot = name.rfind('.');
    const std::string layer = dot == name.npos ? "" : name.substr(0, dot);
    const auto same = [&](const VelocityLayer& other) { return other.name == layer; };
    auto place = std::find_if(layers.begin(), layers.end(), same);
    if (place == layers.end()) place = layers.insert(layers.end(), {layer});
    place->channels.emplace_back(lower_case(dot == name.npos ? name : name.substr(dot + 1)), i);
  }
  return layers;
}

/// The planes of a motion, and what makes pixels to the right and down of them.
struct VelocityPlanes {
  std::array<std::size_t, 2> planes;
  float of_x = 1.0f, of_y = 1.0f;
  VelocityEncoding encoding = VelocityEncoding::pixels;
};

/// Nothing if the layer has no two channels for it. A layer that does not speak of motion holds one
/// if it is no colour and no direction.
std::optional<VelocityPlanes> planes_of(const VelocityLayer& layer, bool is_motion,
                                        std::optional<VelocityEncoding> encoding) {
  using enum VelocityEncoding;
  const std::string word = layer.word();
  const bool has_next = layer.find("x") && layer.find("y") && layer.find("z") && layer.find("w");
  const bool has_uv = layer.find("u") && layer.find("v");
  VelocityPlanes found{};
  found.encoding = encoding.value_or(has_next && is_motion ? blender : has_uv ? nuke : pixels);
  const bool is_backward = found.encoding == nuke && word.find("backward") != word.npos;
  if (found.encoding == blender) found.of_x = -1.0f;
  if (found.encoding == nuke) (is_backward ? found.of_x : found.of_y) = -1.0f;
  struct Pair {
    const char *x, *y, *without;
  };
  for (const Pair& pair : {Pair{"z", "w", ""}, Pair{"u", "v", ""}, Pair{"x", "y", "r"},
                           Pair{"r", "g", "b"}, Pair{"red", "green", "blue"}}) {
    if (*pair.x == 'z' && (found.encoding != blender || !has_next)) continue;
    const auto x = layer.find(pair.x), y = layer.find(pair.y);
    const bool is_direction = *pair.x == 'x' && layer.find("z") && !layer.name.empty();
    if (!x || !y || (!is_motion && (is_direction || layer.find(pair.without)))) continue;
    found.planes = {*x, *y};
    return found;
  }
  return {};
}

/// The layer that was asked for, else the first that speaks of motion, a forward one before others,
/// else any that can hold one.
std::optional<VelocityPlanes> find_velocity(const PictureFile& file,
                                            const VelocityOptions& options) {
  const std::vector<VelocityLayer> layers = velocity_layers(file);
  if (options.layer) {
    const std::string wanted = lower_case(*options.layer);
    for (const VelocityLayer& layer : layers) {
      const std::string name = lower_case(layer.name);
      if (name != wanted && !name.ends_with("." + wanted)) continue;
      if (const auto planes = planes_of(layer, true, options.encoding)) return planes;
    }
    throw UsageError("--velocity-layer '" + *options.layer + "': '" + file.path.string() +
                     "' has " + plane_names(file));
  }
  for (const bool is_back : {false, true}) {
    for (const VelocityLayer& layer : layers) {
      const std::string word = layer.word();
      if (!layer.speaks_of_motion() || (word.find("back") != word.npos) != is_back) continue;
      if (const auto planes = planes_of(layer, true, options.encoding)) return planes;
    }
  }
  for (const VelocityLayer& layer : layers) {
    if (const auto planes = planes_of(layer, false, options.encoding)) return planes;
  }
  if (file.planes.size() != 2) return {};
  return VelocityPlanes{.planes = {0, 1}};
}

std::string_view name_of(VelocityEncoding encoding) {
  return kVelocityEncodings[static_cast<std::size_t>(encoding)].name;
}

/// RG16F of that size. Numbers beyond the largest half are cut to it. What is believed is told.
/// Throws FileError for a file that cannot be read, UsageError for one of another shape.
Image read_velocity(const VelocityOptions& options, const PictureFile& picture) {
  PictureFile file = open_picture_file(*options.file);
  const std::string where = "--velocity '" + *options.file + "' ";
  const std::optional<VelocityPlanes> found = find_velocity(file, options);
  if (!found || full_scale(file.planes[found->planes[0]].type) != 1.0) {
    throw UsageError(where + "holds no motions; " + kVelocityFiles +
                     ", in pixels a frame, would be right");
  }
  if (file.shown != picture.shown) {
    throw UsageError(where + "is " + size_text({file.width, file.height}) +
                     "; the picture's size, " +
                     size_text({picture.shown.width, picture.shown.height}) + ", would be right");
  }
  take_data_window(file);
  std::vector<PlaneValues> values = read_planes(file, found->planes, 0.0f);
  for (PlaneValues& plane : values) plane = moved(plane, box_of(file), box_of(picture), 0.0f);
  const int width = picture.width, height = picture.height;
  Image velocity = make_image(Format::rg16f, width, height);
  float longest = 0.0f;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x);
      const auto cut = [](float px) { return std::clamp(px, -65504.0f, 65504.0f); };
      const float right = cut(found->of_x * values[0][at]), down = cut(found->of_y * values[1][at]);
      store_texel<Format::rg16f>(velocity, x, y, {right, down, 0.0f, 1.0f}, {});
      const float length = std::hypot(right, down);
      if (length > longest && std::isfinite(length)) longest = length;
    }
  }
  tell("the velocity is " + file.planes[found->planes[0]].name + " and " +
       file.planes[found->planes[1]].name + " as " + std::string{name_of(found->encoding)} +
       (options.encoding ? "" : " (believed: by their names)") + ", up to " +
       short_number(std::round(10.0 * static_cast<double>(longest)) / 10.0) + " pixels a frame");
  return velocity;
}

struct ApplyOptions {
  std::string picture;
  std::string output;
  FileFormat format = FileFormat::png;
  std::optional<std::string> layer;
  VelocityOptions velocity;
  FileReading files;
  ShaderOptions shaders;
  EffectOptions effects;
  Profile profile{};
  std::string profile_name = "ieee";
  PoolOptions pool;
};

/// A colour with its depth and its opacity.
struct OpenedLayer {
  std::optional<PlaneValues> depth{};  ///< as its codes stand in the file
  PlaneValues opacity{};
  Image colour{};
};

/// A picture with what its file has beside the colour.
struct OpenedPicture {
  PictureSources sources;
  OpenedLayer layer{};
  std::vector<ReplacedPlane> views{};  ///< the other views, with their effects
};

OpenedLayer read_layer(const PictureSources& sources) {
  const PictureFile& file = sources.colour_file;
  OpenedLayer layer;
  Picture read = read_colour(file, sources.colour, false);
  if (read.cut > 0) warn(cut_light_warning(file.path.string(), read.cut, 0));
  layer.colour = std::move(read.image);
  layer.opacity = take_opacity(sources, layer.colour);
  if (sources.depth_plane != kNoPlane) {
    layer.depth = std::move(read_planes(file, {&sources.depth_plane, 1}, 0.0f)[0]);
    put_in_alpha(*layer.depth, layer.colour);
  }
  return layer;
}

OpenedPicture read_picture(const ApplyOptions& options) {
  OpenedPicture opened{{.colour_file = open_picture_file(options.picture)}};
  PictureSources& sources = opened.sources;
  const PictureFile& file = sources.colour_file;
  take_data_window(sources.colour_file);
  take(options.files, sources.colour_file);
  check_memory(options.picture, {file.width, file.height}, 64);
  sources.colour = choose_colour(file, options.layer, "--layer");
  sources.notes = find_notes(file.path, file.bytes).notes;
  sources.depth_plane = find_depth_beside_colour(file).value_or(kNoPlane);
  if (!options.layer) find_views(sources);
  opened.layer = read_layer(sources);
  return opened;
}

/// Opacity goes where light goes.
void apply_effects(const ApplyOptions& options, const Image& velocity, OpenedLayer& layer,
                   ThreadPool& pool) {
  const auto make_velocity = [&](const ChosenEffect&, const Image&) { return velocity; };
  std::vector<ChosenEffect> spreading;
  for (const ChosenEffect& chosen : all_effects(options.effects)) {
    if (chosen.effect->spreads) spreading.push_back(chosen);
  }
  if (is_transparent(layer.opacity)) {
    layer.opacity = opacity_of(with_effects(opacity_picture(layer.opacity, layer.colour), spreading,
                                            make_velocity, options.profile, pool));
  }
  layer.colour = with_shaders(options.shaders, std::move(layer.colour), options.profile, pool);
  layer.colour = with_effects(std::move(layer.colour), all_effects(options.effects), make_velocity,
                              options.profile, pool);
}

/// Of all views.
void apply_effects(const ApplyOptions& options, OpenedPicture& opened, ThreadPool& pool) {
  PictureSources& sources = opened.sources;
  Image velocity;
  if (options.velocity.file) velocity = read_velocity(options.velocity, sources.colour_file);
  apply_effects(options, velocity, opened.layer, pool);
  if (!is_of_exr(options.format)) return;
  for (OtherView& view : sources.views) {
    exchange(sources, view);
    OpenedLayer layer = read_layer(sources);
    apply_effects(options, velocity, layer, pool);
    add_planes({std::move(layer.colour), std::move(layer.opacity)}, sources.colour, opened.views);
    exchange(sources, view);
  }
}

PictureNotes notes_of(const ApplyOptions& options, const OpenedPicture& opened) {
  PictureNotes notes;
  if (opened.sources.notes) {
    notes = *opened.sources.notes;
  } else {
    notes.scene = opened.sources.colour_file.path.filename().string();
    notes.show = "image";
  }
  const Image& colour = opened.layer.colour;
  notes.width = colour.width;
  notes.height = colour.height;
  notes.picture_hash = hash_image(colour);
  for (const std::string& file : options.shaders.files) {
    notes.effects.push_back("shader " + std::filesystem::path{file}.filename().string());
  }
  if (options.shaders.pipeline) {
    notes.effects.push_back("pipeline " +
                            std::filesystem::path{*options.shaders.pipeline}.filename().string());
  }
  for (const ChosenEffect& chosen : all_effects(options.effects)) {
    notes.effects.push_back(effect_text(chosen));
  }
  return notes;
}

bool keeps_windows(const ApplyOptions& options, const OpenedPicture& opened) {
  return is_of_exr(options.format) && opened.sources.colour_file.reader == &kExrReader;
}

Bytes picture_file(const ApplyOptions& options, const OpenedPicture& opened,
                   const PictureNotes& notes) {
  const OpenedLayer& layer = opened.layer;
  PictureExtras extras{.alpha = layer.opacity,
                       .has_depth = layer.depth.has_value(),
                       .icc = kept_profile(opened.sources.colour_file)};
  std::vector<std::size_t> kept;
  if (layer.depth) extras.depth_m = *layer.depth;
  if (keeps_windows(options, opened)) {
    kept = other_planes(opened.sources);
    extras.source = &opened.sources.colour_file;
    extras.kept = kept;
    extras.replaced = opened.views;
    extras.view = opened.sources.view;
  }
  return encode_with_notes(layer.colour, options.format, notes, extras);
}

int apply_to_file(const ApplyOptions& options) {
  const bool to_standard_output = options.output == "-";
  const std::optional<std::filesystem::path> sidecar =
      sidecar_place(options.output, options.format);
  if (!to_standard_output) {
    check_writable(options.output);
    check_not_read("-o", options.output, {{options.picture, "the picture"}});
    if (sidecar) check_not_read("the sidecar of -o", *sidecar, {{options.picture, "the picture"}});
    if (options.velocity.file) {
      check_not_read("-o", options.output, {{*options.velocity.file, "the velocity"}});
    }
    for (const std::string& file : shader_inputs(options.shaders)) {
      check_not_read("-o", options.output, {{file, "a shader's file"}});
      if (sidecar) check_not_read("the sidecar of -o", *sidecar, {{file, "a shader's file"}});
    }
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  OpenedPicture opened = read_picture(options);
  const bool loses_alpha = is_transparent(opened.layer.opacity) && !keeps_alpha(options.format);
  apply_effects(options, opened, pool);
  if (loses_alpha) opened.layer.opacity.clear();
  if (!keeps_windows(options, opened)) {
    PictureOnItsWay picture{std::move(opened.layer.colour), std::move(opened.layer.opacity)};
    cut_to_shown(opened.sources.colour_file, picture,
                 opened.layer.depth ? &*opened.layer.depth : nullptr);
    opened.layer.colour = std::move(picture.picture);
    opened.layer.opacity = std::move(picture.opacity);
    for (const OtherView& view : opened.sources.views) {
      warn(lost_view_warning(options.picture, view));
    }
  }
  const PictureNotes notes = notes_of(options, opened);
  const Bytes bytes = picture_file(options, opened, notes);
  const bool has_room = !sidecar || is_free_for_sidecar(*sidecar);
  if (to_standard_output) {
    write_to_standard_output(bytes);
  } else {
    WholeFile picture{options.output};
    std::optional<WholeFile> notes_file;
    picture.write(bytes);
    if (sidecar && has_room) notes_file.emplace(*sidecar).write(sidecar_text(notes, bytes));
    picture.commit();
    if (notes_file) notes_file->commit();
  }
  if (!has_room) {
    warn("'" + sidecar->string() +
         "' is no sidecar of a picture and stays as it is: what was done is written nowhere");
  }
  const std::string lost = lost_profile_warning(opened.sources.colour_file, options.format);
  if (!lost.empty()) warn(lost);
  const std::string order = order_warning(all_effects(options.effects));
  if (!order.empty()) warn(order);
  if (loses_alpha) {
    warn("'" + options.picture +
         "' is transparent in places; the result's format has no alpha, and black there; .exr and "
         ".png have");
  }
  return kDone;
}

void check_velocity(const ApplyOptions& options) {
  const std::vector<ChosenEffect> all = all_effects(options.effects);
  const auto reader = std::find_if(all.begin(), all.end(), [](const ChosenEffect& chosen) {
    return chosen.effect->velocity != VelocityOf::nothing;
  });
  if (reader == all.end() && options.velocity.file) {
    throw UsageError("--velocity: no effect given reads one; motion-blur does");
  }
  if (reader != all.end() && !options.velocity.file) {
    throw UsageError("--effect " + std::string{reader->effect->name} +
                     ": it needs to know how pixels move; give --velocity FILE: " + kVelocityFiles);
  }
}

}  // namespace

Command add_apply_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "apply", "Put effects on a picture");
  const auto options = std::make_shared<ApplyOptions>();
  add_argument(*parser, "PICTURE",
               "PNG and JPEG (sRGB), EXR, HDR, PFM (linear), NPY (linear; whole numbers sRGB)",
               options->picture);
  begin_group(*parser, "Shaders");
  add_shader_options(*parser, options->shaders);
  begin_group(*parser, "Effects");
  add_effect_options(*parser, options->effects);
  add_text(*parser, "--layer", "NAME", "The colour's layer of an EXR", options->layer);
  add_file_options(*parser, options->files);
  add_text(*parser, "--velocity", "FILE",
           std::string{"How each pixel moves, for motion blur: "} + kVelocityFiles +
               "; pixels a frame, to the right and down",
           options->velocity.file);
  add_text(*parser, "--velocity-layer", "NAME", "The velocity's layer of an EXR",
           options->velocity.layer);
  add_choice(*parser, "--velocity-encoding",
             "Whose way of writing it: of Blender's Vector Z and W, or X and Y, count, x turned "
             "round; Nuke's y goes up; pixels to the right and down (default: by the names)",
             kVelocityEncodings, options->velocity.encoding);
  begin_group(*parser, "Output");
  add_text(*parser, "-o,--output", "FILE",
           "The result: .png, .exr, .tiff, .pfm, .hdr or .npy; - for standard output (required)",
           options->output);
  add_format_option(*parser, options->format);
  begin_group(*parser, "Run");
  add_profile_option(*parser, options->profile, options->profile_name);
  add_pool_options(*parser, options->pool, "the picture is the same");
  return {
      parser, [parser, options] {
        settle_format(*parser, options->output, options->format);
        if (options->shaders.files.empty() && !options->shaders.pipeline &&
            all_effects(options->effects).empty()) {
          throw UsageError(
              "there is nothing to apply; give --shader, --pipeline, --effect (softfocus effects) "
              "or --tone-map");
        }
        if (const auto of_frames = effect_of_frames(all_effects(options->effects), "--effect")) {
          throw UsageError("--effect " + std::string{of_frames->effect->name} +
                           ": it makes frames of a scene from those before; softfocus render has "
                           "it, and a picture has none before");
        }
        check_velocity(*options);
        if (options->output == "-" && is_terminal(kStandardOutput)) {
          throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
        }
        return apply_to_file(*options);
      }};
}

}  // namespace softfocus
