#include "tools/page/picture.h"

#include <algorithm>

#include "raster/images/texel.h"
#include "tools/cli/errors.h"
#include "tools/page/drawing.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/refocus/report.h"

namespace softfocus {
namespace {

template <class Choices, class Value>
void read_choice(const Json& request, std::string_view key, const Choices& choices, Value& place) {
  const Json* name = given(request, key);
  if (name == nullptr) return;
  const auto found = std::find_if(choices.begin(), choices.end(),
                                  [&](const auto& choice) { return choice.name == name->text(); });
  if (found == choices.end()) {
    throw UsageError(std::string{key} + " '" + name->text() + "': there are " + names_of(choices));
  }
  place = found->value;
}

DepthOptions read_reading(const Json& request) {
  DepthOptions reading;
  if (const Json* name = given(request, "encoding")) {
    const DepthEncoding& circles = circles_encoding();
    reading.encoding = name->text() == circles.name ? &circles : find_depth_encoding(name->text());
    if (reading.encoding == nullptr) {
      throw UsageError("encoding '" + name->text() + "': there are " + names_of(depth_encodings()) +
                       ", " + std::string{circles.name});
    }
  }
  read_choice(request, "holes", kHoles, reading.holes);
  read_choice(request, "depth_fit", kDepthFits, reading.fit);
  for (const OfDepth& of : kDepthNumbers) {
    if (const Json* value = given(request, key_of(of.number))) {
      reading.numbers.*of.place = checked_number(*value, of.number);
    }
  }
  return reading;
}

/// A clause that says what is missing before the depth can be read, or nothing.
std::string lacking(const BelievedEncoding& believed, const DepthNumbers& numbers) {
  if (believed.encoding == nullptr) return believed.why + "; choose what its numbers mean";
  try {
    check_depth_numbers(*believed.encoding, numbers);
  } catch (const UsageError& error) {
    const std::string_view needs = believed.encoding->needs;
    const bool has_near = numbers.near_m.has_value(), has_far = numbers.far_m.has_value();
    const bool is_reversed = has_near && has_far && !(*numbers.near_m < *numbers.far_m);
    if (needs.empty() || is_reversed) return error.what();
    std::string names;
    for (const char letter : needs) names += letter == ' ' ? ", " : std::string(1, letter);
    return std::string{believed.encoding->name} + " needs numbers: " + names;
  }
  return {};
}

/// Every `step`-th pixel of every `step`-th row.
Image thinned(const Image& picture, int step) {
  Image thin = make_image(picture.format, std::max(1, picture.width / step),
                          std::max(1, picture.height / step));
  for (int y = 0; y < thin.height; ++y) {
    const auto from = row<std::uint16_t>(picture, y * step);
    const auto to = row<std::uint16_t>(thin, y);
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = from[(i - i % 4) * static_cast<std::size_t>(step) + i % 4];
    }
  }
  return thin;
}
std::vector<float> thinned(const std::vector<float>& values, const Image& picture, int step) {
  std::vector<float> thin;
  if (values.empty()) return thin;
  for (int y = 0; y < std::max(1, picture.height / step); ++y) {
    for (int x = 0; x < std::max(1, picture.width / step); ++x) {
      thin.push_back(
          values[static_cast<std::size_t>(y * step) * static_cast<std::size_t>(picture.width) +
                 static_cast<std::size_t>(x * step)]);
    }
  }
  return thin;
}

std::shared_ptr<const Drawn> as_drawn(Image picture) {
  auto drawn = std::make_shared<Drawn>();
  drawn->frame.parts.opaque = std::move(picture);
  return drawn;
}

const PictureAtSize& at_size(OpenedPicture& opened, int preview) {
  if (preview == 1) return opened.whole;
  if (opened.coarse && opened.coarse->preview == preview) return *opened.coarse;
  const PictureAtSize& whole = opened.whole;
  const Image& picture = whole.drawn->picture();
  Image thin = thinned(picture, preview);
  DepthMap depth{thin.width, thin.height, thinned(whole.depth.metres, picture, preview)};
  opened.coarse = {.preview = preview,
                   .drawn = as_drawn(std::move(thin)),
                   .opacity = thinned(whole.opacity, picture, preview),
                   .depth = std::move(depth)};
  return *opened.coarse;
}

Json reading_json(const OpenedPicture& opened, const BelievedEncoding& believed,
                  const NumbersSeen& seen) {
  const PictureFile& file = opened.sources.of_depth();
  const PlaneInfo& plane = file.planes[opened.sources.depth_plane];
  const DepthEncoding* encoding = opened.options.reading.encoding != nullptr
                                      ? opened.options.reading.encoding
                                      : believed.encoding;
  Json json{{"width", opened.whole.drawn->picture().width},
            {"height", opened.whole.drawn->picture().height},
            {"depth_channel", plane.name},
            {"type", name_of(plane.type)},
            {"least", seen.least},
            {"largest", seen.largest},
            {"encoding", nullptr},
            {"believed", nullptr},
            {"why", believed.why},
            {"lacks", opened.lacks},
            {"line", nullptr}};
  if (encoding != nullptr) json["encoding"] = encoding->name;
  if (believed.encoding != nullptr) json["believed"] = believed.encoding->name;
  if (opened.reading) {
    json["line"] = depth_line(opened.options, opened.sources, *opened.reading, {});
  }
  return json;
}

/// A depth of another shape is there all the same, stretched; `lacks` says that it must be asked
/// for.
PictureSources found_sources(const RefocusOptions& options, std::string& lacks) {
  try {
    return open_sources(options.colour, options.depth, options.reading);
  } catch (const UsageError& error) {
    if (options.reading.fit) throw;
    DepthOptions stretched = options.reading;
    stretched.fit = DepthFit::stretch;
    PictureSources sources = open_sources(options.colour, options.depth, stretched);
    lacks = error.what();
    return sources;
  }
}

/// As `refocus` begins with.
NotedLens first_lens(const PictureSources& sources) {
  if (sources.notes && sources.notes->lens) return *sources.notes->lens;
  NotedLens first;
  first.lens.focal_length_mm = sources.lens.focal_length_mm.value_or(first.lens.focal_length_mm);
  first.lens.f_number = sources.lens.f_number.value_or(first.lens.f_number);
  return first;
}

int pixel_of(double part, int count) { return std::min(static_cast<int>(part * count), count - 1); }

RefocusOptions options_of(const OpenedPicture& opened, const FrameSettings& settings) {
  if (settings.method.of_scene != nullptr) {
    throw UsageError("method " + std::string{settings.method.name()} +
                     ": it draws a scene anew, and there is a picture alone; choose a filter");
  }
  RefocusOptions options = opened.options;
  options.method = settings.method;
  options.show = settings.show == Show::coc     ? RefocusShow::coc
                 : settings.show == Show::depth ? RefocusShow::depth
                                                : RefocusShow::image;
  options.photo.lens = settings.lens;
  if (settings.focus_at) {
    const Image& picture = opened.whole.drawn->picture();
    options.photo.focus_at = Pixel{pixel_of(settings.focus_at->x, picture.width),
                                   pixel_of(settings.focus_at->y, picture.height)};
  }
  options.max_coc_px = settings.max_coc_px;
  options.aperture = used_aperture(settings);
  options.highlights = settings.highlights;
  return options;
}

}  // namespace

