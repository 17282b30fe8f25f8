// EXRs whose pixels lie elsewhere than in one picture of squares: windows, pixel aspect, views, and
// motions as programs name them.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfMultiView.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "raster/images/texel.h"
#include "tests/support/run_program.h"
#include "tools/pictures/picture_file.h"

using namespace softfocus;

namespace {

/// The value of a channel at a pixel of the display window.
using Values = std::function<float(int x, int y)>;
using Channels = std::vector<std::pair<std::string, Values>>;

struct Filled {
  std::vector<std::vector<float>> planes{};
  Imf::FrameBuffer buffer{};
  int rows = 0;
};

/// The pixels of a data window.
Filled filled(const Channels& channels, const Imath::Box2i& data, Imf::Header& header) {
  const int width = data.max.x - data.min.x + 1;
  Filled result;
  result.rows = data.max.y - data.min.y + 1;
  result.planes.resize(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto& [name, value] = channels[i];
    for (int y = data.min.y; y <= data.max.y; ++y) {
      for (int x = data.min.x; x <= data.max.x; ++x) result.planes[i].push_back(value(x, y));
    }
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    result.buffer.insert(
        name, Imf::Slice::Make(Imf::FLOAT, result.planes[i].data(), data.min, width, result.rows,
                               sizeof(float), static_cast<std::size_t>(width) * sizeof(float)));
  }
  return result;
}

void write_exr(const std::string& name, const Channels& channels, const Imath::Box2i& display,
               const Imath::Box2i& data, const std::function<void(Imf::Header&)>& add = {}) {
  Imf::Header header{display, data};
  if (add) add(header);
  const Filled pixels = filled(channels, data, header);
  Imf::OutputFile file{name.c_str(), header};
  file.setFrameBuffer(pixels.buffer);
  file.writePixels(pixels.rows);
}

Imath::Box2i box(int width, int height) { return {{0, 0}, {width - 1, height - 1}}; }

Values even(float value) {
  return [value](int, int) { return value; };
}

/// A pattern without an end, for any place.
float pattern(int x, int y) {
  return 0.1f + static_cast<float>(((x * 7 + y * 5) % 11 + 11) % 11) / 8.0f;
}

/// Grey by these values, with these depths.
Channels grey(const Values& light, const Values& depth, const std::string& before = "") {
  return {
      {before + "R", light}, {before + "G", light}, {before + "B", light}, {before + "Z", depth}};
}

std::size_t plane_named(const PictureFile& file, const std::string& name) {
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    if (file.planes[i].name == name) return i;
  }
  FAIL("no plane ", name, " but ", plane_names(file));
  return 0;
}

/// A plane with all pixels that are there.
PlaneValues values_of(const std::string& name, const std::string& plane) {
  PictureFile file = open_picture_file(name);
  take_data_window(file);
  const std::size_t index = plane_named(file, plane);
  return read_planes(file, {&index, 1}, -5.0f)[0];
}

const std::vector<std::string> kLens{"--focus", "2",        "--blur-at-infinity",
                                     "6",       "--method", "disc-layers"};

ProgramRun run_refocus(const std::string& from, const std::string& to,
                       std::vector<std::string> more = kLens) {
  more.insert(more.begin(), {"refocus", from, "-o", to});
  ProgramRun run = run_program(more);
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  return run;
}

}  // namespace

