// Colours along an ICC profile as light, by Little CMS where the build has it.

#include <array>
#include <string>

#include "tools/cli/errors.h"
#include "tools/pictures/picture_file.h"

#ifdef SOFTFOCUS_WITH_LCMS
#include <lcms2.h>

#include <memory>
#include <vector>
#endif

namespace softfocus {

#ifdef SOFTFOCUS_WITH_LCMS

std::string_view missing_lcms() { return {}; }

namespace {

using ClosedProfile = std::unique_ptr<void, decltype(&cmsCloseProfile)>;

/// Linear, of sRGB's red, green, blue and white.
ClosedProfile linear_srgb() {
  constexpr cmsCIExyY kWhite{0.3127, 0.3290, 1.0};
  constexpr cmsCIExyYTRIPLE kPrimaries{{0.64, 0.33, 1.0}, {0.30, 0.60, 1.0}, {0.15, 0.06, 1.0}};
  const std::unique_ptr<cmsToneCurve, decltype(&cmsFreeToneCurve)> line{cmsBuildGamma(nullptr, 1.0),
                                                                        cmsFreeToneCurve};
  const std::array<cmsToneCurve*, 3> lines{line.get(), line.get(), line.get()};
  return {cmsCreateRGBProfile(&kWhite, &kPrimaries, lines.data()), cmsCloseProfile};
}

}  // namespace

void profile_to_light(const PictureFile& file, double full,
                      const std::array<PlaneValues*, 3>& rgb) {
  const ClosedProfile from{
      cmsOpenProfileFromMem(file.icc.data(), static_cast<cmsUInt32Number>(file.icc.size())),
      cmsCloseProfile};
  const ClosedProfile to = linear_srgb();
  const std::unique_ptr<void, decltype(&cmsDeleteTransform)> transform{
      from && to ? cmsCreateTransform(from.get(), TYPE_RGB_FLT, to.get(), TYPE_RGB_FLT,
                                      INTENT_RELATIVE_COLORIMETRIC, 0)
                 : nullptr,
      cmsDeleteTransform};
  if (!transform) {
    throw FileError("its ICC profile, " + file.icc_name + ", cannot be used; --icc keep leaves it");
  }
  std::vector<float> row(3 * static_cast<std::size_t>(file.width));
  for (std::size_t first = 0; first < rgb[0]->size(); first += row.size() / 3) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = static_cast<float>(static_cast<double>((*rgb[i % 3])[first + i / 3]) / full);
    }
    cmsDoTransform(transform.get(), row.data(), row.data(),
                   static_cast<cmsUInt32Number>(file.width));
    for (std::size_t i = 0; i < row.size(); ++i) (*rgb[i % 3])[first + i / 3] = row[i];
  }
}

#else

std::string_view missing_lcms() {
  return "this build converts no ICC profiles; install the library (liblcms2-dev) and build again";
}

void profile_to_light(const PictureFile&, double, const std::array<PlaneValues*, 3>&) {
  throw FileError(std::string{missing_lcms()});
}

#endif

}  // namespace softfocus
