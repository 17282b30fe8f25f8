// The page's requests about a picture and its depth, answered natively: the bits of `refocus`.

#include "tools/page/picture.h"

#include <doctest/doctest.h>

#include <bit>
#include <functional>
#include <limits>

#include "tests/support/cli_render.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 48, kHeight = 32;

/// A map of one grey as PFM.
std::string pfm(int width, int height, const std::function<float(int x, int y)>& value) {
  std::string text = "Pf\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) {
      const auto bits = std::bit_cast<std::uint32_t>(value(x, y));
      for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(bits >> shift & 255U);
    }
  }
  return text;
}

/// figures as a picture: a.png, and its depth d.png in millimetres; both in a.npy; the depth as a
/// grey picture grey.png. Other maps: one with a hole, one of another shape, one of circles.
struct Files {
  TemporaryDirectory directory;
  std::string a = directory.file("a.png"), d = directory.file("d.png"),
              both = directory.file("a.npy"), grey = directory.file("grey.png"),
              hole = directory.file("hole.pfm"), wide = directory.file("wide.pfm"),
              circles = directory.file("circles.pfm");

  Files() {
    write_file(hole, pfm(kWidth, kHeight, [](int x, int y) {
                 const bool is_hole = x >= 10 && x < 20 && y >= 10 && y < 20;
                 return is_hole ? std::numeric_limits<float>::quiet_NaN() : x < 15 ? 0.7f : 2.0f;
               }));
    write_file(wide, pfm(2 * kWidth, kHeight,
                         [](int x, int) { return 0.5f + 0.02f * static_cast<float>(x); }));
    write_file(circles, pfm(kWidth, kHeight,
                            [](int x, int) { return 0.25f * static_cast<float>(x) - 4.0f; }));
    const Words pinhole{"--show", "pinhole"};
    CHECK(run_program(render("figures", a, {"--show", "pinhole", "--depth-output", d})).status ==
          0);
    CHECK(run_program(render("figures", both, pinhole)).status == 0);
    CHECK(run_program(render("figures", grey, {"--show", "depth"})).status == 0);
  }
};

Json ask(Page& page, const Json& request) { return *parse_json(answer(page, json_text(request))); }

Json ask_well(Page& page, const Json& request) {
  Json reply = ask(page, request);
  const Json* error = reply.find("error");
  REQUIRE_MESSAGE(error == nullptr, error->text());
  return reply;
}

std::string error_of(Page& page, const Json& request) {
  const Json reply = ask(page, request);
  const Json* error = reply.find("error");
  return error == nullptr ? "" : error->text();
}

/// The report of `refocus` on the same files.
nlohmann::json refocused_by_program(const Files& files, Words words) {
  words.insert(words.begin(), "refocus");
  words.insert(words.end(), {"-o", files.directory.file("result.npy"), "--json"});
  const ProgramRun run = run_program(words);
  REQUIRE_MESSAGE(run.status == 0, run.err);
  return nlohmann::json::parse(run.out);
}

}  // namespace