OpenedWithReply open_picture(const Json& request, ThreadPool& pool) {
  auto picture = std::make_shared<OpenedPicture>();
  RefocusOptions& options = picture->options;
  options.colour = request.at("picture").text();
  if (const Json* depth = given(request, "depth")) options.depth = depth->text();
  options.reading = read_reading(request);
  if (options.reading.encoding == &circles_encoding()) {
    options.circles = options.depth.empty() ? options.colour : options.depth;
    read_circles(options);
  }
  PictureSources& sources = picture->sources;
  sources = found_sources(options, picture->lacks);
  options.photo = with_sources(options.photo, sources);
  const PictureFile& depth_file = sources.of_depth();
  PictureOnItsWay source{read_colour(sources.colour_file, sources.colour, false).image};
  source.opacity = take_opacity(sources, source.picture);

  const NumberType type = depth_file.planes[sources.depth_plane].type;
  const NumbersSeen seen = numbers_seen(depth_codes(depth_file, sources.depth_plane), type);
  const BelievedEncoding believed = believed_encoding(sources, seen);
  const DepthEncoding* chosen = options.reading.encoding;
  const BelievedEncoding used = chosen != nullptr ? BelievedEncoding{chosen, ""} : believed;
  if (picture->lacks.empty()) {
    picture->lacks = lacking(used, depth_numbers(sources, options.reading, used.encoding));
  }
  PictureAtSize& whole = picture->whole;
  if (picture->lacks.empty()) {
    picture->reading = read_depth(sources, source.picture, options.reading, options.photo, pool);
    whole.depth = std::move(picture->reading->map);
    if (options.circles) options.photo.circles = coc_of_circles(picture->reading->numbers);
    put_in_alpha(whole.depth.metres, source.picture);
  }
  whole.opacity = std::move(source.opacity);
  whole.drawn = as_drawn(std::move(source.picture));

  OpenedWithReply made{std::make_unique<Opened>(), {}};
  made.opened->source = options.colour;
  made.opened->scene.title = std::filesystem::path{options.colour}.filename().string();
  const NotedLens lens = first_lens(sources);
  made.reply = {{"title", made.opened->scene.title},
                {"warnings", Json::array()},
                {"triangles", 0},
                {"animation_frames", 0},
                {"camera", nullptr},
                {"lens", nullptr},
                {"autofocus", true},
                {"picture", reading_json(*picture, believed, seen)}};
  add_lens(made.reply["lens"], lens.lens, lens.coc_scale);
  if (picture->reading) {
    const std::string odd = odd_depth_warning(sources, *picture->reading);
    if (!odd.empty()) made.reply["warnings"].push_back(odd);
  }
  made.opened->picture = std::move(picture);
  return made;
}

