#include "live/stream/message_cutter.h"

#include <fmt/format.h>
#include <algorithm>

#include "retarget/try.h"

#ifdef RETARGET_HAS_LZ4
#include <lz4frame.h>

#include <array>
#endif

namespace retarget {

#ifdef RETARGET_HAS_LZ4

struct Lz4Frame::Context {
  Context() { LZ4F_createDecompressionContext(&handle, LZ4F_VERSION); }
  ~Context() { LZ4F_freeDecompressionContext(handle); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  LZ4F_dctx* handle = nullptr;
};

bool Lz4Frame::is_available() {
  return true;
}

void Lz4Frame::clear() {
  if (context_) LZ4F_resetDecompressionContext(context_->handle);
}

Result<bool> Lz4Frame::unpack(std::string_view& bytes, std::size_t max_size, std::string& text) {
  if (!context_) context_ = std::make_unique<Context>();
  std::array<char, 1 << 14> room;
  const auto refused = [this](std::string message) {
    clear();
    return input_failure({}, std::move(message));
  };
  for (;;) {
    std::size_t taken = bytes.size(), made = room.size();
    const std::size_t wants =
        LZ4F_decompress(context_->handle, room.data(), &made, bytes.data(), &taken, nullptr);
    if (LZ4F_isError(wants) != 0U) {
      return refused(std::string("not an LZ4 frame: ") + LZ4F_getErrorName(wants));
    }
    if (text.size() + made > max_size)
      return refused("the LZ4 frame exceeds the packet size limit");
    text.append(room.data(), made);
    bytes.remove_prefix(taken);
    if (wants == 0) return true;
    if (taken == 0 && made == 0) return false;
  }
}

#else

struct Lz4Frame::Context {};

bool Lz4Frame::is_available() {
  return false;
}

void Lz4Frame::clear() {
  context_.reset();
}

Result<bool> Lz4Frame::unpack(std::string_view&, std::size_t, std::string&) {
  return input_failure({}, "the packet is compressed with LZ4, which this build does not support",
                       "configure the sender to send plain JSON");
}

#endif

Lz4Frame::Lz4Frame() = default;
Lz4Frame::~Lz4Frame() = default;
Lz4Frame::Lz4Frame(Lz4Frame&&) noexcept = default;
Lz4Frame& Lz4Frame::operator=(Lz4Frame&&) noexcept = default;

namespace {

constexpr std::size_t kMostLineBytes = std::size_t{1} << 20;

constexpr std::size_t kMaxText = std::size_t{1} << 20;  // bytes
constexpr std::string_view kBetween(" \t\r\n\0", 5);

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostValues = 20'000;
constexpr std::size_t kMostDepth = 32;

// Stops scanning as soon as a bound is exceeded.
Result<void> check_bounds(std::string_view text, const std::string& what) {
  if (text.size() > kMostBytes) return input_failure({}, what + " exceeds one megabyte");
  std::size_t depth = 0, values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == ',' || c == ':' || c == '[' || c == '{') ++values;
    if (depth > kMostDepth) {
      return input_failure({},
                           fmt::format("{} is nested more than {} levels deep", what, kMostDepth));
    }
    if (values > kMostValues) {
      return input_failure({}, fmt::format("{} has more than {} values", what, kMostValues));
    }
  }
  return {};
}

}  // namespace

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

Result<PacketJson> parse_packet_json(std::string_view text, const std::string& what) {
  RETARGET_TRY(check_bounds(text, what));
  try {
    return PacketJson::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    return input_failure({}, fmt::format("{} is not JSON: byte {}", what, error.byte));
  } catch (const nlohmann::json::exception&) {
    return input_failure({}, what + " contains a number that is too large");
  }
}

Result<PacketJson> parse_json_line(std::string_view line) {
  RETARGET_TRY_ASSIGN(PacketJson json, parse_packet_json(line, "the line"));
  if (!json.is_object()) return input_failure({}, "expected a JSON object per line");
  return json;
}

const PacketJson* find_member(const PacketJson& json, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const auto found = json.find(name);
    if (found != json.end() && !found->is_null()) return &*found;
  }
  return nullptr;
}

}  // namespace retarget
