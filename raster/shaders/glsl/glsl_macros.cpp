#include "raster/shaders/glsl/glsl_macros.h"

#include <algorithm>
#include <cctype>
#include <limits>

namespace softfocus {

bool begins_word(const GlslToken& token) {
  return std::isalpha(static_cast<unsigned char>(token.text[0])) != 0 || token.text[0] == '_';
}

namespace {

constexpr std::size_t kMostRounds = 200;
constexpr double kEndless = std::numeric_limits<double>::infinity();

/// Beyond all limits, and finite: infinity times 0 is none.
double capped(double weight) {
  constexpr double kMost = 1e60;
  return weight < kMost ? weight : kMost;
}

bool is_word_or_number(const GlslToken& token) {
  return begins_word(token) || std::isdigit(static_cast<unsigned char>(token.text[0])) != 0;
}

bool has(std::span<const std::string_view> parameters, const GlslToken& token) {
  return std::find(parameters.begin(), parameters.end(), token.text) != parameters.end();
}

/// The second sign of == or !=, between what may be arrays or structures.
bool compares_values(std::span<const GlslToken> tokens, std::size_t i) {
  return i > 0 && i + 1 < tokens.size() && tokens[i].text == "=" &&
         (tokens[i - 1].text == "=" || tokens[i - 1].text == "!") &&
         (begins_word(tokens[i + 1]) || tokens[i + 1].text == "(");
}

/// A dot of `a.xy`, not of `1.5`.
bool is_member(std::span<const GlslToken> tokens, std::size_t i) {
  return i > 0 && i + 1 < tokens.size() && begins_word(tokens[i + 1]) &&
         std::isdigit(static_cast<unsigned char>(tokens[i - 1].text[0])) == 0;
}

}  // namespace

GlslMacros::GlslMacros(std::span<const GlslToken> tokens) {
  split(tokens);
  find_loose(tokens);
  weigh_all();
  if (!is_loose_) return;
  // A macro that is called by another's parameter repeats its arguments as often as any does that
  // calls none so. If it does call one, it is weighed too lightly: a bound of all such chains has
  // no end where a shader passes the names of its blend modes on.
  loose_times_ = most_times_;
  weigh_all();
}

GlslWeight GlslMacros::weight_of(std::span<const GlslToken> tokens,
                                 const FoundOperators& found) const {
  if (is_endless_) return {.tokens = kEndless};
  return weigh(tokens, {}, nullptr, found);
}

std::vector<std::string_view> GlslMacros::meanings(std::string_view word) const {
  std::vector<std::string_view> all{word};
  const auto name = names_.find(word);
  if (name == names_.end()) return all;
  for (const std::size_t of : name->second.definitions) {
    for (const GlslToken& token : definitions_[of].body) all.push_back(token.text);
  }
  return all;
}

void GlslMacros::split(std::span<const GlslToken> tokens) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < tokens.size();) {
    if (!tokens[i].is_first || tokens[i].text != "#") {
      ++i;
      continue;
    }
    if (i > begin) code.push_back(tokens.subspan(begin, i - begin));
    std::size_t end = i + 1;
    while (end < tokens.size() && !tokens[end].is_first) ++end;
    const std::string_view word = end > i + 1 ? tokens[i + 1].text : std::string_view{};
    if (word == "if" || word == "elif") code.push_back(tokens.subspan(i + 2, end - i - 2));
    if (word == "define" && end > i + 2) define(tokens.subspan(i + 2, end - i - 2));
    begin = i = end;
  }
  if (begin < tokens.size()) code.push_back(tokens.subspan(begin));
}

void GlslMacros::define(std::span<const GlslToken> tokens) {
  Definition made{.name = tokens[0].text};
  MacroName& name = names_[made.name];
  std::size_t i = 1;
  if (i < tokens.size() && tokens[i].text == "(" &&
      tokens[i].text.data() == made.name.data() + made.name.size()) {
    name.takes_arguments = true;
    for (++i; i < tokens.size() && tokens[i].text != ")"; ++i) {
      if (begins_word(tokens[i])) made.parameters.push_back(tokens[i].text);
    }
    ++i;
  }
  made.body = tokens.subspan(std::min(i, tokens.size()));
  name.definitions.push_back(definitions_.size());
  definitions_.push_back(made);
}

