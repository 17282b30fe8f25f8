// The functions of softfocus.h on pictures: every argument is checked, no exception leaves.

#include "dof/c/softfocus.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "dof/auto/auto_method.h"
#include "dof/c/context.h"
#include "dof/c/pictures.h"
#include "dof/c/settings.h"
#include "dof/lens.h"

using namespace softfocus;

static_assert(SOFTFOCUS_LARGEST_SIZE == kMaxImageSize);
static_assert(SOFTFOCUS_LARGEST_RADIUS == kLargestMaxCoc);
static_assert(SOFTFOCUS_MOST_BEHIND == kMostBehind);
static_assert(SOFTFOCUS_MOST_TRANSPARENT == kMostTransparent);

namespace softfocus {
namespace {

/// A picture with what the settings come to for it.
struct Work {
  ReadFrame frame;
  const Method* method = nullptr;
  DofSettings settings;
  Profile profile;
  softfocus_report report{};
};

DofInput input_of(const Work& work) {
  return {.scene = work.frame.scene.view,
          .settings = work.settings,
          .profile = work.profile,
          .objects = work.frame.objects,
          .behind = work.frame.behind,
          .transparent = work.frame.transparent,
          .radii_px = work.frame.radii_px};
}

/// A caller's own radii are circles too.
float largest_of(const CircleSizes& sizes, std::span<const float> radii_px) {
  float largest = sizes.largest_px;
  for (const float radius_px : radii_px) largest = std::max(largest, std::fabs(radius_px));
  return std::min(largest, kLargestMaxCoc);
}

Work prepared(const softfocus_picture* picture, const softfocus_settings* settings,
              bool with_report, ThreadPool& pool) {
  const auto shape = read_struct("picture", picture);
  ReadSettings read = read_settings(settings, std::max(shape.width, 1), std::max(shape.height, 1));
  Work work{.frame = read_frame(picture, pool),
            .method = read.method,
            .settings = read.dof,
            .profile = read.profile};
  const ConstImageView& scene = work.frame.scene.view;
  const float largest_px =
      largest_of(circle_sizes(scene, read.dof.coc, kLargestMaxCoc, pool), work.frame.radii_px);
  work.settings.max_coc_px = read.max_radius_px.value_or(std::ceil(largest_px));
  if (work.method == nullptr) {
    const AutoMethod choice =
        auto_filter(scene, read.dof.coc, {.max_error = read.max_error}, read.max_radius_px, pool);
    work.method = find_method(choice.method);
    if (!is_sharp(choice)) work.settings.max_coc_px = choice.radius_px;
    work.report.predicted_error = choice.predicted_error;
  }
  const DofInput input = input_of(work);
  if (const char* error = input_error(input, scene)) refuse("picture", error);
  work.report.method = work.method->name.data();  // a literal
  work.report.radius_at_infinity_px = static_cast<double>(read.dof.coc.radius_at_infinity_px);
  work.report.largest_radius_px = static_cast<double>(largest_px);
  work.report.max_radius_px = static_cast<double>(work.settings.max_coc_px);
  const bool cuts = largest_px >= work.settings.max_coc_px;  // if equal, because of the largest
  if (with_report && cuts) {
    work.report.share_cut =
        circle_sizes(scene, read.dof.coc, work.settings.max_coc_px, pool).beyond_limit;
  }
  return work;
}

/// Fills a struct for a caller of any version: fields that are unknown here become 0.
void give_struct(const void* ours, std::size_t our_bytes, void* to, std::size_t bytes) {
  std::memset(to, 0, bytes);
  std::memcpy(to, ours, std::min(bytes, our_bytes));
  std::memcpy(to, &bytes, sizeof bytes);
}

/// The bytes of the caller's report, 0 if there is none.
std::size_t report_bytes(const softfocus_report* report) {
  if (report == nullptr) return 0;
  // The struct's contents do not matter: it is written.
  return struct_bytes("report", report, sizeof *report, SIZE_MAX);
}

template <class Named>
const char* text_of(std::span<const Named> things, std::size_t index,
                    std::string_view Named::*member) {
  return index < things.size() ? (things[index].*member).data() : nullptr;  // literals
}

}  // namespace
}  // namespace softfocus

const char* softfocus_version() { return SOFTFOCUS_VERSION; }

const char* softfocus_method_name(size_t index) { return text_of(methods(), index, &Method::name); }
const char* softfocus_method_summary(size_t index) {
  return text_of(methods(), index, &Method::summary);
}
const char* softfocus_profile_name(size_t index) {
  return text_of(profiles(), index, &NamedProfile::name);
}
const char* softfocus_profile_summary(size_t index) {
  return text_of(profiles(), index, &NamedProfile::summary);
}

int softfocus_open(softfocus_context** context, int threads) {
  if (context == nullptr) return SOFTFOCUS_BAD_ARGUMENT;
  *context = nullptr;
  if (threads < 0 || threads > SOFTFOCUS_MOST_THREADS) return SOFTFOCUS_BAD_ARGUMENT;
  try {
    *context = new softfocus_context(threads == 0 ? hardware_threads() : threads);
    return SOFTFOCUS_OK;
  } catch (const std::bad_alloc&) {
    return SOFTFOCUS_NO_MEMORY;
  } catch (...) {
    return SOFTFOCUS_FAILED;
  }
}

void softfocus_close(softfocus_context* context) { delete context; }

const char* softfocus_message(const softfocus_context* context) {
  return context != nullptr ? context->message.data() : "there is no context (a null pointer)";
}

void softfocus_init_settings(softfocus_settings* settings, size_t struct_size) {
  if (settings == nullptr || struct_size < sizeof(size_t)) return;
  const softfocus_settings ours = default_settings();
  give_struct(&ours, sizeof ours, settings, struct_size);
}

int softfocus_refocus(softfocus_context* context, const softfocus_picture* picture,
                      const softfocus_settings* settings, const softfocus_target* target,
                      softfocus_report* report) {
  return guarded(context, [&](ThreadPool& pool) {
    const std::size_t bytes = report_bytes(report);
    const Work work = prepared(picture, settings, report != nullptr, pool);
    const ConstImageView& scene = work.frame.scene.view;
    const ResultTarget result_target{target, scene.width, scene.height};
    Image own;
    const ImageView result = result_target.place(work.frame, own);
    apply(*work.method, input_of(work), result, pool);
    result_target.finish(result, pool);
    if (report != nullptr) give_struct(&work.report, sizeof work.report, report, bytes);
  });
}

int softfocus_plan(softfocus_context* context, const softfocus_picture* picture,
                   const softfocus_settings* settings, softfocus_report* report) {
  return guarded(context, [&](ThreadPool& pool) {
    const std::size_t bytes = report_bytes(report);
    if (report == nullptr) refuse("report", "a null pointer");
    const Work work = prepared(picture, settings, true, pool);
    give_struct(&work.report, sizeof work.report, report, bytes);
  });
}
