// serve and play: streams over the network, pipes and files.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <atomic>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "live_keywords.h"
#include "raise.h"
#include "retarget/live_table.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/serve_table.h"
#include "tables.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable serve_keywords(ServeRequest& request) {
  // The robot is a separate parameter, and so is the rate, which is a text in other functions.
  return without(serve_table(request), {"robot", "fps"});
}

namespace {

nb::dict summary_of(const ServeSummary& summary) {
  nb::dict all = described(summary.live);
  all["packets"] = summary.packets.packets;
  all["malformed"] = summary.packets.malformed;
  all["skeletons"] = summary.packets.skeletons;
  all["refused_skeletons"] = summary.packets.refused_skeletons;
  all["latency_p50_s"] = summary.latency.p50_s;
  all["latency_p99_s"] = summary.latency.p99_s;
  all["latency_max_s"] = summary.latency.max_s;
  nb::list outputs;
  for (const OutputStatistics& each : summary.outputs) {
    nb::dict output;
    output["name"] = path_of(each.name);
    output["sent"] = each.sent;
    output["dropped"] = each.dropped;
    output["reconnects"] = each.reconnects;
    output["last_error"] = text_of(each.last_error);
    outputs.append(output);
  }
  all["outputs"] = outputs;
  return all;
}

std::string message_of(std::string_view label, std::string_view text) {
  return std::string(label) + (label.empty() ? "" : ": ") + spell_options(text);
}

// Collects the messages about loading a robot.
class LoadingObserver : public Observer {
 public:
  void line(std::string_view label, std::string_view text) override {
    messages.push_back(message_of(label, text));
  }
  void warn(const std::vector<Warning>& warnings, std::string_view file) override {
    for (const Warning& each : warnings) messages.push_back(describe(each, file));
  }

  std::vector<std::string> messages;
};

// A live run. run() is called once, on its own thread; the other functions may be called from any
// thread.
class PythonServer {
 public:
  PythonServer(RobotSetup robot, ServeRequest request, std::vector<std::string> messages)
      : robot_(std::move(robot)), request_(std::move(request)), messages_(std::move(messages)) {}

  // Runs until it is stopped or over. Returns its summary.
  nb::dict run() {
    ServeControl control;
    control.is_stopped = [this] { return stopped_.load(); };
    control.is_recalibrated = [this] { return recalibrated_.exchange(false); };
    control.tell = [this](std::string_view label, std::string_view text) { tell(label, text); };
    const ServeSummary summary =
        without_gil([&] { return serve_request(robot_, request_, control); });
    for (const auto& [label, text] : serve_summary_lines(summary)) tell(label, text);
    if (!summary.written) raise(summary.written.error());
    return summary_of(summary);
  }

  void stop() { stopped_ = true; }
  void recalibrate() { recalibrated_ = true; }
  nb::list messages() {
    const std::lock_guard lock(mutex_);
    return texts_of(messages_);
  }

 private:
  void tell(std::string_view label, std::string_view text) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(message_of(label, text));
  }

  RobotSetup robot_;
  ServeRequest request_;
  std::atomic<bool> stopped_ = false, recalibrated_ = false;
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

void open_server(PythonServer* self, const nb::object& robot, const nb::object& fps,
                 const nb::dict& options, const nb::object& data_dir) {
  ServeRequest request;
  nb::dict rate;
  rate["fps"] = fps;
  apply_keywords(live_table(request.serve.pipeline.live), rate);
  apply_keywords(serve_keywords(request), options);
  if (!robot.is_none()) request.robot.name = bytes_of_path(robot, "robot");
  value_of(prepare_serve(request));
  const DataFolder folder{value_of(data_folder_of(bytes_of_folder(data_dir)))};
  LoadingObserver told;
  LoadedRobot loaded = without_gil([&] { return load_robot(request.robot, folder, told); });
  RobotSetup setup =
      without_gil([&] { return set_up_robot(std::move(loaded), request.serve.pipeline.run); });
  told.lines(setup.follow_lines());
  told.warn(setup.doubts, setup.loaded.robot->name());
  new (self) PythonServer(std::move(setup), std::move(request), std::move(told.messages));
}

// Returns the number of frames that were sent.
int play_clip(const ClipHandle& clip, const nb::object& to, double speed, bool header,
              const nb::dict& human, const nb::object& data_dir) {
  PlayOptions options;
  nb::dict own;
  own["to"] = to;
  own["speed"] = speed;
  apply_keywords(player_table(options), own);
  options.header = header;
  apply_keywords(rows_for(OptionUse::kLive, human_table(options.human)), human);
  options.data_folder = value_of(data_folder_of(bytes_of_folder(data_dir)));
  Watcher watcher(nb::none());
  Result<int> sent = [&] {
    const ReleasedGil released;
    return play(*clip, options, [&] { return !watcher.keep_going({}) || watcher.is_stopped(); });
  }();
  watcher.rethrow();
  return value_of(std::move(sent));
}

}  // namespace

void bind_serve(nb::module_& module) {
  nb::class_<PythonServer>(module, "Server", "The engine of retarget.serve(); use that function.")
      .def("__init__", &open_server, "robot"_a.none(), "fps"_a.none(), "options"_a,
           "data_dir"_a.none())
      .def("run", &PythonServer::run)
      .def("stop", &PythonServer::stop)
      .def("recalibrate", &PythonServer::recalibrate)
      .def("messages", &PythonServer::messages);
  module.def("play", &play_clip, "clip"_a, "to"_a, "speed"_a, "header"_a, "human"_a,
             "data_dir"_a.none());
}

}  // namespace retarget::python