TEST_CASE("refocus: pixels beside the display window are filtered, and both windows stay") {
  const TemporaryDirectory directory;
  const std::string over = directory.file("over.exr"), full = directory.file("full.exr");
  const std::string over_out = directory.file("o.exr"), full_out = directory.file("f.exr");
  const Imath::Box2i display{{100, 50}, {147, 89}}, data{{88, 42}, {163, 93}};
  const auto depth = [](int x, int) { return x < 110 ? 1.0f : 1e10f; };
  write_exr(over, grey(pattern, depth), display, data);
  write_exr(full, grey(pattern, depth), data, data);
  for (const char* method : {"two-pass", "disc-layers"}) {  // the first by bands of rows
    std::vector<std::string> words = kLens;
    words.back() = method;
    run_refocus(over, over_out, words);
    run_refocus(full, full_out, words);
    const Imf::InputFile exr{over_out.c_str()};
    CHECK(exr.header().displayWindow() == display);
    CHECK(exr.header().dataWindow() == data);
    for (const char* plane : {"R", "B", "Z", "coc"}) {
      CHECK(values_of(over_out, plane) == values_of(full_out, plane));
    }
  }
  // A depth without windows has the size of one of them; beside it its border repeats.
  for (const Imath::Box2i& window : {data, display}) {
    const std::string of_depth = directory.file("d.npy");
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    PlaneValues metres;
    for (int i = 0; i < width * height; ++i) {
      metres.push_back(depth(window.min.x + i % width, 0));
    }
    write_file(of_depth, encode_grey_npy(metres, width, height));
    std::vector<std::string> words = kLens;
    words.insert(words.begin(), of_depth);
    run_refocus(over, over_out, words);
    CHECK(values_of(over_out, "R") == values_of(full_out, "R"));
  }
  // Other formats have what is shown.
  const std::string npy = directory.file("o.npy");
  run_refocus(over, npy);
  const Image shown = read_image_file(npy).image;
  const Image whole = read_image_file(full_out).image;
  REQUIRE(shown.width == 48);
  REQUIRE(shown.height == 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) {
      CHECK(load_texel(shown, x, y).x == load_texel(whole, x + 12, y + 8).x);
    }
  }
}

TEST_CASE(
    "refocus: a picture that was rendered in part is filtered as it is, and stays where it was") {
  const TemporaryDirectory directory;
  const std::string part = directory.file("part.exr"), alone = directory.file("alone.exr");
  const Imath::Box2i display = box(64, 48), data{{20, 10}, {51, 33}};
  write_exr(part, grey(pattern, even(9.0f)), display, data);
  write_exr(alone, grey(pattern, even(9.0f)), data, data);
  run_refocus(part, directory.file("p.exr"));
  run_refocus(alone, directory.file("a.exr"));
  const Imf::InputFile exr{directory.file("p.exr").c_str()};
  CHECK(exr.header().displayWindow() == display);
  CHECK(exr.header().dataWindow() == data);
  CHECK(values_of(directory.file("p.exr"), "G") == values_of(directory.file("a.exr"), "G"));
  run_refocus(part, directory.file("p.npy"));
  const Image image = read_image_file(directory.file("p.npy")).image;
  CHECK(image.width == 64);
  CHECK(load_texel(image, 19, 20).x == 0.0f);
  CHECK(load_texel(image, 20, 20).x > 0.0f);
}

TEST_CASE("refocus: the lens is that of the display window, and so is the pixel in focus") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  const auto depth = [](int x, int) { return static_cast<float>(x + 20); };
  write_exr(name, grey(pattern, depth), box(64, 48), {{-16, -12}, {79, 59}});
  const ProgramRun run = run_refocus(name, directory.file("b.exr"), {"--focus-at", "8,4", "-v"});
  CHECK(contains(run.err, "28 m, by the median around pixel 8,4"));
  write_exr(name, grey(pattern, depth), box(64, 48), box(64, 48));
  const auto radius_line = [](const std::string& text) {
    const auto at = text.find("blur at infinity");
    return text.substr(at, text.find('\n', at) - at);
  };
  const ProgramRun plain = run_refocus(name, directory.file("b.exr"), {"--focus-at", "8,4", "-v"});
  CHECK(radius_line(run.err) == radius_line(plain.err));
}

