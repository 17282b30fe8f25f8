#include "tools/files/json.h"

#include <doctest/doctest.h>

#include <limits>

using namespace softfocus;

TEST_CASE("json: pairs that begin with a text make an object, all else an array") {
  CHECK(json_text({{"a", 1}, {"b", "two"}}) == R"({"a":1,"b":"two"})");
  CHECK(json_text({1, 2.5, true, nullptr}) == "[1,2.5,true,null]");
  CHECK(json_text({{"place", {3, 4}}}) == R"({"place":[3,4]})");
}

TEST_CASE("json: members keep the order in which they were added") {
  Json json{{"z", 1}};
  json["a"] = 2;
  json["z"] = 3;
  json["list"].push_back("first");
  CHECK(json_text(json) == R"({"z":3,"a":2,"list":["first"]})");
}

TEST_CASE("json: a text comes back as it was written") {
  const Json json{{"text", "\"\n"}, {"numbers", std::vector<double>{0.1, -7.0}}, {"none", nullptr}};
  const auto parsed = parse_json(json_text(json));
  REQUIRE(parsed);
  CHECK(json_text(*parsed, 2) == json_text(json, 2));
  CHECK(parsed->at("text").text() == "\"\n");
  CHECK(parsed->at("numbers").numbers() == std::vector<double>{0.1, -7.0});
  CHECK(parsed->at("none").is_null());
}

TEST_CASE("json: what is no UTF-8 is replaced, and what is no number is null") {
  CHECK(json_text("\xff") == "\"\xef\xbf\xbd\"");
  CHECK(number_or_null(std::numeric_limits<double>::infinity()).is_null());
}

TEST_CASE("json: 64 levels are read, and a file of brackets ends no stack") {
  const auto nested = [](std::size_t levels) {
    return std::string(levels, '[') + std::string(levels, ']');
  };
  CHECK(parse_json(nested(64)));
  CHECK(parse_json(std::string(64, '[') + "1" + std::string(64, ']')));
  CHECK_FALSE(parse_json(nested(65)));
  CHECK_FALSE(parse_json(nested(1'000'000)));
  CHECK_FALSE(parse_json(std::string(1'000'000, '[')));
}

TEST_CASE("json: a value of another kind or a missing one is an error") {
  const auto parsed = parse_json(R"({"a": [1]})");
  REQUIRE(parsed);
  CHECK_THROWS_AS(parsed->at("b"), JsonError);
  CHECK_THROWS_AS(parsed->at("a").text(), JsonError);
  CHECK_THROWS_AS(parsed->at("a").at(1), JsonError);
  CHECK_FALSE(parse_json("{"));
}