void GlslMacros::find_loose(std::span<const GlslToken> all) {
  const auto look = [&](std::span<const GlslToken> tokens, std::string_view own) {
    for (std::size_t i = 0; i < tokens.size(); ++i) {
      const auto found = names_.find(tokens[i].text);
      if (found == names_.end() || !found->second.takes_arguments || found->first == own) continue;
      const std::string_view before = i == 0 ? std::string_view{} : tokens[i - 1].text;
      if (before == "defined" || (before == "(" && i > 1 && tokens[i - 2].text == "defined")) {
        continue;
      }
      if (i + 1 == tokens.size() || tokens[i + 1].text != "(") is_loose_ = true;
    }
  };
  find_ends();
  for (const auto& tokens : code) {
    look(tokens, {});
    find_adjacent(tokens, {});
  }
  bool pastes = false;
  for (const Definition& of : definitions_) {
    look(of.body, of.name);
    find_adjacent(of.body, of.parameters);
    int open = 0;
    for (std::size_t i = 0; i < of.body.size(); ++i) {
      open += of.body[i].text == "(" ? 1 : of.body[i].text == ")" ? -1 : 0;
      pastes = pastes || (i > 0 && of.body[i].text == "#" && of.body[i - 1].text == "#");
      is_called_again_ = is_called_again_ ||
                         (i > 0 && of.body[i].text == "(" && has(of.parameters, of.body[i - 1]));
    }
    // If a macro has one bracket of a pair, what stands between the two is no group here.
    if (open != 0 && uses_arguments(of)) is_endless_ = true;
  }
  if (pastes) find_pasted(all);
  is_called_again_ = is_called_again_ || is_adjacent_ || !pasted_names_.empty() ||
                     2 * names_.size() >= kMostRounds;
  for (std::size_t i = 1; i < all.size(); ++i) {
    is_called_again_ = is_called_again_ || (all[i - 1].text == ")" && all[i].text == "(");
  }
}
bool GlslMacros::may_open(const GlslToken& token,
                          std::span<const std::string_view> parameters) const {
  const auto found = names_.find(token.text);
  return has(parameters, token) || (found != names_.end() && found->second.may_open);
}
bool GlslMacros::may_call(const GlslToken& token,
                          std::span<const std::string_view> parameters) const {
  const auto found = names_.find(token.text);
  return has(parameters, token) || token.text == ")" ||
         (found != names_.end() && (found->second.takes_arguments || found->second.may_call));
}
void GlslMacros::find_ends() {
  for (bool grew = true; grew;) {
    grew = false;
    for (const Definition& of : definitions_) {
      MacroName& name = names_[of.name];
      const bool opens = of.body.empty() || of.body.front().text == "(" ||
                         may_open(of.body.front(), of.parameters);
      const bool calls = of.body.empty() || may_call(of.body.back(), of.parameters);
      grew = grew || (opens && !name.may_open) || (calls && !name.may_call);
      name.may_open = name.may_open || opens;
      name.may_call = name.may_call || calls;
    }
  }
}
void GlslMacros::find_adjacent(std::span<const GlslToken> tokens,
                               std::span<const std::string_view> parameters) {
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    is_adjacent_ =
        is_adjacent_ || (may_call(tokens[i - 1], parameters) && may_open(tokens[i], parameters));
  }
}
bool GlslMacros::uses_arguments(const Definition& of) const {
  return std::any_of(of.body.begin(), of.body.end(), [&](const GlslToken& token) {
    const auto found = names_.find(token.text);
    return found != names_.end() && found->second.takes_arguments;
  });
}

void GlslMacros::find_pasted(std::span<const GlslToken> all) {
  constexpr std::size_t kLongest = 32;
  std::unordered_set<std::string_view> words;
  for (const GlslToken& token : all) {
    if (is_word_or_number(token)) words.insert(token.text);
  }
  for (const auto& [name, of] : names_) {
    bool reached[kLongest + 1] = {true};
    bool is_made = name.size() > kLongest;
    for (std::size_t from = 0; from < name.size() && !is_made; ++from) {
      if (!reached[from]) continue;
      for (std::size_t to = from + 1; to <= name.size(); ++to) {
        if (from == 0 && to == name.size()) continue;
        const std::string_view part = name.substr(from, to - from);
        const bool is_digit =
            part.size() == 1 && std::isdigit(static_cast<unsigned char>(part[0])) != 0;
        if (is_digit || words.contains(part)) reached[to] = true;
      }
    }
    if (!is_made && !reached[name.size()]) continue;
    pasted_names_.insert(name);
    if (of.takes_arguments) is_loose_ = true;
  }
}