TEST_CASE("a picture's frame has the bits of refocus, by every setting") {
  const Files files;
  const Json pair{{"do", "open"}, {"picture", files.a}, {"depth", files.d}};
  const Json both{{"do", "open"}, {"picture", files.both}};
  const Json grey{{"do", "open"},         {"picture", files.a}, {"depth", files.grey},
                  {"encoding", "device"}, {"near_m", 0.5},      {"far_m", 4.0}};
  const Words of_pair{files.a, files.d}, of_both{files.both};
  const Words of_grey{files.a, files.grey, "--depth-encoding", "device", "--near", "0.5",
                      "--far", "4"};
  struct Case {
    Json open;
    Words files;
    Json frame;
    Words options;
  };
  const auto opened = [&](const std::string& depth, const Json& key, const Json& value) {
    Json open{{"do", "open"}, {"picture", files.a}, {"depth", depth}, {"encoding", "metres"}};
    open[key.text()] = value;
    return open;
  };
  const Json sharp_at_1{
      {"do", "frame"}, {"focus", {{"m", 1.0}}}, {"coc_scale", 9.0}, {"method", "two-pass"}};
  const Words by_program{"--focus", "1", "--coc-scale", "9", "--method", "two-pass"};
  std::vector<Case> cases;
  for (const char* side : {"near", "far", "infinity", "background"}) {
    cases.push_back({opened(files.hole, "holes", side),
                     {files.a, files.hole, "--depth-encoding", "metres", "--holes", side},
                     sharp_at_1,
                     by_program});
  }
  for (const char* fit : {"stretch", "crop"}) {
    cases.push_back({opened(files.wide, "depth_fit", fit),
                     {files.a, files.wide, "--depth-encoding", "metres", "--depth-fit", fit},
                     sharp_at_1,
                     by_program});
  }
  cases.push_back({opened(files.circles, "encoding", "circles"),
                   {files.a, "--circles", files.circles},
                   sharp_at_1,
                   {"--method", "two-pass"}});
  const std::vector<Case> of_old{
      {pair,
       of_pair,
       {{"do", "frame"},
        {"focus", {{"m", 1.0}}},
        {"coc_scale", 9.0},
        {"method", "scatter-aperture"},
        {"aperture_blades", 6},
        {"aperture_turn_degrees", 15.0},
        {"anamorphic", 0.5},
        {"highlight_gain", 8.0},
        {"highlight_threshold", 0.25}},
       {"--focus", "1", "--coc-scale", "9", "--method", "scatter-aperture", "--aperture-blades",
        "6", "--aperture-turn", "15", "--anamorphic", "0.5", "--highlights", "8,0.25"}},
      {pair,
       of_pair,
       {{"do", "frame"},
        {"focus", {{"at", {0.5, 0.5}}}},
        {"coc_scale", 4.0},
        {"method", "two-pass"}},
       {"--coc-scale", "4", "--method", "two-pass", "--focus-at", "24,16"}},
      {both,
       of_both,
       {{"do", "frame"},
        {"focus", {{"m", 0.9}}},
        {"f_number", 1.2},
        {"focal_length_mm", 80.0},
        {"method", "disc-layers"}},
       {"--focus", "0.9", "--f-number", "1.2", "--focal-length", "80", "--method", "disc-layers"}},
      {both,
       of_both,
       {{"do", "frame"}, {"focus", {{"at", {0.0, 1.0}}}}, {"show", "coc"}},
       {"--focus-at", "0,31", "--show", "coc"}},
      {grey,
       of_grey,
       {{"do", "frame"},
        {"focus", {{"m", 2.0}}},
        {"max_coc_px", 3.0},
        {"coc_scale", 9.0},
        {"method", "two-pass"}},
       {"--focus", "2", "--max-coc", "3", "--method", "two-pass", "--coc-scale", "9"}},
      {pair,
       of_pair,
       {{"do", "frame"}, {"focus", {{"m", 1.0}}}, {"show", "depth"}},
       {"--focus", "1", "--show", "depth"}}};
  cases.insert(cases.end(), of_old.begin(), of_old.end());
  for (const Case& one : cases) {
    Page page;
    ask_well(page, one.open);
    const Json frame = ask_well(page, one.frame);
    Words words = one.files;
    words.insert(words.end(), one.options.begin(), one.options.end());
    CAPTURE(words.back());
    const auto expected = refocused_by_program(files, words);
    CHECK(frame.at("hash").text() == expected["picture_hash"].get<std::string>());
    if (!expected["focus_m"].is_null()) {
      CHECK(frame.at("focus_m").number() == doctest::Approx(expected["focus_m"].get<double>()));
    }
    CHECK(frame.at("max_coc_px").number() == expected["max_coc_px"].get<double>());
  }
}

TEST_CASE("a picture's file is the one that refocus writes") {
  const Files files;
  Page page;
  ask_well(page, {{"do", "open"}, {"picture", files.a}, {"depth", files.d}});
  CHECK(error_of(page, {{"do", "save"}, {"format", "png"}}) != "");  // nothing is shown yet
  ask_well(page,
           {{"do", "frame"}, {"focus", {{"m", 1.0}}}, {"coc_scale", 5.0}, {"method", "two-pass"}});
  for (const std::string format : {"png", "png-16", "npy", "pfm", "hdr"}) {
    CAPTURE(format);
    const Json reply = ask_well(page, {{"do", "save"}, {"format", format}});
    CHECK(reply.at("saved_bytes").integer() == static_cast<int>(page.saved.size()));
    const std::string out = files.directory.file("r." + format.substr(0, 3));
    CHECK(run_program({"refocus", files.a, files.d, "-o", out, "--format", format, "--focus", "1",
                       "--coc-scale", "5", "--method", "two-pass"})
              .status == 0);
    CHECK(std::string{reinterpret_cast<const char*>(page.saved.data()), page.saved.size()} ==
          read_file(out));
  }
  for (const std::string format : {"rgb24", "bmp", ""}) {
    CHECK(error_of(page, {{"do", "save"}, {"format", format}}) != "");
  }
}

