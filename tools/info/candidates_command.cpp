// softfocus candidates: what --method auto chooses from, and how far off it predicts each to be;
// with --measure, how far off each is.

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>

#include "dof/auto/auto_method.h"
#include "dof/auto/candidates.h"
#include "dof/dof.h"
#include "dof/measure/flip.h"
#include "scenes/auto/auto_picture.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/load/load_scene.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/info/candidates.h"
#include "tools/options/lens_options.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

struct CandidatesOptions {
  std::string scene;
  std::vector<std::filesystem::path> scene_path;
  PictureSize size{512, 512};
  double frame = 0.0;
  LensOptions lens;
  std::optional<int> measured_samples;  ///< of the truth
  std::vector<double> errors_asked;     ///< for which auto chooses
  std::filesystem::path table;          ///< in place of auto's own, if not empty
  std::vector<std::string> only;        ///< methods to list, all if empty
  bool json = false;
  PoolOptions pool;
};

/// The scene as all candidates get it.
struct Subject {
  Scene scene;
  CameraMatrices view{};
  double frame = 0.0;
  ThinLens lens;
  PixelCoc coc;
  double aperture_m = 0.0;
  Image pinhole;
};

Subject make_subject(const CandidatesOptions& options, ThreadPool& pool) {
  Subject subject;
  subject.scene = load_scene(options.scene, scene_search_path(options.scene_path), &pool);
  const auto [width, height] = options.size;
  const Scene& scene = subject.scene;
  print_scene_warnings(scene.warnings, false);
  subject.view = camera_matrices(scene.camera, options.frame, width, height);
  subject.frame = options.frame;
  subject.lens = overruled(lens_at(scene.lens, options.frame), options.lens);
  check_lens(subject.lens, options.lens, options.scene);
  const double coc_scale = options.lens.coc_scale.value_or(scene.lens.coc_scale);
  subject.coc = checked_pixel_coc(subject.lens, scene.camera.fov_y_degrees, height, coc_scale);
  subject.aperture_m = aperture_radius_m(subject.lens, coc_scale);
  subject.pinhole = draw_scene(scene, subject.view, options.frame, width, height, Profile{}, pool);
  return subject;
}

LensViewInput views_of(const Subject& subject, int samples) {
  return {.scene = subject.scene,
          .camera = subject.view,
          .frame = subject.frame,
          .pinhole = subject.pinhole,
          .focus_m = subject.lens.focus_m,
          .aperture_radius_m = subject.aperture_m,
          .sampling = {.samples = samples},
          .profile = Profile{},
          .progress = {}};
}

/// --measure's findings: the mean FLIP of each choice, in their order.
struct Measured {
  double noise_floor = 0.0;  ///< of the truth's halves, one against the other
  std::vector<double> flips;
};

bool is_accumulation(const AutoMethod& choice) { return choice.method == "accumulation"; }

