#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "tools/sequence/run_frames.h"

using namespace softfocus;

namespace {

std::vector<std::byte> picture(const std::string& text) {
  const auto bytes = std::as_bytes(std::span{text.data(), text.size()});
  return {bytes.begin(), bytes.end()};
}

/// A video of letters.
struct Video {
  std::string text;
  FramesInOrder::Write writer() {
    return [this](std::span<const std::byte> bytes) {
      text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      return true;
    };
  }
};

}  // namespace

TEST_CASE("pictures are written in order, however long each takes" *
          doctest::test_suite("threads")) {
  Video video;
  FramesInOrder order{true, video.writer()};
  std::vector<std::thread> threads;
  for (std::size_t place = 0; place < 8; ++place) {
    threads.emplace_back([&order, place] {
      std::this_thread::sleep_for(std::chrono::milliseconds{2 * (8 - place)});
      order.put(place, picture(std::string(1, static_cast<char>('a' + place))));
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(video.text == "abcdefgh");
}

TEST_CASE("the picture before stands for one that is missing or of another length") {
  Video video;
  FramesInOrder order{true, video.writer()};
  CHECK(order.put(0, {}) == Put::written);
  CHECK(order.put(1, {}) == Put::written);
  CHECK(video.text == "");
  CHECK(order.put(2, picture("cc")) == Put::written);
  CHECK(video.text == "cccccc");
  CHECK(order.put(3, picture("d")) == Put::other_length);
  CHECK(order.put(4, picture("ee")) == Put::written);
  CHECK(order.put(5, {}) == Put::written);
  CHECK(video.text == "cccccccceeee");
}

TEST_CASE("files one after the other may have any length") {
  Video video;
  FramesInOrder order{false, video.writer()};
  CHECK(order.put(0, picture("a")) == Put::written);
  CHECK(order.put(1, picture("bbb")) == Put::written);
  CHECK(video.text == "abbb");
}

TEST_CASE("nothing is written once the reader is gone or writing failed, and nobody waits") {
  int written = 0;
  FramesInOrder gone{true, [&](std::span<const std::byte>) { return ++written < 2; }};
  CHECK(gone.put(0, picture("a")) == Put::written);
  CHECK(gone.put(1, picture("b")) == Put::reader_gone);
  CHECK(gone.put(7, picture("c")) == Put::reader_gone);
  CHECK(written == 2);

  FramesInOrder full{
      true, [](std::span<const std::byte>) -> bool { throw std::runtime_error{"no room"}; }};
  Put of_next = Put::written;
  std::thread next{[&] { of_next = full.put(1, picture("b")); }};
  CHECK_THROWS_AS(full.put(0, picture("a")), std::runtime_error);
  next.join();
  CHECK(of_next == Put::failed);
}
