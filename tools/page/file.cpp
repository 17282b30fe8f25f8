// file and save: what the page hands out, as text and as a picture.

#include <cstdio>

#include "tools/cli/errors.h"
#include "tools/files/hash_text.h"
#include "tools/page/picture.h"
#include "tools/page/requests.h"
#include "tools/page/scene_text.h"
#include "tools/refocus/refocused.h"
#include "tools/refocus/report.h"
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
  if (opened.picture) return "picture";
  if (!opened.stress_case) return opened.source;
  const StressCase& of = *opened.stress_case;
  return "case " + std::string{of.name} + ", " + std::string{of.parameter.name} + " " +
         short_number(opened.severity) + " " + std::string{of.parameter.unit};
}

std::string lens_text(const UsedLens& used) {
  const ThinLens& lens = used.lens;
  return line("Focus distance", short_number(lens.focus_m) + " m") +
         line("Focal length", short_number(lens.focal_length_mm) + " mm") +
         line("F-number", short_number(lens.f_number)) +
         line("CoC scale", short_number(used.coc_scale)) +
         line("Filter size", short_number(static_cast<double>(used.settings.max_coc_px)) +
                                 " pixels (largest CoC radius)");
}

/// The camera as text, or what stands in its place.
std::string seen_text(const Opened& opened, const ShownFrame& shown) {
  if (const OpenedPicture* picture = opened.picture.get()) {
    return line("Depth",
                picture->reading ? std::string{picture->reading->encoding->name} : picture->lacks);
  }
  const Camera& camera = shown.drawn->camera;
  return line("Frame", short_number(shown.settings.frame)) +
         line("Camera", "from " + vector_text(camera.position) + " to " +
                            vector_text(camera.target) + ", " + short_number(camera.fov_y_degrees) +
                            " degrees");
}

std::string report_text(const Page& page, const ShownFrame& shown) {
  const Image& picture = shown.picture;
  std::string text = "softfocus " SOFTFOCUS_VERSION ", the simulator\n\n";
  text += line("Scene", source_text(*page.opened) + ": " + page.opened->scene.title);
  text += line("Resolution",
               std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels");
  text += seen_text(*page.opened, shown);
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

Json answer_save(Page& page, const Json& request) {
  const std::string& name = request.at("format").text();
  const std::optional<FileFormat> format = format_by_name(name);
  if (!format || is_raw_video(*format)) {
    throw UsageError("format '" + name + "': give png, png-16, hdr, pfm or npy");
  }
  if (const std::string_view missing = missing_format(*format); !missing.empty()) {
    throw UsageError("format '" + name + "': " + std::string{missing});
  }
  if (!page.shown || !page.shown->refocused || page.shown->settings.preview != 1) {
    throw UsageError(
        "no refocused picture is shown: open a picture and its depth, and wait until "
        "it is whole");
  }
  const RefocusedFrame& frame = *page.shown->refocused;
  const OpenedPicture& opened = *page.opened->picture;
  RefocusOptions options = frame.options;
  options.format = *format;
  const Image& picture = page.shown->picture;
  page.saved = refocused_file(
      options, opened.sources, opened.whole.depth, frame.used, {picture, frame.opacity},
      refocus_notes(options, frame.used, picture.width, picture.height, hash_image(picture)));
  return {{"saved_bytes", static_cast<std::int64_t>(page.saved.size())}};
}

}  // namespace softfocus