ShownFrame refocused_frame(Page& page, const FrameSettings& settings) {
  OpenedPicture& opened = *page.opened->picture;
  const PictureAtSize& seen = at_size(opened, settings.preview);
  ShownFrame shown{.drawn = seen.drawn,
                   .settings = settings,
                   .lens = {},
                   .picture = {},
                   .flip = {},
                   .refocused = {}};
  RefocusedFrame frame{options_of(opened, settings), {}, {}};
  if (!opened.reading || settings.show == Show::pinhole) {
    shown.picture = seen.drawn->picture();
    return shown;
  }
  stop_if_cancelled(page);
  frame.used.lens = settle_lens(frame.options.photo, opened.sources.notes,
                                frame.options.reading.numbers.focal_px, opened.whole.depth);
  frame.used.lens.coc.radius_at_infinity_px /= static_cast<float>(settings.preview);
  const auto start = std::chrono::steady_clock::now();
  PictureOnItsWay result = refocused({seen.drawn->picture(), seen.opacity}, seen.depth,
                                     frame.options, frame.used, *page.pool);
  shown.filter_ms = milliseconds_since(start);
  shown.picture = std::move(result.picture);
  frame.opacity = std::move(result.opacity);
  const SettledLens& lens = frame.used.lens;
  shown.lens = UsedLens{lens.lens, lens.coc_scale, 0.0, frame.used.settings};
  // The filter's own may be an equal one with other depths.
  shown.lens->settings.coc = lens.coc;
  shown.refocused = std::make_shared<RefocusedFrame>(std::move(frame));
  return shown;
}

void add_refocus_figures(Json& reply, const ShownFrame& shown) {
  if (!shown.refocused) return;
  const SettledLens& lens = shown.refocused->used.lens;
  add_lens(reply, lens.lens, lens.coc_scale);
  reply["focus_from"] = lens.focus_from;
  reply["fov_y_degrees"] = lens.fov_y_degrees;
  reply["radius_at_infinity_px"] = lens.coc.radius_at_infinity_px;
  reply["largest_coc_px"] = shown.refocused->used.largest_circle_px;
  reply["max_coc_px"] = shown.refocused->used.settings.max_coc_px;
}

}  // namespace softfocus
