#include "tools/pictures/picture_notes.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "raster/numbers/half.h"
#include "raster/numbers/hash.h"
#include "tools/files/hash_text.h"
#include "tools/pictures/png_text.h"

namespace softfocus {
namespace {

/// Marks the JSON; its value is the version of the form.
constexpr const char* kMark = "softfocus_picture";
constexpr int kNotesForm = 1;
constexpr const char* kKeyword = "softfocus";
/// No notes are longer: larger files are not read for being taken for some.
constexpr std::size_t kMostBytes = 65536;

std::string hash_of_file(const ByteSource& bytes) {
  constexpr std::uint64_t kPart = 1 << 20;
  Hash hash;
  Bytes buffer;
  for (std::uint64_t place = 0; place < bytes.size(); place += kPart) {
    const auto count = static_cast<std::size_t>(std::min(kPart, bytes.size() - place));
    for (const std::byte byte : bytes.at(place, count, buffer)) {
      add_to_hash(hash, std::to_integer<std::uint8_t>(byte));
    }
  }
  return hash_text(hash.value);
}

/// The text of a small regular file, or nullopt.
std::optional<std::string> small_text(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > kMostBytes) return std::nullopt;
  std::ifstream stream{file, std::ios::binary};
  if (!stream) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>{stream}, {}};
}

PictureNotes notes_of(const Json& json) {
  PictureNotes notes;
  notes.scene = json.at("scene").text();
  notes.frame = json.at("frame").number();
  notes.width = static_cast<int>(json.at("width").integer());
  notes.height = static_cast<int>(json.at("height").integer());
  notes.show = json.at("show").text();
  notes.fov_y_degrees = json.at("fov_y_degrees").number();
  notes.method = json.at("method");
  const Json& lens = json.at("lens");
  if (!lens.is_null()) {
    notes.lens = {{}, lens.at(key_of(parameter::kCocScale)).number(), notes.fov_y_degrees};
    for (const LensNumber& number : kLensNumbers) {
      notes.lens->lens.*number.place = lens.at(key_of(number.parameter)).number();
    }
  }
  if (const Json* effects = json.find("effects")) {
    for (const Json& effect : effects->values()) notes.effects.push_back(effect.text());
  }
  notes.picture_hash = std::stoull(json.at("picture_hash").text(), nullptr, 16);
  return notes;
}

/// A field of view and a lens that cannot be are no notes of ours.
bool is_usable(const PictureNotes& notes) {
  const bool sees = notes.fov_y_degrees > 0.0 && notes.fov_y_degrees < 180.0;
  return sees && (!notes.lens || (lens_error(notes.lens->lens) == nullptr &&
                                  notes.lens->coc_scale >= 0.0 && notes.lens->coc_scale <= 1e6));
}

/// Of halves, which are cut to the largest.
Image brightened(Image image, float light) {
  for (int y = 0; y < image.height; ++y) {
    const auto halves = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < halves.size(); ++i) {
      if (i % 4 == 3) continue;
      const float value = std::clamp(half_to_float(halves[i]) * light, -65504.0f, 65504.0f);
      halves[i] = float_to_half(value, HalfRounding::nearest_even);
    }
  }
  return image;
}

}  // namespace

void add_lens(Json& json, const ThinLens& lens, double coc_scale) {
  for (const LensNumber& number : kLensNumbers) {
    json[key_of(number.parameter)] = lens.*number.place;
  }
  json[key_of(parameter::kCocScale)] = coc_scale;
}

Json notes_json(const PictureNotes& notes) {
  Json json{{kMark, kNotesForm},
            {"softfocus", SOFTFOCUS_VERSION},
            {"scene", notes.scene},
            {"frame", notes.frame},
            {"width", notes.width},
            {"height", notes.height},
            {"show", notes.show},
            {"lens", nullptr},
            {"fov_y_degrees", notes.fov_y_degrees},
            {"method", notes.method},
            {"picture_hash", hash_text(notes.picture_hash)}};
  if (notes.lens) {
    add_lens(json["lens"], notes.lens->lens, notes.lens->coc_scale);
  }
  for (const std::string& effect : notes.effects) json["effects"].push_back(effect);
  return json;
}

