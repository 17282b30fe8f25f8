#include "tools/refocus/refocus_by_rows.h"

#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "dof/two_pass/two_pass_stream.h"
#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"
#include "tools/pictures/picture_rows.h"
#include "tools/refocus/depth/mend_depth.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/refocus/refocused.h"

namespace softfocus {
namespace {

/// Which of it is wanted.
struct WantedRows {
  bool colour = false, alpha = false, depth = false;
};

class SourceRows {
 public:
  /// Needs the sources as long as it lives.
  SourceRows(const PictureSources& sources, const WantedRows& wanted);

  /// Throws FileError; UsageError for a depth of three channels that differ.
  void read(Rows rows);

  /// How many values of colours were cut so far.
  std::size_t cut() const { return halves_.cut(); }

  Image colour{};       ///< RGBA16F, of light; alpha is 0
  PlaneValues alpha{};  ///< as they are in the file
  PlaneValues codes{};  ///< of the depth

 private:
  /// Planes of one file, read together: they may lie in the same compressed blocks.
  struct Group {
    const PictureFile* file;
    std::vector<std::size_t> planes;
    std::vector<float> outside;  // of each plane
    ReadRows read;
    std::vector<PlaneValues> values;
  };
  struct Place {
    std::size_t group, plane;
  };

  Place want(const PictureFile& file, std::size_t plane, float outside);
  PlaneValues& values_of(Place place) { return groups_[place.group].values[place.plane]; }

