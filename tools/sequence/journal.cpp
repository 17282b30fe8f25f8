#include "tools/sequence/journal.h"

#include <cstdio>
#include <iterator>

#include "raster/numbers/hash.h"
#include "tools/cli/errors.h"
#include "tools/files/hash_text.h"
#include "tools/files/whole_file.h"

namespace softfocus {
namespace {

std::string without_sum(const JournalLine& line) {
  return "frame " + std::to_string(line.frame) + " from " + hash_text(line.made_from) + " files " +
         hash_text(line.files);
}

std::string sum_of(std::string_view text) { return " sum " + hash_text(hash_of(text)); }

/// Nothing of a device, which may have no end.
std::string file_text(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

void read_lines(std::string_view text, std::set<std::string>& lines) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    if (const auto line = parse_journal_line(text.substr(0, end)))
      lines.insert(journal_line(*line));
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
}

}  // namespace

std::string journal_line(const JournalLine& line) {
  const std::string text = without_sum(line);
  return text + sum_of(text) + "\n";
}

std::optional<JournalLine> parse_journal_line(std::string_view text) {
  JournalLine line;
  unsigned long long made_from = 0, files = 0;
  long long frame = 0;
  if (std::sscanf(std::string{text}.c_str(), "frame %lld from %llx files %llx", &frame, &made_from,
                  &files) != 3) {
    return std::nullopt;
  }
  line = {frame, made_from, files};
  const std::string whole = journal_line(line);
  if (text != std::string_view{whole}.substr(0, whole.size() - 1)) return std::nullopt;
  return line;
}

std::uint64_t hash_of(std::string_view text) {
  Hash hash;
  for (const char letter : text) add_to_hash(hash, static_cast<std::uint8_t>(letter));
  return hash.value;
}

std::uint64_t stamp_of(std::span<const std::filesystem::path> files) {
  Hash hash;
  for (const std::filesystem::path& file : files) {
    add_to_hash(hash, hash_of(file.string()));
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    add_to_hash(hash, static_cast<std::uint64_t>(error ? ~std::uintmax_t{0} : size));
    const auto time = std::filesystem::last_write_time(file, error).time_since_epoch().count();
    add_to_hash(hash, static_cast<std::uint64_t>(error ? 0 : time));
  }
  return hash.value;
}

Journal::Journal(const std::string& output, const std::string& shard)
    : file_(output + (shard.empty() ? "" : "." + shard) + ".journal") {
  const std::filesystem::path picture{output};
  const std::string start = picture.filename().string();
  const std::filesystem::path folder = picture.parent_path();
  std::error_code error;
  std::filesystem::directory_iterator entries{folder.empty() ? "." : folder, error};
  for (; !error && entries != std::filesystem::directory_iterator{}; entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (name.starts_with(start) && name.ends_with(".journal")) {
      read_lines(file_text(entries->path()), lines_);
    }
  }
  check_writable(file_);
  const std::string before = file_text(file_);
  stream_.open(file_, std::ios::binary | std::ios::app);
  if (!stream_) throw FileError("cannot write '" + file_.string() + "': the list of frames made");
  torn_ = !before.empty() && before.back() != '\n';
}

bool Journal::add(const JournalLine& line) {
  const std::string text = journal_line(line);
  lines_.insert(text);
  stream_.clear();
  // A torn line must not take the next one with it.
  stream_ << (torn_ ? "\n" : "") << text << std::flush;
  torn_ = !stream_;
  return !torn_;
}

}  // namespace softfocus
