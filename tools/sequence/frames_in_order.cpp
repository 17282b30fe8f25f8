#include "tools/sequence/frames_in_order.h"

namespace softfocus {

void FramesInOrder::write(std::span<const std::byte> picture) {
  if (end_ != Put::written) return;
  try {
    if (!write_(picture)) end_ = Put::reader_gone;
  } catch (...) {
    end_ = Put::failed;
    turn_.notify_all();
    throw;
  }
}

Put FramesInOrder::put(std::size_t place, std::vector<std::byte> picture) {
  std::unique_lock lock(mutex_);
  turn_.wait(lock, [&] { return end_ != Put::written || next_ == place; });
  if (end_ != Put::written) return end_;
  const bool fits =
      !same_length_ || picture.empty() || last_.empty() || picture.size() == last_.size();
  if (!picture.empty() && fits) last_ = std::move(picture);
  if (last_.empty()) {
    ++owed_;
  } else {
    for (; owed_ > 0; --owed_) write(last_);
    write(last_);
  }
  ++next_;
  turn_.notify_all();
  if (end_ != Put::written) return end_;
  return fits ? Put::written : Put::other_length;
}

}  // namespace softfocus
