#pragma once
// `softfocus refocus` for plug-ins of other programs, GEGL's and OpenFX's: its options as tables,
// from which a plug-in makes its controls, and its work on floats in memory.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "raster/numbers/parameter.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {

/// A number that can be set: named as the option of `refocus`, or (0: not used) instead of another.
struct PluginNumber {
  Parameter parameter;
  double shown_most;  ///< where a slider ends, which begins at the least
};
std::span<const PluginNumber> plugin_numbers();

/// An option whose values are words.
struct PluginChoice {
  std::string_view name, summary;
  std::vector<std::string_view> words;
  std::size_t preset = 0;
};
const PluginChoice& plugin_methods();
const PluginChoice& plugin_encodings();
const PluginChoice& plugin_holes();
std::string_view plugin_mend_edges();  ///< the text of that switch

/// Values of all controls; at first their presets.
struct PluginSettings {
  PluginSettings();
  double number(std::string_view name) const;

  std::vector<double> numbers;  ///< in the order of plugin_numbers()
  std::size_t method, encoding, holes;
  bool mend_edges = false;
};

/// A picture in linear light, red, green, blue and alpha, multiplied by it, row by row from the top
/// without a gap; and a depth of the same size.
struct PluginFrame {
  int width = 0, height = 0;
  std::span<float> rgba{};        ///< the result too
  std::vector<float> codes{};     ///< of the depth, as stored: whole numbers up to 255 of 8 bits
  std::vector<float> is_known{};  ///< 0: nothing is known of the depth; or empty
  NumberType type = NumberType::single;  ///< of the codes
  KeptPart kept{};                       ///< what of the result is wanted
};

/// Refocuses a frame, whose codes are used up. With the same settings and numbers the bits are
/// those of `softfocus refocus`. Returns "", or a sentence about what is wrong: then the picture
/// stays as it is. Throws std::bad_alloc.
std::string refocus_in_plugin(const PluginSettings& settings, PluginFrame frame);

}  // namespace softfocus
