#include "scenes/load/scene_sections.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/vector_math.h"
#include "scenes/make/shapes.h"
#include "scenes/make/teapot.h"

namespace softfocus {
namespace {

// 2 million triangles at most: a mesh of 80 MB.
constexpr int kMaxCells = 1024;

int read_cells(Section& section, std::string_view key, int fallback, int least) {
  return read_whole_number(section, key, fallback, least, kMaxCells);
}

double read_size(Section& section, std::string_view key, double fallback) {
  return read_number(section, key, fallback, kAnySize);
}

Mesh read_sphere(Section& section) {
  const double radius = read_size(section, "radius", 1.0);
  const int segments = read_cells(section, "segments", 48, 3);
  return make_sphere(radius, segments, read_cells(section, "rings", 24, 2));
}

Mesh read_torus(Section& section) {
  const double ring_radius = read_size(section, "ring_radius", 1.0);
  const double tube_radius = read_size(section, "tube_radius", 0.35);
  if (tube_radius >= ring_radius) {
    fail_at(section, "tube_radius", "must be smaller than ring_radius, or the torus has no hole");
  }
  const int segments = read_cells(section, "segments", 64, 3);
  return make_torus(ring_radius, tube_radius, segments, read_cells(section, "sides", 32, 3));
}

Mesh read_cone(Section& section) {
  const double radius = read_size(section, "radius", 0.5);
  const double height = read_size(section, "height", 1.0);
  const int segments = read_cells(section, "segments", 48, 3);
  return make_cone(radius, height, segments, read_cells(section, "rings", 16, 1));
}

Mesh read_cube(Section& section) {
  const double size = read_size(section, "size", 1.0);
  // Six faces of cells x cells.
  return make_cube(size, read_whole_number(section, "cells", 8, 1, 400));
}

Mesh read_plane(Section& section) {
  const double width = read_size(section, "width", 1.0);
  const double depth = read_size(section, "depth", 1.0);
  const int cells_x = read_cells(section, "cells_x", 8, 1);
  return make_plane(width, depth, cells_x, read_cells(section, "cells_z", 8, 1));
}

Mesh read_teapot(Section& section) {
  const double height = read_size(section, "height", 1.0);
  // 32 patches of divisions x divisions.
  return make_teapot(height, read_whole_number(section, "divisions", 12, 2, 180));
}

struct ShapeKind {
  std::string_view name;
  Mesh (*read)(Section& section);
};

constexpr std::array<ShapeKind, 6> kShapes = {{
    {"sphere", read_sphere},
    {"torus", read_torus},
    {"cone", read_cone},
    {"cube", read_cube},
    {"plane", read_plane},
    {"teapot", read_teapot},
}};

}  // namespace

Mesh read_shape(Section& section) {
  std::vector<std::string_view> names;
  names.reserve(kShapes.size() + 1);
  for (const ShapeKind& kind : kShapes) names.push_back(kind.name);
  names.push_back("model");
  if (!has_key(section, "shape")) {
    const std::vector<std::string> words(names.begin(), names.end());
    fail_at(section, "shape", "is missing; there are " + list_words(words));
  }
  const std::size_t choice = read_choice(section, "shape", 0, names);
  if (choice >= kShapes.size()) {
    fail_at(section, "shape", "a model cannot be used here; only a shape made by formula would do");
  }
  Mesh mesh = kShapes[choice].read(section);
  const auto times = read_numbers(section, "texture_repeat", {1.0, 1.0}, 2, {-1e4, 1e4});
  if (read_flag(section, "inside_out", false)) mesh = inside_out(std::move(mesh));
  repeat_uvs(mesh, {times[0], times[1]});
  return mesh;
}

bool is_model(Section& section) {
  const toml::node* shape = find_key(section, "shape");
  return shape != nullptr && shape->value<std::string_view>() == "model";
}

double bounding_radius(const Mesh& mesh) {
  double largest = 0.0;
  for (const glm::vec3& position : mesh.positions) {
    const glm::dvec3 p{position};
    largest = std::max(largest, dot(p, p));
  }
  return std::sqrt(largest);
}

}  // namespace softfocus