TEST_CASE("apply: effects see pixels beside the display window, and both windows stay") {
  const TemporaryDirectory directory;
  const std::string over = directory.file("over.exr"), full = directory.file("full.exr");
  const Imath::Box2i display = box(32, 24), data{{-5, -3}, {40, 30}};
  write_exr(over, grey(pattern, even(1.0f)), display, data);
  write_exr(full, grey(pattern, even(1.0f)), data, data);
  for (const std::string& name : {over, full}) {
    REQUIRE(run_program({"apply", name, "-o", name + ".exr", "--effect", "box-3"}).status == 0);
  }
  const Imf::InputFile exr{(over + ".exr").c_str()};
  CHECK(exr.header().displayWindow() == display);
  CHECK(exr.header().dataWindow() == data);
  CHECK(values_of(over + ".exr", "R") == values_of(full + ".exr", "R"));
}

TEST_CASE("refocus: circles of pixels that are not square are ellipses of their ratio") {
  const TemporaryDirectory directory;
  // A lamp of one square, far out of focus: half a pixel's width of it, or two pixels.
  const auto shape = [&](double aspect, const std::string& method) {
    const std::string name = directory.file("a.exr"), out = directory.file("b.exr");
    const int width = aspect > 1.0 ? 80 : 160, height = aspect > 1.0 ? 160 : 80;
    const int column = width / 2, line = height / 2;
    write_exr(
        name,
        grey([&](int x, int y) { return x == column && y == line ? 1000.0f : 0.0f; }, even(1e10f)),
        box(width, height), box(width, height),
        [&](Imf::Header& header) { header.pixelAspectRatio() = static_cast<float>(aspect); });
    run_refocus(name, out, {"--focus", "2", "--blur-at-infinity", "16", "--method", method});
    const Imf::InputFile exr{out.c_str()};
    CHECK(exr.header().pixelAspectRatio() == static_cast<float>(aspect));
    const PlaneValues light = values_of(out, "R");
    double sum = 0.0, of_x = 0.0, of_y = 0.0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double value = static_cast<double>(light[static_cast<std::size_t>(y * width + x)]);
        sum += value;
        const double right = x - column, down = y - line;
        of_x += value * right * right;
        of_y += value * down * down;
      }
    }
    // Of a disc the second moment is a quarter of the radius's square.
    return std::array{2.0 * std::sqrt(of_x / sum), 2.0 * std::sqrt(of_y / sum)};
  };
  for (const char* method : {"disc-layers", "two-pass", "one-pass", "scatter-sorted"}) {
    for (const double aspect : {2.0, 1.5, 0.5}) {
      CAPTURE(method);
      CAPTURE(aspect);
      const auto [x, y] = shape(aspect, method);
      CHECK(y / x == doctest::Approx(aspect).epsilon(0.05));
      // two-pass has squares, whose moment is a third of their half side's square.
      const bool is_square = std::string{method} == "two-pass";
      CHECK(y == doctest::Approx(is_square ? 16.0 * 2.0 / std::sqrt(3.0) : 16.0).epsilon(0.06));
    }
  }
}

TEST_CASE("refocus: an anamorphic picture is the mean of the one with square pixels") {
  const TemporaryDirectory directory;
  const std::string wide = directory.file("wide.exr"), squeezed = directory.file("squeezed.exr");
  // Pairs of columns are alike, so that nothing is lost where they become one.
  const auto depth = [](int x, int) { return x / 2 < 30 ? 2.0f : 40.0f; };
  write_exr(wide, grey([](int x, int y) { return pattern(x / 2, y); }, depth), box(120, 50),
            box(120, 50));
  write_exr(squeezed, grey(pattern, [&](int x, int y) { return depth(2 * x, y); }), box(60, 50),
            box(60, 50), [](Imf::Header& header) { header.pixelAspectRatio() = 2.0f; });
  run_refocus(wide, directory.file("w.exr"));
  run_refocus(squeezed, directory.file("s.exr"));
  const PlaneValues of_wide = values_of(directory.file("w.exr"), "R");
  const PlaneValues of_squeezed = values_of(directory.file("s.exr"), "R");
  float worst = 0.0f;
  for (std::size_t i = 0; i < of_squeezed.size(); ++i) {
    const float mean = 0.5f * (of_wide[2 * i] + of_wide[2 * i + 1]);
    worst = std::max(worst, std::fabs(of_squeezed[i] - mean));
  }
  CHECK(worst < 0.001f);
}

