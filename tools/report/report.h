#pragma once
// What an experiment found, as JSON that tools/report/report.js draws, and the files that hold it,
// in the directory that -o names. Each file is whole or absent.
//
//   report   title, text [paragraph], command, machine, parts [part],
//            pictures {name: PNG in base64}
//   part     id (of its place in the page), title, below (whether a heading of lower rank), text
//            [paragraph], and what it has of plots, table, figures, cards
//   plots    name (of a saved file), panels [plot], height (pixels)
//   plot     title, about (in words), x axis, y axis, series [series]
//   axis     title, short (for tips); log; least, most (values beyond lie on the border; none: as
//            the values are), ticks [number]; or names [text] in place of numbers, from above
//   series   name, kind, points [{x, y (null: beyond all), to_x, text (of the tip), label (in the
//            plot), to (a place in the page), bad}]. kind: line (with marks), dots, ring; stair (a
//            front), level (all across), limit (likewise), thin, span (from x to to_x)
//   table    columns [{name, group, word, places (decimal ones; "ms": by size)}],
//            rows [{cells [cell], best}]; and to colour cells by their value: key (text), grades
//            [{up_to, text}], of which the last has no up_to
//   cell     a number, a text, null, or {value, text (shown in its place), to, about}
//   figures  [row of {picture (its name), caption, about (in words), crop (whether it is
//   enlarged)}] card     id, title, text [paragraph], figures, own (the series of the part's first
//   plot that
//            is coloured in a plot of the card)

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/files/json.h"

namespace softfocus {

/// A page (report.html) with results in place of its own, which are null.
std::string page_with(std::string_view page, const Json& results);

/// The report as one page that needs no other file.
std::string report_page(const Json& report);

/// [text, ...], of one or two texts too.
Json json_list(const std::vector<Json>& values);

/// A part of a plot.
Json report_series(const std::string& name, const char* kind, Json points);

/// Adds a picture (PNG in base64) to the report's, and returns a figure of it.
Json report_figure(Json& pictures, const std::string& name, const std::string& png,
                   const std::string& about, const std::string& caption);

/// A list of objects with the same members as lines under a line of names (RFC 4180, but lines end
/// in LF). An object is "max_coc_px=16;profile=ieee"; null is empty.
std::string csv_of(const Json& list);

/// A command as it is typed: words that a shell would take apart are in quotes.
std::string command_text(const std::vector<std::string>& words);

/// "a,b,c", as options take lists.
std::string joined_names(const std::vector<std::string>& names);

/// Makes a directory and those above it. Throws FileError.
void make_directory(const std::filesystem::path& directory);

/// Makes DIR and DIR/cache, and sees that the files can be written: nothing is measured in vain.
/// Throws FileError.
void prepare_results(const std::filesystem::path& directory,
                     const std::vector<std::filesystem::path>& files);

/// Throws FileError.
void write_text(const std::filesystem::path& file, std::string_view text);
void write_json(const std::filesystem::path& file, const Json& json);

/// A file's JSON, if it is there and is JSON.
std::optional<Json> read_json(const std::filesystem::path& file);

}  // namespace softfocus
