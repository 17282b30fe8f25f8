#pragma once
// glTF 2.0 models, .gltf and .glb, read by tinygltf.

#include <filesystem>

#include "scenes/models/model.h"

namespace softfocus {

/// Reads the file's scene: meshes where its nodes put them, joined by material; skins and morph
/// targets in the pose of the file; the first perspective camera; the lights of
/// KHR_lights_punctual.
///
/// A metallic-roughness material becomes Blinn-Phong's, with m metallic and r roughness, each times
/// the mean of its texture:
///   diffuse, ambient   base colour * (1 - m / 2): half stands in for what a metal would mirror
///   shininess n        2 / r^4 - 2, from 1 to 1024
///   specular           (1 - r) min(1, (n + 8) / 8 * (0.04 (1 - m) + mean base colour * m))
///   alpha              of BLEND opacity, of MASK a cut-out
/// KHR_materials_unlit gives the base colour alone, and KHR_texture_transform is obeyed. A black
/// material (by its factor) that gives off light shows that light; of others it is left out, with a
/// warning.
///
/// Lights: the colours of all are divided by what the brightest throws on the middle of the model.
/// A spot is a point.
///
/// Missing normals are those of the triangles. A texture that is missing or of another format than
/// PNG and JPEG is a warning; so are points and lines. Of a model far from the origin for its size
/// the middle is subtracted. Throws SceneError for what is no glTF 2.0, an accessor that goes past
/// its buffer, a position that is none, a picture that cannot be decoded, a file without triangles,
/// and one that needs an extension that is not understood.
Model load_gltf_model(const std::filesystem::path& path);

}  // namespace softfocus
