// gl_open, gl_frame, gl_probe, gl_crosscheck: the same work on the GPU of the page's machine, and
// how far it is from ours. In a browser that is WebGL2; natively, for tests, the first driver.

#include <algorithm>
#include <cctype>

#include "dof/measure/difference.h"
#include "tools/cli/errors.h"
#include "tools/crosscheck/cases.h"
#include "tools/crosscheck/probe.h"
#include "tools/gl/filter_on_gl.h"
#include "tools/gl/pipeline_on_gl.h"
#include "tools/gl/scene_on_gl.h"
#include "tools/page/drawing.h"
#include "tools/page/requests.h"
#include "tools/page/screen.h"

namespace softfocus {

struct Gpu {
  GlContext context;
  Shaders shaders;
  ChosenProfile profile;  ///< what our side is drawn with
  Image frame, emulated;  ///< of the last gl_frame
};

struct GpuScene {
  std::shared_ptr<Gpu> gpu;
  GlScene on_gl;
  PreparedScene prepared;  ///< with the GPU's profile
};

namespace {

/// A driver known by its name; else IEEE 754, until it is probed.
ChosenProfile profile_of(std::string renderer) {
  std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const NamedProfile* chosen = &profiles().front();
  for (const NamedProfile& known : profiles()) {
    if (renderer.find(known.name) != renderer.npos) chosen = &known;
  }
  return {std::string{chosen->name}, std::string{chosen->summary}, chosen->profile};
}

Gpu& opened_gpu(Page& page) {
  if (page.gpu && page.gpu->context.is_lost()) {
    page.gpu_scene.reset();
    page.gpu.reset();
  }
  if (!page.gpu) {
    page.gpu.reset(new Gpu{GlContext{drivers().front()}, {}, {}, {}, {}});
    page.gpu->profile = profile_of(page.gpu->context.renderer());
  }
  return *page.gpu;
}

/// A lost context gives zeros and no errors.
void check_not_lost(const Gpu& gpu) {
  if (gpu.context.is_lost()) {
    throw DriverError("the browser took the GPU away, perhaps because it was busy for too long");
  }
}

template <class Work>
double milliseconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return milliseconds_since(start);
}

/// Both sides' results of one stage.
struct Stage {
  Image on_gl, emulated;
  double gl_ms = 0.0, emulated_ms = 0.0;
};

Json json_of(const Stage& stage) {
  Tally tally;
  add_pictures(tally, stage.on_gl, stage.emulated);
  Json differing{{"values", tally.differing},
                 {"of", tally.values},
                 {"largest_half_ulps", tally.max_ulp},
                 {"first", nullptr}};
  if (tally.first) {
    differing["first"] = {{"x", tally.first->x},
                          {"y", tally.first->y},
                          {"channel", tally.first->channel},
                          {"gpu", tally.first->driver},
                          {"module", tally.first->emulated}};
  }
  return differing;
}

GpuScene& opened_scene_on_gpu(Page& page) {
  if (!page.gpu_scene) {
    const Gpu& gpu = *page.gpu;
    const Scene& scene = page.opened->scene;
    page.gpu_scene.reset(new GpuScene{page.gpu, GlScene{gpu.context, gpu.shaders, scene},
                                      prepare_scene(scene, gpu.profile.profile, *page.pool)});
  }
  return *page.gpu_scene;
}

/// Shaders are compiled in a first drawing, which is not timed.
Stage drawn_by_both(Page& page, const Drawn& drawn, const GlTarget& target) {
  GpuScene& scene = opened_scene_on_gpu(page);
  const double frame = drawn.settings.frame;
  Stage stage;
  const auto draw = [&] {
    scene.on_gl.draw(drawn.frame.view, frame, target);
    wait_for(target);
  };
  draw();
  stage.gl_ms = milliseconds_of(draw);
  stage.on_gl = read_colour(target, 0);
  stage.emulated = make_image(Format::rgba16f, target.width, target.height);
  stage.emulated_ms = milliseconds_of(
      [&] { draw_scene(scene.prepared, drawn.frame.view, frame, stage.emulated, *page.pool); });
  return stage;
}

/// Both filter the GPU's sharp picture. The shaders have two forms with the same bits: the time is
/// the faster one's.
Stage filtered_by_both(const Page& page, const Method& method, const DofSettings& settings,
                       const GlTexture& sharp, const Image& picture) {
  const Gpu& gpu = *page.gpu;
  Stage stage;
  for (const FilterForm form : kFilterForms) {
    const GlFilter filter = make_filter(gpu.context, gpu.shaders, method.name, form, settings,
                                        picture.width, picture.height);
    const auto run = [&] {
      run_filter(filter, sharp);
      wait_for(filter.targets.back());
    };
    run();
    const double ms = milliseconds_of(run);
    if (form == FilterForm::brute_force) stage.on_gl = read_colour(filter.targets.back(), 0);
    stage.gl_ms = form == FilterForm::brute_force ? ms : std::min(ms, stage.gl_ms);
  }
  stage.emulated_ms = milliseconds_of([&] {
    stage.emulated = apply(method, {picture, settings, gpu.profile.profile}, *page.pool);
  });
  return stage;
}

/// The same for a user's passes, with the GLSL of their text.
Stage piped_by_both(const Page& page, const Method& method, const DofSettings& settings,
                    const Image& picture) {
  const Gpu& gpu = *page.gpu;
  const Pipeline& pipeline = *method.pipeline;
  const DofInput input{picture, settings, gpu.profile.profile};
  const GlTexture sharp = upload(source_image(pipeline, input, PipelineSource::picture));
  PipelineOnGl on_gl{gpu.context, pipeline, input};
  const auto run = [&] {
    on_gl.run(sharp);
    wait_for(on_gl.result());
  };
  run();
  Stage stage;
  stage.gl_ms = milliseconds_of(run);
  stage.on_gl = make_image(Format::rgba16f, picture.width, picture.height);
  store_result(pipeline, input, read_colour(on_gl.result(), 0), stage.on_gl, *page.pool);
  stage.emulated_ms = milliseconds_of([&] { stage.emulated = apply(method, input, *page.pool); });
  return stage;
}

void add(Json& reply, const std::string& stage_name, const Stage& stage) {
  reply[stage_name + "_ms"] = stage.gl_ms;
  reply["emulated_" + stage_name + "_ms"] = stage.emulated_ms;
  reply["differing"][stage_name] = json_of(stage);
}

Json shown_again(Page& page, bool emulated) {
  if (!page.gpu || page.gpu->frame.width == 0) {
    throw UsageError("there is no frame of the GPU's yet; gl_show 'difference' makes one");
  }
  const Image& frame = emulated ? page.gpu->emulated : page.gpu->frame;
  show_on_screen(frame, page.pixels, *page.pool);
  return {{"width", frame.width}, {"height", frame.height}};
}

}  // namespace