void GlslMacros::weigh_all() {
  // No macro is replaced within itself, so two that name each other end in as many rounds as there
  // are names, unless brackets behind what one became call it again.
  const std::size_t most = std::min(2 * names_.size() + 2, kMostRounds);
  std::size_t rounds = 0;
  for (bool grew = true; grew && rounds < most; ++rounds) {
    grew = false;
    for (const Definition& of : definitions_) grew = add(of) || grew;
    is_endless_ = is_endless_ || (grew && rounds + 1 == most && is_called_again_);
  }
}

bool GlslMacros::add(const Definition& of) {
  ParameterUses uses;
  for (const std::string_view parameter : of.parameters) uses[parameter] = {};
  GlslWeight made = weigh(of.body, of.name, &uses, [](double, const GlslToken&) {});
  MacroName& name = names_[of.name];
  made.ends_statements = made.ends_statements && name.definitions.size() == 1;
  if (!made.ends_statements) made.operators = std::max(made.operators, made.worst);
  bool grew = false;
  const auto raise = [&](double& to, double from) {
    from = capped(from);
    grew = grew || from > to;
    to = std::max(to, from);
  };
  const auto raise_all = [&](GlslWeight& to) {
    raise(to.tokens, made.tokens);
    raise(to.cases, made.cases);
    raise(to.compared, made.compared);
    raise(to.operators, made.operators);
    raise(to.inside, made.inside);
    raise(to.worst, made.worst);
  };
  raise_all(name.weight);
  name.weight.ends_statements = made.ends_statements;
  if (pasted_names_.contains(of.name)) {
    made.operators = std::max(made.operators, made.worst);
    raise_all(pasted_);
  }
  if (name.arguments.size() < of.parameters.size()) {
    name.arguments.resize(of.parameters.size(), Uses{.all = 1});
  }
  for (std::size_t i = 0; i < of.parameters.size(); ++i) {
    const Uses& use = uses.at(of.parameters[i]);
    for (Uses* const to : {&name.arguments[i], &name.any_argument}) {
      raise(to->all, use.all);
      raise(to->outside, use.outside);
    }
  }
  raise(most_times_, name.any_argument.all);
  return grew;
}

struct GlslMacros::Level {
  bool is_list = false;
  bool is_index = false;  ///< in square brackets
  double operators = 0, inside = 0;
  double head = -1;  ///< of its first part, once that has ended
  double worst = 0;  ///< of its parts before this one
  double times = 1;  ///< that a token in it is there
  double depth = 1;  ///< of what is in it
  /// If it holds a macro's arguments: which macro's, which is the present one, how often that is
  /// there behind the macro, and the operators that those before it become.
  const MacroName* called = nullptr;
  std::size_t argument = 0;
  Uses uses{.all = 1};
  Uses before{};

  double all() const { return std::max(worst, operators + inside); }
  Uses repeated() const {
    return {.all = capped(before.all + uses.all * all()),
            .outside = capped(before.outside + uses.outside * all())};
  }
  void begin_argument(std::size_t number) {
    before = repeated();
    worst = operators = inside = 0;
    argument = number;
    uses = called->uses_of(number);
  }
  void end_part() {
    if (head < 0) head = operators + inside;
    worst = all();
    operators = inside = 0;
  }
  void take(const GlslWeight& of) {
    if (of.ends_statements) {
      operators += of.operators;
      end_part();
      worst = std::max(worst, of.worst);
    }
    operators += of.operators;
    inside = std::max(inside, of.inside);
  }
};

