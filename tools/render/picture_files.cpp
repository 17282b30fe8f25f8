#include "tools/render/picture_files.h"

#include <algorithm>
#include <cmath>

#include "raster/numbers/half.h"
#include "scenes/load/pipeline_file.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/files/whole_file.h"

namespace softfocus {
namespace {

/// Less of the picture than this is not worth a line.
constexpr double kNoticeableShare = 0.01;

/// A circle is cut so far that it can be seen from a tenth and a pixel on.
float noticeable_px(float max_coc_px) { return 1.1f * max_coc_px + 1.0f; }

/// The largest --max-coc that the method takes (fixed_settings_error()).
float most_max_coc_px(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::floats ? kLargestMaxCoc : 64.0f;
}

Json method_json(const RenderOptions& options, const RenderRecord& record) {
  if (options.show != Show::image) return nullptr;
  const MethodChoice& method = record.frame.method;
  Json json{{"name", method.name()}};
  if (options.supersample > 1) json["supersample"] = options.supersample;
  if (record.frame.samples > 1) json["multisample"] = record.frame.samples;
  if (record.frame.sampled) {
    json["samples"] = record.frame.sampled->samples;
    if (record.frame.sampled->mean_samples) {
      json["mean_samples"] = *record.frame.sampled->mean_samples;
      json["most_samples"] = record.frame.sampling.samples;
    }
    json["jitter"] = record.frame.sampling.jitter;
    json["aperture_blades"] = record.frame.sampling.aperture.blades;
    if (record.frame.sampling.shutter_frames > 0.0) {
      json["shutter_frames"] = record.frame.sampling.shutter_frames;
    }
  } else if (record.frame.lens && method.of_scene == nullptr) {
    json["max_coc_px"] = record.frame.lens->settings.max_coc_px;
    json["leak"] = record.frame.lens->settings.leak;
    if (method.name() == kBudgetMethod) json["budget"] = record.frame.lens->settings.budget;
    if (method.name() == kApertureMethod && options.aperture != Aperture{}) {
      json["aperture"] = aperture_json(options.aperture);
    }
    json["arithmetic"] = arithmetic_name(options.arithmetic);
    if (!options.sharp_depths.empty()) {
      json["sharp_depths_m"] = ranges_json(options.sharp_depths);
    }
  }
  if (record.gl_renderer.empty()) {
    json["profile"] = options.profile_name;
  } else {
    json["gl_driver"] = record.gl_renderer;
    if (!options.shaders.own.empty()) json["shaders"] = options.shaders.folder.string();
  }
  return json;
}

}  // namespace

void check_outputs(const RenderOptions& options, const Scene& scene) {
  std::vector<ReadFile> inputs;
  for (const auto& file : scene.files) inputs.push_back({file, "a file of the scene"});
  if (options.method.filter != nullptr) {
    for (const std::string& file : files_of(*options.method.filter)) {
      inputs.push_back({file, "a file of the pipeline"});
    }
  }
  if (!options.profile_file.empty()) inputs.push_back({options.profile_file, "the profile"});
  for (const auto& [name, text] : options.shaders.own) {
    inputs.push_back({options.shaders.folder / name, "a shader"});
  }
  std::vector<WrittenFile> outputs;
  if (options.output != "-") outputs.push_back({"-o", options.output});
  for (std::size_t layer = 2; options.show != Show::image && layer <= layers_of(options); ++layer) {
    outputs.push_back({"--layers", layer_place(options, layer)});
  }
  if (const auto sidecar = sidecar_place(options))
    outputs.push_back({"the sidecar of -o", *sidecar});
  if (options.depth_output) outputs.push_back({"--depth-output", *options.depth_output});
  if (options.report) outputs.push_back({"--report", *options.report});
  check_written(outputs, inputs);
}

std::filesystem::path layer_place(const RenderOptions& options, std::size_t layer) {
  const std::filesystem::path picture = options.output;
  std::filesystem::path place = picture;
  place.replace_filename(picture.stem().string() + ".layer" + std::to_string(layer) +
                         picture.extension().string());
  return place;
}

PictureNotes notes_of(const RenderOptions& options, const RenderRecord& record) {
  PictureNotes notes{.scene = record.scene_name,
                     .frame = options.frame,
                     .width = options.size.width,
                     .height = options.size.height,
                     .show = std::string{name_of(options.show)},
                     .fov_y_degrees = record.camera.fov_y_degrees,
                     .lens = {},
                     .method = method_json(options, record),
                     .picture_hash = record.picture_hash};
  if (record.frame.lens) {
    notes.lens = {record.frame.lens->lens, record.frame.lens->coc_scale, notes.fov_y_degrees};
  }
  for (const ChosenEffect& chosen : record.effects) notes.effects.push_back(effect_text(chosen));
  return notes;
}

Bytes depth_bytes(const RenderOptions& options, const Image& picture) {
  std::vector<float> metres;
  metres.reserve(static_cast<std::size_t>(picture.width) *
                 static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture, y);
    for (std::size_t i = 3; i < halves.size(); i += 4) metres.push_back(half_to_float(halves[i]));
  }
  return encode_depth(metres, picture.width, picture.height,
                      *format_by_extension(*options.depth_output));
}

std::optional<std::filesystem::path> sidecar_place(const RenderOptions& options) {
  return sidecar_place(options.output, options.format);
}

bool cuts_by_default(const RenderOptions& options) {
  return options.show == Show::image && options.method.filter != nullptr &&
         has_depth_of_field(options) && !options.max_coc_px && !takes_all_circles(options);
}

bool takes_all_circles(const RenderOptions& options) {
  return options.show == Show::image && options.method.takes_any_radius() && !options.max_coc_px;
}

CircleSizes cut_circles(const ConstImageView& drawn, const UsedLens& used, ThreadPool& pool) {
  return circle_sizes(drawn, used.settings.coc, noticeable_px(used.settings.max_coc_px), pool);
}

std::string cut_warning(const CircleSizes& sizes, const RenderOptions& options,
                        const UsedLens& used) {
  const float max_coc_px = used.settings.max_coc_px;
  if (sizes.beyond_limit < kNoticeableShare) return {};
  const float most = most_max_coc_px(options.arithmetic);
  const auto scale = static_cast<float>(options.supersample);
  const float needed = std::min(std::ceil(sizes.largest_px / scale), most / scale);
  return "--max-coc, " + short_number(static_cast<double>(max_coc_px / scale)) +
         " by default, cuts the circles of " +
         short_number(std::round(100.0 * sizes.beyond_limit)) + " % of the picture; --max-coc " +
         short_number(static_cast<double>(needed)) +
         (sizes.largest_px >= most ? " cuts as few as can be" : " cuts none");
}

}  // namespace softfocus
