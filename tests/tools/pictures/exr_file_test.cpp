// OpenEXR files as other programs write them. tests/CMakeLists.txt leaves exr_*_test.cpp out where
// the build has no OpenEXR.

#include "tools/pictures/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "raster/images/texel.h"
#include "tests/support/run_program.h"
#include "tools/cli/errors.h"
#include "tools/pictures/picture_file.h"
#include "tools/refocus/chosen_layers.h"

using namespace softfocus;

namespace {

constexpr int kColumns = 37, kRows = 301;  // more rows than the largest block has

float value_at(int x, int y, int channel) {
  return static_cast<float>(channel + 1) + static_cast<float>(x) / 64.0f +
         static_cast<float>(y) / 4.0f;
}

/// The planes of a data window, each `value_at` its place in the display window.
struct Planes3 {
  Imath::Box2i window;
  std::vector<std::vector<float>> values;

  Planes3(const Imath::Box2i& of, int count) : window(of) {
    for (int c = 0; c < count; ++c) {
      std::vector<float>& plane = values.emplace_back();
      for (int y = window.min.y; y <= window.max.y; ++y) {
        for (int x = window.min.x; x <= window.max.x; ++x) plane.push_back(value_at(x, y, c));
      }
    }
  }

  Imf::FrameBuffer buffer(const std::vector<std::string>& names) {
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < names.size(); ++c) {
      buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values[c].data(), window.min, width,
                                               height, sizeof(float),
                                               static_cast<std::size_t>(width) * sizeof(float)));
    }
    return buffer;
  }
};

const Imath::Box2i kDisplay{{0, 0}, {kColumns - 1, kRows - 1}};

Imf::Header header_with(const std::vector<std::string>& names,
                        const Imath::Box2i& data = kDisplay) {
  Imf::Header header{kDisplay, data};
  for (const std::string& name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  return header;
}

/// A plane of a file that stays on the disk, a few rows at a time.
PlaneValues read_in_bands(const std::filesystem::path& path, std::size_t plane, float outside) {
  constexpr int kBand = 23;
  std::string why;
  const auto file = open_on_disk(path, why);
  REQUIRE(file);
  const ReadRows read = rows_of(*file, {plane});
  PlaneValues all;
  for (int y = 0; y < file->height; y += kBand) {
    const Rows rows{y, std::min(kBand, file->height - y)};
    std::vector<PlaneValues> band(1);
    band[0].assign(static_cast<std::size_t>(rows.count * file->width), outside);
    read(rows, band);
    all.insert(all.end(), band[0].begin(), band[0].end());
  }
  return all;
}

/// How many values of a plane are not those of value_at(), to within `error` times their size.
int wrong_values(const PictureFile& file, std::size_t plane, int channel, float error = 0.0f) {
  const PlaneValues values = read_planes(file, {&plane, 1}, -5.0f)[0];
  CHECK(read_in_bands(file.path, plane, -5.0f) == values);
  int wrong = 0;
  for (int y = 0; y < file.height; ++y) {
    for (int x = 0; x < file.width; ++x) {
      const float expected = value_at(x, y, channel);
      wrong += !(std::fabs(values[static_cast<std::size_t>(y * file.width + x)] - expected) <=
                 error * expected);
    }
  }
  return wrong;
}

std::size_t plane_of(const PictureFile& file, const std::string& name) {
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    if (file.planes[i].name == name) return i;
  }
  FAIL("no plane ", name);
  return 0;
}

}  // namespace

TEST_CASE("EXR: what is written comes back, halves bit by bit and depth in alpha") {
  Image image = make_image(Format::rgba16f, 33, 70);
  std::uint16_t next = 1;
  for (int y = 0; y < image.height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) value = next++;  // no NaN
  }
  for (const FileFormat format : {FileFormat::exr, FileFormat::exr_float}) {
    CHECK(equal(decode(encode(image, format), format).image, image));
  }
}

TEST_CASE("EXR: notes stand in an attribute") {
  const Bytes bytes = encode_exr(make_image(Format::rgba16f, 2, 2), ExrNumbers::half, "{\"a\": 1}");
  CHECK(find_exr_notes(bytes) == "{\"a\": 1}");
  CHECK_FALSE(find_exr_notes(encode_exr(make_image(Format::rgba16f, 2, 2), ExrNumbers::half, "")));
}

