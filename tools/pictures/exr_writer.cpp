// OpenEXR files of ours, a band of rows at a time.

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiView.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <mutex>
#include <vector>

#include "raster/images/texel.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/exr_streams.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {
namespace {

/// OpenEXR has threads of its own, the whole program's, which wait for its next file.
void want_exr_threads(int count) {
  static std::mutex mutex;
  const std::scoped_lock lock{mutex};
  if (count > Imf::globalThreadCount()) Imf::setGlobalThreadCount(count);
}

/// Rows that are written at a time: those of the largest block, or fewer, so that a hundred layers
/// take no more than a few.
int band_rows(std::size_t planes, int width) {
  constexpr std::size_t kMostValues = std::size_t{1} << 23;
  int rows = 256;
  while (rows > 16 && planes * static_cast<std::size_t>(width * rows) > kMostValues) rows /= 2;
  return rows;
}

std::size_t bytes_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// A channel on its way: `fill` writes the `rows` rows from `y` on.
struct ExrPlane {
  std::string name;
  Imf::PixelType type;
  std::function<void(int y, int rows, std::byte* to)> fill;
};

/// Calls `make` before the planes of a band are filled.
void write_planes(const std::vector<ExrPlane>& planes, const PictureToWrite& picture,
                  Imf::Header header, const std::function<void(Rows rows)>& make,
                  const WriteAt& write, ThreadPool* pool = nullptr) {
  const int width = picture.width, height = picture.height;
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const ExrPlane& plane : planes) header.channels().insert(plane.name, {plane.type});
  if (!picture.notes.empty()) header.insert("softfocus", Imf::StringAttribute(picture.notes));
  const int band = band_rows(planes.size(), width);
  std::vector<std::vector<std::byte>> bands;
  bands.reserve(planes.size());
  for (const ExrPlane& plane : planes) {
    bands.emplace_back(bytes_of(plane.type) * static_cast<std::size_t>(width) *
                       static_cast<std::size_t>(std::min(band, height)));
  }
  ExrOutput stream{write};
  std::optional<std::uint64_t> notes_place;
  {
    const int threads = pool != nullptr && pool->threads() > 1 ? pool->threads() : 0;
    want_exr_threads(threads);
    Imf::OutputFile exr{stream, header, threads};
    if (picture.notes_after) notes_place = stream.find(picture.notes);
    stream.begin();
    for (int y = 0; y < height; y += band) {
      const int rows = std::min(band, height - y);
      make({y, rows});
      Imf::FrameBuffer buffer;
      for (std::size_t i = 0; i < planes.size(); ++i) {
        planes[i].fill(y, rows, bands[i].data());
        const std::size_t size = bytes_of(planes[i].type);
        buffer.insert(planes[i].name,
                      Imf::Slice::Make(planes[i].type, bands[i].data(),
                                       header.dataWindow().min + Imath::V2i{0, y}, width, rows,
                                       size, size * static_cast<std::size_t>(width)));
      }
      exr.setFrameBuffer(buffer);
      exr.writePixels(rows);
    }
  }
  stream.end();
  if (!notes_place) return;
  const std::string notes = picture.notes_after();
  write(*notes_place, std::as_bytes(std::span{notes}));
}

ExrPlane plane_of(std::string name, const std::span<const float>& band) {
  return {std::move(name), Imf::FLOAT,
          [&band](int, int, std::byte* to) { std::memcpy(to, band.data(), band.size_bytes()); }};
}

ExrPlane plane_of(std::string name, const ConstImageView& band, std::size_t channel,
                  Imf::PixelType type, float light = 1.0f) {
  return {std::move(name), type, [&band, channel, type, light](int, int rows, std::byte* to) {
            for (int y = 0; y < rows; ++y) {
              const auto from = row<std::uint16_t>(band, y);
              if (type == Imf::HALF) {
                for (std::size_t i = channel; i < from.size(); i += 4, to += sizeof from[i]) {
                  std::memcpy(to, &from[i], sizeof from[i]);
                }
                continue;
              }
              for (std::size_t i = channel; i < from.size(); i += 4, to += sizeof(float)) {
                const float value = half_to_float(from[i]) * light;
                std::memcpy(to, &value, sizeof value);
              }
            }
          }};
}