// Beyond kMostFewLensPoints the views that accumulation averages are the truth's first: each such
// number of samples on the way is measured against the truth once it is there.
Measured measure(const Subject& subject, std::span<const AutoMethod> choices, int samples,
                 ThreadPool& pool) {
  const LensViewInput input = views_of(subject, samples);
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  SampleSums sums = make_sample_sums(subject.pinhole.width, subject.pinhole.height);
  std::vector<std::pair<int, Image>> on_the_way;
  SampleSums half;
  while (sums.count < samples) {
    const int step = sums.count < kLensViewGroup ? kSampleGroup : kLensViewGroup;
    add_lens_views(buffer, input, sums.count, std::min(sums.count + step, samples), sums, pool);
    for (const AutoMethod& choice : choices) {
      if (!is_accumulation(choice) || choice.samples <= kMostFewLensPoints) continue;
      if (choice.samples != sums.count || sums.count == samples) continue;
      on_the_way.emplace_back(sums.count, mean_picture(sums, subject.pinhole, Profile{}, pool));
    }
    if (sums.count == samples / 2) half = sums;
  }
  const Image truth = mean_picture(sums, subject.pinhole, Profile{}, pool);
  for (const AutoMethod& choice : choices) {
    if (!is_accumulation(choice) || choice.samples > std::min(kMostFewLensPoints, samples - 1)) {
      continue;
    }
    on_the_way.emplace_back(choice.samples,
                            accumulation(views_of(subject, choice.samples), pool).picture);
  }
  Measured measured;
  measured.noise_floor =
      mean_flip(mean_picture(half, subject.pinhole, Profile{}, pool),
                mean_picture(later_samples(half, sums), subject.pinhole, Profile{}, pool), pool);
  for (const AutoMethod& choice : choices) {
    if (is_accumulation(choice)) {
      const auto drawn = std::find_if(on_the_way.begin(), on_the_way.end(),
                                      [&](const auto& of) { return of.first == choice.samples; });
      measured.flips.push_back(drawn != on_the_way.end()
                                   ? mean_flip(truth, drawn->second, pool)
                                   : std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const Image picture = picture_of(choice, input, {.coc = subject.coc}, pool);
    measured.flips.push_back(mean_flip(truth, picture, pool));
  }
  return measured;
}

Json candidate_json(const AutoMethod& choice, std::optional<double> flip) {
  Json json{{"candidate", candidate_id(choice)}, {"method", choice.method}};
  if (choice.radius_px > 0.0f) json["max_coc_px"] = choice.radius_px;
  if (choice.samples > 0) json["samples"] = choice.samples;
  json["predicted_error"] = choice.predicted_error;
  json["predicted_ms"] = choice.predicted_ms;
  json["flip"] = flip ? number_or_null(*flip) : nullptr;
  return json;
}

void print_table(std::span<const AutoMethod> choices, const std::optional<Measured>& measured) {
  std::cout << (measured ? "predicted ms  predicted FLIP  measured FLIP  setting\n"
                         : "predicted ms  predicted FLIP  setting\n");
  for (std::size_t i = 0; i < choices.size(); ++i) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%12.1f  %14.4f  ", choices[i].predicted_ms,
                  choices[i].predicted_error);
    std::cout << text.data();
    if (measured) {
      const bool is_known = measured->flips[i] == measured->flips[i];
      std::snprintf(text.data(), text.size(), "%13.4f  ", measured->flips[i]);
      std::cout << (is_known ? text.data() : "            -  ");
    }
    std::cout << setting_text(choices[i]) << '\n';
  }
}

/// auto's choice for an error, checks and all.
struct Taken {
  double error_asked;
  AutoMethod choice;
  std::optional<double> measured_error;
};

std::vector<Taken> take(const Subject& subject, std::span<const double> errors_asked,
                        const AutoLimits& limits, ThreadPool& pool) {
  std::vector<Taken> taken;
  for (const double error : errors_asked) {
    AutoPicture found = auto_picture({.views = views_of(subject, 1),
                                      .settings = {.coc = subject.coc},
                                      .goal = {.max_error = error},
                                      .limits = limits},
                                     pool);
    taken.push_back({error, std::move(found.choice), found.measured_error});
  }
  return taken;
}

Json taken_json(const Taken& taken) {
  return {{"max_error", taken.error_asked},
          {"candidate", candidate_id(taken.choice)},
          {"predicted_error", taken.choice.predicted_error},
          {"measured_error", taken.measured_error ? Json(*taken.measured_error) : Json(nullptr)},
          {"meets_goal", taken.choice.meets_goal},
          {"reason", taken.choice.reason}};
}

std::vector<AutoMethod> listed_choices(const CandidatesOptions& options,
                                       std::vector<AutoMethod> choices) {
  for (const std::string& name : options.only) {
    if (std::none_of(choices.begin(), choices.end(),
                     [&](const AutoMethod& choice) { return choice.method == name; })) {
      std::vector<std::string> known;
      for (const AutoMethod& choice : choices) {
        if (known.empty() || known.back() != choice.method) known.emplace_back(choice.method);
      }
      refuse_name("--only", name, known);
    }
  }
  if (!options.only.empty()) {
    std::erase_if(choices, [&](const AutoMethod& choice) {
      return std::find(options.only.begin(), options.only.end(), choice.method) ==
             options.only.end();
    });
  }
  return choices;
}

