// Sends robot frames as keys of a Redis server. CMake defines RETARGET_HAS_HIREDIS if hiredis is
// available.

#ifdef RETARGET_HAS_HIREDIS

#include <fmt/format.h>
#include <hiredis/hiredis.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "live/stream/byte_output.h"
#include "live/stream/controller_messages.h"
#include "live/stream/frame_output.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kOpenWithin = 1.0;  // seconds
constexpr auto kAnswerWithin = std::chrono::seconds(1);
constexpr int kMaxUnanswered = 10;       // Commands without a reply; allows for network latency.
constexpr std::size_t kMaxReply = 4096;  // Bytes; replies are `+OK` or errors.
constexpr auto kCloseWithin = std::chrono::milliseconds(200);

struct FreeReader {
  void operator()(redisReader* reader) const { redisReaderFree(reader); }
};
struct FreeReply {
  void operator()(void* reply) const { freeReplyObject(reply); }
};
struct FreeCommand {
  void operator()(char* command) const { redisFreeCommand(command); }
};

// Sets keys without waiting for the server and drops frames when it falls too far behind. Uses
// hiredis to format commands and parse replies only, because its connections would block.
class RedisKeys {
 public:
  using Pairs = std::span<const std::pair<std::string, std::string>>;

  RedisKeys(const StreamAddress& address, LiveTell tell)
      : connection_(address), account_(address.text(), std::move(tell)) {}
  RedisKeys(const RedisKeys&) = delete;
  RedisKeys& operator=(const RedisKeys&) = delete;

  [[nodiscard]] Result<void> open() {
    RETARGET_TRY(connection_.open(kOpenWithin));
    begin();
    return {};
  }

  // Sets all keys in one command, so that readers never see a partial update.
  void set(Pairs pairs) {
    const auto now = Clock::now();
    if (!advance(now) || !unsent_.empty() || waiting_ >= kMaxUnanswered) {
      account_.count_dropped();
      return;
    }
    arguments_ = {"MSET"};
    for (const auto& [key, value] : pairs) arguments_.insert(arguments_.end(), {key, value});
    texts_.clear();
    sizes_.clear();
    for (const std::string_view text : arguments_) {
      texts_.push_back(text.data());
      sizes_.push_back(text.size());
    }
    char* command = nullptr;
    const auto size = redisFormatCommandArgv(&command, static_cast<int>(texts_.size()),
                                             texts_.data(), sizes_.data());
    const std::unique_ptr<char, FreeCommand> owner(command);
    if (size <= 0) return account_.count_dropped();
    unsent_.assign(command, static_cast<std::size_t>(size));
    if (waiting_++ == 0) heard_ = now;
    advance(now);
  }

  // Waits briefly for the last frame to leave, unless the server stalls.
  void finish() {
    const auto until = Clock::now() + kCloseWithin;
    while (waiting_ > 0 && Clock::now() < until && advance(Clock::now())) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    account_.count_dropped(std::exchange(waiting_, 0));
  }
  [[nodiscard]] const OutputStatistics& statistics() const { return account_.statistics(); }

 private:
  void begin() {
    reader_.reset(redisReaderCreate());
    unsent_.clear();
    waiting_ = 0;
    reply_size_ = 0;
    was_open_ = true;
  }

  // Sends and receives without blocking. @return whether the server is connected
  bool advance(Clock::time_point now) {
    connection_.retry(now);
    if (connection_.is_open() && !was_open_) {
      account_.count_reconnect();
      begin();
    }
    if (!unsent_.empty()) unsent_.erase(0, connection_.send(unsent_));
    if (connection_.is_open()) take_replies(now);
    if (waiting_ > 0 && now - heard_ > kAnswerWithin) connection_.close("it does not answer");
    if (!connection_.is_open()) lose();
    return connection_.is_open();
  }

  void take_replies(Clock::time_point now) {
    std::array<char, 4096> room;
    // Bounded, so that a peer that sends endlessly cannot stall the frame.
    constexpr int kMostAtATime = 16;
    for (int i = 0; i < kMostAtATime; ++i) {
      const std::string_view bytes = connection_.receive(room);
      if (bytes.empty()) return;
      if (!are_plain(bytes)) return connection_.close("the peer is not a Redis server");
      void* reply = nullptr;
      redisReaderFeed(reader_.get(), bytes.data(), bytes.size());
      while (redisReaderGetReply(reader_.get(), &reply) == REDIS_OK && reply != nullptr) {
        heard_ = now;
        take_reply(std::unique_ptr<redisReply, FreeReply>(static_cast<redisReply*>(reply)));
      }
      if (reader_->err != 0) return connection_.close("the peer is not a Redis server");
    }
  }