/// The header of a file with the windows of another.
Imf::Header header_of(const PictureToWrite& picture, const PictureExtras& extras) {
  if (extras.source == nullptr) return {picture.width, picture.height};
  const PictureFile& source = *extras.source;
  ExrInput stream{source_of(source)};
  const Imf::MultiPartInputFile exr{stream, 1, false};
  const Imath::Box2i& display = exr.header(0).displayWindow();
  const Imath::V2i first = display.min + Imath::V2i{source.left, source.top};
  return {display, {first, first + Imath::V2i{picture.width - 1, picture.height - 1}}};
}

/// Names as OpenEXR has them in one part: those of the default view without it, and others with it
/// before the channel. Parts of the same view may have the same channels: the first has the name.
std::vector<std::string> names_in_one_part(const PictureFile& file,
                                           std::span<const std::size_t> kept,
                                           const std::string& view) {
  std::vector<std::string> names;
  for (const std::size_t index : kept) {
    const PlaneInfo& plane = file.planes[index];
    const bool has_parts = plane.name != plane.channel;
    std::string name = plane.name;
    if (!view.empty() && has_parts && !plane.view.empty()) {
      name = plane.channel;
      if (plane.view != view) name.insert(name.rfind('.') + 1, plane.view + ".");
      if (std::find(names.begin(), names.end(), name) != names.end()) name = plane.name;
    }
    names.push_back(std::move(name));
  }
  return names;
}

/// Channels of another EXR, in their own type. A band of all of them is read at once: they lie in
/// the same compressed blocks.
class SourcePlanes {
 public:
  SourcePlanes(const PictureFile& file, const PictureExtras& extras)
      : file_(file), stream_(source_of(file)), exr_(stream_, 1, false) {
    const std::vector<std::string> names = names_in_one_part(file, extras.kept, extras.view);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const PlaneInfo& info = file.planes[extras.kept[i]];
      const Imf::PixelType type = exr_.header(info.part).channels()[info.channel.c_str()].type;
      kept_.push_back({&info, names[i], type, {}, nullptr});
      for (const ReplacedPlane& replaced : extras.replaced) {
        if (replaced.plane != extras.kept[i]) continue;
        kept_.back().values = replaced.values.data();
        if (brightest_of(replaced.values) > 65504.0f) kept_.back().type = Imf::FLOAT;
      }
    }
  }

  const Imf::Header& header() const { return exr_.header(0); }

  /// In the order of `kept`. They need this object.
  std::vector<ExrPlane> planes() {
    std::vector<ExrPlane> planes;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      planes.push_back({kept_[i].name, kept_[i].type, [this, i](int y, int rows, std::byte* to) {
                          if (kept_[i].values != nullptr) return put_values(kept_[i], y, rows, to);
                          if (y != loaded_y_) load_or_refuse(y, rows);
                          copy(kept_[i], y, rows, to);
                        }});
    }
    return planes;
  }

 private:
  struct Kept {
    const PlaneInfo* info;
    std::string name;
    Imf::PixelType type;
    std::vector<std::byte> band;  // as wide as the data window
    const float* values;          // in place of the file's
  };

  void put_values(const Kept& kept, int y, int rows, std::byte* to) const {
    const auto width = static_cast<std::size_t>(file_.width);
    const float* from = kept.values + static_cast<std::size_t>(y) * width;
    for (std::size_t i = 0; i < width * static_cast<std::size_t>(rows); ++i) {
      const std::uint16_t half = float_to_half(from[i], HalfRounding::nearest_even);
      const std::size_t size = bytes_of(kept.type);
      std::memcpy(to + size * i,
                  kept.type == Imf::HALF ? static_cast<const void*>(&half) : from + i, size);
    }
  }

  /// The rows of the picture from `y` on that a part has.
  struct Window {
    int left, right, first, last;  // empty if left > right or first > last
    std::size_t data_width;
    Imath::V2i data, display;  // their upper left corners
  };
  Window window_of(int part, int y, int rows) const {
    const Imath::Box2i data = exr_.header(part).dataWindow();
    const Imath::V2i display =  // of the planes' pixels
        exr_.header(part).displayWindow().min + Imath::V2i{file_.left, file_.top};
    return {std::max(display.x, data.min.x),
            std::min(display.x + file_.width - 1, data.max.x),
            std::max(display.y + y, data.min.y),
            std::min(display.y + y + rows - 1, data.max.y),
            static_cast<std::size_t>(data.max.x - data.min.x + 1),
            data.min,
            display};
  }

  void load_or_refuse(int y, int rows) {
    try {
      load(y, rows);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      throw FileError("cannot read '" + file_.path.string() + "': " + error.what());
    }
  }

  void load(int y, int rows) {
    loaded_y_ = y;
    for (int part = 0; part < exr_.parts(); ++part) {
      const Window window = window_of(part, y, rows);
      if (window.left > window.right || window.first > window.last) continue;
      const int count = window.last - window.first + 1;
      Imf::FrameBuffer buffer;
      for (Kept& kept : kept_) {
        if (kept.info->part != part || kept.values != nullptr) continue;
        const std::size_t size = bytes_of(kept.type);
        kept.band.resize(size * window.data_width * static_cast<std::size_t>(count));
        buffer.insert(
            kept.info->channel,
            Imf::Slice::Make(kept.type, kept.band.data(), Imath::V2i{window.data.x, window.first},
                             static_cast<std::int64_t>(window.data_width), count, size,
                             size * window.data_width));
      }
      if (buffer.begin() == buffer.end()) continue;
      Imf::InputPart input{exr_, part};
      input.setFrameBuffer(buffer);
      input.readPixels(window.first, window.last);
    }
  }

  /// Outside the data window there is nothing: 0.
  void copy(const Kept& kept, int y, int rows, std::byte* to) const {
    const Window window = window_of(kept.info->part, y, rows);
    const std::size_t size = bytes_of(kept.type);
    const auto width = static_cast<std::size_t>(file_.width);
    std::fill_n(to, size * width * static_cast<std::size_t>(rows), std::byte{0});
    if (window.left > window.right) return;
    for (int at = window.first; at <= window.last; ++at) {
      const std::size_t from = static_cast<std::size_t>(at - window.first) * window.data_width +
                               static_cast<std::size_t>(window.left - window.data.x);
      const std::size_t place = static_cast<std::size_t>(at - window.display.y - y) * width +
                                static_cast<std::size_t>(window.left - window.display.x);
      std::memcpy(to + size * place, kept.band.data() + size * from,
                  size * static_cast<std::size_t>(window.right - window.left + 1));
    }
  }

  const PictureFile& file_;
  ExrInput stream_;
  Imf::MultiPartInputFile exr_;
  std::vector<Kept> kept_{};
  int loaded_y_ = -1;
};