  const PictureSources& sources_;
  ColourHalves halves_;
  std::vector<Group> groups_{};
  std::vector<Place> colour_{}, alpha_{}, depth_{};
};

SourceRows::SourceRows(const PictureSources& sources, const WantedRows& wanted)
    : sources_(sources), halves_(sources.colour_file, sources.colour, false) {
  const PictureFile& file = sources.colour_file;
  if (wanted.colour) {
    for (const std::size_t plane : halves_.planes()) colour_.push_back(want(file, plane, 0.0f));
  }
  if (wanted.alpha) alpha_.push_back(want(file, *sources.colour.alpha, 0.0f));
  if (wanted.depth) {
    const PictureFile& of_depth = sources.of_depth();
    for (const std::size_t plane : planes_of_depth(of_depth, sources.depth_plane)) {
      depth_.push_back(want(of_depth, plane, kNoDepthThere));
    }
  }
  for (Group& group : groups_) group.read = rows_of(*group.file, group.planes);
}

SourceRows::Place SourceRows::want(const PictureFile& file, std::size_t plane, float outside) {
  std::size_t at = 0;
  for (; at < groups_.size(); ++at) {
    const auto& planes = groups_[at].planes;
    // A plane that is wanted twice, as colour and as depth, is read twice.
    const bool is_free = std::find(planes.begin(), planes.end(), plane) == planes.end();
    if (groups_[at].file == &file && is_free) break;
  }
  if (at == groups_.size()) groups_.push_back({&file, {}, {}, {}, {}});
  Group& group = groups_[at];
  group.planes.push_back(plane);
  group.outside.push_back(outside);
  group.values.emplace_back();
  return {at, group.planes.size() - 1};
}

void SourceRows::read(Rows rows) {
  const int width = sources_.colour_file.width;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows.count);
  for (Group& group : groups_) {
    for (std::size_t i = 0; i < group.values.size(); ++i) {
      group.values[i].assign(pixels, group.outside[i]);
    }
    group.read(rows, group.values);
  }
  if (!colour_.empty()) {
    if (colour.height != rows.count) colour = make_image(Format::rgba16f, width, rows.count);
    for (std::size_t i = 0; i < colour_.size(); ++i) halves_.put(i, values_of(colour_[i]), colour);
  }
  if (!alpha_.empty()) alpha.swap(values_of(alpha_[0]));
  if (depth_.empty()) return;
  if (depth_.size() > 1) {
    std::vector<PlaneValues> all;
    for (const Place place : depth_) all.push_back(values_of(place));
    check_one_depth(sources_.of_depth(), all);
  }
  codes.swap(values_of(depth_[0]));
}

constexpr int kBandRows = 64;

/// Calls `work` with each band of a picture, from the top down.
template <class Work>
void for_each_band(int height, const Work& work) {
  for (int y = 0; y < height; y += kBandRows) work(Rows{y, std::min(kBandRows, height - y)});
}

/// Facts about a picture once its depths were looked at.
struct Survey {
  PhotoLens photo{};  ///< with what the file's header says
  ReadDepth depth{};  ///< its map has a size alone
  DepthReading reading{};
  FocusDepths focus;
  std::vector<bool> halves = std::vector<bool>(65536);  ///< the depths that the filter sees
  float nearest_m = std::numeric_limits<float>::infinity(), farthest_m = 0.0f;  ///< of these
  bool has_opacity = false, is_opaque = true;
  float full_alpha = 1.0f;  ///< the file's number for what is opaque
};

/// Kinds of alpha among the pixels.
struct AlphaSeen {
  bool is_alpha = true, is_opaque = true;
  void add(const PlaneValues& values, float whole) {
    for (const float value : values) {
      is_alpha = is_alpha && value >= 0.0f && value <= whole;
      is_opaque = is_opaque && value / whole >= 1.0f;
    }
  }
};

/// The encoding, as read_depth() settles it.
void survey_codes(const PictureSources& sources, const RefocusOptions& options, Survey& survey) {
  const PictureFile& file = sources.of_depth();
  const NumberType type = file.planes[sources.depth_plane].type;
  const bool is_ours = !sources.depth_file && sources.notes;
  const auto settle = [&] {
    settle_encoding(sources, options.reading, survey.depth);
    survey.reading = depth_reading(sources, options.reading, survey.photo, survey.depth);
  };
  if (options.reading.encoding == nullptr && !is_ours) {
    SourceRows rows{sources, {.depth = true}};
    NumberCounter counter{type};
    for_each_band(file.height, [&](Rows band) {
      rows.read(band);
      counter.add(rows.codes);
    });
    survey.depth.seen = counter.seen();
  }
  settle();
  if (!survey.depth.encoding->by_ends) return;
  SourceRows rows{sources, {.depth = true}};
  CodeEnds ends{type, survey.reading};
  for_each_band(file.height, [&](Rows band) {
    rows.read(band);
    ends.add(rows.codes, {});
  });
  ends.put_in(survey.reading.numbers);
  survey.depth.numbers = survey.reading.numbers;
}

/// Depths of a band of rows.
DepthMap depths_of(const PictureSources& sources, const Survey& survey, PlaneValues codes,
                   Rows rows) {
  const PictureFile& file = sources.of_depth();
  codes_to_depths(codes, file.planes[sources.depth_plane].type, rows.first, file.width, file.height,
                  survey.reading, {});
  return {file.width, rows.count, std::move(codes)};
}

/// False, with the reason in `why`, if the whole picture is needed.
bool survey_depths(const PictureSources& sources, const RefocusOptions& options, Survey& survey,
                   std::string& why) {
  const PictureFile& file = sources.colour_file;
  const bool has_alpha = may_be_opacity(sources);
  if (has_alpha) {
    survey.full_alpha = static_cast<float>(full_scale(file.planes[*sources.colour.alpha].type));
  }
  AlphaSeen alpha;
  const bool may_be_whole = file.height <= kMaxImageSize && may_be_bright(file, sources.colour);
  SourceRows rows{sources, {.colour = may_be_whole, .alpha = has_alpha, .depth = true}};
  for_each_band(file.height, [&](Rows band) {
    rows.read(band);
    alpha.add(rows.alpha, survey.full_alpha);
    DepthMap map = depths_of(sources, survey, std::exchange(rows.codes, {}), band);
    survey.depth.filled += missing_depths(map);
    add_to_ends(survey.depth.ends, map.metres);
    survey.focus.add(map.metres, band.first);
    move_to_seen(map, options.photo.focus_range);
    for (const float metres : map.metres) {
      survey.halves[float_to_half(metres, HalfRounding::nearest_even)] = true;
      survey.nearest_m = std::min(survey.nearest_m, metres);
      survey.farthest_m = std::max(survey.farthest_m, metres);
    }
  });
  survey.has_opacity = has_alpha && (alpha.is_alpha || is_sure_of_alpha(file));
  survey.is_opaque = !survey.has_opacity || alpha.is_opaque;
  if (rows.cut() > 0) {
    why = "it has colours beyond the largest half";
    return false;
  }
  if (survey.depth.filled == 0) return true;
  why = std::to_string(survey.depth.filled) +
        " pixels have no depth, and are filled from around them";
  return false;
}

/// Whether so large circles make the rows in the filter larger than the whole picture. A few bytes
/// more do not matter.
bool is_larger_by_rows(const PictureFile& file, const DofSettings& settings, Isa isa) {
  constexpr std::uint64_t kFew = std::uint64_t{64} << 20, kBytesPerPixel = 20;
  const std::uint64_t whole = kBytesPerPixel * static_cast<std::uint64_t>(file.width) *
                              static_cast<std::uint64_t>(file.height);
  return file.height <= kMaxImageSize &&
         two_pass_stream_bytes(file.width, settings, isa) > std::max(whole, kFew);
}

/// A picture that has each depth of another.
Image picture_of_depths(const std::vector<bool>& halves) {
  constexpr int kSide = 256;
  Image picture = make_image(Format::rgba16f, kSide, kSide);
  auto last =
      static_cast<std::uint16_t>(std::find(halves.begin(), halves.end(), true) - halves.begin());
  for (int y = 0; y < kSide; ++y) {
    const auto to = row<std::uint16_t>(picture, y);
    for (std::size_t x = 0; x < kSide; ++x) {
      const auto half = static_cast<std::uint16_t>(static_cast<std::size_t>(y) * kSide + x);
      if (halves[half]) last = half;
      to[4 * x + 3] = last;
    }
  }
  return picture;
}

/// The filtered picture, made in bands as its writer asks for them.
class FilteredRows {
 public:
  FilteredRows(const PictureSources& sources, const RefocusOptions& options, const Survey& survey,
               const UsedRefocus& used, const std::optional<FinerLens>& finer, ThreadPool& pool)
      : sources_(sources),
        options_(options),
        survey_(survey),
        used_(used),
        finer_(finer),
        pool_(pool),
        rows_(sources, {.colour = true, .alpha = !survey.is_opaque, .depth = true}),
        stream_(sources.colour_file.width, used.settings, options.profile, pool.isa()),
        hash_(begin_image_hash(Format::rgba16f, sources.colour_file.width,
                               sources.colour_file.height)) {
    if (!survey.is_opaque && is_of_exr(options.format)) {
      opacity_stream_.emplace(sources.colour_file.width, used.settings, options.profile,
                              pool.isa());
    }
  }

