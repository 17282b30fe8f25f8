#include "tools/chart/pareto.h"

#include <doctest/doctest.h>

#include <limits>

using namespace softfocus;

namespace {

using Indices = std::vector<std::size_t>;

Indices front_of(const std::vector<TwoCosts>& contenders) { return pareto_front(contenders); }

}  // namespace

TEST_CASE("front: what another beats in time and in error is not on it") {
  CHECK(front_of({{2, 0.5}, {1, 0.9}, {3, 0.6}, {4, 0.1}}) == Indices{1, 0, 3});
}

TEST_CASE("front: being as good in one and worse in the other is being beaten") {
  CHECK(front_of({{1, 0.5}, {1, 0.4}, {2, 0.4}}) == Indices{1});
}

TEST_CASE("front: equal ones are all on it, in their order") {
  CHECK(front_of({{5, 0.2}, {1, 0.5}, {1, 0.5}}) == Indices{1, 2, 0});
}

TEST_CASE("front: one alone is on it, of none there is none, NaN is never on it") {
  CHECK(front_of({{7, 7}}) == Indices{0});
  CHECK(front_of({}).empty());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  CHECK(front_of({{kNan, 0.1}, {1, kNan}, {2, 0.2}}) == Indices{2});
}