TEST_CASE("EXR: the lens stands in attributes") {
  const TemporaryDirectory directory;
  const Bytes bytes = encode_exr(make_image(Format::rgba16f, 2, 2), ExrNumbers::half, "",
                                 {.lens = ThinLens{85.0, 1.5, 2.5}});
  write_file(directory.file("a.exr"), bytes);
  const Imf::InputFile exr{directory.file("a.exr").c_str()};
  CHECK(Imf::focus(exr.header()) == 2.5f);
  CHECK(Imf::aperture(exr.header()) == 1.5f);
  CHECK(exr.header().typedAttribute<Imf::FloatAttribute>("nominalFocalLength").value() == 85.0f);
}

namespace {

constexpr const char* kLensNames[] = {"focus", "aperture", "nominalFocalLength"};

/// Grey columns with depths of 1 to 4 m, and a header with these attributes.
void write_with(const std::string& name, const std::function<void(Imf::Header&)>& add) {
  constexpr int kSide = 24;
  const Imath::Box2i window{{0, 0}, {kSide - 1, kSide - 1}};
  Imf::Header header{window, window};
  for (const char* channel : {"R", "G", "B", "Z"}) {
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  }
  add(header);
  std::vector<float> grey, depth;
  for (int i = 0; i < kSide * kSide; ++i) {
    grey.push_back(i % 3 == 0 ? 1.0f : 0.0f);
    depth.push_back(1.0f + 3.0f * static_cast<float>(i % kSide) / (kSide - 1));
  }
  Imf::FrameBuffer buffer;
  for (const char* channel : {"R", "G", "B", "Z"}) {
    buffer.insert(channel,
                  Imf::Slice::Make(Imf::FLOAT, channel[0] == 'Z' ? depth.data() : grey.data(),
                                   window.min, kSide, kSide, sizeof(float), kSide * sizeof(float)));
  }
  Imf::OutputFile file{name.c_str(), header};
  file.setFrameBuffer(buffer);
  file.writePixels(kSide);
}

std::function<void(Imf::Header&)> lens_of(float focus, float aperture, float focal_length) {
  return [=](Imf::Header& header) {
    const float values[] = {focus, aperture, focal_length};
    for (int i = 0; i < 3; ++i) header.insert(kLensNames[i], Imf::FloatAttribute(values[i]));
  };
}

}  // namespace

TEST_CASE("EXR: the header's lens is read, and what no lens can have is a fault") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  write_with(name, lens_of(1.5f, 4.0f, 85.0f));
  const HeaderLens lens = find_exr_lens(read_picture_bytes(name));
  CHECK(lens.focus_m == 1.5);
  CHECK(lens.f_number == 4.0);
  CHECK(lens.focal_length_mm == 85.0);
  CHECK(lens.faults.empty());
  for (const float wrong : {NAN, INFINITY, -2.0f, 0.0f}) {
    write_with(name, lens_of(wrong, wrong, wrong));
    const HeaderLens none = find_exr_lens(read_picture_bytes(name));
    CHECK_FALSE(none.focus_m);
    CHECK_FALSE(none.f_number);
    CHECK_FALSE(none.focal_length_mm);
    CHECK(none.faults.size() == 3);
  }
  write_with(name, lens_of(0.05f, 4.0f, 85.0f));  // nearer than the focal length
  CHECK_FALSE(find_exr_lens(read_picture_bytes(name)).focus_m);
  CHECK(find_exr_lens(read_picture_bytes(name)).faults.size() == 1);
  write_with(name,
             [](Imf::Header& header) { header.insert("aperture", Imf::StringAttribute("f/4")); });
  REQUIRE(find_exr_lens(read_picture_bytes(name)).faults.size() == 1);
  CHECK(contains(find_exr_lens(read_picture_bytes(name)).faults[0], "aperture is a string"));
  CHECK(find_exr_lens(Bytes{}).faults.empty());
}

