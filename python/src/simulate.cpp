// simulate: replays a motion in a physics simulation.

#include "retarget/simulate.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <utility>

#include "bindings.h"
#include "handles.h"
#include "notes_observer.h"
#include "raise.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

// Returns the simulated motion and the report as JSON.
nb::tuple simulate(const MotionHandle& motion) {
  nb::list notes;
  Watcher watcher(nb::none());
  const NotesObserver observer(watcher, notes);
  Result<Simulation> done = [&] {
    const ReleasedGil released;
    SimulateOptions options;
    options.is_stopped = [&observer] { return observer.is_stopped(); };
    return retarget::simulate(*motion.clip, options);
  }();
  watcher.rethrow();
  Simulation simulation = value_of(std::move(done));
  MotionHandle simulated{
      nullptr,      std::make_shared<const RobotClip>(std::move(simulation.motion)),
      motion.robot, nullptr,
      motion.name,  "simulated"};
  simulated.save = motion.save;
  return nb::make_tuple(std::move(simulated), simulation_json(simulation.report));
}

}  // namespace

void bind_simulate(nb::module_& module) {
  module.def("simulate", &simulate, "motion"_a);
}

}  // namespace retarget::python