Json answer_gl_open(Page& page, const Json& /*request*/) {
  const Gpu& gpu = opened_gpu(page);
  return {{"renderer", gpu.context.renderer()},
          {"version", "OpenGL " + gpu.context.version()},
          {"profile", gpu.profile.name},
          {"linear_varyings", gpu.context.has_linear_varyings()}};
}

Json answer_gl_frame(Page& page, const Json& request) {
  const std::string& show = request.at("gl_show").text();
  if (show == "picture" || show == "emulated") return shown_again(page, show == "emulated");
  if (show != "difference") {
    throw UsageError("gl_show '" + show + "': there are difference, picture, emulated");
  }
  const FrameSettings settings = read_frame_settings(request);
  Gpu& gpu = opened_gpu(page);
  const std::shared_ptr<const Drawn> drawn = drawn_picture(page, settings);
  Stage frame{drawn->picture(), drawn->picture(), 0.0, 0.0};
  Json reply{{"width", frame.on_gl.width},
             {"height", frame.on_gl.height},
             {"profile", gpu.profile.name},
             {"differing", Json::object()}};
  GlTarget target;
  GlTexture uploaded;
  // A case is made as a picture: both sides begin with it.
  if (drawn->trial) {
    uploaded = upload(drawn->picture());
  } else {
    target = make_scene_target(drawn->picture().width, drawn->picture().height);
    frame = drawn_by_both(page, *drawn, target);
    add(reply, "draw", frame);
  }
  const Method* method = settings.show == Show::image ? settings.method.filter : nullptr;
  const bool has_passes = method != nullptr && method->pipeline != nullptr;
  if (method != nullptr && (has_passes || has_shader(method->name))) {
    const DofSettings lens =
        used_lens(page, *drawn, settings, shot_of_drawn(page, *drawn, settings)).settings;
    const GlTexture& sharp = drawn->trial ? uploaded : target.colour[0];
    Stage filter = has_passes ? piped_by_both(page, *method, lens, frame.on_gl)
                              : filtered_by_both(page, *method, lens, sharp, frame.on_gl);
    add(reply, "filter", filter);
    frame.emulated = apply(*method, {frame.emulated, lens, gpu.profile.profile}, *page.pool);
    frame.on_gl = std::move(filter.on_gl);
  }
  reply["differing"]["frame"] = json_of(frame);
  check_not_lost(gpu);
  show_on_screen(difference_picture(frame.on_gl, frame.emulated), page.pixels, *page.pool);
  gpu.frame = std::move(frame.on_gl);
  gpu.emulated = std::move(frame.emulated);
  return reply;
}

Json answer_gl_probe(Page& page, const Json& /*request*/) {
  Gpu& gpu = opened_gpu(page);
  const Probe probe = probe_context(gpu.context, "", *page.pool);
  check_not_lost(gpu);
  gpu.profile = probe.profile;
  page.gpu_scene.reset();
  return {{"name", probe.profile.name}, {"toml", probe_text(probe)}};
}

Json answer_gl_crosscheck(Page& page, const Json& request) {
  const Gpu& gpu = opened_gpu(page);
  const std::vector<Case> cases = crosscheck_cases();
  const Json* wanted = request.find("case");
  if (wanted == nullptr) {
    Json list = Json::array();
    for (const Case& one : cases) {
      list.push_back({{"name", one.stage + '/' + one.name}, {"quick", one.quick}});
    }
    return {{"cases", list}};
  }
  const auto found = std::find_if(cases.begin(), cases.end(), [&](const Case& one) {
    return one.stage + '/' + one.name == wanted->text();
  });
  if (found == cases.end()) throw UsageError("there is no case '" + wanted->text() + "'");
  Tally tally;
  found->run({gpu.context, gpu.shaders, gpu.profile.profile, *page.pool}, tally);
  check_not_lost(gpu);
  Json reply{{"values", tally.values},
             {"differing", tally.differing},
             {"largest_ulps", tally.max_ulp},
             {"first", nullptr}};
  if (tally.first) {
    reply["first"] = {{"x", tally.first->x},
                      {"y", tally.first->y},
                      {"where", tally.first->where},
                      {"gpu", tally.first->driver},
                      {"module", tally.first->emulated}};
  }
  return reply;
}

}  // namespace softfocus
