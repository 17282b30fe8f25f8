#pragma once
// A JSON value, and its way from and to text. Only json.cpp includes nlohmann's header, which takes
// seconds to compile.

#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// A value is not of the kind that is asked for, or lacks a member.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Json {
 public:
  Json(std::nullptr_t = nullptr) {}  // NOLINT(google-explicit-constructor): so is all below
  template <std::integral T>
  Json(T value) : kind_(Kind::integer), integer_(static_cast<std::int64_t>(value)) {
    if constexpr (std::same_as<T, bool>) kind_ = Kind::boolean;
  }
  template <std::floating_point T>
  Json(T value) : kind_(Kind::number), number_(static_cast<double>(value)) {}
  Json(const char* text) : Json(std::string_view{text}) {}
  Json(const std::string& text) : Json(std::string_view{text}) {}
  Json(std::string_view text);
  Json(const std::vector<double>& numbers);
  template <std::size_t n>
  Json(const std::array<float, n>& numbers)
      : Json(std::vector<double>(numbers.begin(), numbers.end())) {}
  /// {{"a", 1}, {"b", 2}} is an object: pairs that begin with a text. All else is an array.
  Json(std::initializer_list<Json> values);
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;
  ~Json();

  static Json array();
  static Json object();

  /// An object's member, added as null if there is none. A null becomes an object.
  Json& operator[](std::string_view name);
  /// Appends to an array. A null becomes an array.
  void push_back(Json value);

  bool is_null() const { return kind_ == Kind::null; }
  bool is_text() const { return kind_ == Kind::text; }
  bool is_object() const { return kind_ == Kind::object; }

  // The value. Throw JsonError if it is something else.
  bool boolean() const;
  std::int64_t integer() const;
  double number() const;  ///< an integer too
  const std::string& text() const;
  std::vector<double> numbers() const;

  /// An array's or an object's values, in order.
  const std::vector<Json>& values() const { return values_; }
  /// The names of an object's values.
  const std::vector<std::string>& names() const { return names_; }
  /// An object's member, or null where there is none.
  const Json* find(std::string_view name) const;
  /// A member that must be there: JsonError.
  const Json& at(std::string_view name) const;
  const Json& at(std::size_t index) const;

 private:
  enum class Kind { null, boolean, integer, number, text, array, object };

  void become(Kind kind);

  Kind kind_ = Kind::null;
  std::int64_t integer_ = 0;
  double number_ = 0.0;
  std::string text_;
  std::vector<Json> values_;
  std::vector<std::string> names_;

  friend struct JsonConversion;
};

/// As text, on one line or indented by so many blanks a level. Bytes that are no UTF-8, as the
/// name of a file may have, become U+FFFD.
std::string json_text(const Json& json, int indent = -1);

/// A text's value, or nullopt if it is not JSON, or has more than 64 levels of arrays and objects.
std::optional<Json> parse_json(std::string_view text);

/// A number, or null for NaN and infinity, which JSON does not have.
Json number_or_null(double value);

}  // namespace softfocus