  PictureBand make(Rows rows) {
    while (finished_.size() < static_cast<std::size_t>(rows.count)) filter_next_band();
    depth_ = {sources_.colour_file.width, rows.count, {}};
    for (int y = 0; y < rows.count; ++y) {
      depth_.metres.insert(depth_.metres.end(), depths_.front().begin(), depths_.front().end());
      depths_.pop_front();
    }
    if (opacity_stream_) {
      take(finished_opacity_, rows.count, picture_);
      opacity_ = opacity_of(picture_);
    }
    take(finished_, rows.count, picture_);
    if (options_.highlights) lower_highlights(*options_.highlights, opacity_, picture_);
    put_depth_in_alpha(options_, depth_.metres, picture_);
    add_rows_to_hash(hash_, picture_);
    if (!is_of_exr(options_.format)) return {picture_};
    if (survey_.has_opacity && !opacity_stream_) opacity_.assign(depth_.metres.size(), 1.0f);
    radii_px_ = circle_radii(depth_, used_);
    return {picture_, opacity_, depth_.metres, radii_px_};
  }

  std::uint64_t hash() const { return hash_.value; }
  std::size_t cut() const { return rows_.cut(); }

 private:
  using FinishedRows = std::deque<std::vector<std::uint16_t>>;

  void take(FinishedRows& from, int rows, Image& to) const {
    if (to.height != rows) to = make_image(Format::rgba16f, sources_.colour_file.width, rows);
    for (int y = 0; y < rows; ++y) {
      std::copy(from.front().begin(), from.front().end(), row<std::uint16_t>(to, y).begin());
      from.pop_front();
    }
  }

