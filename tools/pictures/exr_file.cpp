#include "tools/pictures/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiView.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/pictures/exr_streams.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {
namespace {

constexpr const char* kNotes = "softfocus";

/// No layer of a compositor comes near; a hostile header could name millions.
constexpr std::size_t kMostChannels = 4096;
/// Flat colour in DWAB and PIZ shrinks to about a ten-thousandth. Beyond this no file is one.
constexpr std::uint64_t kMostOfCompression = 50000;
/// Anamorphic lenses have 2; none needs more. Others count as 1.
constexpr float kMostOfAspect = 16.0f;

NumberType type_of(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT: return NumberType::unsigned32;
    case Imf::HALF: return NumberType::half;
    default: return NumberType::single;
  }
}

std::int64_t width_of(const Imath::Box2i& window) {
  return std::int64_t{window.max.x} - window.min.x + 1;
}
std::int64_t height_of(const Imath::Box2i& window) {
  return std::int64_t{window.max.y} - window.min.y + 1;
}

std::string window_text(const Imath::Box2i& window) {
  return std::to_string(window.min.x) + "," + std::to_string(window.min.y) + ".." +
         std::to_string(window.max.x) + "," + std::to_string(window.max.y);
}

std::string_view compression_name(Imf::Compression compression) {
  constexpr std::string_view kNames[] = {"no compression", "RLE", "ZIPS", "ZIP",  "PIZ",
                                         "PXR24",          "B44", "B44A", "DWAA", "DWAB"};
  const auto index = static_cast<std::size_t>(compression);
  return index < std::size(kNames) ? kNames[index] : "unknown compression";
}

/// "part.layer.R": the part's name is left out where the channel's begins with it, or there is one
/// part alone.
std::string full_name(const Imf::Header& header, int parts, const std::string& channel) {
  if (parts == 1 || !header.hasName()) return channel;
  const std::string& part = header.name();
  return part.empty() || channel.starts_with(part + ".") ? channel : part + "." + channel;
}

/// The union of the parts' data windows.
void add_data_window(PictureFile& file, const Imath::Box2i& data, const Imath::Box2i& display,
                     int part) {
  const std::int64_t left = std::int64_t{data.min.x} - display.min.x;
  const std::int64_t top = std::int64_t{data.min.y} - display.min.y;
  constexpr std::int64_t kFar = std::int64_t{1} << 29;
  if (std::abs(left) > kFar || std::abs(top) > kFar) {
    throw FileError("the EXR's data window lies far from its display window");
  }
  PictureBox box{static_cast<int>(left), static_cast<int>(top), static_cast<int>(width_of(data)),
                 static_cast<int>(height_of(data))};
  if (part > 0) {
    const int right = std::max(box.x + box.width, file.data.x + file.data.width);
    const int bottom = std::max(box.y + box.height, file.data.y + file.data.height);
    box.x = std::min(box.x, file.data.x);
    box.y = std::min(box.y, file.data.y);
    box.width = right - box.x;
    box.height = bottom - box.y;
    check_picture_size("the union of the EXR's data windows", box.width, box.height,
                       most_rows_of(file));
  }
  file.data = box;
}

/// Of a file of one part; those of several say their view each.
std::vector<std::string> views_of(const Imf::Header& header) {
  return Imf::hasMultiView(header) ? Imf::multiView(header) : std::vector<std::string>{};
}

/// The view that a channel is of, by the part's or, if there is a list of views, by its name.
std::string view_of(PictureFile& file, const Imf::Header& header, const std::string& channel) {
  if (!header.hasView()) {
    // The library looks for the first of the list.
    return file.views.empty() ? "" : Imf::viewFromChannelName(channel, file.views);
  }
  if (std::find(file.views.begin(), file.views.end(), header.view()) == file.views.end()) {
    file.views.push_back(header.view());
  }
  return header.view();
}

