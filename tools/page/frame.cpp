// frame and pixel: the picture, and what it is at a place.

#include <cmath>

#include "dof/lens.h"
#include "raster/images/texel.h"
#include "tools/cli/errors.h"
#include "tools/page/drawing.h"
#include "tools/page/picture.h"
#include "tools/page/requests.h"
#include "tools/page/scene_text.h"
#include "tools/page/screen.h"

namespace softfocus {
namespace {

constexpr double kMostSliceMs = 60000.0;

/// The lens in the numbers of the thesis's equations; dof/lens.h has them.
void add_lens_figures(Json& reply, const UsedLens& used, const Drawn& drawn, ThreadPool& pool) {
  const ThinLens& lens = used.lens;
  const double film_mm = film_height_mm(lens, drawn.camera.fov_y_degrees);
  const double sharp_mm = film_mm / drawn.picture().height;
  const SharpRange sharp = sharp_range(lens, sharp_mm);
  const CircleSizes sizes =
      circle_sizes(drawn.picture(), used.settings.coc, used.settings.max_coc_px, pool);
  add_lens(reply, lens, used.coc_scale);
  reply["aperture_mm"] = aperture_mm(lens);
  reply["image_distance_mm"] = image_distance_mm(lens, lens.focus_m);
  reply["film_height_mm"] = film_mm;
  reply["largest_sharp_coc_mm"] = sharp_mm;
  reply["near_limit_m"] = sharp.near_m;
  reply["far_limit_m"] = number_or_null(sharp.far_m);  // null: infinity
  reply["hyperfocal_m"] = hyperfocal_m(lens, sharp_mm);
  reply["radius_at_infinity_px"] = used.settings.coc.radius_at_infinity_px;
  reply["largest_coc_px"] = sizes.largest_px;
  reply["cut_share"] = sizes.beyond_limit;
  reply["max_coc_px"] = used.settings.max_coc_px;
}

ShownFrame scene_frame(Page& page, const FrameSettings& settings, const Json& request) {
  ShownFrame shown{.drawn = drawn_picture(page, settings),
                   .settings = settings,
                   .lens = {},
                   .picture = {},
                   .flip = {},
                   .refocused = {}};
  stop_if_cancelled(page);
  const Drawn& drawn = *shown.drawn;
  const Shot shot = shot_of_drawn(page, drawn, settings);
  if (shot.lens) shown.lens = used_lens(page, drawn, settings, shot);
  std::optional<double> slice_ms;
  if (const Json* ms = given(request, "slice_ms")) {
    slice_ms = checked_number(*ms, "slice_ms", 0.0, kMostSliceMs);
  }
  const std::string text = json_text(request);
  if (!page.begun || page.begun->request != text || page.begun->drawn != shown.drawn) {
    page.begun = {.request = text, .drawn = shown.drawn, .memory = {.is_last = !slice_ms}};
  }
  BegunFrame& begun = *page.begun;
  const auto start = std::chrono::steady_clock::now();
  try {
    shown.picture = made_picture(page, drawn, shot, shown.lens, begun.memory, slice_ms);
  } catch (const Interrupted&) {
    begun.ms += milliseconds_since(start);
    throw;
  } catch (...) {
    page.begun.reset();
    throw;
  }
  shown.filter_ms = begun.ms + milliseconds_since(start);
  page.begun.reset();
  return shown;
}

/// Puts a map's numbers: circles' signed radii in pixels of this size, or depths in metres. False:
/// what is shown is no such map.
bool put_map_numbers(const ShownFrame& shown, Pixels& pixels) {
  const Image& picture = shown.drawn->picture();
  const auto depth_at = [&](int x, int y) { return load_texel<Format::rgba16f>(picture, x, y).w; };
  if (shown.settings.show == Show::depth) {
    put_numbers(picture.width, picture.height, depth_at, pixels);
    return true;
  }
  if (shown.settings.show != Show::coc || !shown.lens) return false;
  const PixelCoc& coc = shown.lens->settings.coc;
  put_numbers(
      picture.width, picture.height,
      [&](int x, int y) { return coc_radius_px(coc, depth_at(x, y)); }, pixels);
  return true;
}

}  // namespace

Json answer_frame(Page& page, const Json& request) {
  const FrameSettings settings = read_frame_settings(request);
  const bool is_picture = page.opened && page.opened->picture;
  ShownFrame shown =
      is_picture ? refocused_frame(page, settings) : scene_frame(page, settings, request);
  const Drawn& drawn = *shown.drawn;
  if (settings.hash) shown.hash = hash_image(shown.picture);
  Json reply{{"width", shown.picture.width},
             {"height", shown.picture.height},
             {"hash", settings.hash ? Json(hash_text(shown.hash)) : Json(nullptr)},
             {"draw_ms", drawn.ms},
             {"filter_ms", shown.filter_ms},
             {"command", command_text(*page.opened, settings)}};
  if (drawn.shadows) {
    reply["shadows"] = {
        {"triangles", triangle_count(*drawn.scene)}, {"casters", drawn.shadows->casters},
        {"receivers", drawn.shadows->receivers},     {"projected", drawn.shadows->projected},
        {"volumes", drawn.shadows->volumes},         {"ms", drawn.shadows_ms}};
  }
  if (is_picture) {
    add_refocus_figures(reply, shown);
  } else if (shown.lens) {
    add_lens_figures(reply, *shown.lens, drawn, *page.pool);
  }
  const Json* numbers = given(request, "numbers");
  const bool wants_numbers = numbers != nullptr && numbers->boolean();
  reply["numbers"] = wants_numbers && put_map_numbers(shown, page.pixels);
  if (!reply["numbers"].boolean()) show_on_screen(shown.picture, page.pixels, *page.pool);
  page.shown = std::move(shown);
  return reply;
}

Json answer_pixel(Page& page, const Json& request) {
  if (!page.shown) throw UsageError("there is no frame yet; the request 'frame' makes one");
  const ShownFrame& shown = *page.shown;
  const Image& picture = shown.drawn->picture();
  const auto x = static_cast<int>(checked_number(request.at("x"), "x", 0, picture.width - 1));
  const auto y = static_cast<int>(checked_number(request.at("y"), "y", 0, picture.height - 1));
  const float depth_m = load_texel<Format::rgba16f>(picture, x, y).w;
  const glm::vec4 colour = load_texel<Format::rgba16f>(shown.picture, x, y);
  const bool has_depth = !page.opened->picture || !page.opened->picture->options.circles;
  Json reply{{"depth_m", number_or_null(static_cast<double>(depth_m))},
             {"has_depth", has_depth},
             {"coc_radius_px", nullptr},
             {"coc_on_film_mm", nullptr},
             {"colour_linear", std::array{colour.x, colour.y, colour.z}}};
  if (shown.lens) {
    const auto radius_px = static_cast<double>(coc_radius_px(shown.lens->settings.coc, depth_m));
    reply["coc_radius_px"] = number_or_null(radius_px);
    reply["coc_on_film_mm"] =
        number_or_null(coc_on_film_mm(shown.lens->lens, static_cast<double>(depth_m)));
  }
  return reply;
}

}  // namespace softfocus
