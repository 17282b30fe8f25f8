#pragma once
// Texts in a PNG: chunks tEXt and iTXt (PNG specification, 11.3.4), and the walk over chunks.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

bool is_png(std::span<const std::byte> bytes);

/// A PNG's first bytes.
inline constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

/// Appends a chunk with its length and checksum; `type` has four letters.
void append_png_chunk(std::vector<std::byte>& bytes, std::string_view type, std::string_view data);

/// Throws FileError for chunks that are cut short, have a wrong checksum, or do not end where the
/// bytes do, and for a side beyond kMaxImageSize.
void check_png_chunks(std::span<const std::byte> png);

/// Whether a grey or coloured PNG without an alpha says which of its colours is transparent (tRNS,
/// 11.3.2.1), so that stb gives it an alpha. Needs sound chunks (check_png_chunks()).
bool has_transparent_colour(std::span<const std::byte> png);

/// The first chunk of that type, or nothing. Needs sound chunks (check_png_chunks()).
std::span<const std::byte> find_png_chunk(std::span<const std::byte> png, std::string_view type);

/// A PNG with an ICC profile behind its header (iCCP, 11.3.2.3).
std::vector<std::byte> with_png_profile(std::span<const std::byte> png,
                                        std::span<const std::byte> icc);

struct PngText {
  std::string_view keyword;  ///< 1 to 79 Latin letters, digits and single blanks
  std::string text;          ///< UTF-8
};

/// A PNG with these texts behind its header. Plain ASCII on one line without quotes is a tEXt, all
/// else an uncompressed iTXt.
std::vector<std::byte> with_png_texts(std::span<const std::byte> png,
                                      const std::vector<PngText>& texts);

/// The first text of that keyword, of a tEXt or an uncompressed iTXt. Needs sound chunks
/// (check_png_chunks()).
std::optional<std::string> find_png_text(std::span<const std::byte> png, std::string_view keyword);

}  // namespace softfocus