void list_part(PictureFile& file, const Imf::Header& header, int part, int parts) {
  const std::string type = header.hasType() ? header.type() : std::string{};
  if (type == Imf::DEEPSCANLINE || type == Imf::DEEPTILE) {
    throw FileError(
        "it is a deep EXR, with any number of samples a pixel; flatten it: oiiotool --flatten IN "
        "-o OUT.exr");
  }
  const Imath::Box2i& display = header.displayWindow();
  const Imath::Box2i& data = header.dataWindow();
  const int most_rows = most_rows_of(file);
  check_picture_size("the EXR", width_of(display), height_of(display), most_rows);
  check_picture_size("the EXR's data window", width_of(data), height_of(data), most_rows);
  add_data_window(file, data, display, part);
  if (part == 0) {
    file.width = static_cast<int>(width_of(display));
    file.height = static_cast<int>(height_of(display));
    file.views = views_of(header);
    const float aspect = header.pixelAspectRatio();
    if (aspect >= 1.0f / kMostOfAspect && aspect <= kMostOfAspect) {
      file.pixel_aspect = static_cast<double>(aspect);
    }
    file.remark =
        std::string{compression_name(header.compression())} +
        (header.hasTileDescription() ? ", tiles" : "") +
        (data != display ? ", data window " + window_text(data) : "") +
        (aspect != 1.0f ? ", pixel aspect " + short_number(static_cast<double>(aspect)) : "") +
        (parts > 1 ? ", " + std::to_string(parts) + " parts" : "");
  } else if (width_of(display) != file.width || height_of(display) != file.height) {
    throw FileError("the EXR's parts have different sizes; one size would do");
  }
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tiles = header.tileDescription();
    if (tiles.xSize > kMaxImageSize || tiles.ySize > kMaxImageSize) {
      throw FileError("the EXR's tiles are larger than any picture may be");
    }
  }
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
      throw FileError(std::string{"the EXR's channel '"} + channel.name() +
                      "' has fewer pixels than the others, as luminance and chroma do; "
                      "ImageMagick's convert IN OUT.exr makes red, green and blue of them");
    }
    if (file.planes.size() >= kMostChannels) {
      throw FileError("the EXR has more than " + std::to_string(kMostChannels) + " channels");
    }
    file.planes.push_back({.name = full_name(header, parts, channel.name()),
                           .type = type_of(channel.channel().type),
                           .part = part,
                           .channel = channel.name(),
                           .view = view_of(file, header, channel.name())});
  }
}

void list_exr(PictureFile& file) {
  guarded_exr([&] {
    ExrInput stream{source_of(file)};
    const Imf::MultiPartInputFile exr{stream, 1, false};
    for (int part = 0; part < exr.parts(); ++part) {
      list_part(file, exr.header(part), part, exr.parts());
    }
  });
  const auto pixels = std::max(
      static_cast<std::uint64_t>(file.width) * static_cast<std::uint64_t>(file.height),
      static_cast<std::uint64_t>(file.data.width) * static_cast<std::uint64_t>(file.data.height));
  if (pixels * file.planes.size() / kMostOfCompression > source_of(file).size()) {
    throw FileError("the EXR is too small a file for the size that it claims");
  }
}

/// Reads planes, a band at a time into a buffer as wide as the data window, which may reach beyond
/// the picture.
class ExrRows {
 public:
  ExrRows(const PictureFile& file, std::vector<std::size_t> planes)
      : file_(file),
        planes_(std::move(planes)),
        stream_(source_of(file)),
        exr_(stream_, 1, false) {}

  void read(Rows rows, std::span<PlaneValues> values) {
    for (int part = 0; part < exr_.parts(); ++part) read_part(part, rows, values);
  }

 private:
  void read_part(int part, Rows rows, std::span<PlaneValues> values) {
    std::vector<std::size_t> wanted;  // places in planes_
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      if (file_.planes[planes_[i]].part == part) wanted.push_back(i);
    }
    if (wanted.empty()) return;
    Imf::InputPart input{exr_, part};
    const Imath::Box2i data = input.header().dataWindow();
    Imath::Box2i display = input.header().displayWindow();  // moved to the planes' pixels
    display.min += Imath::V2i{file_.left, file_.top};
    display.max = display.min + Imath::V2i{file_.width - 1, file_.height - 1};
    const auto width = static_cast<std::size_t>(width_of(data));
    constexpr int kBand = 256;  // rows: those of the largest block
    const std::int64_t top = std::int64_t{display.min.y} + rows.first;
    const std::int64_t first_y = std::max<std::int64_t>(data.min.y, top);
    const std::int64_t last_y = std::min<std::int64_t>(data.max.y, top + rows.count - 1);
    const int first_x = std::max(data.min.x, display.min.x);
    const int last_x = std::min(data.max.x, display.max.x);
    const auto band_rows = static_cast<std::size_t>(std::min(kBand, rows.count));
    bands_.resize(std::max(bands_.size(), wanted.size()));
    for (std::size_t i = 0; i < wanted.size(); ++i) bands_[i].resize(width * band_rows);
    for (std::int64_t y0 = first_y; y0 <= last_y; y0 += kBand) {
      const auto y1 = std::min<std::int64_t>(y0 + kBand - 1, last_y);
      Imf::FrameBuffer buffer;
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        buffer.insert(file_.planes[planes_[wanted[i]]].channel,
                      Imf::Slice::Make(Imf::FLOAT, bands_[i].data(),
                                       Imath::V2i{data.min.x, static_cast<int>(y0)},
                                       static_cast<std::int64_t>(width), y1 - y0 + 1, sizeof(float),
                                       width * sizeof(float)));
      }
      input.setFrameBuffer(buffer);
      input.readPixels(static_cast<int>(y0), static_cast<int>(y1));
      if (first_x > last_x) continue;
      for (std::int64_t y = y0; y <= y1; ++y) {
        const auto from = static_cast<std::size_t>(y - y0) * width +
                          static_cast<std::size_t>(std::int64_t{first_x} - data.min.x);
        const auto to = static_cast<std::size_t>(y - top) * static_cast<std::size_t>(file_.width) +
                        static_cast<std::size_t>(std::int64_t{first_x} - display.min.x);
        const auto count = static_cast<std::size_t>(std::int64_t{last_x} - first_x + 1);
        for (std::size_t i = 0; i < wanted.size(); ++i) {
          std::copy_n(bands_[i].begin() + static_cast<std::ptrdiff_t>(from), count,
                      values[wanted[i]].begin() + static_cast<std::ptrdiff_t>(to));
        }
      }
    }
  }

  const PictureFile& file_;
  std::vector<std::size_t> planes_;
  ExrInput stream_;
  Imf::MultiPartInputFile exr_;
  std::vector<std::vector<float>> bands_{};
};