int list_candidates(const CandidatesOptions& options) {
  std::vector<Candidate> table;
  if (!options.table.empty()) table = read_candidate_table(options.table);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const Subject subject = make_subject(options, pool);
  const SceneTraits traits = scene_traits(subject.pinhole, subject.coc, pool);
  AutoLimits limits{.max_radius_px = {}, .triangles = triangle_count(subject.scene)};
  if (!table.empty()) limits.table = table;
  const std::vector<AutoMethod> choices = listed_choices(options, open_choices(traits, limits));
  const std::vector<Taken> taken = take(subject, options.errors_asked, limits, pool);
  std::optional<Measured> measured;
  if (options.measured_samples) {
    measured = measure(subject, choices, *options.measured_samples, pool);
  }
  if (!options.json) {
    print_table(choices, measured);
    for (const Taken& of : taken) {
      std::cout << "for " << short_number(of.error_asked) << ": " << setting_text(of.choice) << ": "
                << of.choice.reason << '\n';
    }
    return kDone;
  }
  Json json{{"scene", subject.scene.name},     {"title", subject.scene.title},
            {"size", size_text(options.size)}, {"frame", options.frame},
            {"focus_m", subject.lens.focus_m}, {"f_number", subject.lens.f_number}};
  if (measured) {
    json["truth_samples"] = *options.measured_samples;
    json["noise_floor_flip"] = measured->noise_floor;
  }
  json["traits"] = traits_json(traits);
  json["candidates"] = Json::array();
  for (std::size_t i = 0; i < choices.size(); ++i) {
    json["candidates"].push_back(
        candidate_json(choices[i], measured ? std::optional{measured->flips[i]} : std::nullopt));
  }
  if (!taken.empty()) {
    json["choices"] = Json::array();
    for (const Taken& of : taken) json["choices"].push_back(taken_json(of));
  }
  std::cout << json_text(json) << '\n';
  return kDone;
}

}  // namespace

std::string candidate_id(const AutoMethod& choice) {
  return candidate_id(candidates()[choice.candidate]);
}

Json traits_json(const SceneTraits& traits) {
  Json json{{"nearest_px", traits.nearest_px},       {"farthest_px", traits.farthest_px},
            {"blurred_share", traits.blurred_share}, {"blur", traits.blur},
            {"brightest", traits.brightest},         {"ghosts", traits.ghosts}};
  for (const RadiusTraits& of : traits.by_radius) {
    json["blurred"].push_back(of.blurred);
    json["lost"].push_back(of.lost);
    json["near_edges"].push_back(of.near_edges);
    json["far_edges"].push_back(of.far_edges);
  }
  return json;
}

Command add_candidates_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "candidates",
                                 "List what --method auto chooses from: predicted time and error");
  const auto options = std::make_shared<CandidatesOptions>();
  add_scene_argument(*parser, options->scene);
  begin_group(*parser, "Picture");
  add_scene_path(*parser, options->scene_path);
  add_size(*parser, options->size);
  add_frame(*parser, options->frame);
  begin_group(*parser, "Lens");
  add_lens_options(*parser, options->lens);
  begin_group(*parser, "Candidates");
  add_value(*parser, "--measure", "N",
            "Measure each error too, against N views of the lens: a multiple of 16 from 32 on",
            [options](const std::string& text) {
              constexpr const char* kWanted = "a multiple of 16 from 32 to 65536";
              const int samples = parse_whole("--measure", text, 32, kMostSamples, kWanted);
              if (samples % kLensViewGroup != 0) {
                throw UsageError("--measure '" + text + "': give " + kWanted);
              }
              options->measured_samples = samples;
            });
  add_repeatable_value(
      *parser, "--choose", "E",
      "Also what auto takes for this mean FLIP, checks and all; may be repeated",
      [options](const std::string& text) {
        options->errors_asked.push_back(parse_number("--choose", text, 0.0, 1.0,
                                                     "a mean FLIP from 0 to 1, such as "
                                                     "0.02"));
      });
  add_repeatable_value(*parser, "--only", "METHOD",
                       "List and measure this method alone; may be repeated",
                       [options](const std::string& text) { options->only.push_back(text); });
  offer(*parser, "--only", all_methods);
  add_value(*parser, "--table", "FILE",
            "Coefficients in place of auto's own: JSON, {\"two-pass:8\": [seven numbers], ...}",
            [options](const std::string& text) { options->table = text; });
  begin_group(*parser, "Run");
  add_flag(*parser, "--json", "Print JSON", options->json);
  add_pool_options(*parser, options->pool, "what is printed is the same");
  return {parser, [options] { return list_candidates(*options); }};
}

}  // namespace softfocus