TEST_CASE("refocus: what is in focus keeps its bits, whatever the pixels' shape") {
  const TemporaryDirectory directory;
  for (const float aspect : {1.37f, 0.61f, 2.0f}) {
    write_exr(directory.file("a.exr"), grey(pattern, even(2.0f)), box(41, 31), box(41, 31),
              [&](Imf::Header& header) { header.pixelAspectRatio() = aspect; });
    run_refocus(directory.file("a.exr"), directory.file("b.exr"));
    const Image before = read_image_file(directory.file("a.exr")).image;
    CHECK(equal(read_image_file(directory.file("b.exr")).image, before));
  }
}

namespace {

Channels both(Channels first, const Channels& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Values shifted(int by) {
  return [by](int x, int y) { return pattern(x + by, y); };
}

}  // namespace

TEST_CASE("refocus and apply: every view gets its effect, by its own depth, and the list stays") {
  const TemporaryDirectory directory;
  const auto right_depth = [](int x, int) { return x < 20 ? 2.0f : 60.0f; };
  const std::string right = directory.file("right.exr");
  write_exr(right, grey(shifted(3), right_depth), box(48, 40), box(48, 40));
  run_refocus(right, directory.file("r.exr"));
  REQUIRE(
      run_program({"apply", right, "-o", directory.file("ra.exr"), "--effect", "box-3"}).status ==
      0);

  const std::string one = directory.file("one.exr"), parts = directory.file("parts.exr");
  write_exr(one, both(grey(pattern, even(30.0f)), grey(shifted(3), right_depth, "right.")),
            box(48, 40), box(48, 40), [](Imf::Header& header) {
              Imf::addMultiView(header, {"left", "right"});
            });
  {
    std::vector<Imf::Header> headers;
    std::vector<Filled> pixels;
    for (const char* view : {"left", "right"}) {
      Imf::Header header{box(48, 40), box(48, 40)};
      header.setName(std::string{"rgba."} + view);
      header.setType(Imf::SCANLINEIMAGE);
      header.setView(view);
      const bool is_left = view == std::string{"left"};
      pixels.push_back(filled(is_left ? grey(pattern, even(30.0f)) : grey(shifted(3), right_depth),
                              box(48, 40), header));
      headers.push_back(header);
    }
    Imf::MultiPartOutputFile file{parts.c_str(), headers.data(), 2};
    for (int i = 0; i < 2; ++i) {
      Imf::OutputPart part{file, i};
      part.setFrameBuffer(pixels[static_cast<std::size_t>(i)].buffer);
      part.writePixels(40);
    }
  }
  for (const std::string& name : {one, parts}) {
    CAPTURE(name);
    const std::string out = directory.file("out.exr");
    run_refocus(name, out);
    const Imf::InputFile exr{out.c_str()};
    REQUIRE(Imf::hasMultiView(exr.header()));
    CHECK(Imf::multiView(exr.header()) == std::vector<std::string>{"left", "right"});
    CHECK(values_of(out, "right.R") == values_of(directory.file("r.exr"), "R"));
    CHECK(values_of(out, "right.Z") == values_of(right, "Z"));
    CHECK(values_of(out, "R") != values_of(one, "R"));
    REQUIRE(run_program({"apply", name, "-o", out, "--effect", "box-3"}).status == 0);
    CHECK(values_of(out, "right.G") == values_of(directory.file("ra.exr"), "G"));
    CHECK(Imf::hasMultiView(Imf::InputFile{out.c_str()}.header()));
    // A picture of one view alone is told of.
    CHECK(contains(run_refocus(name, directory.file("out.npy")).err, "has a view right"));
  }
}

TEST_CASE(
    "apply --velocity: layers by their names, with the signs of the program that wrote them") {
  const TemporaryDirectory directory;
  const std::string from = directory.file("a.exr"), plain = directory.file("v.exr");
  const std::string expected = directory.file("expected.exr"), out = directory.file("out.exr");
  const auto light = [](int x, int y) { return (x / 6 + y / 6) % 2 == 0 ? 1.0f : 0.0f; };
  write_exr(from, grey(light, even(5.0f)), box(48, 40), box(48, 40));
  const auto right = [](int x, int) { return x < 24 ? 6.0f : -3.0f; };
  const auto down = [](int, int y) { return y < 20 ? -8.0f : 2.0f; };
  const auto turned = [](const Values& of) {
    return Values{[of](int x, int y) { return -of(x, y); }};
  };
  const auto applied = [&](const std::string& velocity, const std::string& to,
                           const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"apply",      from,     "-o",       to,
                                   "--velocity", velocity, "--effect", "motion-blur:shutter=1"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_program(words);
    CAPTURE(run.err);
    CHECK(run.status == 0);
    return run.err;
  };
  write_exr(plain, {{"X", right}, {"Y", down}}, box(48, 40), box(48, 40));
  CHECK(contains(applied(plain, expected), "the velocity is X and Y as pixels"));
  const PlaneValues blurred = values_of(expected, "R");
  CHECK(blurred != values_of(from, "R"));
  struct Layer {
    Channels channels;
    std::vector<std::string> more;
    const char* told;
  };
  const Channels blender{{"ViewLayer.Normal.X", even(1.0f)}, {"ViewLayer.Normal.Y", even(1.0f)},
                         {"ViewLayer.Normal.Z", even(1.0f)}, {"ViewLayer.Vector.X", even(0.0f)},
                         {"ViewLayer.Vector.Y", even(0.0f)}, {"ViewLayer.Vector.Z", turned(right)},
                         {"ViewLayer.Vector.W", down}};
  const std::vector<Layer> layers{
      {blender, {}, "ViewLayer.Vector.Z and ViewLayer.Vector.W as blender"},
      {both(grey(light, even(1.0f)), {{"forward.u", right}, {"forward.v", turned(down)}}),
       {},
       "forward.u and forward.v as nuke"},
      {{{"backward.u", turned(right)}, {"backward.v", down}},
       {},
       "backward.u and backward.v as nuke"},
      {both(grey(light, even(1.0f)),
            {{"velocity.X", right}, {"velocity.Y", down}, {"velocity.Z", even(3.0f)}}),
       {},
       "velocity.X and velocity.Y as pixels"},
      {{{"a.motionvector.R", right}, {"a.motionvector.G", down}, {"a.motionvector.B", even(0.0f)}},
       {},
       "a.motionvector.R and a.motionvector.G as pixels"},
      {{{"mine.X", right}, {"mine.Y", turned(down)}, {"mine.Z", even(1.0f)}},
       {"--velocity-layer", "mine", "--velocity-encoding", "nuke"},
       "mine.X and mine.Y as nuke"}};
  for (const Layer& layer : layers) {
    const std::string name = directory.file("layer.exr");
    write_exr(name, layer.channels, box(48, 40), box(48, 40));
    CAPTURE(layer.told);
    CHECK(contains(applied(name, out, layer.more), layer.told));
    CHECK(values_of(out, "R") == blurred);
  }
  // A direction alone is no motion.
  write_exr(plain, {{"Normal.X", right}, {"Normal.Y", down}, {"Normal.Z", down}}, box(48, 40),
            box(48, 40));
  const ProgramRun refused =
      run_program({"apply", from, "-o", out, "--velocity", plain, "--effect", "motion-blur"});
  CHECK(refused.status == 2);
  CHECK(contains(refused.err, "holds no motions"));
}
