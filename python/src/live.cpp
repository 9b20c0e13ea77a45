// live: one stream of human frames in, robot frames out. The caller passes the time.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <mutex>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "live_keywords.h"
#include "raise.h"
#include "retarget/live.h"
#include "retarget/live_table.h"
#include "retarget/plan.h"
#include "tables.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable live_keywords(LiveKeywords& options) {
  // A rate is a number here, and a text or a number in other functions, so it is a separate
  // argument.
  OptionTable table = without(live_table(options.live), {"fps"});
  for (Option& row : recorded_serve_table(options.serve)) {
    if (row.name == "plain") table.push_back(std::move(row));
  }
  append(table, rows_for(OptionUse::kLive, solve_table(options.run.solve)));
  append(table, rows_for(OptionUse::kLive, human_table(options.run.human)));
  return table;
}

nb::dict described(const LiveStatistics& now) {
  nb::dict all;
  all["received"] = now.received;
  all["bad"] = now.bad;
  all["doubled"] = now.doubled;
  all["late"] = now.late;
  all["skipped"] = now.skipped;
  all["lost"] = now.lost;
  all["interruptions"] = now.interruptions;
  all["robot_frames"] = now.robot_frames;
  all["held"] = now.held;
  all["limited"] = now.limited;
  all["missed"] = now.missed;
  all["delay_s"] = now.delay_s;
  all["jitter_s"] = now.jitter_s;
  return all;
}

namespace {

const char* state_name(LiveState state) {
  switch (state) {
    case LiveState::kWaiting:
      return "waiting";
    case LiveState::kFollowing:
      return "following";
    case LiveState::kHolding:
      return "holding";
    case LiveState::kStanding:
      break;
  }
  return "standing";
}

// A session with the conversion of its skeleton's frames. Calls are serialised.
class PythonLive {
 public:
  PythonLive(LiveSession session, LivePoser poser, RobotHandle robot,
             std::shared_ptr<const Skeleton> skeleton)
      : session_(std::move(session)),
        poser_(std::move(poser)),
        robot_(std::move(robot)),
        skeleton_(std::move(skeleton)) {}

  void push(const nb::object& rotations, const nb::object& positions, double time, double now) {
    const auto joints = static_cast<std::int64_t>(skeleton_->joint_count());
    const GivenArray turns(rotations, "rotations_wxyz", {joints, 4});
    const GivenArray places(positions, "positions", {joints, 3});
    std::vector<Eigen::Quaterniond> local;
    std::vector<Eigen::Vector3d> moved;
    for (int joint = 0; joint < skeleton_->joint_count(); ++joint) {
      const double* wxyz = &turns.numbers()[4 * static_cast<std::size_t>(joint)];
      Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
      const double norm = rotation.norm();
      if (std::abs(norm - 1.0) > 1e-3) {
        raise(usage_failure(fmt::format("rotations_wxyz[{}]: expected a unit quaternion, found the "
                                        "norm {}",
                                        joint, norm))
                  .value());
      }
      rotation.normalize();
      local.push_back(rotation);
      if (skeleton_->translation_slot(joint) < 0) continue;
      moved.emplace_back(Eigen::Map<const Eigen::Vector3d>(
          &places.numbers()[3 * static_cast<std::size_t>(joint)]));
    }
    const ReleasedGil released;
    const std::lock_guard lock(mutex_);
    HumanFrame frame;
    frame.time = time;
    poser_.pose(local, moved, frame.world_from_bone);
    session_.push(frame, now);
  }

  // Returns all robot frames that are due: (index, time, state, qpos, due). Frames that have been due
  // for longer than `longest` seconds are dropped, because they would be a burst.
  nb::list pull(double now, double longest) {
    struct Due {
      RobotFrame frame;
      std::vector<double> qpos;
    };
    std::vector<Due> all;
    {
      const ReleasedGil released;
      const std::lock_guard lock(mutex_);
      const auto due = session_.due();
      if (due && now - *due > longest) session_.skip_to(now);
      while (const auto frame = session_.pull(now)) {
        all.push_back({*frame, {frame->qpos.begin(), frame->qpos.end()}});
      }
    }
    nb::list frames;
    for (Due& each : all) {
      const std::size_t size = each.qpos.size();
      frames.append(nb::make_tuple(each.frame.index, each.frame.time, state_name(each.frame.state),
                                   array_of(std::move(each.qpos), {size}), each.frame.due));
    }
    return frames;
  }

  void finish() {
    const std::lock_guard lock(mutex_);
    session_.finish();
  }
  nb::object due() {
    const std::lock_guard lock(mutex_);
    const auto time = session_.due();
    return time ? nb::object(nb::float_(*time)) : nb::none();
  }
  const char* state() {
    const std::lock_guard lock(mutex_);
    return state_name(session_.state());
  }
  nb::dict statistics() {
    const std::lock_guard lock(mutex_);
    return described(session_.statistics());
  }
  [[nodiscard]] const RobotHandle& robot() const { return robot_; }

 private:
  std::mutex mutex_;
  LiveSession session_;
  LivePoser poser_;
  RobotHandle robot_;
  std::shared_ptr<const Skeleton> skeleton_;
};

void open_live(PythonLive* self, const ClipHandle& clip, const RobotHandle& robot,
               const nb::object& fps, const nb::dict& options) {
  LiveKeywords given;
  nb::dict rate;
  rate["fps"] = fps;
  apply_keywords(live_table(given.live), rate);
  std::vector<std::string> names;
  apply_keywords(noting_given(live_keywords(given), names), options);
  value_of(check_live_use(given.live, given.run, names));
  if (given.serve.plain) make_plain(given.live);
  // The clip calibrates the body; all of its frames may do so.
  given.run.part.lead_in = LeadIn::kKeep;
  const Plan plan = without_gil([&] { return make_plan(*clip, robot.loaded, given.run); });
  LiveSession session = without_gil([&] { return LiveSession::make(plan, given.live); });
  warn(plan.doubts(), clip->name());
  new (self) PythonLive(std::move(session), LivePoser(plan), robot, clip->shared_skeleton());
}

}  // namespace

void bind_live(nb::module_& module) {
  module.attr("MAX_LIVE_TIME") = kMaxLiveTime;
  nb::class_<PythonLive>(module, "LiveSession", "The engine of retarget.live(); use that function.")
      .def("__init__", &open_live, "clip"_a, "robot"_a, "fps"_a, "options"_a)
      .def("push", &PythonLive::push, "rotations_wxyz"_a.none(), "positions"_a.none(), "time"_a,
           "now"_a)
      .def("pull", &PythonLive::pull, "now"_a, "longest"_a)
      .def("finish", &PythonLive::finish)
      .def("due", &PythonLive::due, nb::sig("def due(self) -> float | None"))
      .def("state", &PythonLive::state)
      .def("statistics", &PythonLive::statistics)
      .def("robot", [](const PythonLive& live) { return live.robot(); });
}

}  // namespace retarget::python