TEST_CASE("refocus: an EXR's own lens is the default, options overrule it, and -v says so") {
  const TemporaryDirectory directory;
  const std::string with = directory.file("with.exr"), without = directory.file("without.exr");
  const std::string out = directory.file("out.npy");
  write_with(with, lens_of(1.5f, 1.25f, 85.0f));
  write_with(without, [](Imf::Header&) {});
  const auto refocus = [&](const std::string& file, std::vector<std::string> more) {
    more.insert(more.begin(), {"refocus", file, "-o", out, "--coc-scale", "9"});
    ProgramRun run = run_program(more);
    CHECK(run.status == 0);
    return run;
  };
  const auto hash_after = [&](const std::string& file, const std::vector<std::string>& more) {
    CHECK(tells_depth_alone(refocus(file, more).err));
    return hash_image(read_image_file(out).image);
  };
  const auto own = hash_after(with, {});
  CHECK(own ==
        hash_after(without, {"--focus", "1.5", "--f-number", "1.25", "--focal-length", "85"}));
  CHECK(own != hash_after(without, {}));
  CHECK(hash_after(with, {"--focus-at", "20,4", "--f-number", "2", "--focal-length", "50"}) ==
        hash_after(without, {"--focus-at", "20,4"}));
  CHECK(hash_after(with, {"--focus-nearest"}) ==
        hash_after(without, {"--focus-nearest", "--f-number", "1.25", "--focal-length", "85"}));
  CHECK(contains(refocus(with, {"-v"}).err, "1.5 m, by the file's focus"));
  CHECK(contains(refocus(with, {"-v", "--f-number", "2"}).err,
                 "by the file's nominalFocalLength, --f-number"));
  CHECK(
      contains(refocus(without, {"-v"}).err, "by the default focal length, the default f-number"));

  // A picture of ours has notes, which come first.
  CHECK(
      run_program({"refocus", with, "-o", directory.file("ours.exr"), "--f-number", "3"}).status ==
      0);
  CHECK(contains(refocus(directory.file("ours.exr"), {"-v"}).err, "by what the picture says"));

  CHECK(contains(run_program({"inspect", with}).out, "lens: 85 mm, f/1.25, focus 1.5 m"));
  CHECK(contains(run_program({"inspect", with, "--json"}).out, "\"f_number\": 1.25"));
  CHECK_FALSE(contains(run_program({"inspect", without}).out, "lens:"));
}

TEST_CASE("refocus: attributes that no lens can have are ignored with a warning") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr"), out = directory.file("out.npy");
  write_with(name, lens_of(NAN, -2.0f, 85.0f));
  const ProgramRun run = run_program({"refocus", name, "-o", out});
  CHECK(run.status == 0);
  CHECK(contains(run.err, "its attribute focus is nan, which no lens has; it is ignored"));
  CHECK(contains(run.err, "its attribute aperture is -2, which no lens has; it is ignored"));
  CHECK(contains(run_program({"inspect", name}).out, "its attribute aperture is -2"));
}

