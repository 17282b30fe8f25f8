// file: what the page hands out as text.

#include <cstdio>

#include "tools/cli/errors.h"
#include "tools/files/hash_text.h"
#include "tools/page/requests.h"
#include "tools/page/scene_text.h"
#include "tools/render/performance_report.h"

namespace softfocus {
namespace {

std::string line(const char* name, const std::string& value) {
  char text[32];
  std::snprintf(text, sizeof text, "%-20s", name);
  return text + value + "\n";
}

std::string vector_text(const glm::dvec3& v) {
  return short_number(v.x) + ", " + short_number(v.y) + ", " + short_number(v.z);
}

std::string source_text(const Opened& opened) {
  if (!opened.stress_case) return opened.source;
  const StressCase& of = *opened.stress_case;
  return "case " + std::string{of.name} + ", " + std::string{of.parameter.name} + " " +
         short_number(opened.severity) + " " + std::string{of.parameter.unit};
}

std::string lens_text(const FrameLens& used) {
  const ThinLens& lens = used.lens;
  return line("Focus distance", short_number(lens.focus_m) + " m") +
         line("Focal length", short_number(lens.focal_length_mm) + " mm") +
         line("F-number", short_number(lens.f_number)) +
         line("CoC scale", short_number(used.coc_scale)) +
         line("Filter size", short_number(static_cast<double>(used.settings.max_coc_px)) +
                                 " pixels (largest CoC radius)");
}

std::string report_text(const Page& page, const ShownFrame& shown) {
  const Image& picture = shown.picture;
  const Camera& camera = shown.drawn->camera;
  std::string text = "softfocus " SOFTFOCUS_VERSION ", the simulator\n\n";
  text += line("Scene", source_text(*page.opened) + ": " + page.opened->scene.title);
  text += line("Frame", short_number(shown.settings.frame));
  text += line("Resolution",
               std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels");
  text +=
      line("Camera", "from " + vector_text(camera.position) + " to " + vector_text(camera.target) +
                         ", " + short_number(camera.fov_y_degrees) + " degrees");
  text += line("Picture", std::string{name_of(shown.settings.show)});
  if (shown.settings.show == Show::image) {
    text += line("Method", std::string{shown.settings.method.name()});
  }
  if (shown.lens) text += lens_text(*shown.lens);
  text += line("Threads", std::to_string(page.pool->threads()));
  text += line("Vector unit", std::string{isa_name(page.pool->isa())});
  text += line("Drawing", short_number(shown.drawn->ms) + " ms");
  text += line("Filtering", short_number(shown.filter_ms) + " ms");
  return text + line("Hash", hash_text(hash_image(picture)));
}

}  // namespace

Json answer_file(Page& page, const Json& request) {
  const std::string& name = request.at("name").text();
  if (!page.shown) throw UsageError("there is no frame yet; the request 'frame' makes one");
  if (name == "scene.toml") return {{"text", scene_text(*page.opened, *page.shown)}};
  if (name == "report.txt") return {{"text", report_text(page, *page.shown)}};
  throw UsageError("there is no file '" + name + "'; there are scene.toml, report.txt");
}

}  // namespace softfocus
