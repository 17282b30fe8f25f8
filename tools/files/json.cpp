#include "tools/files/json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace softfocus {

using Library = nlohmann::ordered_json;

struct JsonConversion {
  using Kind = Json::Kind;

  static Library to_library(const Json& json) {
    switch (json.kind_) {
      case Kind::null: break;
      case Kind::boolean: return json.integer_ != 0;
      case Kind::integer: return json.integer_;
      case Kind::number: return json.number_;
      case Kind::text: return json.text_;
      case Kind::array: {
        Library array = Library::array();
        for (const Json& value : json.values_) array.push_back(to_library(value));
        return array;
      }
      case Kind::object: {
        Library object = Library::object();
        for (std::size_t i = 0; i < json.values_.size(); ++i) {
          object[json.names_[i]] = to_library(json.values_[i]);
        }
        return object;
      }
    }
    return nullptr;
  }

  static Json from_library(const Library& library) {
    if (library.is_boolean()) return library.get<bool>();
    if (library.is_number_integer()) return library.get<std::int64_t>();
    if (library.is_number()) return library.get<double>();
    if (library.is_string()) return library.get_ref<const std::string&>();
    Json json;
    if (library.is_array()) {
      json.kind_ = Kind::array;
      for (const Library& value : library) json.values_.push_back(from_library(value));
    }
    if (library.is_object()) {
      json.kind_ = Kind::object;
      for (auto member = library.begin(); member != library.end(); ++member) {
        json[member.key()] = from_library(*member);
      }
    }
    return json;
  }
};

Json::Json(std::string_view text) : kind_(Kind::text), text_(text) {}

Json::Json(const std::vector<double>& numbers)
    : kind_(Kind::array), values_(numbers.begin(), numbers.end()) {}

Json::Json(std::initializer_list<Json> values) {
  const bool is_object = std::all_of(values.begin(), values.end(), [](const Json& value) {
    return value.kind_ == Kind::array && value.values_.size() == 2 && value.values_[0].is_text();
  });
  if (is_object) {
    kind_ = Kind::object;
    for (const Json& pair : values) (*this)[pair.values_[0].text_] = pair.values_[1];
  } else {
    kind_ = Kind::array;
    values_ = values;
  }
}

Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) = default;
Json& Json::operator=(Json&& other) noexcept = default;
Json::~Json() = default;

Json Json::array() {
  Json json;
  json.kind_ = Kind::array;
  return json;
}

Json Json::object() {
  Json json;
  json.kind_ = Kind::object;
  return json;
}

void Json::become(Kind kind) {
  if (kind_ == Kind::null) kind_ = kind;
  if (kind_ != kind) throw JsonError("a JSON value is of another kind");
}

Json& Json::operator[](std::string_view name) {
  become(Kind::object);
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) return values_[static_cast<std::size_t>(found - names_.begin())];
  names_.emplace_back(name);
  return values_.emplace_back();
}

void Json::push_back(Json value) {
  become(Kind::array);
  values_.push_back(std::move(value));
}

bool Json::boolean() const {
  if (kind_ != Kind::boolean) throw JsonError("a JSON value is no boolean");
  return integer_ != 0;
}

std::int64_t Json::integer() const {
  if (kind_ != Kind::integer) throw JsonError("a JSON value is no integer");
  return integer_;
}

double Json::number() const {
  return kind_ == Kind::number ? number_ : static_cast<double>(integer());
}

const std::string& Json::text() const {
  if (kind_ != Kind::text) throw JsonError("a JSON value is no text");
  return text_;
}

std::vector<double> Json::numbers() const {
  if (kind_ != Kind::array) throw JsonError("a JSON value is no array");
  std::vector<double> numbers;
  for (const Json& value : values_) numbers.push_back(value.number());
  return numbers;
}

const Json* Json::find(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  return found == names_.end() ? nullptr
                               : &values_[static_cast<std::size_t>(found - names_.begin())];
}

const Json& Json::at(std::string_view name) const {
  if (const Json* found = find(name)) return *found;
  throw JsonError("a JSON object lacks " + std::string{name});
}

const Json& Json::at(std::size_t index) const {
  if (index < values_.size()) return values_[index];
  throw JsonError("a JSON array is too short");
}

std::string json_text(const Json& json, int indent) {
  return JsonConversion::to_library(json).dump(indent, ' ', false,
                                               Library::error_handler_t::replace);
}

std::optional<Json> parse_json(std::string_view text) {
  // Each level is a call of from_library() within another: a file of brackets could end the stack.
  constexpr int kMostLevels = 64;
  bool too_deep = false;
  using Event = Library::parse_event_t;
  const auto is_wanted = [&](int levels_around, Event event, const Library&) {
    const bool is_level = event == Event::array_start || event == Event::object_start;
    too_deep = too_deep || (is_level && levels_around == kMostLevels);
    return !too_deep;
  };
  const Library library = Library::parse(text, is_wanted, false);
  if (too_deep || library.is_discarded()) return std::nullopt;
  return JsonConversion::from_library(library);
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace softfocus
