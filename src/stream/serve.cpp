#include "stream/serve.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/try.h"
#include "stream/byte_source.h"
#include "stream/frame_output.h"
#include "stream/stream_record.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordedInput = "input.stream";
constexpr const char* kRecordedOutput = "output.jsonl";

// microseconds since it was made, by a clock that never goes back
class Stopwatch {
 public:
  [[nodiscard]] std::int64_t now() const {
    const auto passed = std::chrono::steady_clock::now() - begin_;
    return std::chrono::duration_cast<std::chrono::microseconds>(passed).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

double seconds_of(std::int64_t microseconds) {
  return 1e-6 * static_cast<double>(microseconds);
}

// the places that robot frames go to
class Outputs {
 public:
  Result<void> add(const StreamAddress& to, const FrameOutputContext& context) {
    TRY_ASSIGN(auto output, open_frame_output(to, context));
    all_.push_back(std::move(output));
    return {};
  }
  void take(const RobotFrame& frame) {
    ++frames_;
    for (const auto& output : all_) {
      if (auto taken = output->take(frame); !taken && failed_) failed_ = std::move(taken);
    }
  }
  [[nodiscard]] std::int64_t frames() const { return frames_; }
  // the first failure, if there was one
  Result<void> check() { return std::exchange(failed_, {}); }

 private:
  std::vector<std::unique_ptr<FrameOutput>> all_;
  std::int64_t frames_ = 0;
  Result<void> failed_;
};

// Asks a stream's sender, at once what is new, and the same again until something else is to be asked.
class Asker {
 public:
  void ask(ByteSource& source, std::string_view request, std::int64_t now) {
    constexpr std::int64_t kEvery = 250000;  // microseconds
    if (request.empty() || (request == asked_ && now - at_ < kEvery)) return;
    source.send(request);
    asked_ = request;
    at_ = now;
  }

 private:
  std::string asked_;
  std::int64_t at_ = 0;
};

class Server {
 public:
  Server(const RobotSetup& robot, const ServeOptions& options, const ServeControl& control)
      : robot_(robot), options_(options), control_(control) {}

  Result<ServeSummary> run();

 private:
  [[nodiscard]] FrameOutputContext output_context() const {
    return {robot_.loaded.robot, options_.pipeline.live.fps, control_.tell};
  }
  Result<void> open_outputs();
  Result<void> open_record();
  Result<void> make_pipeline();
  Result<void> take(StreamEvent event, std::int64_t time, std::string_view bytes);
  Result<void> listen();
  Result<void> replay();
  [[nodiscard]] bool is_over(std::int64_t now, std::int64_t latest) const;

  const RobotSetup& robot_;
  const ServeOptions& options_;
  const ServeControl& control_;
  StreamAddress from_;
  Outputs outputs_;
  std::optional<StreamRecorder> recorder_;
  std::unique_ptr<LivePipeline> pipeline_;
  Stopwatch watch_;
  ServeSummary summary_;
};

Result<void> Server::open_outputs() {
  std::vector<std::string> places = options_.outputs;
  if (places.empty()) places.emplace_back("stdout");
  for (const std::string& place : places) {
    TRY_ASSIGN(const StreamAddress to, parse_address(place));
    TRY(outputs_.add(to, output_context()));
  }
  return {};
}

Result<void> Server::open_record() {
  if (options_.record.empty()) return {};
  std::error_code failed;
  fs::create_directories(options_.record, failed);
  const fs::path folder(options_.record);
  if (fs::exists(folder / kRecordedInput, failed)) {
    return usage_failure(options_.record + " holds a recording already", "name another folder");
  }
  TRY_ASSIGN(recorder_, StreamRecorder::create((folder / kRecordedInput).string()));
  StreamAddress to;
  to.transport = Transport::kFile;
  to.file = (folder / kRecordedOutput).string();
  return outputs_.add(to, output_context());
}

Result<void> Server::make_pipeline() {
  TRY_ASSIGN(const StreamFormat* format, find_stream_format(from_.format));
  pipeline_ = std::make_unique<LivePipeline>(
      robot_, options_.pipeline, format->decoder(from_),
      [this](const RobotFrame& frame) { outputs_.take(frame); }, control_.tell);
  if (options_.skeleton) TRY(pipeline_->know_skeleton(*options_.skeleton));
  return {};
}

Result<void> Server::take(StreamEvent event, std::int64_t time, std::string_view bytes) {
  if (recorder_) recorder_->add(event, time, bytes);
  const double now = seconds_of(time);
  switch (event) {
    case StreamEvent::kPacket:
      TRY(pipeline_->packet(bytes, now));
      break;
    case StreamEvent::kNewSender:
      pipeline_->restart_sender(now);
      break;
    case StreamEvent::kRecalibrate:
      pipeline_->recalibrate(now);
      break;
    case StreamEvent::kEnd:
      pipeline_->finish(now);
      break;
  }
  return outputs_.check();
}

bool Server::is_over(std::int64_t now, std::int64_t latest) const {
  if (control_.is_stopped && control_.is_stopped()) return true;
  if (options_.seconds > 0.0 && seconds_of(now) >= options_.seconds) return true;
  return options_.silent_s > 0.0 && seconds_of(now - latest) >= options_.silent_s;
}

Result<void> Server::listen() {
  constexpr double kWait = 0.002;  // seconds: how late a held frame may be
  TRY_ASSIGN(const StreamFormat* format, find_stream_format(from_.format));
  TRY_ASSIGN(ByteSource source, ByteSource::open(from_, format->is_text, format->request_port));
  Asker asker;
  if (from_.transport != Transport::kStdin) {
    StreamAddress had = from_;
    had.port = source.port();
    control_.tell("input", "listening at " + had.text());
  }
  std::int64_t latest = watch_.now(), now = latest;
  while (!is_over(now, latest)) {
    if (source.can_send()) asker.ask(source, pipeline_->request(), now);
    const ByteSource::Event event = source.wait(kWait);
    now = watch_.now();
    if (control_.is_recalibrated && control_.is_recalibrated()) {
      TRY(take(StreamEvent::kRecalibrate, now, {}));
    }
    if (event == ByteSource::Event::kEnd) break;
    if (event == ByteSource::Event::kNewSender) TRY(take(StreamEvent::kNewSender, now, {}));
    if (event == ByteSource::Event::kPacket) {
      latest = now;
      const std::int64_t before = outputs_.frames();
      TRY(take(StreamEvent::kPacket, now, source.packet()));
      if (outputs_.frames() > before) summary_.latency.add(seconds_of(watch_.now() - now));
    } else {
      pipeline_->tick(seconds_of(now));
      TRY(outputs_.check());
    }
  }
  return take(StreamEvent::kEnd, std::max(now, watch_.now()), {});
}

Result<void> Server::replay() {
  TRY_ASSIGN(StreamReplay recorded,
             StreamReplay::open((fs::path(options_.replay) / kRecordedInput).string()));
  StreamReplay::Entry entry;
  for (;;) {
    TRY_ASSIGN(const bool is_there, recorded.next(entry));
    if (!is_there || (control_.is_stopped && control_.is_stopped())) break;
    TRY(take(entry.event, entry.microseconds, entry.bytes));
  }
  return {};
}

Result<ServeSummary> Server::run() {
  TRY_ASSIGN(from_, parse_address(options_.input));
  TRY(make_pipeline());
  TRY(open_outputs());
  TRY(open_record());
  const Result<void> ran = options_.replay.empty() ? listen() : replay();
  if (recorder_) TRY(recorder_->finish());
  if (!ran) return failure(ran.error());
  summary_.live = pipeline_->statistics();
  summary_.packets = pipeline_->packets();
  return summary_;
}

}  // namespace

Result<ServeSummary> serve(const RobotSetup& robot, const ServeOptions& options,
                           const ServeControl& control) {
  return Server(robot, options, control).run();
}

}  // namespace retarget
