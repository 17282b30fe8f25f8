#include "tools/render/performance_report.h"

#include <array>
#include <cstdio>

#include "tools/files/hash_text.h"
#include "tools/files/json.h"
#include "tools/info/candidates.h"
#include "tools/pictures/picture_notes.h"
#include "tools/render/options.h"

namespace softfocus {
namespace {

struct NamedTime {
  const char* name;
  double StageTimes::*ms;
};
constexpr std::array kStages{
    NamedTime{"load", &StageTimes::load},     NamedTime{"draw", &StageTimes::draw},
    NamedTime{"focus", &StageTimes::focus},   NamedTime{"choose", &StageTimes::choose},
    NamedTime{"filter", &StageTimes::filter}, NamedTime{"check", &StageTimes::check},
    NamedTime{"encode", &StageTimes::encode}, NamedTime{"write", &StageTimes::write}};

double cost_ms(const StageTimes& ms) { return ms.focus + ms.choose + ms.filter + ms.check; }

double frames_per_second(double ms) { return ms > 0.0 ? 1000.0 / ms : 0.0; }

std::string line(const char* name, const std::string& value) {
  char text[32];
  std::snprintf(text, sizeof text, "%-24s", name);
  return text + value + "\n";
}

std::string time_line(const char* name, double ms, bool with_rate) {
  char text[64];
  std::snprintf(text, sizeof text, "%12.2f", ms);
  std::string value = text;
  std::snprintf(text, sizeof text, "%20.2f", frames_per_second(ms));
  if (with_rate) value += text;
  return line(name, value);
}

/// Choosing and checking are stages of auto alone.
bool is_timed(const NamedTime& stage, const RenderRecord& record) {
  const std::optional<AutoPicture>& chosen = record.frame.chosen;
  if (stage.ms == &StageTimes::choose) return chosen.has_value();
  return stage.ms != &StageTimes::check || (chosen && chosen->measured_error);
}

std::string lens_lines(const UsedLens& used, const RenderOptions& options) {
  std::string focus = short_number(used.lens.focus_m) + " m";
  if (options.autofocus) {
    const glm::ivec2 at = *used.focus_at;
    focus += ", found at pixel " + std::to_string(at.x) + "," + std::to_string(at.y);
  }
  return line("Focus distance", focus) +
         line("Focal length", short_number(used.lens.focal_length_mm) + " mm") +
         line("F-number", short_number(used.lens.f_number)) +
         line("Aperture", short_number(aperture_mm(used.lens)) + " mm") +
         line("CoC scale", short_number(used.coc_scale));
}

std::string filter_lines(const UsedLens& used) {
  return line("Filter size",
              short_number(used.settings.max_coc_px) + " pixels (largest CoC radius)") +
         line("Leak", short_number(used.settings.leak));
}

std::string choice_lines(const AutoPicture& chosen) {
  const AutoMethod& choice = chosen.choice;
  return line("Chosen", setting_text(choice)) + line("Because", choice.reason) +
         line("Predicted error", short_number(choice.predicted_error) + " (mean FLIP)") +
         (chosen.measured_error ? line("Measured error", short_number(*chosen.measured_error))
                                : "") +
         line("Predicted time",
              short_number(choice.predicted_ms) + " ms (two cores of the reference machine)");
}

std::string sampling_lines(const Sampling& sampling, const SampledPicture& used) {
  const int blades = sampling.aperture.blades;
  std::string text = line("Samples", std::to_string(used.samples)) +
                     line("Pixel jitter", sampling.jitter ? "yes" : "no") +
                     line("Blades", blades == 0 ? "round" : std::to_string(blades));
  if (sampling.shutter_frames > 0.0) {
    text += line("Shutter", short_number(sampling.shutter_frames) + " frames");
  }
  if (used.mean_samples) {
    text += line("Samples a pixel", short_number(*used.mean_samples) + " in the mean");
  }
  if (used.half_set_rms) {
    text += line("Half-sets differ by", short_number(*used.half_set_rms) + " (RMS, linear)");
  }
  return text;
}

Json vector_json(const glm::dvec3& v) { return std::vector<double>{v.x, v.y, v.z}; }

Json camera_json(const Camera& camera) {
  return {{"fov_y_degrees", camera.fov_y_degrees},
          {"position", vector_json(camera.position)},
          {"target", vector_json(camera.target)},
          {"up", vector_json(camera.up)},
          {"near_m", camera.near_m},
          {"far_m", camera.far_m}};
}

Json choice_json(const AutoPicture& chosen, const AutoGoal& goal) {
  const AutoMethod& choice = chosen.choice;
  Json json{{"candidate", candidate_id(choice)}, {"method", choice.method}};
  if (choice.radius_px > 0.0f) json["max_coc_px"] = choice.radius_px;
  if (choice.samples > 0) json["samples"] = choice.samples;
  if (goal.max_time_ms) {
    json["max_time_ms"] = *goal.max_time_ms;
  } else {
    json["max_error"] = goal.max_error;
  }
  json["meets_goal"] = choice.meets_goal;
  json["predicted_error"] = choice.predicted_error;
  json["measured_error"] = nullptr;
  if (chosen.measured_error) json["measured_error"] = *chosen.measured_error;
  json["predicted_ms"] = choice.predicted_ms;
  json["reason"] = choice.reason;
  json["traits"] = traits_json(choice.traits);
  return json;
}

}  // namespace

std::string_view name_of(Show show) {
  switch (show) {
    case Show::image: return "image";
    case Show::pinhole: return "pinhole";
    case Show::coc: return "coc";
    case Show::depth: return "depth";
    case Show::wireframe: return "wireframe";
  }
  return "";
}

bool has_depth_of_field(const RenderOptions& options) {
  return options.show == Show::image && options.method.name() != "pinhole";
}

std::string text_report(const RenderOptions& options, const RenderRecord& record) {
  const StageTimes& ms = record.ms;
  std::string text = "softfocus " SOFTFOCUS_VERSION " performance report\n\n";
  text += line("Scene", record.scene_name + ": " + record.scene_title);
  text += line("Frame", short_number(options.frame));
  text += line("Resolution", std::to_string(options.size.width) + " x " +
                                 std::to_string(options.size.height) + " pixels");
  if (options.supersample > 1) {
    text += line("Supersample",
                 std::to_string(options.supersample) + " x " + std::to_string(options.supersample));
  }
  if (record.frame.samples > 1) {
    text += line("Multisample", std::to_string(record.frame.samples));
  }
  text += line("Triangles", std::to_string(record.triangles));
  text += line("Method", std::string{options.method.name()});
  if (options.arithmetic != Arithmetic::floats) {
    text += line("Arithmetic", std::string{arithmetic_name(options.arithmetic)});
  }
  if (record.frame.chosen) text += choice_lines(*record.frame.chosen);
  text += line("Picture", std::string{name_of(options.show)});
  text += record.gl_renderer.empty() ? line("Profile", options.profile_name)
                                     : line("GL driver", record.gl_renderer);
  if (record.frame.shaded_share) {
    text +=
        line("Drawn anew", short_number(100.0 * *record.frame.shaded_share) + " % of the pixels");
  }
  if (!record.made.empty()) text += line("Made", record.made);
  text += line("Threads", std::to_string(options.pool.threads));
  text += line("Vector unit", std::string{isa_name(options.pool.isa)});
  text += "\n";
  if (record.frame.lens) {
    text += lens_lines(*record.frame.lens, options);
    if (!options.sharp_depths.empty()) {
      text += line("Sharp depths", ranges_text(options.sharp_depths) + " m");
    }
    if (record.frame.sampled) {
      text += sampling_lines(record.frame.sampling, *record.frame.sampled);
    } else if (record.frame.method.of_scene == nullptr) {
      text += filter_lines(*record.frame.lens);
    }
    text += "\n";
  }

  text += line("", "milliseconds   frames per second");
  text += time_line("Without depth of field", ms.draw, true);
  if (has_depth_of_field(options)) {
    text += time_line("With depth of field", ms.draw + cost_ms(ms), true);
    text += time_line("Cost of depth of field", cost_ms(ms), false);
  }
  text += "\n" + line("Stage", "milliseconds");
  for (const NamedTime& stage : kStages) {
    if (!is_timed(stage, record)) continue;
    text += time_line(stage.name, ms.*stage.ms, false);
  }
  return text;
}

std::string json_report(const RenderOptions& options, const RenderRecord& record) {
  const StageTimes& ms = record.ms;
  Json json{
      {"softfocus", SOFTFOCUS_VERSION},
      {"scene", record.scene_name},
      {"title", record.scene_title},
      {"frame", options.frame},
      {"width", options.size.width},
      {"height", options.size.height},
      {"supersample", options.supersample},
      {"multisample", record.frame.samples},
      {"triangles", record.triangles},
      {"method", options.method.name()},
      {"show", name_of(options.show)},
      {"profile", options.profile_name},
      {"threads", options.pool.threads},
      {"isa", isa_name(options.pool.isa)},
      {"output", options.output},
      {"picture_hash", hash_text(record.picture_hash)},
      {"camera", camera_json(record.camera)},
  };
  if (options.arithmetic != Arithmetic::floats) {
    json["arithmetic"] = arithmetic_name(options.arithmetic);
  }
  if (!record.gl_renderer.empty()) {
    json["profile"] = nullptr;
    json["gl_driver"] = record.gl_renderer;
    if (!options.shaders.own.empty()) json["shaders"] = options.shaders.folder.string();
  }
  if (record.frame.lens) {
    const UsedLens& used = *record.frame.lens;
    Json& lens = json["lens"];
    add_lens(lens, used.lens, used.coc_scale);
    lens["aperture_mm"] = aperture_mm(used.lens);
    lens["radius_at_infinity_px"] = used.settings.coc.radius_at_infinity_px;
    lens["max_coc_px"] = used.settings.max_coc_px;
    lens["leak"] = used.settings.leak;
    if (options.autofocus) {
      const glm::ivec2 at = *used.focus_at;
      json["lens"]["autofocus_pixel"] = {at.x, at.y};
    }
  }
  if (!options.sharp_depths.empty()) {
    json["sharp_depths_m"] = ranges_json(options.sharp_depths);
  }
  if (record.frame.chosen) {
    json["choice"] = choice_json(*record.frame.chosen, options.goal);
  }
  if (record.frame.sampled) {
    json["sampling"] = {{"samples", record.frame.sampled->samples},
                        {"jitter", record.frame.sampling.jitter},
                        {"aperture_blades", record.frame.sampling.aperture.blades}};
    if (record.frame.sampling.shutter_frames > 0.0) {
      json["sampling"]["shutter_frames"] = record.frame.sampling.shutter_frames;
    }
    if (record.frame.sampled->mean_samples) {
      json["sampling"]["mean_samples"] = *record.frame.sampled->mean_samples;
      json["sampling"]["most_samples"] = record.frame.sampling.samples;
    }
    if (record.frame.sampled->unseen) {
      json["sampling"]["views"] = record.frame.sampling.drawn_views;
      json["sampling"]["unseen"] = *record.frame.sampled->unseen;
    }
    if (record.frame.sampled->half_set_rms)
      json["sampling"]["half_set_rms"] = *record.frame.sampled->half_set_rms;
  }
  if (record.frame.shaded_share) json["drawn_anew"] = *record.frame.shaded_share;
  json["without_depth_of_field"] = {{"ms", ms.draw}, {"fps", frames_per_second(ms.draw)}};
  if (has_depth_of_field(options)) {
    const double with = ms.draw + cost_ms(ms);
    json["with_depth_of_field"] = {{"ms", with}, {"fps", frames_per_second(with)}};
    json["cost_of_depth_of_field_ms"] = cost_ms(ms);
  }
  for (const NamedTime& stage : kStages) {
    if (!is_timed(stage, record)) continue;
    json["stages_ms"][stage.name] = ms.*stage.ms;
  }
  // A file's name need not be UTF-8, but JSON must be.
  return json_text(json, 2) + "\n";
}

}  // namespace softfocus
