#include "tools/stress/curve_svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/cli/option_values.h"
#include "tools/report/html.h"

namespace softfocus {
namespace {

constexpr double kWidth = 320, kHeight = 190, kLeft = 52, kRight = 8, kTop = 10, kBottom = 40;
constexpr double kSpan = 30.0;  // the limit's multiple at which the axis ends

/// From values to places in the drawing.
struct CurveAxes {
  std::vector<double> severities;
  double least, most;  // of the upright axis
  bool log_severity;
  bool log_value;

  double x(double severity) const {
    const auto placed = [&](double at) { return log_severity ? std::log2(at) : at; };
    const double first = placed(severities.front()), last = placed(severities.back());
    if (first == last) return (kLeft + kWidth - kRight) / 2.0;
    return kLeft + (placed(severity) - first) / (last - first) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    const double bounded = std::isfinite(value) ? std::clamp(value, least, most) : most;
    const double up = log_value ? std::log(bounded / least) / std::log(most / least)
                                : (bounded - least) / (most - least);
    return kHeight - kBottom - up * (kHeight - kBottom - kTop);
  }
};

CurveAxes axes_of(const StressResult& result) {
  CurveAxes axes{result.severities, 0.0, 0.0, false, result.of.limit > 0.0};
  const double first = axes.severities.front(), last = axes.severities.back();
  const double smaller = std::min(first, last), larger = std::max(first, last);
  axes.log_severity = smaller > 0.0 && larger / smaller > 6.0;
  if (axes.log_value) {
    axes.least = result.of.limit / kSpan;
    axes.most = result.of.limit * kSpan;
    return axes;
  }
  axes.most = 1.0;
  for (const StressCurve& curve : result.curves) {
    for (const double value : curve.values) {
      if (std::isfinite(value)) axes.most = std::max(axes.most, value);
    }
  }
  return axes;
}

std::string tenths(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

std::string points_of(const CurveAxes& axes, const std::vector<double>& values) {
  std::string points;
  for (std::size_t i = 0; i < values.size(); ++i) {
    points +=
        (i == 0 ? "" : " ") + tenths(axes.x(axes.severities[i])) + "," + tenths(axes.y(values[i]));
  }
  return points;
}

std::string polyline(const std::string& points, const char* name) {
  return std::string{"<polyline class=\""} + name + "\" points=\"" + points + "\"/>";
}

std::string label(double x, double y, const char* anchor, const std::string& text) {
  return "<text x=\"" + tenths(x) + "\" y=\"" + tenths(y) + "\" text-anchor=\"" + anchor + "\">" +
         html_text(text) + "</text>";
}

std::string level(const CurveAxes& axes, double value, const char* name) {
  return std::string{"<line class=\""} + name + "\" x1=\"" + tenths(kLeft) + "\" x2=\"" +
         tenths(kWidth - kRight) + "\" y1=\"" + tenths(axes.y(value)) + "\" y2=\"" +
         tenths(axes.y(value)) + "\"/>";
}

/// Severities with a label: so many that they do not touch.
std::string severity_labels(const CurveAxes& axes) {
  constexpr double kApart = 34.0;
  std::string labels;
  double before = -kApart;
  for (const double severity : axes.severities) {
    const double x = axes.x(severity);
    if (x - before < kApart) continue;
    before = x;
    labels += "<line class=\"axis\" x1=\"" + tenths(x) + "\" x2=\"" + tenths(x) + "\" y1=\"" +
              tenths(kHeight - kBottom) + "\" y2=\"" + tenths(kHeight - kBottom + 4) + "\"/>" +
              label(x, kHeight - kBottom + 15, "middle", short_number(severity));
  }
  return labels;
}

std::string value_labels(const CurveAxes& axes, double limit) {
  std::string labels;
  const auto add = [&](double value) {
    labels += label(kLeft - 4, axes.y(value) + 4, "end", short_number(value));
  };
  add(limit);
  if (!axes.log_value) {
    add(axes.most);
    return labels;
  }
  for (const double factor : {0.1, 10.0}) {
    labels += level(axes, limit * factor, "grid");
    add(limit * factor);
  }
  return labels;
}

}  // namespace

std::string curve_backdrop(const StressResult& result) {
  const CurveAxes axes = axes_of(result);
  const StressCase& of = result.of;
  std::string drawing = "<svg width=\"0\" height=\"0\" aria-hidden=\"true\"><defs><g id=\"curves-" +
                        std::string{of.name} + "\">";
  drawing += value_labels(axes, of.limit) + severity_labels(axes);
  for (const StressCurve& curve : result.curves) {
    if (curve.can_run) drawing += polyline(points_of(axes, curve.values), "other");
  }
  if (!result.noise_floor.empty())
    drawing += polyline(points_of(axes, result.noise_floor), "noise");
  drawing += level(axes, of.limit, "limit");
  drawing += "<path class=\"axis\" d=\"M" + tenths(kLeft) + " " + tenths(kTop) + "V" +
             tenths(kHeight - kBottom) + "H" + tenths(kWidth - kRight) + "\"/>";
  drawing += label((kLeft + kWidth - kRight) / 2, kHeight - 8, "middle",
                   std::string{of.parameter.name} + ", " + std::string{of.parameter.unit});
  drawing += "<text transform=\"translate(11 " + tenths((kHeight - kBottom + kTop) / 2) +
             ") rotate(-90)\" text-anchor=\"middle\">" + html_text(of.unit) + "</text>";
  return drawing + "</g></defs></svg>\n";
}

std::string curve_svg(const StressResult& result, const StressCurve& curve) {
  const CurveAxes axes = axes_of(result);
  std::string drawing = "<svg class=\"curve\" role=\"img\" viewBox=\"0 0 " + tenths(kWidth) + " " +
                        tenths(kHeight) + "\" aria-label=\"" +
                        html_text(std::string{result.of.measured} + " of " + curve.method + " by " +
                                  std::string{result.of.parameter.name}) +
                        "\"><use href=\"#curves-" + std::string{result.of.name} + "\"/>" +
                        polyline(points_of(axes, curve.values), "own");
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    drawing += "<circle class=\"" +
               std::string{holds(result.of, curve.values[i]) ? "right" : "wrong"} +
               "\" r=\"2.6\" cx=\"" + tenths(axes.x(axes.severities[i])) + "\" cy=\"" +
               tenths(axes.y(curve.values[i])) + "\"><title>" +
               html_text(std::string{result.of.parameter.name} + " " +
                         short_number(axes.severities[i]) + ": " +
                         (std::isfinite(curve.values[i]) ? short_number(curve.values[i])
                                                         : std::string{"no number"})) +
               "</title></circle>";
  }
  return drawing + "</svg>\n";
}

}  // namespace softfocus