GlslWeight GlslMacros::weigh(std::span<const GlslToken> tokens, std::string_view own,
                             ParameterUses* uses, const FoundOperators& found) const {
  GlslWeight sum;
  std::vector<Level> levels(1);
  const auto macro_at = [&](std::size_t i) -> const MacroName* {
    const auto at = tokens[i].text == own ? names_.end() : names_.find(tokens[i].text);
    return at == names_.end() ? nullptr : &at->second;
  };
  const auto is_parameter = [&](std::size_t i) {
    return uses != nullptr && uses->contains(tokens[i].text);
  };
  const auto is_pasted = [&](std::size_t i) {
    return !pasted_names_.empty() && ((i > 0 && tokens[i - 1].text == "#") ||
                                      (i + 1 < tokens.size() && tokens[i + 1].text == "#"));
  };
  const auto take = [&](const GlslWeight& of) {
    Level& level = levels.back();
    sum.tokens += level.times * of.tokens;
    sum.cases += level.times * of.cases;
    sum.compared += level.times * of.compared;
    sum.ends_statements = sum.ends_statements || of.ends_statements;
    level.take(of);
  };
  // What stands behind a name that may become another, or begins an argument or a body.
  const auto may_be_anothers = [&](std::size_t i, const MacroName* macro) {
    if (i == 0) return own.empty() || is_adjacent_;
    const std::string_view before = tokens[i - 1].text;
    if (is_parameter(i - 1) || is_pasted(i - 1) || before == ")") return true;
    if (macro != nullptr) return !macro->takes_arguments || macro->definitions.size() > 1;
    return is_adjacent_ && (before == "(" || before == ",");
  };
  const auto open = [&](std::size_t i) {
    Level level;
    level.is_index = tokens[i].text == "[";
    level.is_list =
        !level.is_index && i > 0 && (is_word_or_number(tokens[i - 1]) || tokens[i - 1].text == "]");
    const MacroName* const macro = i > 0 ? macro_at(i - 1) : nullptr;
    if (macro != nullptr && macro->takes_arguments) {
      level.depth = 1 + macro->weight.inside;
      level.called = macro;
      level.uses = macro->uses_of(0);
    }
    if (is_loose_ && may_be_anothers(i, macro)) {
      level.called = nullptr;
      level.uses = {.all = loose_times_, .outside = loose_times_};
    }
    level.times = capped(levels.back().times * level.uses.all);
    levels.push_back(level);
  };
  // Square brackets hold no comma of a macro's back: behind it any argument may be meant.
  const auto begin_argument = [&] {
    std::size_t of = levels.size() - 1;
    while (of > 0 && levels[of].is_index) --of;
    if (levels[of].called == nullptr) return false;
    constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
    const bool is_sure = of + 1 == levels.size() && levels[of].argument != kAny;
    levels[of].begin_argument(is_sure ? levels[of].argument + 1 : kAny);
    levels[of].times = capped(levels[of - 1].times * levels[of].uses.all);
    for (std::size_t i = of + 1; i < levels.size(); ++i) levels[i].times = levels[of].times;
    return true;
  };
  const auto close = [&](const GlslToken& token) {
    const Level inner = levels.back();
    levels.pop_back();
    Level& outer = levels.back();
    const Uses repeated = inner.repeated();
    outer.operators += repeated.outside;
    outer.inside = std::max(outer.inside, inner.depth + repeated.all);
    found(outer.all(), token);
  };
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const GlslToken& token = tokens[i];
    const char c = token.text[0];
    Level& level = levels.back();
    if (is_pasted(i)) take(pasted_);
    sum.tokens += level.times;
    if (is_parameter(i)) {
      Uses& of = uses->at(token.text);
      of.all += level.times;
      if (levels.size() == 1) of.outside += level.times;
    } else if (const MacroName* const macro = macro_at(i)) {
      take(macro->weight);
      found(level.all(), token);
    } else if (token.text == "case") {
      sum.cases += level.times;
    } else if (c == '(' || c == '[') {
      open(i);
    } else if (c == ')' || c == ']') {
      if (levels.size() > 1) close(token);
    } else if (c == ',' && begin_argument()) {
      continue;
    } else if (c == ';' || c == '{' || c == '}' || (c == ',' && level.is_list)) {
      level.end_part();
      sum.ends_statements = sum.ends_statements || levels.size() == 1;
    } else if (!is_word_or_number(token) && (c != '.' || is_member(tokens, i))) {
      if (compares_values(tokens, i)) sum.compared += level.times;
      ++level.operators;
      found(level.all(), token);
    }
  }
  while (levels.size() > 1) close(tokens.back());
  const Level& last = levels.back();
  if (last.head < 0) {
    sum.operators = last.operators;
    sum.inside = last.inside;
  } else {
    sum.operators = std::max(last.head, last.operators + last.inside);
    sum.worst = last.all();
  }
  return sum;
}

}  // namespace softfocus
