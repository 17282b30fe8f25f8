#pragma once
// What can be set of a scene's time, lights and shadow maps, by its file and on the command line.

#include <array>

#include "raster/numbers/parameter.h"
#include "scenes/scene.h"

namespace softfocus::parameter {

// clang-format off
inline constexpr Parameter kPlace{"place", "A coordinate of a place or a direction",
    -1e6, 1e6, 0.0, "m"};
inline constexpr Parameter kFrame{"frame", "Frame of the animation",
    0.0, 1e9, 0.0, "", "N"};
inline constexpr Parameter kShutter{"shutter",
    "Of accumulation: how long the shutter is open, half of it before the frame's time",
    0.0, 64.0, 0.0, "frames", "FRAMES"};
inline constexpr Parameter kBackdrop{"backdrop",
    "Distance to which the scene's backdrop is moved; it is scaled, and looks as large as before",
    0.01, 1e4, 0.0, "m", "METRES", "backdrop_m"};

// --- lights with shadows ---
inline constexpr Parameter kShadowDarkness{"shadow-darkness",
    "The part of a light's share that its shadow takes away",
    0.0, 1.0, 1.0, "", "X", "shadow_darkness"};
inline constexpr Parameter kLightPoints{"soft", "Draw lights that have a size from so many points",
    1, kMostLightPoints, kUsualLightPoints, "points", "N", "light_points", 1};
inline constexpr Parameter kLightRadius{"light-radius",
    "Point lights with shadows are balls of this size",
    0.0, 1e6, 0.0, "m", "METRES", "radius_m"};
inline constexpr Parameter kLightAngle{"light-angle",
    "Directional lights with shadows are discs of this angular radius; the sun has .27",
    0.0, kMostAngularRadius, 0.0, "degrees", "DEGREES", "angular_radius_degrees"};

// --- relief impostors ---
inline constexpr Parameter kImpostorTolerance{"tolerance",
    "How far a pixel of an impostor may lie from where geometry would have it",
    0.01, 100.0, ImpostorBudget{}.tolerance_px, "px", "PIXELS", "tolerance_px"};
inline constexpr Parameter kImpostorMemory{"memory", "Of the impostors' reliefs",
    0.0, 1e6, ImpostorBudget{}.memory_mb, "MB", "MB", "memory_mb"};
inline constexpr Parameter kImpostorMilliseconds{"milliseconds",
    "Of a frame, as predicted from its triangles and texels: what costs more gets a larger "
    "tolerance; 0: any",
    0.0, 1e6, ImpostorBudget{}.milliseconds, "ms", "MS"};
// clang-format on

inline constexpr std::array kShadowKinds{Choice<ShadowKind>{"none", ShadowKind::none},
                                         Choice<ShadowKind>{"projected", ShadowKind::projected},
                                         Choice<ShadowKind>{"volumes", ShadowKind::volumes},
                                         Choice<ShadowKind>{"map", ShadowKind::map}};
inline constexpr std::array kTerminators{Choice<Terminator>{"facets", Terminator::facets},
                                         Choice<Terminator>{"normals", Terminator::normals},
                                         Choice<Terminator>{"fade", Terminator::fade}};
inline constexpr std::array kLightKinds{Choice<LightKind>{"directional", LightKind::directional},
                                        Choice<LightKind>{"point", LightKind::point}};
inline constexpr std::array kEasings{Choice<Easing>{"linear", Easing::linear},
                                     Choice<Easing>{"smooth", Easing::smooth}};
/// Of all objects, in place of what a scene says.
inline constexpr std::array kImpostorUses{Choice<ImpostorUse>{"auto", ImpostorUse::where_cheaper},
                                          Choice<ImpostorUse>{"off", ImpostorUse::never}};

// --- shadow maps ---
struct OfMap {
  Parameter number;
  void (*set)(ShadowMapSettings& map, double value);
};
inline constexpr std::array kMapParameters{
    OfMap{{"size", "Texels along an edge", kLeastMapSize, kMostMapSize, ShadowMapSettings{}.size,
           "texels", "", "", 1},
          [](ShadowMapSettings& map, double value) { map.size = static_cast<int>(value); }},
    OfMap{{"bias", "Towards the light, in widths of what a look into the map reaches", 0.0,
           kMostMapBias, ShadowMapSettings{}.bias},
          [](ShadowMapSettings& map, double value) { map.bias = value; }},
    OfMap{{"slope-bias", "Likewise, times the tangent of the light's angle", 0.0, kMostMapBias,
           ShadowMapSettings{}.slope_bias, "", "", "slope_bias"},
          [](ShadowMapSettings& map, double value) { map.slope_bias = value; }},
    OfMap{{"kernel", "So many texels in square are compared", 1, kMostMapKernel,
           ShadowMapSettings{}.kernel, "texels", "", "", 2},
          [](ShadowMapSettings& map, double value) { map.kernel = static_cast<int>(value); }},
    OfMap{{"cascades", "Maps, one behind the other, of a directional light's picture", 1,
           kMostCascades, ShadowMapSettings{}.cascades, "", "", "", 1},
          [](ShadowMapSettings& map, double value) { map.cascades = static_cast<int>(value); }}};
/// ShadowMapSettings::fits_camera.
inline constexpr std::array kMapFits{Choice<bool>{"camera", true}, Choice<bool>{"scene", false}};

}  // namespace softfocus::parameter
