// docs/scene-format.md says what the program does: each key, default and range of its tables.

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/support/scene_texts.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

using Words = std::vector<std::string>;

/// A scene in which % stands for keys of the section, by the heading in the document.
const std::map<std::string, std::string> kScenes{
    {"Top of the file", "%"},
    {"`[camera]`", "[camera]\n%"},
    {"`[lens]`", "[lens]\n%"},
    {"`[impostors]`", "[impostors]\n%"},
    {"`[backdrop]`", "[backdrop]\neye = [0, 0, 9]\nbeyond_m = 2\n%" + object("shape = \"cube\"\n")},
    {"`[[light]]`", "[[light]]\nkind = \"directional\"\ndirection = [0, 1, 0]\n%"},
    {"`map`", "[[light]]\nkind = \"directional\"\ndirection = [0, 1, 0]\n[light.map]\n%"},
    {"`[texture.NAME]`",
     "[texture.t]\nkind = \"dots\"\ncolours = [[0, 0, 0], [1, 1, 1]]\n%[material.m]\ntexture = "
     "\"t\"\n[[object]]\nmaterial = \"m\"\nshape = \"cube\"\n"},
    {"`[material.NAME]`", "[material.m]\n%[[object]]\nmaterial = \"m\"\nshape = \"cube\"\n"},
    {"`[[object]]`", object("shape = \"cube\"\n%")},
    {"`[[scatter]]`", scatter_of("%")}};

std::string between(const std::string& begin, const std::string& middle, const std::string& end) {
  return begin + middle + end;
}

std::string setting(const std::string& key, const std::string& value) {
  return key + " = " + value + "\n";
}

std::string with_keys(const std::string& heading, const std::string& keys) {
  std::string text = kScenes.at(heading);
  if (keys.starts_with("position") || keys.starts_with("radius_m")) {
    if (heading == "`[[light]]`") text = "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n%";
  }
  const std::string key = keys.substr(0, keys.find(' '));
  const std::size_t there = text.find("\n" + key + " = ");  // in place of the scene's own
  if (there != text.npos) text.erase(there + 1, text.find('\n', there + 1) - there);
  return text.replace(text.find('%'), 1, keys);
}

struct Section {
  std::string text;
  std::vector<Words> rows;  ///< the tables' cells, without backquotes
};

std::map<std::string, Section> sections() {
  std::map<std::string, Section> all;
  const std::string document = read_file(SOFTFOCUS_TEST_DATA "/../../docs/scene-format.md");
  std::string heading;
  for (std::size_t start = 0; start < document.size();) {
    const std::size_t end = std::min(document.find('\n', start), document.size());
    const std::string line = document.substr(start, end - start);
    start = end + 1;
    if (line.starts_with("#")) heading = line.substr(line.find(' ') + 1);
    all[heading].text += line + "\n";
    if (!line.starts_with("| `")) continue;
    Words cells;
    for (std::size_t bar = 0, next; (next = line.find('|', bar + 1)) != line.npos; bar = next) {
      std::string cell = next - bar > 2 ? line.substr(bar + 2, next - bar - 3) : "";
      if (cells.size() < 2 && std::count(cell.begin(), cell.end(), '`') == 2) {
        cell.erase(std::remove(cell.begin(), cell.end(), '`'), cell.end());
      }
      cells.push_back(cell);
    }
    all[heading].rows.push_back(cells);
  }
  return all;
}

/// "LOW..HIGH" as the complaint about a number far beyond has it.
std::string told_range(const std::string& said) {
  const std::string above = "above 0, up to ";
  if (said.find(above) != said.npos) return "1e-9.." + said.substr(said.find(above) + above.size());
  const std::size_t from = said.rfind("from "), to = said.rfind(" to ");
  if (from == said.npos || to == said.npos || to < from) return "";
  return said.substr(from + 5, to - from - 5) + ".." + said.substr(to + 4);
}

void check_range(const std::string& text, const std::string& range) {
  const std::string said = complaint(text);
  CAPTURE(said);
  const std::string told = told_range(said);
  REQUIRE(told != "");
  const auto ends = [](const std::string& of) {
    return std::pair{std::stod(of), std::stod(of.substr(of.find("..") + 2))};
  };
  CHECK(ends(told) == ends(range));
}

/// All numbers of a scene.
std::vector<double> numbers_of(const Scene& scene) {
  std::vector<double> all;
  const auto add = [&](const auto&... numbers) {
    (all.push_back(static_cast<double>(numbers)), ...);
  };
  const auto add_vector = [&](const auto& v) { add(v.x, v.y, v.z); };
  add_vector(scene.background), add_vector(scene.ambient_light), add(scene.light_points);
  const Camera& camera = scene.camera;
  add_vector(camera.position), add_vector(camera.target), add_vector(camera.up);
  add(camera.fov_y_degrees, camera.near_m, camera.far_m, camera.orbit_degrees_per_frame,
      camera.shutter_frames, camera.easing);
  const ImpostorBudget& impostors = scene.impostors;
  add(impostors.tolerance_px, impostors.memory_mb, impostors.milliseconds);
  const SceneLens& lens = scene.lens;
  for (const LensNumber& number : kLensNumbers) add(lens.lens.*number.place);
  add(lens.easing, lens.coc_scale, lens.max_coc_px_at_1024);
  for (const Light& light : scene.lights) {
    add_vector(light.colour);
    add(light.kind, light.shadows, light.shadow_darkness, light.terminator, light.radius_m,
        light.angular_radius_degrees, light.map.size, light.map.bias, light.map.slope_bias,
        light.map.kernel, light.map.cascades, light.map.fits_camera);
  }
  for (const Texture& texture : scene.textures) {
    for (const std::byte byte : texture.levels[0].bytes) add(static_cast<int>(byte));
  }
  for (const Material& material : scene.materials) {
    add_vector(material.ambient), add_vector(material.diffuse), add_vector(material.specular);
    add(material.shininess, material.opacity, material.two_sided, material.lit,
        material.sampler.filter, material.sampler.wrap_u, material.sampler.wrap_v);
  }
  for (const Object& object : scene.objects) {
    add_vector(object.position), add_vector(object.rotation_degrees), add_vector(object.scale);
    add_vector(object.spin_degrees_per_frame), add_vector(object.sway);
    add(object.sway_period_frames, object.sway_phase, object.impostor);
  }
  for (const Mesh& mesh : scene.meshes) {
    for (const glm::vec3& position : mesh.positions) add_vector(position);
    for (const glm::vec2& uv : mesh.uvs) add(uv.x, uv.y);
  }
  return all;
}

