#include "tools/render/render_by_rows.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>

#include "raster/images/image.h"
#include "scenes/frame/frame_rows.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/pictures/picture_rows.h"
#include "tools/render/picture_files.h"

namespace softfocus {
namespace {

/// From so many pixels on memory counts more than a few per cent of time.
constexpr std::int64_t kLargePixels = std::int64_t{1} << 22;

/// The circles that are cut, of bands.
class CutCircles {
 public:
  CutCircles(const RenderOptions& options, const UsedLens& lens, ThreadPool& pool)
      : options_(options), lens_(lens), pool_(pool) {}

  void add(const ConstImageView& drawn) {
    const CircleSizes sizes = cut_circles(drawn, lens_, pool_);
    all_.largest_px = std::max(all_.largest_px, sizes.largest_px);
    all_.beyond_limit += sizes.beyond_limit * drawn.height / options_.size.height;
  }
  std::string warning() const { return cut_warning(all_, options_, lens_); }

 private:
  const RenderOptions& options_;
  const UsedLens& lens_;
  ThreadPool& pool_;
  CircleSizes all_{};
};

}  // namespace

bool may_render_by_rows(const RenderOptions& options) {
  std::error_code error;
  const auto output = std::filesystem::status(options.output, error);
  const bool is_file = options.output != "-" && (!std::filesystem::exists(output) ||
                                                 std::filesystem::is_regular_file(output));
  return is_file && is_written_by_rows(options.format) && options.gl == nullptr && !options.shard &&
         !options.depth_output && !options.sequence.frames &&
         std::int64_t{options.size.width} * options.size.height >= kLargePixels;
}

void render_by_rows(const RenderOptions& options, const Shot& shot, RenderRecord& record,
                    std::vector<std::string>& warnings,
                    const std::function<void(FrameStage)>& on_stage, ThreadPool& pool) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  std::optional<FrameRows> rows;
  try {
    rows.emplace(shot, pool, on_stage);
  } catch (const LensError& error) {
    refuse_lens(error, options);
  }
  const Frame& frame = rows->frame();
  record.frame.view = frame.view;
  record.frame.lens = frame.lens;
  record.frame.method = frame.method;
  record.frame.sampling = frame.sampling;
  record.frame.samples = frame.samples;
  record.camera.position = frame.view.eye;
  record.camera.target = target_at(shot.scene->camera, shot.frame);

  std::optional<CutCircles> cut;
  if (frame.lens && cuts_by_default(options)) cut.emplace(options, *frame.lens, pool);
  Hash hash = begin_image_hash(Format::rgba16f, shot.width, shot.height);
  Image band;
  PictureToWrite picture{shot.width, shot.height, [&](Rows of) {
                           rows->make(of.count, band, [&](const ConstImageView& drawn) {
                             if (cut) cut->add(drawn);
                           });
                           add_rows_to_hash(hash, band);
                           return PictureBand{.picture = band};
                         }};
  PictureNotes notes = notes_of(options, record);
  PictureExtras extras{.pool = &pool};
  if (notes.lens) extras.lens = notes.lens->lens;
  picture.notes = json_text(notes_json(notes));
  picture.notes_after = [&] {
    notes.picture_hash = hash.value;
    return json_text(notes_json(notes));
  };
  WholeFile file{options.output};
  write_picture_rows(picture, options.format, extras,
                     [&file](std::uint64_t place, std::span<const std::byte> bytes) {
                       file.write_at(place, bytes);
                     });
  notes.picture_hash = record.picture_hash = hash.value;
  record.ms.encode = std::chrono::duration<double, std::milli>(Clock::now() - begun).count() -
                     record.ms.draw - record.ms.focus - record.ms.filter;
  if (cut) warnings.push_back(cut->warning());
  std::optional<WholeFile> sidecar_file;
  const auto sidecar = sidecar_place(options);
  if (sidecar && is_free_for_sidecar(*sidecar)) {
    sidecar_file.emplace(*sidecar).write(sidecar_text(notes, file.written()));
  } else if (sidecar) {
    warnings.push_back(busy_sidecar_warning(*sidecar));
  }
  std::optional<WholeFile> report;
  if (options.report) report.emplace(*options.report).write(text_report(options, record));
  file.commit();
  if (sidecar_file) sidecar_file->commit();
  if (report) report->commit();
}

}  // namespace softfocus