constexpr std::array<std::string_view, 3> kLensNames{"focus", "aperture", "nominalFocalLength"};

/// Copies the attributes of another file's header, but for its form and, if the picture has a lens
/// of its own, its lens.
void copy_attributes(const Imf::Header& from, Imf::Header& to, bool keeps_lens) {
  constexpr std::array<std::string_view, 21> kForm{"channels",
                                                   "compression",
                                                   "dataWindow",
                                                   "displayWindow",
                                                   "lineOrder",
                                                   "tiles",
                                                   "type",
                                                   "name",
                                                   "version",
                                                   "chunkCount",
                                                   "view",
                                                   "multiView",
                                                   "preview",
                                                   "envmap",
                                                   "deepImageState",
                                                   "worldToNDC",
                                                   "softfocus",
                                                   "dwaCompressionLevel",
                                                   "maxSamplesPerPixel",
                                                   "originalDataWindow",
                                                   "wrapmodes"};
  for (auto attribute = from.begin(); attribute != from.end(); ++attribute) {
    const std::string_view name = attribute.name();
    if (std::find(kForm.begin(), kForm.end(), name) != kForm.end()) continue;
    // Left out here, for they may have another type, and Header::erase leaks what it erases.
    if (!keeps_lens && std::find(kLensNames.begin(), kLensNames.end(), name) != kLensNames.end()) {
      continue;
    }
    to.insert(attribute.name(), attribute.attribute());
  }
}

/// The picture's view comes first: it is the one whose channels have no name.
void add_views(const PictureExtras& extras, Imf::Header& header) {
  if (extras.source != nullptr && extras.source->views.size() == 1) {
    header.setView(extras.source->views.front());
  }
  if (extras.view.empty()) return;
  std::vector<std::string> views{extras.view};
  for (const std::string& view : extras.source->views) {
    if (view != extras.view) views.push_back(view);
  }
  Imf::addMultiView(header, views);
}