TEST_CASE("a depth that cannot be told is asked for, and the picture is there meanwhile") {
  const Files files;
  Page page;
  Json open{{"do", "open"}, {"picture", files.a}, {"depth", files.grey}};
  Json about = ask_well(page, open).at("picture");
  CHECK(about.at("believed").is_null());
  CHECK(about.at("lacks").text().find("choose") != std::string::npos);
  CHECK(about.at("type").text() == "8 bits");
  const Json sharp = ask_well(page, {{"do", "frame"}});
  CHECK(sharp.find("focus_m") == nullptr);
  CHECK(sharp.at("width").integer() == 48);
  open["encoding"] = "white-near";
  CHECK(ask_well(page, open).at("picture").at("lacks").text() ==
        "white-near needs numbers: near, far");
  open["near_m"] = 4.0;
  open["far_m"] = 1.0;
  CHECK(ask_well(page, open).at("picture").at("lacks").text().find("less than") !=
        std::string::npos);
  open["near_m"] = 0.5;
  about = ask_well(page, open).at("picture");
  CHECK(about.at("lacks").text() == "");
  CHECK(about.at("line").text().starts_with("the depth is white-near, 0."));
  CHECK(ask_well(page, {{"do", "frame"}}).find("focus_m") != nullptr);
}

TEST_CASE("a depth of another shape is there once its fit is said, and holes may be refused") {
  const Files files;
  Page page;
  Json open{{"do", "open"}, {"picture", files.a}, {"depth", files.wide}, {"encoding", "metres"}};
  CHECK(ask_well(page, open).at("picture").at("lacks").text().find("--depth-fit stretch or crop") !=
        std::string::npos);
  CHECK(ask_well(page, {{"do", "frame"}}).find("focus_m") == nullptr);
  open["depth_fit"] = "crop";
  CHECK(ask_well(page, open).at("picture").at("lacks").text() == "");
  open["depth_fit"] = "squeeze";
  CHECK(error_of(page, open) == "depth_fit 'squeeze': there are stretch, crop");
  open["depth"] = files.hole;
  open["depth_fit"] = nullptr;
  open["holes"] = "refuse";
  CHECK(error_of(page, open).starts_with("--holes refuse: "));
}

TEST_CASE("circles need no lens, and a pixel of theirs has no depth") {
  const Files files;
  Page page;
  ask_well(
      page,
      {{"do", "open"}, {"picture", files.a}, {"depth", files.circles}, {"encoding", "circles"}});
  Json frame{{"do", "frame"}, {"focus", {{"m", 1.0}}}};
  const Json made = ask_well(page, frame);
  frame["f_number"] = 1.0;
  frame["focus"] = {{"m", 3.0}};
  CHECK(ask_well(page, frame).at("hash").text() == made.at("hash").text());
  const Json pixel = ask_well(page, {{"do", "pixel"}, {"x", 40}, {"y", 16}});
  CHECK(!pixel.at("has_depth").boolean());
  CHECK(pixel.at("coc_radius_px").number() == doctest::Approx(6.0).epsilon(0.01));
}

TEST_CASE("a guess that puts the picture beyond 100 m warns, as refocus does") {
  const TemporaryDirectory directory;
  const std::string colour = directory.file("a.png"), depth = directory.file("d.pfm");
  CHECK(run_program(render("figures", colour, {"--show", "pinhole"})).status == 0);
  std::string far = "Pf\n48 32\n-1.0\n";
  for (int i = 0; i < 48 * 32; ++i) far += std::string("\0\0\x7A\x43", 4);  // 250
  write_file(depth, far);
  Page page;
  const Json reply = ask_well(page, {{"do", "open"}, {"picture", colour}, {"depth", depth}});
  CHECK(reply.at("picture").at("line").text().starts_with("the depth is metres, 250 m"));
  REQUIRE(reply.at("warnings").values().size() == 1);
  CHECK(reply.at("warnings").at(std::size_t{0}).text().find("beyond 100 m") != std::string::npos);
}

