// batch: converts folders of clips to folders of motions, in separate processes.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <utility>

#include "batch_keywords.h"
#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "raise.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/measure.h"
#include "retarget/option_table.h"
#include "solving_table.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable batch_keywords(BatchRequest& request) {
  OptionTable table = batch_table(request, request.run);
  // The rows of a batch replace those of a run.
  append(table, without_rows_of(table, source_table(request.run.options.source)));
  append(table, without_rows_of(table, solving_table(request.run.options)));
  append(table, without_rows_of(table, robot_table(request.run.robot)));
  table.push_back(dynamics_row(request.of_clip.dynamics));
  // Parameters of their own in Python.
  return without(std::move(table), {"robot", "output"});
}

namespace {

// Set by signals in a worker process.
volatile std::sig_atomic_t worker_is_stopped = 0;

void begin_worker() {
  // Python's handlers must not run in a worker. The terminal sends Ctrl-C to the parent, which
  // forwards it.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, [](int) { worker_is_stopped = 1; });
}

// Forwards the messages of a batch to Python.
class BatchObserver : public Observer {
 public:
  BatchObserver(Watcher& watcher, nb::object notes) : watcher_(watcher), notes_(std::move(notes)) {}

  void line(std::string_view label, std::string_view text) override {
    tell(std::string(label) + (label.empty() ? "" : ": ") + spell_options(text));
  }
  void warn(const std::vector<Warning>& warnings, std::string_view file) override {
    for (const Warning& each : warnings) tell(describe(each, file));
  }
  void fault(const Error& error) override { tell(describe(error)); }
  [[nodiscard]] bool is_stopped() const override {
    // A worker process must not call into Python.
    if (getpid() != process_) return worker_is_stopped != 0;
    return !watcher_.keep_going({}) || watcher_.is_stopped();
  }

 private:
  void tell(const std::string& text) const {
    if (getpid() != process_) return;
    const nb::gil_scoped_acquire acquired;
    notes_.attr("append")(text_of(text));
  }

  Watcher& watcher_;
  nb::object notes_;
  const pid_t process_ = getpid();
};

std::vector<std::string> paths_of(const nb::object& given, const char* what) {
  const bool is_one = nb::isinstance<nb::str>(given) || nb::isinstance<nb::bytes>(given) ||
                      nb::hasattr(given, "__fspath__");
  if (is_one) return {bytes_of_path(given, what)};
  std::vector<std::string> paths;
  for (nb::handle each : given) paths.push_back(bytes_of_path(each, what));
  return paths;
}

// Returns the number of failed clips and the summary lines.
nb::tuple batch(const nb::object& inputs, const nb::object& output, const nb::object& robots,
                const nb::dict& keywords, bool quality, bool sidecar, const nb::object& data_dir) {
  BatchRequest request;
  apply_keywords(batch_keywords(request), keywords);
  request.inputs = paths_of(inputs, "inputs");
  request.output = bytes_of_path(output, "output");
  if (!robots.is_none()) request.robots = paths_of(robots, "robots");
  request.quality = quality;
  request.of_clip.sidecar = sidecar;
  request.begin_worker = begin_worker;
  request.data_folder = value_of(data_folder_of(bytes_of_folder(data_dir)));
  nb::list notes;
  Watcher watcher(nb::none());
  BatchObserver observer(watcher, notes);
  auto failed = [&] {
    const nb::gil_scoped_release released;
    return run_batch(request, observer);
  }();
  watcher.rethrow();
  return nb::make_tuple(value_of(std::move(failed)), notes);
}

}  // namespace

void bind_batch(nb::module_& module) {
  module.def("batch", &batch, "inputs"_a.none(), "output"_a.none(), "robots"_a.none(), "options"_a,
             "quality"_a, "sidecar"_a, "data_dir"_a.none());
}

}  // namespace retarget::python
