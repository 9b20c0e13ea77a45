#include "live/stream/json_cutter.h"

#include <algorithm>
#include <utility>

#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxText = std::size_t{1} << 20;  // bytes
constexpr std::string_view kBetween(" \t\r\n\0", 5);

}  // namespace

void JsonCutter::clear() {
  inside_ = Inside::kNothing;
  depth_ = 0;
  in_text_ = escaped_ = false;
  frame_.clear();
}

// @return whether the object has ended
bool JsonCutter::take_object(std::string_view& bytes) {
  std::size_t size = 0;
  while (size < bytes.size()) {
    const char byte = bytes[size++];
    if (in_text_) {
      if (escaped_) {
        escaped_ = false;
      } else if (byte == '\\') {
        escaped_ = true;
      } else if (byte == '"') {
        in_text_ = false;
      }
    } else if (byte == '"') {
      in_text_ = true;
    } else if (byte == '{') {
      ++depth_;
    } else if (byte == '}' && --depth_ == 0) {
      break;
    }
  }
  text_.append(bytes.substr(0, size));
  bytes.remove_prefix(size);
  return depth_ == 0;
}

Result<std::optional<std::string_view>> JsonCutter::next(std::string_view& bytes) {
  if (!is_inside()) {
    text_.clear();
    bytes.remove_prefix(std::min(bytes.find_first_not_of(kBetween), bytes.size()));
    if (bytes.empty()) return std::nullopt;
    if (bytes.front() != '{' && bytes.front() != kLz4Mark) {
      bytes.remove_prefix(std::min(bytes.find('{'), bytes.size()));
      return input_failure({}, "the data do not begin with a JSON object");
    }
    inside_ = bytes.front() == '{' ? Inside::kObject : Inside::kFrame;
  }
  bool ended = false;
  if (inside_ == Inside::kObject) {
    ended = take_object(bytes);
  } else {
    const std::size_t before = text_.size();
    auto unpacked = frame_.unpack(bytes, std::min(kMaxText, before + unpacked_left_), text_);
    unpacked_left_ -= text_.size() - before;
    if (!unpacked) {
      // The start of the next frame is unknown.
      bytes = {};
      clear();
      return failure(std::move(unpacked.error()));
    }
    ended = *unpacked;
  }
  if (text_.size() > kMaxText) {
    clear();
    return input_failure({}, "a JSON object exceeds one megabyte");
  }
  if (!ended) return std::nullopt;
  clear();
  return std::string_view(text_);
}

}  // namespace retarget
