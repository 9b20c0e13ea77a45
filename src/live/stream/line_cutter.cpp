#include "live/stream/line_cutter.h"

#include <algorithm>
#include <utility>

namespace retarget {
namespace {

constexpr std::size_t kMostLineBytes = std::size_t{1} << 20;

}  // namespace

void LineCutter::add(std::string_view bytes) {
  waiting_.append(bytes);
  is_whole_ = is_datagram_ = false;
}

void LineCutter::add_datagram(std::string_view bytes) {
  waiting_ = bytes;
  taken_ = looked_ = given_ = 0;
  is_whole_ = is_datagram_ = true;
}

void LineCutter::clear() {
  waiting_.clear();
  taken_ = looked_ = given_ = 0;
  is_whole_ = is_datagram_ = skips_ = false;
}

bool LineCutter::next(std::string_view& line) {
  while (taken_ < waiting_.size()) {
    std::size_t end = waiting_.find('\n', std::max(taken_, looked_));
    if (end == std::string::npos) {
      looked_ = waiting_.size();
      if (!is_whole_) break;
      end = waiting_.size();
    }
    const std::string_view found = std::string_view(waiting_).substr(taken_, end - taken_);
    taken_ = std::min(end + 1, waiting_.size());
    if (std::exchange(skips_, false)) continue;
    if (found.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (is_datagram_ && given_++ == most_) {
      ++dropped_;
      taken_ = waiting_.size();
      break;
    }
    line = found;
    return true;
  }
  looked_ -= std::min(looked_, taken_);
  waiting_.erase(0, std::exchange(taken_, 0));
  if (waiting_.size() > kMostLineBytes) {
    if (!std::exchange(skips_, true)) ++dropped_;
    waiting_.clear();
    looked_ = 0;
  }
  return false;
}

}  // namespace retarget