TEST_CASE("EXR: layers of another file are kept as they are, in their types") {
  const TemporaryDirectory directory;
  const Imath::Box2i data{{3, -7}, {kColumns + 4, 280}};  // beyond the picture and within it
  const auto columns = static_cast<std::size_t>(data.max.x - data.min.x + 1);
  const auto rows = static_cast<std::size_t>(data.max.y - data.min.y + 1);
  std::vector<std::uint32_t> ids;
  std::vector<Imath::half> masks;
  for (std::size_t i = 0; i < columns * rows; ++i) {
    ids.push_back(static_cast<std::uint32_t>(0xFFFF0000u + i));  // no float has it
    masks.emplace_back(static_cast<float>(i % 2000) * 0.25f);
  }
  Imf::Header header{kDisplay, data};
  header.compression() = Imf::PIZ_COMPRESSION;
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  header.channels().insert("mask.V", Imf::Channel(Imf::HALF));
  header.channels().insert("Z", Imf::Channel(Imf::HALF));
  Imf::addOwner(header, "a studio");
  header.insert("focus", Imf::StringAttribute("the actor"));
  Imf::FrameBuffer buffer;
  buffer.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), data.min, static_cast<int>(columns),
                                       static_cast<int>(rows)));
  for (const char* name : {"mask.V", "Z"}) {
    buffer.insert(name, Imf::Slice::Make(Imf::HALF, masks.data(), data.min,
                                         static_cast<int>(columns), static_cast<int>(rows)));
  }
  {
    Imf::OutputFile exr{directory.file("a.exr").c_str(), header};
    exr.setFrameBuffer(buffer);
    exr.writePixels(static_cast<int>(rows));
  }
  const PictureFile source = open_picture_file(directory.file("a.exr"));
  const std::vector<std::size_t> kept{0, 1, 2};
  const Bytes bytes = encode_exr(make_image(Format::rgba16f, kColumns, kRows), ExrNumbers::half, "",
                                 {.lens = ThinLens{}, .source = &source, .kept = kept});
  write_file(directory.file("b.exr"), bytes);
  Imf::InputFile exr{directory.file("b.exr").c_str()};
  CHECK(Imf::owner(exr.header()) == "a studio");
  CHECK(Imf::focus(exr.header()) == 2.0f);
  CHECK(exr.header().channels()["Z"].type == Imf::FLOAT);  // the picture's own
  REQUIRE(exr.header().channels()["id"].type == Imf::UINT);
  REQUIRE(exr.header().channels()["mask.V"].type == Imf::HALF);
  std::vector<std::uint32_t> got_ids(static_cast<std::size_t>(kColumns * kRows), 1u);
  std::vector<Imath::half> got_masks(got_ids.size());
  Imf::FrameBuffer back;
  back.insert("id", Imf::Slice::Make(Imf::UINT, got_ids.data(), kDisplay));
  back.insert("mask.V", Imf::Slice::Make(Imf::HALF, got_masks.data(), kDisplay));
  exr.setFrameBuffer(back);
  exr.readPixels(0, kRows - 1);
  int wrong = 0;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const auto at = static_cast<std::size_t>(y * kColumns + x);
      const bool has_data = x >= data.min.x && y <= data.max.y;
      const std::size_t from = static_cast<std::size_t>(y - data.min.y) * columns +
                               static_cast<std::size_t>(x - data.min.x);
      wrong += got_ids[at] != (has_data ? ids[from] : 0u);
      wrong += got_masks[at].bits() != (has_data ? masks[from].bits() : 0u);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("EXR: refocus keeps other layers, or leaves them out") {
  const TemporaryDirectory directory;
  const std::vector<std::string> names{"B", "G", "R", "Z", "view.mask.V"};
  Planes3 planes{kDisplay, 5};
  {
    Imf::OutputFile exr{directory.file("a.exr").c_str(), header_with(names)};
    exr.setFrameBuffer(planes.buffer(names));
    exr.writePixels(kRows);
  }
  std::vector<std::string> words{"refocus", directory.file("a.exr"), "-o", directory.file("b.exr")};
  words.insert(words.end(), {"--depth-encoding", "metres", "--f-number", "16"});
  CHECK(tells_depth_alone(run_program(words).err));
  const PictureFile kept = open_picture_file(directory.file("b.exr"));
  CHECK(plane_names(kept) == "B, G, R, Z, coc, view.mask.V");
  CHECK(wrong_values(kept, 5, 4) == 0);
  CHECK(wrong_values(kept, 3, 3) == 0);  // the depth's floats
  words.emplace_back("--no-layers");
  CHECK(tells_depth_alone(run_program(words).err));
  CHECK(plane_names(open_picture_file(directory.file("b.exr"))) == "B, G, R, Z, coc");
}

TEST_CASE("EXR: every compression is read") {
  const TemporaryDirectory directory;
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    CAPTURE(compression);
    Planes3 planes{kDisplay, 1};
    Imf::Header header = header_with({"Z"});
    header.compression() = static_cast<Imf::Compression>(compression);
    const std::string name = directory.file("a.exr");
    {
      Imf::OutputFile file{name.c_str(), header};
      file.setFrameBuffer(planes.buffer({"Z"}));
      file.writePixels(kRows);
    }
    // PXR24 keeps 24 bits of a float; the others keep all of them, or halves alone lose some.
    CHECK(wrong_values(open_picture_file(name), 0, 0, 1e-4f) == 0);
  }
}

TEST_CASE("EXR: half, float and uint channels are read as numbers") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  std::vector<std::uint32_t> whole(static_cast<std::size_t>(kColumns) * kRows, 70000);
  {
    Imf::Header header{kDisplay, kDisplay};
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    Imf::OutputFile file{name.c_str(), header};
    Imf::FrameBuffer buffer;
    buffer.insert("id",
                  Imf::Slice(Imf::UINT, reinterpret_cast<char*>(whole.data()), 4, 4 * kColumns));
    file.setFrameBuffer(buffer);
    file.writePixels(kRows);
  }
  const PictureFile file = open_picture_file(name);
  CHECK(file.planes[0].type == NumberType::unsigned32);
  const std::size_t first = 0;
  CHECK(read_planes(file, {&first, 1}, 0.0f)[0].back() == 70000.0f);
}

