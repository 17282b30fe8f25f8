#pragma once
// A text's macros, weighed where they are used, not expanded: a bound of what they become is found
// however fast they grow.

#include <functional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "raster/shaders/glsl/glsl_text.h"

namespace softfocus {

bool begins_word(const GlslToken& token);

/// What a run of tokens becomes. Operators are counted at its own level and, `inside`, those of the
/// deepest bracket in it; if it ends statements, those of its first or last part, and `worst` of
/// all.
struct GlslWeight {
  double tokens = 0, cases = 0, compared = 0;
  double operators = 0, inside = 0, worst = 0;
  bool ends_statements = false;
};

/// Told the operators of each expression, and where they are.
using FoundOperators = std::function<void(double operators, const GlslToken& at)>;

class GlslMacros {
 public:
  /// The tokens' text must outlive it, as must they.
  explicit GlslMacros(std::span<const GlslToken> tokens);

  std::vector<std::span<const GlslToken>> code{};  ///< what is no directive, and conditions

  /// Of code, in which no parameters are.
  GlslWeight weight_of(std::span<const GlslToken> tokens, const FoundOperators& found) const;

  /// The words that a name may stand for, and itself.
  std::vector<std::string_view> meanings(std::string_view word) const;

 private:
  /// How often what a parameter stands for is there afterwards, and how often at the macro's own
  /// level.
  struct Uses {
    double all = 0, outside = 0;
  };
  using ParameterUses = std::unordered_map<std::string_view, Uses>;

  struct Definition {
    std::string_view name{};
    std::vector<std::string_view> parameters{};
    std::span<const GlslToken> body{};
  };

  /// A macro's name, by the worst of all that it is defined as anywhere in the text.
  struct MacroName {
    std::vector<std::size_t> definitions{};
    GlslWeight weight{};
    std::vector<Uses> arguments{};
    Uses any_argument{.all = 1};
    bool takes_arguments = false;
    bool may_open = false;  ///< what it becomes may begin with a bracket
    bool may_call = false;  ///< what it becomes may end in the name of a macro that takes arguments

    /// Of the argument at a position, or of any, where there is none.
    Uses uses_of(std::size_t argument) const {
      return argument < arguments.size() ? arguments[argument] : any_argument;
    }
  };
  struct Level;

  std::vector<Definition> definitions_{};
  std::unordered_map<std::string_view, MacroName> names_{};
  /// A name that takes arguments stands somewhere without: anything in brackets may become its
  /// arguments.
  bool is_loose_ = false;
  bool is_adjacent_ = false;  ///< such a name may end what stands before a bracket's beginning
  /// What a macro with arguments has become may end in its own name, before brackets.
  bool is_called_again_ = false;
  bool is_endless_ = false;
  std::unordered_set<std::string_view> pasted_names_{};  ///< that `##` may make
  GlslWeight pasted_{};                                  ///< the worst of them
  double loose_times_ = 1;
  double most_times_ = 1;  ///< of all macros

  void split(std::span<const GlslToken> tokens);
  void define(std::span<const GlslToken> tokens);
  void find_loose(std::span<const GlslToken> all);
  /// Whether what a word becomes may begin with a bracket, or end in the name of a macro that takes
  /// arguments.
  bool may_open(const GlslToken& token, std::span<const std::string_view> parameters) const;
  bool may_call(const GlslToken& token, std::span<const std::string_view> parameters) const;
  void find_ends();
  /// Only between two such words can what begins an argument or a body become a macro's brackets.
  void find_adjacent(std::span<const GlslToken> tokens,
                     std::span<const std::string_view> parameters);
  bool uses_arguments(const Definition& of) const;
  /// Names that are made of two or more words of the text.
  void find_pasted(std::span<const GlslToken> all);
  void weigh_all();
  /// Whether what is known of a name grew.
  bool add(const Definition& of);
  /// `own`: the macro whose body this is, where its name is not replaced; empty of code.
  GlslWeight weigh(std::span<const GlslToken> tokens, std::string_view own, ParameterUses* uses,
                   const FoundOperators& found) const;
};

}  // namespace softfocus