constexpr const char* kTooMuch = "9000000000000000000";

}  // namespace

TEST_CASE("docs/scene-format.md: ranges are the program's") {
  int ranges = 0;
  for (const auto& named : sections()) {
    const std::string& heading = named.first;
    for (const Words& row : named.second.rows) {
      if (row.size() != 4 || row[2].empty()) continue;
      CAPTURE(heading);
      CAPTURE(row[0]);
      std::string value{kTooMuch};
      if (row[1].starts_with("[0, ") || row[1].starts_with("[1, ") || row[1].starts_with("[-1") ||
          row[0] == "direction" || row[0] == "position" || row[0] == "eye" || row[0] == "diffuse" ||
          row[0] == "ambient" || row[0] == "ambient_light") {
        const auto commas = std::count(row[1].begin(), row[1].end(), ',');
        value = between("[", value, commas == 1 ? ", 1]" : ", 1, 1]");
      }
      if (row[0] == "colours") value = between("[[", value, ", 1, 1], [1, 1, 1]]");
      if (row[0] == "avoid") value = between("[[", value, ", 1, 1, 1]]");
      check_range(with_keys(heading, setting(row[0], value)), row[2]);
      ++ranges;
    }
  }
  CHECK(ranges >= 45);
}

TEST_CASE("docs/scene-format.md: a default is what counts without the key") {
  int defaults = 0;
  for (const auto& named : sections()) {
    const std::string& heading = named.first;
    for (const Words& row : named.second.rows) {
      if (row.size() != 4 || row[1].find_first_of("[\"0123456789tf") != 0) continue;
      if (row[1].starts_with("the ")) continue;
      CAPTURE(heading);
      CAPTURE(row[0]);
      // Radii and angles are of one kind of light, whose scene has a position or a direction.
      const std::string with = with_keys(heading, setting(row[0], row[1]));
      std::string without = with;
      without.erase(without.find("\n" + row[0] + " = ") + 1, row[0].size() + row[1].size() + 4);
      CHECK(numbers_of(read(with)) == numbers_of(read(without)));
      ++defaults;
    }
  }
  CHECK(defaults >= 45);
}

TEST_CASE("docs/scene-format.md: it has every key, and no other") {
  const auto all = sections();
  for (const auto& named : kScenes) {
    const std::string& heading = named.first;
    CAPTURE(heading);
    const Section& section = all.at(heading);
    const std::string said = complaint(with_keys(heading, "nothing = 1\n"));
    const std::string begin = "here are ";
    REQUIRE(said.find(begin) != said.npos);
    std::string known = said.substr(said.find(begin) + begin.size());
    known.replace(known.find(" and "), 5, ", ");
    known = between(", ", known, ", ");
    for (std::size_t at = 0, next; (next = known.find(", ", at + 2)) != known.npos; at = next) {
      const std::string key = known.substr(at + 2, next - at - 2);
      CAPTURE(key);
      CHECK(
          (contains(section.text, "`" + key + "`") || all.contains("`[" + key + "]`") ||
           all.contains("`[[" + key + "]]`") || all.contains("`[" + key + ".NAME]`") ||
           (heading == "`[[scatter]]`" && contains(all.at("`[[object]]`").text, "`" + key + "`"))));
    }
    for (const Words& row : section.rows) {
      if (row.size() != 4) continue;
      CAPTURE(row[0]);
      CHECK(!contains(complaint(with_keys(heading, row[0] + " = 1\n")), "there is no such key"));
    }
  }
}

TEST_CASE("docs/scene-format.md: shapes have these keys, defaults and ranges") {
  int keys = 0;
  const auto all = sections();
  for (const Words& row : all.at("`[[object]]`").rows) {
    if (row.size() != 3 || row[0] == "model") continue;
    const std::string shape = "shape = \"" + row[0] + "\"\n";
    const std::vector<double> plain = numbers_of(read(object(shape)));
    for (std::size_t at = 0; (at = row[1].find('`', at)) != std::string::npos;) {
      const std::size_t end = row[1].find('`', at + 1), next = row[1].find('`', end + 1);
      const std::string key = row[1].substr(at + 1, end - at - 1);
      const std::string rest = row[1].substr(end + 1, next - end - 1);
      CAPTURE(key);
      const std::string preset = rest.substr(1, rest.find_first_of(" ,(", 1) - 1);
      CHECK(numbers_of(read(object(shape + setting(key, preset)))) == plain);
      const std::size_t bracket = rest.find('(');
      check_range(object(shape + setting(key, std::string{kTooMuch})),
                  bracket == rest.npos ? "1e-6..1e6" : rest.substr(bracket + 1));
      at = next;
      ++keys;
    }
  }
  CHECK(keys == 19);
}