  void filter(TwoPassStream& stream, const Image& band, FinishedRows& to) {
    const RowSink sink = [&to](std::span<const std::uint16_t> row) {
      to.emplace_back(row.begin(), row.end());
    };
    for (int y = 0; y < band.height; ++y) {
      put_row(stream, row<std::uint16_t>(band, y), pool_, sink);
    }
    if (next_ == sources_.colour_file.height) end_rows(stream, pool_, sink);
  }

  void filter_next_band() {
    const int width = sources_.colour_file.width, height = sources_.colour_file.height;
    const Rows band{next_, std::min(kBandRows, height - next_)};
    next_ += band.count;
    rows_.read(band);
    DepthMap map = depths_of(sources_, survey_, std::exchange(rows_.codes, {}), band);
    for (auto from = map.metres.begin(); from != map.metres.end(); from += width) {
      depths_.emplace_back(from, from + width);
    }
    move_to_seen(map, used_.lens.range);
    if (finer_) to_finer_depths(map.metres, *finer_);
    put_in_alpha(map.metres, rows_.colour);
    if (!survey_.is_opaque) {
      take_opacity(sources_.colour_file, survey_.full_alpha, rows_.alpha, rows_.colour);
    }
    // Without a place for it in the file, opacity ends here.
    const PlaneValues opacity = opacity_stream_ ? std::exchange(rows_.alpha, {}) : PlaneValues{};
    if (options_.highlights) raise_highlights(*options_.highlights, opacity, rows_.colour);
    filter(stream_, rows_.colour, finished_);
    if (opacity_stream_) {
      filter(*opacity_stream_, opacity_picture(opacity, rows_.colour), finished_opacity_);
    }
  }

  const PictureSources& sources_;
  const RefocusOptions& options_;
  const Survey& survey_;
  const UsedRefocus& used_;
  std::optional<FinerLens> finer_;
  ThreadPool& pool_;
  SourceRows rows_;
  TwoPassStream stream_;
  std::optional<TwoPassStream> opacity_stream_{};  // of the same reach: rows come out together
  Hash hash_;
  int next_ = 0;  // row to read
  FinishedRows finished_{}, finished_opacity_{};
  std::deque<std::vector<float>> depths_{};  // of the rows in the filter and in finished_
  Image picture_{};
  DepthMap depth_{};
  PlaneValues opacity_{}, radii_px_{};
};

/// The picture and its sidecar.
void write_files(const RefocusOptions& options, const PictureSources& sources, const Survey& survey,
                 const UsedRefocus& used, FilteredRows& rows, Refocused& made,
                 std::uint64_t& hash) {
  const int width = sources.colour_file.width, height = sources.colour_file.height;
  PictureNotes notes = refocus_notes(options, used, width, height, 0);
  const std::vector<std::size_t> kept = kept_planes(options, sources);
  PictureToWrite picture{width, height, [&rows](Rows band) { return rows.make(band); }};
  PictureExtras extras;
  constexpr std::array kSome{0.0f};
  if (is_of_exr(options.format)) {
    extras.depth_m = extras.radii_px = kSome;
    extras.has_depth = !options.circles;
    if (survey.has_opacity) extras.alpha = kSome;
    if (sources.colour_file.reader == &kExrReader) extras.source = &sources.colour_file;
    extras.kept = kept;
    if (options.keep_layers) extras.view = sources.view;
    if (notes.lens) extras.lens = notes.lens->lens;
    picture.notes = json_text(notes_json(notes));
    picture.notes_after = [&] {
      notes.picture_hash = rows.hash();
      return json_text(notes_json(notes));
    };
  }
  WholeFile file{options.output};
  write_picture_rows(picture, options.format, extras,
                     [&file](std::uint64_t place, std::span<const std::byte> bytes) {
                       file.write_at(place, bytes);
                     });
  hash = notes.picture_hash = rows.hash();
  const auto sidecar = sidecar_place(options.output, options.format);
  std::optional<WholeFile> sidecar_file;
  if (sidecar && is_free_for_sidecar(*sidecar)) {
    sidecar_file.emplace(*sidecar).write(sidecar_text(notes, file.written()));
  } else if (sidecar) {
    made.warnings.push_back(busy_sidecar_warning(*sidecar));
  }
  if (!survey.is_opaque && !keeps_alpha(options.format)) {
    made.warnings.push_back(lost_alpha_warning(options.colour));
  }
  file.commit();
  if (sidecar_file) sidecar_file->commit();
}

}  // namespace