TEST_CASE("EXR: tiles are read") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  Planes3 planes{kDisplay, 2};
  {
    Imf::Header header = header_with({"Y", "Z"});
    header.setTileDescription(Imf::TileDescription(16, 8));
    Imf::TiledOutputFile file{name.c_str(), header};
    file.setFrameBuffer(planes.buffer({"Y", "Z"}));
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  const PictureFile file = open_picture_file(name);
  CHECK(wrong_values(file, plane_of(file, "Z"), 1) == 0);
  CHECK(contains(file.remark, "tiles"));
}

TEST_CASE("EXR: a data window beyond the picture is cut, one within leaves the rest outside") {
  const TemporaryDirectory directory;
  for (const Imath::Box2i& window : {Imath::Box2i{{-7, -9}, {kColumns + 5, kRows + 300}},
                                     Imath::Box2i{{5, 100}, {kColumns - 3, kRows - 20}}}) {
    const std::string name = directory.file("a.exr");
    Planes3 planes{window, 1};
    {
      Imf::OutputFile file{name.c_str(), header_with({"Z"}, window)};
      file.setFrameBuffer(planes.buffer({"Z"}));
      file.writePixels(window.max.y - window.min.y + 1);
    }
    const PictureFile file = open_picture_file(name);
    CHECK(file.width == kColumns);
    CHECK(file.height == kRows);
    const std::size_t first = 0;
    const PlaneValues values = read_planes(file, {&first, 1}, -5.0f)[0];
    CHECK(read_in_bands(name, 0, -5.0f) == values);
    int wrong = 0;
    for (int y = 0; y < kRows; ++y) {
      for (int x = 0; x < kColumns; ++x) {
        const bool inside = window.intersects(Imath::V2i{x, y});
        wrong += values[static_cast<std::size_t>(y * kColumns + x)] !=
                 (inside ? value_at(x, y, 0) : -5.0f);
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("EXR: layers as Blender names them give colour and depth without an option") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  const std::vector<std::string> names{"ViewLayer.Combined.A", "ViewLayer.Combined.B",
                                       "ViewLayer.Combined.G", "ViewLayer.Combined.R",
                                       "ViewLayer.Depth.Z",    "ViewLayer.Normal.X",
                                       "ViewLayer.Normal.Y",   "ViewLayer.Normal.Z"};
  Planes3 planes{kDisplay, 8};
  {
    Imf::OutputFile file{name.c_str(), header_with(names)};
    file.setFrameBuffer(planes.buffer(names));
    file.writePixels(kRows);
  }
  const PictureFile file = open_picture_file(name);
  CHECK(choose_colour(file, {}, "--layer").name == "ViewLayer.Combined");
  CHECK(choose_depth(file, {}, true) == plane_of(file, "ViewLayer.Depth.Z"));
  CHECK(choose_depth(file, "ViewLayer.Normal", true) == plane_of(file, "ViewLayer.Normal.Z"));
  CHECK(wrong_values(file, plane_of(file, "ViewLayer.Depth.Z"), 4) == 0);
  CHECK_THROWS_AS(choose_depth(file, "Nowhere", true), UsageError);
}

namespace {

/// A file with these channels, of no pixels.
PictureFile file_of(const std::vector<std::string>& names) {
  PictureFile file{.path = "a.exr", .reader = &kExrReader, .width = 1, .height = 1};
  for (const std::string& name : names) file.planes.push_back({.name = name});
  return file;
}

}  // namespace

TEST_CASE("EXR: depths are found by the names that programs give them") {
  const std::vector<std::string> colour{"R", "G", "B", "A", "Normal.X", "Normal.Y", "Normal.Z"};
  for (const std::string name :
       {"Z", "subimage00.Z", "rgb_depth.Z", "VRayZDepth.R", "VRayZDepth", "ZDepth.R",
        "FinalImageWorldDepth.R", "FinalImageMovieRenderQueue_WorldDepth.R", "SceneDepth.R",
        "CESSENTIAL_ZDepth.R", "Z-Depth.Z", "Pz", "depth.depth", "beauty.Z", "linear_depth.Y"}) {
    CAPTURE(name);
    std::vector<std::string> names = colour;
    names.push_back(name);
    names.emplace_back("WorldPosition.X");
    names.emplace_back("WorldPosition.Y");
    names.emplace_back("WorldPosition.Z");
    CHECK(choose_depth(file_of(names), {}, true) == colour.size());
  }
  CHECK_FALSE(find_depth_beside_colour(file_of(colour)));
  CHECK_FALSE(find_depth_beside_colour(file_of({"R", "G", "B", "depth_of_field.R"})));
  const PictureFile unreal =
      file_of({"WorldDepth.R", "WorldDepth.G", "WorldDepth.B", "x.R", "x.G", "x.B"});
  CHECK(choose_colour(unreal, {}, "--layer").name == "x");
}

TEST_CASE("EXR: a layer is named without what stands before it, if it is the only one") {
  const PictureFile file = file_of({"View.Combined.R", "View.Combined.G", "View.Combined.B",
                                    "View.Depth.Z", "a.Light.R", "a.Light.G", "a.Light.B",
                                    "b.Light.R", "b.Light.G", "b.Light.B", "a.Far.V", "b.Far.V"});
  CHECK(choose_colour(file, "Combined", "--layer").name == "View.Combined");
  CHECK(choose_colour(file, "b.Light", "--layer").name == "b.Light");
  CHECK(choose_depth(file, "Depth", true) == plane_of(file, "View.Depth.Z"));
  CHECK(choose_depth(file, "Depth.Z", true) == plane_of(file, "View.Depth.Z"));
  CHECK_THROWS_WITH_AS(choose_colour(file, "Light", "--layer"),
                       "--layer 'Light': 'a.exr' has 'a.Light', 'b.Light'", UsageError);
  CHECK_THROWS_WITH_AS(choose_depth(file, "Far", true),
                       "--depth-layer 'Far': 'a.exr' has a.Far.V, b.Far.V", UsageError);
  CHECK_THROWS_AS(choose_colour(file, "ombined", "--layer"), UsageError);
}

TEST_CASE("EXR: a camera that is no perspective's is told") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  const auto camera = [&](const std::function<void(Imf::Header&)>& add) {
    write_with(name, add);
    return find_exr_lens(read_picture_bytes(name)).camera;
  };
  CHECK(camera([](Imf::Header&) {}) == "");
  CHECK(camera([](Imf::Header& header) { Imf::addEnvmap(header, Imf::ENVMAP_LATLONG); }) ==
        "panoramic");
  const auto matrix = [&](float w) {
    return camera([w](Imf::Header& header) {
      Imath::M44f onto_screen;
      onto_screen[2][3] = w;
      header.insert("worldToNDC", Imf::M44fAttribute(onto_screen));
    });
  };
  CHECK(matrix(0.0f) == "orthographic");
  CHECK(matrix(-1.0f) == "");
  const auto text = [&](const char* attribute, const char* value) {
    return camera(
        [=](Imf::Header& header) { header.insert(attribute, Imf::StringAttribute(value)); });
  };
  CHECK(text("cameraProjection", "Orthographic") == "orthographic");
  CHECK(text("renderer/camera/type", "PANO: equirectangular") == "panoramic");
  CHECK(text("cameraProjection", "perspective") == "");
  text("camera.type", "orthographic");
  const ProgramRun run = run_program({"refocus", name, "-o", directory.file("o.npy")});
  CHECK(run.status == 0);
  CHECK(contains(run.err, "its camera is orthographic"));
  CHECK(contains(run.err, "--circles"));
}

TEST_CASE("EXR: parts of a file are layers") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  Planes3 colour{kDisplay, 3}, depth{kDisplay, 1};
  {
    std::vector<Imf::Header> headers{header_with({"B", "G", "R"}), header_with({"Z"})};
    headers[0].setName("beauty");
    headers[1].setName("depth");
    for (Imf::Header& header : headers) header.setType(Imf::SCANLINEIMAGE);
    Imf::MultiPartOutputFile file{name.c_str(), headers.data(), 2};
    Imf::OutputPart first{file, 0};
    first.setFrameBuffer(colour.buffer({"B", "G", "R"}));
    first.writePixels(kRows);
    Imf::OutputPart second{file, 1};
    second.setFrameBuffer(depth.buffer({"Z"}));
    second.writePixels(kRows);
  }
  const PictureFile file = open_picture_file(name);
  CHECK(plane_names(file) == "beauty.B, beauty.G, beauty.R, depth.Z");
  CHECK(wrong_values(file, plane_of(file, "beauty.R"), 2) == 0);
  CHECK(wrong_values(file, choose_depth(file, {}, true), 0) == 0);
  CHECK(choose_colour(file, {}, "--layer").name == "beauty");
}
