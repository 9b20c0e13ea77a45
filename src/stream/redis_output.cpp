// Robot frames as keys of a Redis server. CMake says RETARGET_HAS_HIREDIS where hiredis is there.

#include "base/try.h"
#include "stream/frame_output.h"

#ifdef RETARGET_HAS_HIREDIS

#include <fmt/format.h>
#include <hiredis/hiredis.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/printable.h"
#include "stream/patient_connection.h"
#include "stream/twist2_action.h"

namespace retarget {
namespace {

using Clock = PatientConnection::Clock;

constexpr double kOpenWithin = 1.0;  // seconds
constexpr auto kAnswerWithin = std::chrono::seconds(1);
constexpr int kMaxUnanswered = 10;       // commands without a reply: networks have them under way
constexpr std::size_t kMaxReply = 4096;  // bytes, of `+OK` and of errors
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

// Keys are set without waiting for the server: frames are left out where it is too far behind. hiredis
// writes commands and reads replies; its own connections would wait.
class RedisKeys {
 public:
  using Tell = std::function<void(std::string_view label, std::string_view text)>;
  using Pairs = std::span<const std::pair<std::string, std::string>>;

  RedisKeys(const StreamAddress& address, Tell tell)
      : connection_(address), tell_(std::move(tell)) {}
  RedisKeys(const RedisKeys&) = delete;
  RedisKeys& operator=(const RedisKeys&) = delete;
  // the last frame leaves, unless the server stalls
  ~RedisKeys() {
    const auto until = Clock::now() + kCloseWithin;
    while (waiting_ > 0 && Clock::now() < until && advance(Clock::now())) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  [[nodiscard]] Result<void> open() {
    TRY(connection_.open(kOpenWithin));
    begin();
    return {};
  }

  // all keys at once, so that readers never see some of them
  void set(Pairs pairs) {
    const auto now = Clock::now();
    if (!advance(now) || !unsent_.empty() || waiting_ >= kMaxUnanswered) {
      ++left_out_;
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
    if (size <= 0) return;
    unsent_.assign(command, static_cast<std::size_t>(size));
    if (waiting_++ == 0) heard_ = now;
    advance(now);
  }

 private:
  void begin() {
    reader_.reset(redisReaderCreate());
    unsent_.clear();
    waiting_ = 0;
    reply_size_ = 0;
    was_open_ = true;
  }

  // sends and takes what goes; whether the server is there
  bool advance(Clock::time_point now) {
    connection_.retry(now);
    if (connection_.is_open() && !was_open_) begin();
    if (!unsent_.empty()) unsent_.erase(0, connection_.send(unsent_));
    if (connection_.is_open()) take_replies(now);
    if (waiting_ > 0 && now - heard_ > kAnswerWithin) connection_.close("it does not answer");
    if (!connection_.is_open()) lose();
    return connection_.is_open();
  }

  void take_replies(Clock::time_point now) {
    std::array<char, 4096> room;
    // one that talks without end is left for the next frame
    constexpr int kMostAtATime = 16;
    for (int i = 0; i < kMostAtATime; ++i) {
      const std::string_view bytes = connection_.receive(room);
      if (bytes.empty()) return;
      if (!are_plain(bytes)) return connection_.close("what answers is no Redis server");
      void* reply = nullptr;
      redisReaderFeed(reader_.get(), bytes.data(), bytes.size());
      while (redisReaderGetReply(reader_.get(), &reply) == REDIS_OK && reply != nullptr) {
        heard_ = now;
        take_reply(std::unique_ptr<redisReply, FreeReply>(static_cast<redisReply*>(reply)));
      }
      if (reader_->err != 0) return connection_.close("what answers is no Redis server");
    }
  }

  // Whether these bytes go on as replies that are lines do: nothing else is due, and by what other kinds
  // claim to hold the reader would take memory.
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
      ++left_out_;
      tell_once(printable({reply->str, static_cast<std::size_t>(reply->len)}));
    } else if (std::exchange(told_, false)) {
      tell_("output", fmt::format("{} takes robot frames again; {} were left out",
                                  connection_.address().text(), left_out_));
    }
  }

  void lose() {
    if (!was_open_) return;
    was_open_ = false;
    waiting_ = 0;
    unsent_.clear();
    tell_once(connection_.reason());
  }

  void tell_once(std::string_view what) {
    if (!std::exchange(told_, true)) {
      tell_("output", fmt::format("{} takes no robot frames: {}; it is tried again",
                                  connection_.address().text(), what));
    }
  }

  PatientConnection connection_;
  Tell tell_;
  std::unique_ptr<redisReader, FreeReader> reader_;
  std::string unsent_;
  int waiting_ = 0;             // for replies
  std::size_t reply_size_ = 0;  // of the one that has come in part
  Clock::time_point heard_;     // of a reply, or asked while none was due
  bool was_open_ = false, told_ = false;
  std::int64_t left_out_ = 0;
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

// milliseconds since 1970, as the controller compares them with its own clock
std::int64_t wall_clock() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

class Twist2Output final : public FrameOutput {
 public:
  Twist2Output(const StreamAddress& to, RedisKeys::Tell tell, Twist2Actions actions)
      : keys_(to, std::move(tell)), actions_(std::move(actions)) {}

  [[nodiscard]] Result<void> open() { return keys_.open(); }

  [[nodiscard]] Result<void> take(const RobotFrame& frame) override {
    const Twist2Action& action = actions_.take(frame);
    write_list(action.body, pairs_[0].second);
    write_list(action.left_hand, pairs_[1].second);
    write_list(action.right_hand, pairs_[2].second);
    write_list(action.neck, pairs_[3].second);
    pairs_[4].second.clear();
    fmt::format_to(std::back_inserter(pairs_[4].second), "{}", wall_clock());
    keys_.set(pairs_);
    return {};
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
  TRY(check_extras(to, {}));
  if (to.port == 0) return usage_failure(to.text() + " has no port to send to");
  TRY_ASSIGN(Twist2Actions actions, Twist2Actions::make(*context.robot, context.fps));
  auto output = std::make_unique<Twist2Output>(to, context.tell, std::move(actions));
  TRY(output->open());
  return output;
}

bool has_redis_output() {
  return true;
}

}  // namespace retarget

#else

namespace retarget {

Result<std::unique_ptr<FrameOutput>> open_redis_output(const StreamAddress& to,
                                                       const FrameOutputContext& /*context*/) {
  return lacks_library(to, "hiredis", "libhiredis-dev");
}

bool has_redis_output() {
  return false;
}

}  // namespace retarget

#endif