ReadRows exr_rows(const PictureFile& file, std::vector<std::size_t> planes) {
  const auto reader =
      guarded_exr([&] { return std::make_shared<ExrRows>(file, std::move(planes)); });
  return [reader](Rows rows, std::span<PlaneValues> values) {
    guarded_exr([&] { reader->read(rows, values); });
  };
}

struct LensAttribute {
  const char* name;
  std::optional<double> HeaderLens::*value;
};
constexpr std::array kLensAttributes{
    LensAttribute{"focus", &HeaderLens::focus_m}, LensAttribute{"aperture", &HeaderLens::f_number},
    LensAttribute{"nominalFocalLength", &HeaderLens::focal_length_mm}};

void take_lens_attribute(const Imf::Header& header, const LensAttribute& attribute,
                         HeaderLens& lens) {
  const auto found = header.find(attribute.name);
  if (found == header.end()) return;
  const std::string name = "its attribute " + std::string{attribute.name};
  const auto* number = header.findTypedAttribute<Imf::FloatAttribute>(attribute.name);
  if (number == nullptr) {
    lens.faults.push_back(name + " is a " + found.attribute().typeName() + " and no float");
    return;
  }
  const auto value = static_cast<double>(number->value());
  if (std::isfinite(value) && value > 0.0) {
    lens.*attribute.value = value;
  } else {
    lens.faults.push_back(name + " is " + short_number(value) + ", which no lens has");
  }
}

/// A camera that is no perspective's: an environment map is panoramic, a matrix onto the screen
/// that leaves w alone orthographic, and texts of cameras say it in words.
std::string camera_of(const Imf::Header& header) {
  if (Imf::hasEnvmap(header)) return "panoramic";
  for (const char* const name : {"worldToNDC", "worldToScreen", "NP"}) {
    const auto* matrix = header.findTypedAttribute<Imf::M44fAttribute>(name);
    if (matrix == nullptr) continue;
    const Imath::M44f& m = matrix->value();
    if (m[0][3] == 0.0f && m[1][3] == 0.0f && m[2][3] == 0.0f) return "orthographic";
  }
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
    const std::string name = lower_case(attribute.name());
    const auto has = [](const std::string& all, const char* word) {
      return all.find(word) != all.npos;
    };
    if (text == nullptr || !(has(name, "camera") || has(name, "projection"))) continue;
    const std::string value = lower_case(text->value());
    if (has(value, "ortho")) return "orthographic";
    for (const char* const word : {"panoram", "equirect", "latlong", "spheric", "cylindric"}) {
      if (has(value, word)) return "panoramic";
    }
  }
  return {};
}

/// A lens cannot focus nearer than its focal length.
void drop_impossible_focus(HeaderLens& lens) {
  if (!lens.focus_m) return;
  ThinLens whole;
  whole.focus_m = *lens.focus_m;
  whole.f_number = lens.f_number.value_or(whole.f_number);
  whole.focal_length_mm = lens.focal_length_mm.value_or(whole.focal_length_mm);
  const char* const error = lens_error(whole);
  if (error == nullptr) return;
  lens.faults.push_back("its attribute focus is " + short_number(*lens.focus_m) + " m: " + error);
  lens.focus_m.reset();
}

}  // namespace

std::string_view missing_exr() { return {}; }

std::optional<std::string> find_exr_notes(const ByteSource& bytes) {
  try {
    ExrInput stream{bytes};
    const Imf::MultiPartInputFile exr{stream, 1, false};
    const auto* notes = exr.header(0).findTypedAttribute<Imf::StringAttribute>(kNotes);
    if (notes != nullptr) return notes->value();
  } catch (const std::exception&) {  // what cannot be read has no notes
  }
  return std::nullopt;
}

HeaderLens find_exr_lens(const ByteSource& bytes) {
  HeaderLens lens;
  std::vector<std::byte> start;
  if (bytes.size() < 4 || !is_exr(bytes.at(0, 4, start))) return lens;
  try {
    ExrInput stream{bytes};
    const Imf::MultiPartInputFile exr{stream, 1, false};
    for (const LensAttribute& attribute : kLensAttributes) {
      take_lens_attribute(exr.header(0), attribute, lens);
    }
    lens.camera = camera_of(exr.header(0));
  } catch (const std::exception&) {  // what cannot be read has no lens
    return {};
  }
  drop_impossible_focus(lens);
  return lens;
}

const PictureFileReader kExrReader{"OpenEXR", is_exr, list_exr, nullptr, false, exr_rows};

}  // namespace softfocus