TEST_CASE("a coarse picture has a part of its pixels, and of its circles") {
  const Files files;
  Page page;
  ask_well(page, {{"do", "open"}, {"picture", files.both}});
  Json frame{{"do", "frame"}, {"focus", {{"m", 1.0}}}, {"coc_scale", 6.0}};
  const Json whole = ask_well(page, frame);
  frame["preview"] = 4;
  const Json coarse = ask_well(page, frame);
  CHECK(coarse.at("width").integer() == 12);
  CHECK(coarse.at("height").integer() == 8);
  CHECK(coarse.at("radius_at_infinity_px").number() ==
        doctest::Approx(whole.at("radius_at_infinity_px").number() / 4.0));
  CHECK(error_of(page, {{"do", "save"}, {"format", "png"}}) != "");
  frame["preview"] = 1;
  CHECK(ask_well(page, frame).at("hash").text() == whole.at("hash").text());
}

TEST_CASE("a pixel of a picture has its depth and its circle") {
  const Files files;
  Page page;
  ask_well(page, {{"do", "open"}, {"picture", files.both}});
  const Json frame = ask_well(page, {{"do", "frame"}, {"focus", {{"at", {0.5, 0.5}}}}});
  const Json pixel = ask_well(page, {{"do", "pixel"}, {"x", 24}, {"y", 16}});
  CHECK(pixel.at("depth_m").number() == doctest::Approx(frame.at("focus_m").number()).epsilon(0.1));
  CHECK(!pixel.at("coc_radius_px").is_null());
}

TEST_CASE("what needs a scene is refused with why, and scenes are there again") {
  const Files files;
  Page page;
  ask_well(page, {{"do", "open"}, {"picture", files.a}, {"depth", files.d}});
  ask_well(page, {{"do", "frame"}});
  for (const Json& request :
       {Json{{"do", "truth"}, {"views", 4}}, Json{{"do", "file"}, {"name", "scene.toml"}},
        Json{{"do", "compare_methods"}, {"methods", Json::array()}, {"radii", Json::array()}}}) {
    CHECK(error_of(page, request) == kNoScene);
  }
  CHECK(error_of(page, {{"do", "frame"}, {"method", "accumulation"}}).find("draws a scene") !=
        std::string::npos);
  const std::string report =
      ask_well(page, {{"do", "file"}, {"name", "report.txt"}}).at("text").text();
  CHECK(report.find("millimetres") != std::string::npos);
  ask_well(page, {{"do", "open"}, {"scene", "figures"}});
  CHECK(ask_well(page, {{"do", "frame"}, {"size", {32, 32}}}).at("width").integer() == 32);
  CHECK(error_of(page, {{"do", "save"}, {"format", "png"}}) != "");
}

TEST_CASE("files that are no picture and depth are one line, and the page is as before") {
  const Files files;
  Page page;
  ask_well(page, {{"do", "open"}, {"picture", files.a}, {"depth", files.d}});
  const std::string hash = ask_well(page, {{"do", "frame"}}).at("hash").text();
  write_file(files.directory.file("cut.png"), read_file(files.a).substr(0, 90));
  write_file(files.directory.file("x.tif"), std::string{"II*\0____", 8});
  const auto file = [&](const char* name) { return Json{files.directory.file(name)}; };
  const std::vector<Json> wrong{
      {{"do", "open"}, {"picture", file("nothing.png")}},
      {{"do", "open"}, {"picture", file("cut.png")}, {"depth", files.d}},
      {{"do", "open"}, {"picture", file("x.tif")}, {"depth", files.d}},
      {{"do", "open"}, {"picture", files.a}},  // no depth
      {{"do", "open"}, {"picture", files.d}, {"depth", files.a}, {"encoding", "metres"}},
      {{"do", "open"}, {"picture", files.a}, {"depth", files.d}, {"encoding", "none"}},
      {{"do", "open"}, {"picture", files.a}, {"depth", files.d}, {"near_m", -1.0}},
      {{"do", "open"}, {"picture", 3}}};
  for (const Json& request : wrong) {
    const std::string error = error_of(page, request);
    CAPTURE(json_text(request));
    CHECK(error != "");
    CHECK(error.find('\n') == std::string::npos);
  }
  CHECK(ask_well(page, {{"do", "frame"}}).at("hash").text() == hash);
}
