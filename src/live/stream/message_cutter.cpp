#include "live/stream/message_cutter.h"

namespace retarget {

void MessageCutter::append(std::string_view bytes) {
  // Messages are small compared with a read, so less than one message is moved.
  waiting_.erase(0, std::exchange(taken_, 0));
  waiting_.append(bytes);
}

std::optional<std::string_view> MessageCutter::next() {
  while (waiting_.size() - taken_ >= header_size_) {
    const std::string_view rest = std::string_view(waiting_).substr(taken_);
    const auto size = size_of_(rest.substr(0, header_size_));
    if (!size) {
      ++taken_;
      ++skipped_;
      continue;
    }
    if (rest.size() < *size) break;
    taken_ += *size;
    return rest.substr(0, *size);
  }
  return std::nullopt;
}

void MessageCutter::clear() {
  waiting_.clear();
  taken_ = skipped_ = 0;
}

}  // namespace retarget
