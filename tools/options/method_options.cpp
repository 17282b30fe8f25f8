#include "tools/options/method_options.h"

#include <cmath>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {

void add_method_option(CLI::App& parser, const Method*& method) {
  add_value(parser, "--method", "NAME",
            "Depth-of-field method (default: " + std::string{method->name} + ")",
            [&method](const std::string& text) {
              method = find_method(text);
              if (method == nullptr) {
                throw UsageError("--method '" + text + "': there are " + names_of(methods()));
              }
            });
}

void add_method_option(CLI::App& parser, MethodChoice& method) {
  add_value(parser, "--method", "NAME",
            "Depth-of-field method (default: " + std::string{method.name()} + ")",
            [&method](const std::string& text) {
              method = {find_method(text), find_lens_view_method(text)};
              if (method.filter != nullptr || text == kAutoMethod) return;
              if (method.of_scene == nullptr) {
                throw UsageError("--method '" + text + "': there are " + names_of(methods()) +
                                 ", " + names_of(lens_view_methods()) + ", " +
                                 std::string{kAutoMethod});
              }
              if (!method.of_scene->missing.empty()) {
                throw UsageError("--method " + text + ": " + std::string{method.of_scene->missing});
              }
            });
}

void add_max_coc_option(CLI::App& parser, std::optional<float>& max_coc_px) {
  add_value(parser, "--max-coc", "PIXELS",
            "Filter size: largest radius, 0 to 1024 (default: the scene's, by height)",
            [&max_coc_px](const std::string& text) {
              max_coc_px = static_cast<float>(parse_number("--max-coc", text, 0.0, kLargestMaxCoc,
                                                           "a radius in pixels from 0 to 1024"));
            });
}

float used_max_coc_px(std::optional<float> given, const SceneLens& of_scene, int height_px) {
  const double scaled = of_scene.max_coc_px_at_1024 * height_px / 1024.0;
  return given.value_or(static_cast<float>(std::fmin(scaled, static_cast<double>(kLargestMaxCoc))));
}

}  // namespace softfocus
