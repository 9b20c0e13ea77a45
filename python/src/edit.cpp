// retarget.edit: clips in, clips out.

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <numbers>
#include <optional>

#include "base/try.h"
#include "bindings.h"
#include "edit_source.h"
#include "keywords.h"
#include "options/run_tables.h"
#include "raise.h"

namespace retarget::python {

using namespace nb::literals;

Result<EditSource> edit_source(const Clip& clip, const EditOptions& options,
                               const std::string& data_dir, EditNeeds needs) {
  HumanOptions how = options.human;
  how.unit_optional = !needs.unit;
  TRY_ASSIGN(const std::string data_folder, data_folder_of(data_dir));
  Clip copy = clip;
  TRY_ASSIGN(HumanInClip human, find_human(copy, how, data_folder));
  EditSource source{std::move(copy), std::move(human)};
  const PartOptions& part = options.part;
  TRY_ASSIGN(source.clip, trim(std::move(source.clip), part));
  const bool is_part = part.start_s >= 0.0 || !part.frames.empty();
  if (needs.no_lead_in && !is_part) source.clip = cut_lead_in(std::move(source.clip)).clip;
  return source;
}

namespace {

// an error of the motion itself, at its clip
Error placed(Error error, const std::string& name) {
  const bool of_motion = error.kind == ErrorKind::kInput || error.kind == ErrorKind::kRun;
  if (of_motion && error.location.file.empty()) error.location.file = name;
  return error;
}

Result<Clip> plain(Result<Clip> clip) {
  return clip;
}

// a seam that is not good is an error unless it is forced
template <typename SomeEdited>
Result<Edited> plain(Result<SomeEdited> edited) {
  if (!edited) return failure(edited.error());
  return Edited(std::move(*edited));
}

struct Call {
  EditOptions options;
  std::string data_dir;
  EditNeeds needs;
  bool force = false;
};

Call call_of(const nb::dict& keywords, const std::string& data_dir, EditNeeds needs,
             bool force = false) {
  Call call{{}, data_dir, needs, force};
  OptionTable table = human_table(call.options.human);
  append(table, only(part_table(call.options.part), {"start", "end", "frames"}));
  apply_keywords(table, keywords);
  return call;
}

ClipHandle given(Clip&& clip, const std::string&, bool) {
  return ClipHandle(std::move(clip));
}
ClipHandle given(Edited&& edited, const std::string& name, bool force) {
  if (edited.misfit && !force) raise(placed(*edited.misfit, name));
  warn(edited.doubts, name);
  return ClipHandle(std::move(edited.clip));
}

// makes the source ready and edits it without the GIL, then hands over what came of it
template <typename Function>
ClipHandle edited(const ClipHandle& clip, const Call& call, const Function& function) {
  std::vector<Warning> doubts;
  auto result = [&] {
    const nb::gil_scoped_release released;
    using Made = decltype(plain(function(std::declval<EditSource&>())));
    auto source = edit_source(*clip, call.options, call.data_dir, call.needs);
    if (!source) return Made(failure(source.error()));
    doubts = source->human.doubts();
    return Made(plain(function(*source)));
  }();
  if (!result) raise(placed(result.error(), clip->name()));
  warn(doubts, clip->name());
  return given(*std::move(result), clip->name(), call.force);
}

ClipHandle trim_clip(const ClipHandle& clip, const nb::dict& keywords) {
  PartOptions part;
  apply_keywords(only(part_table(part), {"start", "end", "frames"}), keywords);
  return ClipHandle(without_gil([&] { return trim(*clip, part); }));
}

ClipHandle resample(const ClipHandle& clip, std::optional<double> fps, std::optional<double> speed,
                    bool linear, bool antialias) {
  TimingOptions timing;
  if (fps) {
    TimeOptions time;
    nb::dict keywords;
    keywords["fps"] = *fps;
    apply_keywords(only(time_table(time), {"fps"}), keywords);
    timing.rate = frame_rate_from_fps(*time.fps);
  }
  timing.speed = speed;
  timing.linear = linear;
  timing.antialias = antialias;
  return ClipHandle(without_gil([&] { return change_timing(*clip, timing); }));
}

ClipHandle rest(const ClipHandle& clip, const ClipHandle& like) {
  auto made = without_gil(
      [&] { return change_rest(*clip, like->shared_skeleton(), clip->name(), like->name()); });
  return given(std::move(made), clip->name(), false);
}

ClipHandle transferred(const ClipHandle& clip, const ClipHandle& like, const nb::dict& keywords,
                       const std::string& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {}),
                [&](EditSource& source) -> Result<Transferred> {
                  TRY_ASSIGN(const auto target, edit_source(*like, {}, data_dir, {}));
                  return transfer(source.subject(), target.subject());
                });
}

ClipHandle lafan1(const ClipHandle& clip, const nb::dict& keywords, const std::string& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {}),
                [](EditSource& source) { return lafan1_clip(source.clip, source.calibration()); });
}

ClipHandle mirrored_clip(const ClipHandle& clip, const nb::dict& keywords,
                         const std::string& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {}),
                [](EditSource& source) { return mirror(source.clip, source.calibration()); });
}

ClipHandle turned(const ClipHandle& clip, double degrees, const nb::dict& keywords,
                  const std::string& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {}), [&](EditSource& source) {
    return turn_clip(std::move(source.clip), source.calibration(),
                     degrees / 180.0 * std::numbers::pi);
  });
}

ClipHandle moved(const ClipHandle& clip, double x, double y, const nb::dict& keywords,
                 const std::string& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {.unit = true}), [&](EditSource& source) {
    return move_clip(std::move(source.clip), source.calibration(), {x, y});
  });
}