  // Whether the bytes are valid parts of single-line replies. Only these are expected, and other
  // types could make the reader allocate any claimed size.
  bool are_plain(std::string_view bytes) {
    for (const char c : bytes) {
      if (reply_size_ == 0 && c != '+' && c != '-') return false;
      if (++reply_size_ > kMaxReply) return false;
      if (c == '\n') reply_size_ = 0;
    }
    return true;
  }

  void take_reply(const std::unique_ptr<redisReply, FreeReply>& reply) {
    waiting_ = std::max(0, waiting_ - 1);
    if (reply->type == REDIS_REPLY_ERROR) {
      account_.report_trouble({reply->str, static_cast<std::size_t>(reply->len)});
      account_.count_dropped();
    } else {
      account_.report_recovery();
      account_.count_sent();
    }
  }

  void lose() {
    if (!was_open_) return;
    was_open_ = false;
    account_.report_trouble(connection_.reason());
    account_.count_dropped(std::exchange(waiting_, 0));
    unsent_.clear();
  }

  PatientConnection connection_;
  OutputAccount account_;
  std::unique_ptr<redisReader, FreeReader> reader_;
  std::string unsent_;
  int waiting_ = 0;             // Pending replies.
  std::size_t reply_size_ = 0;  // Bytes of a partially received reply.
  Clock::time_point heard_;     // Last reply, or last command sent while none was pending.
  bool was_open_ = false;
  std::vector<std::string_view> arguments_;
  std::vector<const char*> texts_;
  std::vector<std::size_t> sizes_;
};

template <std::size_t N>
void write_list(const std::array<double, N>& values, std::string& text) {
  text.clear();
  for (std::size_t i = 0; i < N; ++i) {
    fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? "[" : ",", values[i]);
  }
  text += ']';
}

// Milliseconds since 1970; the controller compares them with its own clock.
std::int64_t wall_clock() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

class Twist2Output final : public FrameOutput {
 public:
  Twist2Output(const StreamAddress& to, LiveTell tell, Twist2Actions actions)
      : keys_(to, std::move(tell)), actions_(std::move(actions)) {}

  [[nodiscard]] Result<void> open() { return keys_.open(); }

  void finish() override { keys_.finish(); }
  [[nodiscard]] const OutputStatistics& statistics() const override { return keys_.statistics(); }

  void take(const RobotFrame& frame) override {
    const Twist2Action& action = actions_.take(frame);
    write_list(action.body, pairs_[0].second);
    write_list(action.left_hand, pairs_[1].second);
    write_list(action.right_hand, pairs_[2].second);
    write_list(action.neck, pairs_[3].second);
    pairs_[4].second.clear();
    fmt::format_to(std::back_inserter(pairs_[4].second), "{}", wall_clock());
    keys_.set(pairs_);
  }

 private:
  RedisKeys keys_;
  Twist2Actions actions_;
  std::array<std::pair<std::string, std::string>, 5> pairs_ = {
      {{"action_body_unitree_g1_with_hands", {}},
       {"action_hand_left_unitree_g1_with_hands", {}},
       {"action_hand_right_unitree_g1_with_hands", {}},
       {"action_neck_unitree_g1_with_hands", {}},
       {"t_action", {}}}};
};

}  // namespace

Result<std::unique_ptr<FrameOutput>> open_redis_output(const StreamAddress& to,
                                                       const FrameOutputContext& context) {
  RETARGET_TRY(check_extras(to, {}));
  if (to.port == 0) return usage_failure(to.text() + " has no destination port");
  RETARGET_TRY_ASSIGN(Twist2Actions actions, Twist2Actions::make(*context.robot, context.fps));
  auto output = std::make_unique<Twist2Output>(to, context.tell, std::move(actions));
  RETARGET_TRY(output->open());
  return output;
}

}  // namespace retarget

#endif