std::optional<PictureNotes> parse_notes(std::string_view text) {
  const std::optional<Json> json = parse_json(text);
  if (!json || !json->is_object() || json->find(kMark) == nullptr) return std::nullopt;
  try {
    if (json->at(kMark).integer() != kNotesForm) return std::nullopt;
    PictureNotes notes = notes_of(*json);
    if (!is_usable(notes)) return std::nullopt;
    return notes;
  } catch (const JsonError&) {
    return std::nullopt;
  } catch (const std::logic_error&) {  // a hash that is no number
    return std::nullopt;
  }
}

Bytes encode_with_notes(const Image& image, FileFormat format, PictureNotes notes,
                        const PictureExtras& extras, const std::function<std::uint64_t()>& hash) {
  const auto text = [&] {
    if (hash) notes.picture_hash = hash();
    return json_text(notes_json(notes));
  };
  if (format == FileFormat::exr || format == FileFormat::exr_float) {
    PictureExtras all = extras;
    if (!all.lens && notes.lens) all.lens = notes.lens->lens;
    return encode_exr(image, format == FileFormat::exr ? ExrNumbers::half : ExrNumbers::single,
                      json_text(notes_json(notes)), all,
                      hash ? text : std::function<std::string()>{});
  }
  if (extras.light_power > 0) {
    const float light = std::ldexp(1.0f, extras.light_power);
    if (format == FileFormat::pfm) return encode_pfm(image, light);
    if (format == FileFormat::hdr) return encode_hdr(image, light);
    PictureExtras lit = extras;
    lit.light_power = 0;
    return encode_with_notes(brightened(image, light), format, std::move(notes), lit, hash);
  }
  if (format == FileFormat::tiff) return encode_tiff(image, extras.alpha, extras.icc);
  if (format != FileFormat::png && format != FileFormat::png_16) return encode(image, format);
  Bytes bytes = format == FileFormat::png ? encode_png(image, extras.alpha, extras.pool)
                                          : encode_png_16(image, extras.alpha);
  if (!extras.icc.empty()) bytes = with_png_profile(bytes, extras.icc);
  return with_png_texts(bytes, {{"Software", "softfocus " SOFTFOCUS_VERSION}, {kKeyword, text()}});
}

bool needs_sidecar(FileFormat format) {
  return format == FileFormat::pfm || format == FileFormat::npy || format == FileFormat::hdr ||
         format == FileFormat::tiff;
}

std::filesystem::path sidecar_of(const std::filesystem::path& picture) {
  std::filesystem::path sidecar = picture;
  return sidecar += ".json";
}

std::optional<std::filesystem::path> sidecar_place(const std::string& output, FileFormat format) {
  if (output == "-" || !needs_sidecar(format)) return std::nullopt;
  std::error_code error;
  const auto status = std::filesystem::status(output, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return std::nullopt;
  }
  return sidecar_of(output);
}

std::string sidecar_text(const PictureNotes& notes, const ByteSource& picture) {
  Json json = notes_json(notes);
  json["file_hash"] = hash_of_file(picture);
  return json_text(json, 2) + "\n";
}

bool is_free_for_sidecar(const std::filesystem::path& sidecar) {
  std::error_code error;
  const auto status = std::filesystem::status(sidecar, error);
  if (status.type() == std::filesystem::file_type::not_found) return true;
  const auto text = small_text(sidecar);
  return text && parse_notes(*text);
}

std::string busy_sidecar_warning(const std::filesystem::path& sidecar) {
  return "'" + sidecar.string() +
         "' is no sidecar of a picture and stays as it is: the picture's lens is written nowhere";
}

FoundNotes find_notes(const std::filesystem::path& picture, const ByteSource& bytes) {
  Bytes buffer;
  const std::span start =
      bytes.at(0, static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), 8)), buffer);
  if (is_png(start)) {
    const auto size = static_cast<std::size_t>(bytes.size());
    const auto text = find_png_text(bytes.at(0, size, buffer), kKeyword);
    return {text ? parse_notes(*text) : std::nullopt, picture};
  }
  if (is_exr(start)) {
    const auto text = find_exr_notes(bytes);
    return {text ? parse_notes(*text) : std::nullopt, picture};
  }
  FoundNotes found{std::nullopt, sidecar_of(picture)};
  const auto text = small_text(found.place);
  if (!text) return found;
  found.notes = parse_notes(*text);
  if (!found.notes) return found;
  const std::optional<Json> json = parse_json(*text);
  const Json* hash = json->find("file_hash");
  found.stale = hash == nullptr || !hash->is_text() || hash->text() != hash_of_file(bytes);
  if (found.stale) found.notes.reset();
  return found;
}

}  // namespace softfocus