std::string reason_for_whole(const RefocusOptions& options) {
  std::error_code error;
  const auto output = std::filesystem::status(options.output, error);
  if (options.method.is_auto()) return "--method auto looks at all of it";
  if (options.method.name() != "two-pass" && !options.method_by_size) {
    return "--method " + std::string{options.method.name()} + " has no other form";
  }
  if (options.arithmetic != Arithmetic::floats) return "--arithmetic has no other form";
  if (options.show != RefocusShow::image) return "--show has no other form";
  if (options.border != Border::by_method) return "--border makes it larger";
  if (options.unmix) return "--unmix-edges looks around each pixel";
  if (options.reading.mask) return "--mask is read whole";
  if (options.reading.mending.edges) return "--mend-edges looks around each pixel";
  if (options.reading.mending.bands) return "--mend-bands looks around each pixel";
  if (options.output == "-") return "standard output gets it at once";
  if (!is_written_by_rows(options.format)) return "PNG is written whole";
  if (std::filesystem::exists(output) && !std::filesystem::is_regular_file(output)) {
    return "'" + options.output + "' is no regular file";
  }
  return {};
}

std::optional<Refocused> refocus_by_rows(const RefocusOptions& options, Progress& progress,
                                         ThreadPool& pool, std::string& why) {
  const std::optional<PictureSources> sources =
      open_sources_on_disk(options.colour, options.depth, options.reading, why);
  if (!sources) return std::nullopt;
  const PictureFile& file = sources->colour_file;
  if (options.method_by_size) {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(file.width) * static_cast<std::uint64_t>(file.height);
    if (pixels * kWholeBytesPerPixel <= memory_bytes().value_or(~std::uint64_t{0}) &&
        file.height <= kMaxImageSize) {
      why = "--method " + std::string{options.method.name()} + " has no other form";
      return std::nullopt;
    }
    RefocusOptions by_rows = options;
    by_rows.method = find_method_choice("two-pass");
    by_rows.method_by_size = false;
    return refocus_by_rows(by_rows, progress, pool, why);
  }
  if (!sources->views.empty()) why = "it has several views";
  if (file.pixel_aspect != 1.0) why = "its pixels are not square";
  if (box_of(file) != file.shown && !keeps_data_window(options, *sources)) {
    why = "its data window is cut";
  }
  if (!why.empty()) return std::nullopt;
  progress.show("reading the depth");
  PhotoLens photo = with_sources(options.photo, *sources);
  Survey survey{.photo = photo, .focus = {photo, file.width, file.height}};
  survey.depth.width = survey.depth.map.width = file.width;
  survey.depth.height = survey.depth.map.height = file.height;
  survey_codes(*sources, options, survey);
  if (!survey_depths(*sources, options, survey, why)) {
    if (file.height <= kMaxImageSize) return std::nullopt;
    throw UsageError("'" + options.colour + "' is " + size_text({file.width, file.height}) +
                     " pixels, and more than " + std::to_string(kMaxImageSize) +
                     " rows are read in bands alone; but " + why);
  }
  if (options.circles) photo.circles = coc_of_circles(survey.depth.numbers);
  UsedRefocus used{.by_rows = true};
  used.lens =
      settle_lens(photo, sources->notes, options.reading.numbers.focal_px, std::move(survey.focus));
  begin_settings(options, used);
  settle_largest_circle(picture_of_depths(survey.halves), options, used, pool);
  if (is_larger_by_rows(file, used.settings, pool.isa())) {
    why = "circles of " + short_number(static_cast<double>(used.settings.max_coc_px)) +
          " pixels radius take more memory by rows";
    return std::nullopt;
  }
  const std::optional<FinerLens> finer =
      finer_lens(survey.nearest_m, survey.farthest_m, used.settings.coc);
  if (finer) used.settings.coc = finer->coc;

  progress.show("filtering");
  FilteredRows rows{*sources, options, survey, used, finer, pool};
  Refocused made;
  std::uint64_t hash = 0;
  write_files(options, *sources, survey, used, rows, made, hash);
  used.cut = rows.cut();
  tell(options, *sources, survey.depth, used, hash, made);
  return made;
}

}  // namespace softfocus