void add_lens(const ThinLens& lens, Imf::Header& header) {
  Imf::addFocus(header, static_cast<float>(lens.focus_m));
  Imf::addAperture(header, static_cast<float>(lens.f_number));
  // OpenEXR has a function for it from 3.2 on.
  header.insert("nominalFocalLength",
                Imf::FloatAttribute(static_cast<float>(lens.focal_length_mm)));
}

}  // namespace

void write_exr(const PictureToWrite& picture, ExrNumbers numbers, const PictureExtras& extras,
               const WriteAt& write) {
  guarded_exr([&] {
    Imf::Header header = header_of(picture, extras);
    PictureBand band;
    std::vector<ExrPlane> planes;
    const bool is_half = numbers == ExrNumbers::half && extras.light_power == 0;
    const Imf::PixelType type = is_half ? Imf::HALF : Imf::FLOAT;
    const float light = std::ldexp(1.0f, extras.light_power);
    constexpr std::array kNames{"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
      planes.push_back(plane_of(kNames[c], band.picture, c, type, light));
    }
    if (!extras.alpha.empty()) planes.push_back(plane_of("A", band.alpha));
    if (extras.has_depth) {
      planes.push_back(extras.depth_m.empty() ? plane_of("Z", band.picture, 3, Imf::FLOAT)
                                              : plane_of("Z", band.depth_m));
    }
    if (!extras.radii_px.empty()) planes.push_back(plane_of("coc", band.radii_px));
    std::optional<SourcePlanes> source;
    if (extras.source != nullptr) {
      source.emplace(*extras.source, extras);
      copy_attributes(source->header(), header, !extras.lens);
      const std::vector<ExrPlane> own = planes;
      for (ExrPlane& plane : source->planes()) {
        const auto has_name = [&](const ExrPlane& other) { return other.name == plane.name; };
        if (std::none_of(own.begin(), own.end(), has_name)) planes.push_back(std::move(plane));
      }
    }
    if (extras.lens) add_lens(*extras.lens, header);
    add_views(extras, header);
    write_planes(
        planes, picture, std::move(header), [&](Rows rows) { band = picture.make(rows); }, write,
        extras.pool);
  });
}

namespace {

/// Into memory.
WriteAt writer_to(Bytes& bytes) {
  return [&bytes](std::uint64_t place, std::span<const std::byte> more) {
    const auto at = static_cast<std::size_t>(place);
    bytes.resize(std::max(bytes.size(), at + more.size()));
    std::copy(more.begin(), more.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  };
}

/// Rows of a plane.
std::span<const float> rows_of(std::span<const float> plane, int width, Rows rows) {
  const auto columns = static_cast<std::size_t>(width);
  return plane.empty() ? plane
                       : plane.subspan(static_cast<std::size_t>(rows.first) * columns,
                                       static_cast<std::size_t>(rows.count) * columns);
}

}  // namespace

Bytes encode_exr(const Image& image, ExrNumbers numbers, const std::string& notes,
                 const PictureExtras& extras, const std::function<std::string()>& notes_after) {
  const auto make = [&](Rows rows) -> PictureBand {
    const auto part = [&](std::span<const float> plane) {
      return rows_of(plane, image.width, rows);
    };
    return {{image.format, image.width, rows.count, static_cast<std::ptrdiff_t>(image.stride_bytes),
             image.bytes.data() + static_cast<std::size_t>(rows.first) * image.stride_bytes},
            part(extras.alpha),
            part(extras.depth_m),
            part(extras.radii_px)};
  };
  Bytes bytes;
  write_exr({image.width, image.height, make, notes, notes_after}, numbers, extras,
            writer_to(bytes));
  return bytes;
}

Bytes encode_depth_exr(std::span<const float> values, int width, int height) {
  Bytes bytes;
  guarded_exr([&] {
    std::span<const float> band;
    write_planes(
        {plane_of("Z", band)}, {width, height, {}}, Imf::Header{width, height},
        [&](Rows rows) { band = rows_of(values, width, rows); }, writer_to(bytes));
  });
  return bytes;
}

}  // namespace softfocus
