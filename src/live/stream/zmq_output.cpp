// Publishes robot frames over ZeroMQ. CMake defines RETARGET_HAS_ZEROMQ if libzmq is available.

#ifdef RETARGET_HAS_ZEROMQ

#include <fmt/format.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>

#include "live/stream/controller_messages.h"
#include "live/stream/frame_output.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Queue length per subscriber: one second of messages. A stalled subscriber loses further messages.
constexpr int kMaxMessages = 50;
// Time at the end of the run for the last messages to leave.
constexpr int kLinger = 200;  // milliseconds

struct CloseContext {
  void operator()(void* context) const { zmq_ctx_term(context); }
};
struct CloseSocket {
  void operator()(void* socket) const { zmq_close(socket); }
};

// A PUB socket that subscribers connect to.
class Publisher {
 public:
  [[nodiscard]] static Result<Publisher> bind(const StreamAddress& address) {
    Publisher made;
    made.context_.reset(zmq_ctx_new());
    if (made.context_) made.socket_.reset(zmq_socket(made.context_.get(), ZMQ_PUB));
    if (!made.socket_) return failed(address, "cannot create a socket");
    zmq_setsockopt(made.socket_.get(), ZMQ_SNDHWM, &kMaxMessages, sizeof kMaxMessages);
    zmq_setsockopt(made.socket_.get(), ZMQ_LINGER, &kLinger, sizeof kLinger);
    const std::string port = address.port == 0 ? "*" : std::to_string(address.port);
    if (zmq_bind(made.socket_.get(), fmt::format("tcp://{}:{}", address.host, port).c_str()) != 0) {
      return failed(address, "cannot bind the port", "is another program publishing on it?");
    }
    return made;
  }

  // The bound address, such as `zmq:127.0.0.1:5556`.
  [[nodiscard]] std::string place() const {
    std::array<char, 128> endpoint{};
    std::size_t size = endpoint.size();
    zmq_getsockopt(socket_.get(), ZMQ_LAST_ENDPOINT, endpoint.data(), &size);
    const std::string_view text = endpoint.data();
    return "zmq:" +
           std::string(text.substr(std::min(text.size(), std::string_view("tcp://").size())));
  }

  // Sends without waiting; slow subscribers lose the message.
  // @return whether the socket accepted it
  [[nodiscard]] bool send(std::string_view message) {
    return zmq_send(socket_.get(), message.data(), message.size(), ZMQ_DONTWAIT) >= 0;
  }

 private:
  static Failure failed(const StreamAddress& address, std::string_view what,
                        std::string hint = {}) {
    return run_failure(address.text(), fmt::format("{}: {}", what, zmq_strerror(zmq_errno())),
                       std::move(hint));
  }

  // Members are destroyed in reverse order: the socket before its context.
  std::unique_ptr<void, CloseContext> context_;
  std::unique_ptr<void, CloseSocket> socket_;
};

class SonicOutput final : public FrameOutput {
 public:
  SonicOutput(Publisher publisher, SonicMessage message)
      : publisher_(std::move(publisher)), message_(std::move(message)) {
    statistics_.name = publisher_.place();
  }

  // ZeroMQ does not report the losses of individual subscribers.
  void take(const RobotFrame& frame) override {
    const std::string_view message = message_.take(frame);
    if (message.empty()) return;
    if (publisher_.send(message)) {
      ++statistics_.sent;
    } else {
      ++statistics_.dropped;
      statistics_.last_error = zmq_strerror(zmq_errno());
    }
  }
  [[nodiscard]] const OutputStatistics& statistics() const override { return statistics_; }

 private:
  Publisher publisher_;
  SonicMessage message_;
  OutputStatistics statistics_;
};

Result<SonicOptions> parse_options(const StreamAddress& to) {
  RETARGET_TRY(check_extras(to, std::array<std::string, 2>{"frames", "joints"}));
  SonicOptions options;
  if (const std::string frames = to.extra("frames"); !frames.empty()) {
    const auto number = parse_number<int>(frames);
    if (!number) return usage_failure("expected a number of frames, found \"" + frames + "\"");
    options.frames = *number;
  }
  if (const std::string joints = to.extra("joints"); !joints.empty()) {
    if (joints != "all") return usage_failure("expected joints=all, found \"" + joints + "\"");
    options.any_robot = true;
  }
  return options;
}

}  // namespace

Result<std::unique_ptr<FrameOutput>> open_zmq_output(const StreamAddress& to,
                                                     const FrameOutputContext& context) {
  RETARGET_TRY_ASSIGN(const SonicOptions options, parse_options(to));
  RETARGET_TRY_ASSIGN(SonicMessage message,
                      SonicMessage::make(*context.robot, context.fps, options));
  RETARGET_TRY_ASSIGN(Publisher publisher, Publisher::bind(to));
  context.tell("output", "publishing at " + publisher.place());
  return std::make_unique<SonicOutput>(std::move(publisher), std::move(message));
}

}  // namespace retarget

#endif
