#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "dof/lens.h"
#include "tests/support/run_program.h"

using namespace softfocus;

namespace {

nlohmann::json lens_json(std::vector<std::string> options) {
  options.insert(options.begin(), {"lens", "--json"});
  const ProgramRun run = run_program(options);
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return nlohmann::json::parse(run.out);
}

}  // namespace

TEST_CASE("lens: a worked example, 50 mm f/2 at 2 m") {
  const auto json = lens_json({"--at", "1", "2", "4"});
  CHECK(json["aperture_mm"] == 25.0);
  // v0 = 50 * 2000 / 1950 = 51.282 mm, times 2 tan 20 degrees.
  CHECK(json["film_height_mm"].get<double>() == doctest::Approx(37.3303));
  // c = A f |z - z_f| / (z (z_f - f)): 25 * 50 * 1000 / (1000 * 1950) and half of it.
  CHECK(json["at"][0]["coc_on_film_mm"].get<double>() == doctest::Approx(0.641026));
  CHECK(json["at"][1]["coc_on_film_mm"] == 0.0);
  CHECK(json["at"][2]["coc_on_film_mm"].get<double>() == doctest::Approx(0.320513));
}

TEST_CASE("lens: the radius in pixels is half the film's circle, in film heights") {
  const auto json = lens_json({"--height", "600", "--fov", "30", "--focus", "3", "--at", "1", "9"});
  const double pixels_per_mm = 600.0 / json["film_height_mm"].get<double>();
  for (const auto& at : json["at"]) {
    const double sign = at["distance_m"] < 3.0 ? -1.0 : 1.0;
    CHECK(at["radius_px"].get<double>() ==
          doctest::Approx(sign * at["coc_on_film_mm"].get<double>() / 2.0 * pixels_per_mm));
  }
}

TEST_CASE("lens: a circle is sharp up to one pixel of the film if nothing is said") {
  const auto json = lens_json({"--height", "500"});
  CHECK(json["largest_sharp_coc_mm"].get<double>() ==
        doctest::Approx(json["film_height_mm"].get<double>() / 500.0));
}

TEST_CASE("lens: at the sharp limits the circle has the largest size that counts as sharp") {
  const auto json = lens_json({"--max-coc-film", "0.03"});
  const std::string near = json["sharp_from_m"].dump(), far = json["sharp_to_m"].dump();
  const auto limits = lens_json({"--max-coc-film", "0.03", "--at", near, far});
  CHECK(limits["at"][0]["coc_on_film_mm"].get<double>() == doctest::Approx(0.03));
  CHECK(limits["at"][1]["coc_on_film_mm"].get<double>() == doctest::Approx(0.03));
}

TEST_CASE("lens: the hyperfocal distance is f^2 / (N c) + f") {
  const auto json =
      lens_json({"--focal-length", "50", "--f-number", "4", "--max-coc-film", "0.03"});
  CHECK(json["hyperfocal_m"].get<double>() == doctest::Approx((2500.0 / 0.12 + 50.0) / 1000.0));
}

TEST_CASE("lens: focused past the hyperfocal distance everything far is sharp") {
  const std::vector<std::string> options{"--focus", "50", "--max-coc-film", "0.03"};
  CHECK(lens_json(options)["sharp_to_m"].is_null());
  CHECK(contains(run_program({"lens", "--focus", "50", "--max-coc-film", "0.03"}).out,
                 "sharp to               infinity\n"));
}

TEST_CASE("lens: --coc-scale enlarges the radius in pixels and leaves the film alone") {
  const auto once = lens_json({"--at", "1"}), thrice = lens_json({"--at", "1", "--coc-scale", "3"});
  CHECK(thrice["at"][0]["radius_px"].get<double>() ==
        doctest::Approx(3.0 * once["at"][0]["radius_px"].get<double>()));
  CHECK(thrice["at"][0]["coc_on_film_mm"] == once["at"][0]["coc_on_film_mm"]);
}

TEST_CASE("lens: the text names each figure with its unit, and a line for each distance") {
  const ProgramRun run = run_program({"lens", "--at", "1", "--at", "2"});
  CHECK(run.status == 0);
  for (const std::string_view line :
       {"focal length           50 mm\n", "f-number               2\n",
        "aperture               25 mm\n", "focus distance         2 m\n",
        "film height            37.3303 mm for 40 degrees and 1024 pixels\n",
        "hyperfocal distance    34.3385 m\n", "sharp from             1.89238 m\n",
        "sharp to               2.1206 m\n", "radius at infinity     8.79193 px\n",
        "  distance m     circle on film mm     radius px\n",
        "           1              0.641026      -8.79193\n",
        "           2                     0             0\n"}) {
    CAPTURE(line);
    CHECK(contains(run.out, line));
  }
}

TEST_CASE("lens: without --at there are distances around the focus, nearer and farther") {
  const auto at = lens_json({"--focus", "8"})["at"];
  CHECK(at.front()["distance_m"] == 2.0);
  CHECK(at.back()["distance_m"] == 80.0);
}
