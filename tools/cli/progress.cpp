#include "tools/cli/progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <utility>

#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"

namespace softfocus {

void tell(std::string_view text) { std::cerr << "softfocus: " + printable(text) + '\n'; }

void warn(std::string_view text) { std::cerr << "softfocus: warning: " + printable(text) + '\n'; }

namespace {

double steady_seconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

double rounded_up(double value, double step) { return std::ceil(value / step) * step; }

}  // namespace

TimeLeft::TimeLeft(std::function<double()> clock_s)
    : clock_s_(clock_s ? std::move(clock_s) : std::function<double()>{steady_seconds}),
      last_s_(clock_s_()) {}

void TimeLeft::plan(const std::string& kind, double units, double guess) {
  Kind& of = kinds_[kind];
  of.planned += units;
  of.guess = guess;
}

void TimeLeft::done(const std::string& kind, double units) {
  const double now_s = clock_s_();
  Kind& of = kinds_[kind];
  of.planned = std::max(of.planned - units, 0.0);
  of.done += units;
  of.seconds += now_s - last_s_;
  last_s_ = now_s;
}

void TimeLeft::drop(const std::string& kind, double units) {
  Kind& of = kinds_[kind];
  of.planned = std::max(of.planned - units, 0.0);
}

double TimeLeft::units_left(const std::string& kind) const {
  const auto found = kinds_.find(kind);
  return found == kinds_.end() ? 0.0 : found->second.planned;
}

double TimeLeft::seconds() const {
  double done_s = 0.0, guessed = 0.0;
  for (const auto& [name, kind] : kinds_) {
    done_s += kind.seconds;
    guessed += kind.done * kind.guess;
  }
  if (guessed <= 0.0) return 0.0;
  double left_s = 0.0;
  for (const auto& [name, kind] : kinds_) {
    const double rate = kind.done > 0.0 ? kind.seconds / kind.done : kind.guess * done_s / guessed;
    left_s += kind.planned * rate;
  }
  return left_s;
}

std::string time_left_text(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  const auto about = [](double number, const char* unit) {
    return "about " + short_number(number) + unit + " left";
  };
  if (seconds > 2.0 * kHour) return about(rounded_up(seconds / kHour, 0.25), " h");
  if (seconds > kMinute) return about(rounded_up(seconds / kMinute, 1.0), " min");
  return about(std::max(rounded_up(seconds, seconds > 20.0 ? 10.0 : 5.0), 5.0), " s");
}

namespace {

constexpr std::string_view kEraseLine = "\r\x1b[K";

}  // namespace

Progress::Progress(bool quiet) : on_terminal_(!quiet && is_terminal(kStandardError)) {}

Progress::~Progress() { clear(); }

void Progress::show(std::string_view stage) {
  if (on_terminal_) std::cerr << kEraseLine << "softfocus: " << stage << " ..." << std::flush;
}

void Progress::clear() {
  if (on_terminal_) std::cerr << kEraseLine << std::flush;
}

}  // namespace softfocus