ClipHandle grounded(const ClipHandle& clip, std::optional<double> floor, const nb::dict& keywords,
                    const std::string& data_dir) {
  const EditNeeds needs{.unit = floor.has_value(), .no_lead_in = true};
  return edited(clip, call_of(keywords, data_dir, needs), [&](EditSource& source) -> Result<Clip> {
    double height = floor.value_or(0.0);
    if (!floor) {
      TRY_ASSIGN(height, floor_height(source.clip, source.calibration()));
    }
    return put_on_floor(std::move(source.clip), source.calibration(), height);
  });
}

ClipHandle looped(const ClipHandle& clip, double shortest, int times, bool in_place,
                  double threshold, bool force, const nb::dict& keywords,
                  const std::string& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {.no_lead_in = true}, force),
                [&](EditSource& source) {
                  LoopOptions how;
                  how.shortest = shortest;
                  how.times = times;
                  how.in_place = in_place;
                  how.seam.threshold = threshold;
                  return make_loop(source.clip, source.calibration(), how);
                });
}

ClipHandle joined(const std::vector<ClipHandle>& clips, const std::string& search, double window,
                  const std::string& blend, double threshold, bool force, const nb::dict& keywords,
                  const std::string& data_dir) {
  ConcatenateOptions how;
  how.threshold = threshold;
  how.seam.window = window;
  how.blend = blend == "inertial" ? SeamBlend::kInertial : SeamBlend::kCrossfade;
  value_of(how.search(search));
  if (clips.size() < 2) {
    raise(usage_failure("clips: expected two or more").value());
  }
  const Call call = call_of(keywords, data_dir, {.no_lead_in = true}, force);
  Call next_call = call;
  // a bone map is of the first clip's joints
  next_call.options.human.map.clear();
  return edited(clips.front(), call, [&](EditSource& first) -> Result<Edited> {
    Edited all{std::move(first.clip)};
    for (std::size_t i = 1; i < clips.size(); ++i) {
      TRY_ASSIGN(const auto next, edit_source(*clips[i], next_call.options, data_dir, call.needs));
      const Subject before{all.clip, first.human.map, first.calibration()};
      TRY_ASSIGN(const Edited like, like_first(next.subject(), before));
      const std::string name = i == 1 ? clips.front()->name() : "what goes before";
      TRY_ASSIGN(Edited both, concatenate(all.clip, like.clip, first.calibration(), how, name,
                                          clips[i]->name()));
      if (both.misfit && !force) return failure(placed(*both.misfit, clips[i]->name()));
      all.clip = std::move(both.clip);
      all.doubts.insert(all.doubts.end(), both.doubts.begin(), both.doubts.end());
    }
    return all;
  });
}

ClipHandle along_path(const ClipHandle& clip, const nb::object& to, double radius, double scale,
                      double degrees, const std::string& keep, double tolerance, bool force,
                      const nb::dict& keywords, const std::string& data_dir) {
  PathChange change{{}, radius, scale, degrees};
  if (!to.is_none()) change.to = bytes_of_path(to, "to");
  value_of(change.check());
  FollowPathOptions how;
  how.fit.tolerance = tolerance;
  how.keep = keep == "speed"    ? PathKeep::kSpeed
             : keep == "stride" ? PathKeep::kStride
                                : PathKeep::kTime;
  return edited(clip, call_of(keywords, data_dir, {.unit = true, .no_lead_in = true}, force),
                [&](EditSource& source) -> Result<FollowedPath> {
                  const Calibration& calibration = source.calibration();
                  TRY_ASSIGN(const auto own, fit_path(source.clip, calibration, how.fit));
                  TRY_ASSIGN(const auto path, change_path(own.path, change));
                  return follow_path(source.clip, calibration, path, how);
                });
}

}  // namespace

void bind_edit(nb::module_& module) {
  module.def("edit_trim", &trim_clip, "clip"_a, "options"_a);
  module.def("edit_resample", &resample, "clip"_a, "fps"_a.none(), "speed"_a.none(), "linear"_a,
             "antialias"_a);
  module.def("edit_rest", &rest, "clip"_a, "like"_a);
  module.def("edit_transfer", &transferred, "clip"_a, "like"_a, "options"_a, "data_dir"_a);
  module.def("edit_lafan1", &lafan1, "clip"_a, "options"_a, "data_dir"_a);
  module.def("edit_mirror", &mirrored_clip, "clip"_a, "options"_a, "data_dir"_a);
  module.def("edit_turn", &turned, "clip"_a, "degrees"_a, "options"_a, "data_dir"_a);
  module.def("edit_move", &moved, "clip"_a, "x"_a, "y"_a, "options"_a, "data_dir"_a);
  module.def("edit_ground", &grounded, "clip"_a, "floor"_a.none(), "options"_a, "data_dir"_a);
  module.def("edit_loop", &looped, "clip"_a, "shortest"_a, "times"_a, "in_place"_a, "threshold"_a,
             "force"_a, "options"_a, "data_dir"_a);
  module.def("edit_concatenate", &joined, "clips"_a, "search"_a, "window"_a, "blend"_a,
             "threshold"_a, "force"_a, "options"_a, "data_dir"_a);
  module.def("edit_follow_path", &along_path, "clip"_a, "to"_a.none(), "radius"_a, "scale"_a,
             "degrees"_a, "keep"_a, "tolerance"_a, "force"_a, "options"_a, "data_dir"_a);
}

}  // namespace retarget::python
