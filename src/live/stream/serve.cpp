#include "retarget/serve.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <span>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "live/stream/byte_source.h"
#include "live/stream/frame_output.h"
#include "live/stream/live_files.h"
#include "live/stream/live_pipeline.h"
#include "live/stream/stats_writer.h"
#include "live/stream/stream_record.h"
#include "retarget/load_robot.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Microseconds since construction, on a monotonic clock.
class Stopwatch {
 public:
  [[nodiscard]] std::int64_t now() const {
    const auto passed = std::chrono::steady_clock::now() - begin_;
    return std::chrono::duration_cast<std::chrono::microseconds>(passed).count();
  }
  [[nodiscard]] std::chrono::steady_clock::time_point at(std::int64_t microseconds) const {
    return begin_ + std::chrono::microseconds(microseconds);
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

double seconds_of(std::int64_t microseconds) {
  return 1e-6 * static_cast<double>(microseconds);
}

// Sends requests to a stream's sender: a new request at once, the same request again at intervals.
class Asker {
 public:
  void ask(ByteSource& source, std::string_view request, std::int64_t now) {
    constexpr std::int64_t kEvery = 250000;  // microseconds
    if (request.empty() || (request == last_request_ && now - at_ < kEvery)) return;
    source.send(request);
    last_request_ = request;
    at_ = now;
  }

 private:
  std::string last_request_;
  std::int64_t at_ = 0;
};

// A live run. The caller's thread reads and decodes packets. Robot frames leave on that thread when
// a packet makes them possible, otherwise on a second thread, so that neither a slow packet nor the
// recognition of a body delays them.
class Server {
 public:
  Server(const RobotSetup& robot, const ServeOptions& options, const ServeControl& control)
      : robot_(robot), options_(options), control_(control) {}

  Result<ServeSummary> run();

 private:
  [[nodiscard]] FrameOutputContext output_context() const {
    const bool waits = !options_.replay.empty() || pace_ == LivePace::kInput;
    std::vector<std::string> held;
    if (robot_.loaded.choice.follow == Follow::kArms) {
      held = locked_joints(*robot_.loaded.robot, robot_.limits);
    }
    return {robot_.loaded.robot, options_.pipeline.live.fps,
            control_.tell,       waits,
            control_.is_stopped, std::move(held)};
  }
  Result<void> open_source();
  Result<void> open_outputs();
  Result<void> open_record();
  Result<void> make_pipeline();
  void leave(const RobotFrame& frame);
  Result<void> take(StreamEvent event, std::int64_t time, std::string_view bytes);
  Result<void> take_now(StreamEvent event, std::int64_t time, std::string_view bytes = {});
  Result<void> take_packet(std::string_view bytes, std::int64_t arrival);
  Result<void> advance();
  void emit(const std::stop_token& stop);
  Result<void> listen();
  void report_lack(std::int64_t now);
  Result<void> receive();
  Result<void> replay();
  [[nodiscard]] bool is_over(std::int64_t now, std::int64_t latest) const;

  const RobotSetup& robot_;
  const ServeOptions& options_;
  const ServeControl& control_;
  StreamAddress from_;
  LivePace pace_ = LivePace::kClock;
  std::optional<ByteSource> source_;  // Empty in a replay.
  Outputs outputs_;
  std::optional<StreamRecorder> recorder_;
  std::optional<StatsWriter> stats_;
  std::unique_ptr<LivePipeline> pipeline_;
  Stopwatch watch_;
  ServeSummary summary_;
  Latency latency_;  // Of all frames.
  // Guards the state shared by both threads: the pipeline except decoding, the outputs, the
  // recorder.
  std::mutex mutex_;
  std::condition_variable earlier_;     // The next robot frame may be due earlier.
  std::int64_t latest_ = 0;             // Time of the last event, microseconds.
  std::optional<Result<void>> failed_;  // Error of the second thread.
  bool lack_reported_ = false;
};

Result<void> Server::open_source() {
  if (!options_.replay.empty()) return {};
  RETARGET_TRY_ASSIGN(const StreamFormat* format, find_stream_format(from_.format));
  RETARGET_TRY_ASSIGN(
      source_,
      ByteSource::open(from_, *format, [this](std::string_view label, std::string_view text) {
        const std::lock_guard lock(mutex_);
        control_.tell(label, text);
      }));
  return {};
}

Result<void> Server::open_outputs() {
  std::vector<std::string> places = options_.outputs;
  if (places.empty()) places.emplace_back("stdout");
  std::vector<StreamAddress> all;
  for (const std::string& place : places) {
    RETARGET_TRY_ASSIGN(const StreamAddress to, parse_address(place));
    all.push_back(to);
  }
  return outputs_.open(all, output_context());
}

Result<void> Server::open_record() {
  if (options_.record.empty()) return {};
  std::error_code failed;
  fs::create_directories(options_.record, failed);
  RETARGET_TRY_ASSIGN(recorder_,
                      StreamRecorder::create(recorded_input_in(options_.record), output_context()));
  StreamAddress to;
  to.transport = Transport::kFile;
  to.file = recorded_file(options_.record, kRecordedOutput);
  return outputs_.open(std::span(&to, 1), output_context());
}

Result<void> Server::make_pipeline() {
  RETARGET_TRY_ASSIGN(const StreamFormat* format, find_stream_format(from_.format));
  LivePipelineOptions options = options_.pipeline;
  RETARGET_TRY_ASSIGN(pace_, chosen_pace(options_));
  options.pace = pace_;
  options.in_background = pace_ == LivePace::kClock;
  pipeline_ = std::make_unique<LivePipeline>(
      robot_, options, format->decoder(from_), [this](const RobotFrame& frame) { leave(frame); },
      control_.tell);
  if (options_.skeleton) RETARGET_TRY(pipeline_->know_skeleton(*options_.skeleton));
  return {};
}

void Server::leave(const RobotFrame& frame) {
  outputs_.take(frame);
  if (!options_.replay.empty() || std::isnan(frame.since)) return;
  const double latency = seconds_of(watch_.now()) - frame.since;
  latency_.add(latency);
  if (stats_) stats_->add(latency);
}

// Handles an event, in a run as well as in its replay.
Result<void> Server::take(StreamEvent event, std::int64_t time, std::string_view bytes) {
  const double now = seconds_of(time);
  switch (event) {
    case StreamEvent::kPacket:
      pipeline_->decode(bytes);
      RETARGET_TRY(pipeline_->use_decoded(now));
      break;
    case StreamEvent::kNewSender:
      // A connection loses no bytes, but earlier datagrams of the sender were dropped.
      pipeline_->restart_sender(now, from_.transport == Transport::kUdp);
      break;
    case StreamEvent::kEarly:
      RETARGET_TRY(pipeline_->take_early(bytes, now));
      break;
    case StreamEvent::kRecalibrate:
      pipeline_->recalibrate(now);
      break;
    case StreamEvent::kSkip: {
      const auto due = parse_number<std::int64_t>(bytes);
      if (!due) return input_failure({}, "the recording lacks the time of a robot frame");
      pipeline_->skip(seconds_of(*due), now);
      break;
    }
    case StreamEvent::kBody:
      pipeline_->take_body(now);
      break;
    case StreamEvent::kEnd:
      if (pace_ == LivePace::kClock) {
        pipeline_->tick(now);
      } else {
        pipeline_->finish(now);
      }
      break;
  }
  return {};
}

// @pre the caller holds mutex_
Result<void> Server::take_now(StreamEvent event, std::int64_t time, std::string_view bytes) {
  latest_ = std::max(latest_, time);
  if (recorder_) recorder_->add(event, latest_, bytes);
  return take(event, latest_, bytes);
}

// Decodes without the mutex so that robot frames can leave meanwhile.
Result<void> Server::take_packet(std::string_view bytes, std::int64_t arrival) {
  pipeline_->decode(bytes);
  const std::lock_guard lock(mutex_);
  RETARGET_TRY(advance());
  latest_ = std::max(latest_, arrival);
  if (recorder_) recorder_->add(StreamEvent::kPacket, latest_, bytes);
  const auto before = pipeline_->due();
  RETARGET_TRY(pipeline_->use_decoded(seconds_of(latest_)));
  const auto due = pipeline_->due();
  if (due && (!before || *due < *before)) earlier_.notify_one();
  return {};
}

// Emits the frames that are due. If the process was stopped or had no CPU time, drops the overdue
// frames and continues from now. @pre the caller holds mutex_
Result<void> Server::advance() {
  constexpr double kLate = 0.25;        // frames
  constexpr double kLeastLate = 0.001;  // seconds
  const auto due = pipeline_->due();
  if (!due) return {};
  const std::int64_t now = std::max(latest_, watch_.now());
  const auto due_us = static_cast<std::int64_t>(std::floor(1e6 * *due));
  const double late = seconds_of(now) - *due;
  if (late < 0.0) return {};
  if (late > std::max(kLeastLate, kLate / options_.pipeline.live.fps)) {
    RETARGET_TRY(take_now(StreamEvent::kSkip, now, std::to_string(due_us)));
  }
  pipeline_->tick(seconds_of(now));
  // A packet that arrives at the same time is ordered after these frames, in a replay as well.
  constexpr std::int64_t kBehind = 4;  // microseconds
  latest_ = now + kBehind;
  return {};
}

// Body of the thread that emits robot frames independently of packets.
void Server::emit(const std::stop_token& stop) {
  constexpr std::int64_t kLook = 20000;  // Microseconds; polling interval before the first frame.
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (auto given = advance(); !given) failed_ = std::move(given);
    const auto due = pipeline_->due();
    const std::int64_t now = watch_.now();
    const std::int64_t until = due ? static_cast<std::int64_t>(std::ceil(1e6 * *due)) : now + kLook;
    if (until > now) earlier_.wait_until(lock, watch_.at(std::min(until, now + kLook)));
  }
}

bool Server::is_over(std::int64_t now, std::int64_t latest) const {
  if (control_.is_stopped && control_.is_stopped()) return true;
  if (options_.seconds > 0.0 && seconds_of(now) >= options_.seconds) return true;
  return options_.silent_s > 0.0 && seconds_of(now - latest) >= options_.silent_s;
}

Result<void> Server::listen() {
  if (from_.transport != Transport::kStdin) {
    StreamAddress had = from_;
    had.port = source_->port();
    control_.tell("input", "listening at " + had.text());
  }
  if (pace_ != LivePace::kClock) return receive();
  std::jthread emitter([this](const std::stop_token& stop) { emit(stop); });
  Result<void> listened = receive();
  emitter.request_stop();
  earlier_.notify_one();
  emitter.join();
  return listened;
}

// Reports once that a server does not answer.
void Server::report_lack(std::int64_t now) {
  constexpr std::int64_t kPatience = 3000000;  // microseconds
  if (lack_reported_ || now < kPatience) return;
  const std::string lack = pipeline_->lack();
  lack_reported_ = true;
  if (lack.empty()) return;
  const std::lock_guard lock(mutex_);
  control_.tell("input", lack);
}

Result<void> Server::receive() {
  constexpr double kWait = 0.01;  // Seconds between checks whether the run is over.
  // After the end, input that had arrived before it is still read; a pipe may never be empty.
  const std::int64_t longest_rest = from_.transport == Transport::kStdin ? 0 : 500000;
  ByteSource& source = *source_;
  Asker asker;
  std::int64_t heard = watch_.now(), now = heard;
  std::optional<std::int64_t> ended;  // Microseconds.
  for (;;) {
    if (!ended && is_over(now, heard)) ended = now;
    if (ended && now - *ended >= longest_rest) break;
    if (source.can_send()) {
      asker.ask(source, pipeline_->request(), now);
      report_lack(now);
    }
    const ByteSource::Event event = source.wait(ended ? 0.0 : kWait);
    now = watch_.now();
    if (event == ByteSource::Event::kEnd || (ended && event == ByteSource::Event::kIdle)) break;
    if (event == ByteSource::Event::kPacket) {
      heard = now;
      RETARGET_TRY(take_packet(source.packet(), now));
    }
    const std::lock_guard lock(mutex_);
    if (failed_) return *std::exchange(failed_, std::nullopt);
    if (outputs_.are_closed()) break;
    if (control_.is_recalibrated && control_.is_recalibrated()) {
      RETARGET_TRY(take_now(StreamEvent::kRecalibrate, now));
    }
    if (event == ByteSource::Event::kNewSender) {
      RETARGET_TRY(take_now(StreamEvent::kNewSender, now));
    }
    if (event == ByteSource::Event::kEarlyPacket) {
      RETARGET_TRY(take_now(StreamEvent::kEarly, now, source.packet()));
    }
    if (pipeline_->body_is_ready()) RETARGET_TRY(take_now(StreamEvent::kBody, watch_.now()));
    if (stats_) {
      stats_->write_if_due(seconds_of(now), *pipeline_, source.statistics(), outputs_.statistics());
    }
  }
  const std::lock_guard lock(mutex_);
  return take_now(StreamEvent::kEnd, watch_.now());
}

Result<void> Server::replay() {
  RETARGET_TRY_ASSIGN(StreamReplay recorded,
                      StreamReplay::open(recorded_input_in(options_.replay)));
  StreamReplay::Entry entry;
  for (;;) {
    RETARGET_TRY_ASSIGN(const bool is_there, recorded.next(entry));
    if (!is_there || outputs_.are_closed() || (control_.is_stopped && control_.is_stopped())) break;
    RETARGET_TRY(take(entry.event, entry.microseconds, entry.bytes));
  }
  return {};
}

Result<ServeSummary> Server::run() {
  RETARGET_TRY(check_serve(options_));
  RETARGET_TRY(check_live_files(options_, robot_));
  RETARGET_TRY_ASSIGN(from_, parse_address(options_.input));
  RETARGET_TRY(make_pipeline());
  RETARGET_TRY(open_source());
  RETARGET_TRY(open_outputs());
  RETARGET_TRY(open_record());
  if (!options_.stats.empty()) {
    RETARGET_TRY_ASSIGN(stats_, StatsWriter::open(options_.stats));
  }
  const Result<void> ran = options_.replay.empty() ? listen() : replay();
  summary_.written = outputs_.finish();
  if (stats_) stats_->finish();
  if (recorder_) {
    if (auto kept = recorder_->finish(); !kept && summary_.written) summary_.written = kept;
  }
  if (!ran) return failure(ran.error());
  const bool is_pipe = from_.transport == Transport::kStdin;
  const auto used = pipeline_->check_used(is_pipe ? "stdin" : from_.text(),
                                          (*find_stream_format(from_.format))->name);
  // An address without a sender is not a fault; a pipe without packets is.
  const bool is_fed = is_pipe || pipeline_->packets().packets > 0;
  const bool is_interrupted = control_.is_stopped && control_.is_stopped();
  if (!used && is_fed && !is_interrupted) return failure(used.error());
  if (!used) summary_.unused = used.error();
  summary_.outputs = outputs_.statistics();
  summary_.live = pipeline_->statistics();
  summary_.latency = {latency_.percentile(50.0), latency_.percentile(99.0), latency_.max()};
  summary_.packets = pipeline_->packets();
  return summary_;
}

}  // namespace

Result<LivePace> chosen_pace(const ServeOptions& options) {
  if (options.pipeline.pace != LivePace::kAuto) return options.pipeline.pace;
  RETARGET_TRY_ASSIGN(const StreamAddress from, parse_address(options.input));
  if (from.transport != Transport::kStdin) return LivePace::kClock;
  for (const std::string& place : options.outputs) {
    RETARGET_TRY_ASSIGN(const StreamAddress to, parse_address(place));
    if (to.transport != Transport::kFile && to.transport != Transport::kStdout) {
      return LivePace::kClock;
    }
  }
  return LivePace::kInput;
}

Result<ServeSummary> serve(const RobotSetup& robot, const ServeOptions& options,
                           const ServeControl& control) {
  const ExactWaits exact;
  return Server(robot, options, control).run();
}

}  // namespace retarget
