#include "raster/threads/memory.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "raster/images/image.h"
#include "tests/support/random.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("a shelf lends what was given back, and nothing twice at once") {
  MemoryShelf shelf;
  void* first = shelf.lend(1000);
  void* second = shelf.lend(1000);
  CHECK(first != second);
  shelf.take_back(first);
  CHECK(shelf.lend(900) == first);
  shelf.take_back(second);
  shelf.take_back(first);
}

TEST_CASE("a shelf lends the smallest piece that is large enough, on a line's boundary") {
  MemoryShelf shelf;
  void* large = shelf.lend(std::size_t{8} << 20);
  void* small = shelf.lend(100);
  for (const void* piece : {large, small}) {
    CHECK(std::bit_cast<std::uintptr_t>(piece) % kRowAlignment == 0);
  }
  shelf.take_back(large);
  shelf.take_back(small);
  CHECK(shelf.lend(100) == small);
  void* beside = shelf.lend(101);  // for which the large one would be a waste
  CHECK(beside != large);
  CHECK(shelf.lend(std::size_t{5} << 20) == large);
  for (void* piece : {small, beside, large}) shelf.take_back(piece);
}

TEST_CASE("what a shelf has lent is its borrower's, whatever comes and goes beside it") {
  struct Lent {
    unsigned char* memory;
    std::size_t bytes;
    unsigned char mark;
  };
  MemoryShelf shelf;
  std::vector<Lent> all;
  Random random{3};
  int wrong = 0;
  for (int step = 0; step < 2000; ++step) {
    if (all.size() < 5 && random.whole(0, 1) == 0) {
      const auto bytes = static_cast<std::size_t>(random.whole(1, 3000));
      const auto mark = static_cast<unsigned char>(step);
      auto* memory = static_cast<unsigned char*>(shelf.lend(bytes));
      std::memset(memory, mark, bytes);
      all.push_back({memory, bytes, mark});
    } else if (!all.empty()) {
      std::swap(all[static_cast<std::size_t>(random.next()) % all.size()], all.back());
      const Lent& last = all.back();
      wrong += static_cast<int>(last.bytes) -
               static_cast<int>(std::count(last.memory, last.memory + last.bytes, last.mark));
      shelf.take_back(last.memory);
      all.pop_back();
    }
  }
  CHECK(wrong == 0);
  for (const Lent& lent : all) shelf.take_back(lent.memory);
}

TEST_CASE("memory of rows goes back to its shelf where it ends, not before") {
  MemoryShelf shelf;
  const float* first = nullptr;
  {
    RowMemory<float> memory = make_row_memory<float>(100, &shelf);
    first = memory.get();
    const RowMemory<float> moved = std::move(memory);
    CHECK(make_row_memory<float>(100, &shelf).get() != first);
    CHECK(moved.get() == first);
  }
  CHECK(make_row_memory<float>(100, &shelf).get() != nullptr);
}

TEST_CASE("bytes of rows begin as zeros, and a copy has its own") {
  for (const std::size_t size : {std::size_t{1}, std::size_t{640}, std::size_t{9} << 20}) {
    RowBytes bytes{size};
    CHECK(bytes.size() == size);
    CHECK(std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; }));
    bytes[size - 1] = std::byte{7};
    RowBytes copy = bytes;
    CHECK(copy == bytes);
    copy[0] ^= std::byte{1};
    CHECK_FALSE(copy == bytes);
    CHECK_FALSE(RowBytes{size + 1} == bytes);
    const RowBytes moved = std::move(bytes);
    CHECK(moved[size - 1] == std::byte{7});
    CHECK(bytes.empty());  // NOLINT(bugprone-use-after-move): says what is left
    CHECK(bytes == RowBytes{});
    bytes = copy;
    CHECK(bytes == copy);
  }
}
