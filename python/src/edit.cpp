// retarget.edit: edits clips.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "bindings.h"
#include "edit_source.h"
#include "keywords.h"
#include "raise.h"
#include "retarget/clip_range.h"
#include "retarget/edit_tables.h"
#include "retarget/option_table.h"
#include "retarget/try.h"
#include "tables.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable edit_table(EditOptions& options) {
  OptionTable table = rows_for(OptionUse::kEdit, human_table(options.human));
  append(table, rows_for(OptionUse::kEdit, part_table(options.part)));
  return table;
}

Result<EditSource> edit_source(const Clip& clip, const EditOptions& options,
                               const std::string& data_dir, EditNeeds needs) {
  HumanOptions how = options.human;
  how.unit_optional = !needs.unit;
  RETARGET_TRY_ASSIGN(const std::string data_folder, data_folder_of(data_dir));
  Clip copy = clip;
  auto human = find_human(copy, how, data_folder);
  // Without offsets, the rest pose of a clip without frames is unknown.
  if (!human && clip.frame_count() == 0) return input_failure({}, "the clip has no frames");
  if (!human) return failure(human.error());
  EditSource source{std::move(copy), *std::move(human)};
  const PartOptions& part = options.part;
  for (Warning& doubt : range_doubts(part, clip.rate(), clip.frame_count())) {
    source.human.calibration.doubts.push_back(std::move(doubt));
  }
  RETARGET_TRY_ASSIGN(source.clip, trim(std::move(source.clip), part));
  const bool is_part = part.start_s >= 0.0 || !part.frames.empty();
  if (needs.no_lead_in && !is_part) source.clip = cut_lead_in(std::move(source.clip)).clip;
  return source;
}

namespace {

// Adds the clip's name to an error of the motion itself.
Error placed(Error error, const std::string& name) {
  const bool of_motion = error.kind == ErrorKind::kInput || error.kind == ErrorKind::kRun;
  if (of_motion && error.location.file.empty()) error.location.file = name;
  return error;
}

Result<Clip> plain(Result<Clip> clip) {
  return clip;
}

// Converts any edit result to Edited, so that given() can reject a poor seam unless it is forced.
template <typename SomeEdited>
Result<Edited> plain(Result<SomeEdited> edited) {
  if (!edited) return failure(edited.error());
  return Edited(std::move(*edited));
}

struct Call {
  EditOptions options;
  EditSettings settings;
  std::string data_dir;
  EditNeeds needs;
};

// Makes the options of one edit, bound to the given settings.
using OwnTable = OptionTable (*)(EditSettings&);

Call call_of(const nb::dict& keywords, const nb::object& data_dir, EditNeeds needs,
             OwnTable own = nullptr) {
  Call call{{}, {}, bytes_of_folder(data_dir), needs};
  OptionTable table = own == nullptr ? OptionTable{} : own(call.settings);
  append(table, edit_table(call.options));
  apply_keywords(table, keywords);
  return call;
}

ClipHandle given(Clip&& clip, const std::string&, bool) {
  return ClipHandle(std::move(clip)).as_edited();
}
ClipHandle given(Edited&& edited, const std::string& name, bool force) {
  if (edited.misfit && !force) raise(placed(*edited.misfit, name));
  warn(edited.doubts, name);
  return ClipHandle(std::move(edited.clip)).as_edited();
}

// Prepares the source and edits it without the GIL, then returns the new clip.
template <typename Function>
ClipHandle edited(const ClipHandle& clip, const Call& call, const Function& function) {
  std::vector<Warning> doubts;
  auto result = [&] {
    const ReleasedGil released;
    using Made = decltype(plain(function(std::declval<EditSource&>())));
    auto source = edit_source(*clip, call.options, call.data_dir, call.needs);
    if (!source) return Made(failure(source.error()));
    doubts = source->human.doubts();
    return Made(plain(function(*source)));
  }();
  if (!result) raise(placed(result.error(), clip->name()));
  warn(doubts, clip->name());
  return given(*std::move(result), clip->name(), call.settings.force);
}

ClipHandle trim_clip(const ClipHandle& clip, const nb::dict& keywords) {
  PartOptions part;
  apply_keywords(rows_for(OptionUse::kEdit, part_table(part)), keywords);
  warn(range_doubts(part, clip->rate(), clip->frame_count()), clip->name());
  return ClipHandle(without_gil([&] { return trim(*clip, part); })).as_edited();
}

ClipHandle resample(const ClipHandle& clip, const nb::dict& keywords) {
  EditSettings settings;
  apply_keywords(resample_table(settings), keywords);
  if (settings.fps.empty() && !settings.timing.speed) {
    raise(usage_failure("resample() needs fps or speed").value());
  }
  return ClipHandle(without_gil([&]() -> Result<Clip> {
           RETARGET_TRY_ASSIGN(const TimingOptions timing, settings.timing_options());
           return change_timing(*clip, timing);
         }))
      .as_edited();
}

ClipHandle rest(const ClipHandle& clip, const ClipHandle& like) {
  auto made = without_gil(
      [&] { return change_rest(*clip, like->shared_skeleton(), clip->name(), like->name()); });
  return given(std::move(made), clip->name(), false);
}

ClipHandle transferred(const ClipHandle& clip, const ClipHandle& like, const nb::dict& keywords,
                       const nb::object& data_dir) {
  const Call call = call_of(keywords, data_dir, {});
  return edited(clip, call, [&](EditSource& source) -> Result<Transferred> {
    RETARGET_TRY_ASSIGN(const auto target, edit_source(*like, {}, call.data_dir, {}));
    return transfer(source.subject(), target.subject());
  });
}

ClipHandle lafan1(const ClipHandle& clip, const nb::dict& keywords, const nb::object& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {}),
                [](EditSource& source) { return lafan1_clip(source.clip, source.calibration()); });
}

ClipHandle mirrored_clip(const ClipHandle& clip, const nb::dict& keywords,
                         const nb::object& data_dir) {
  return edited(clip, call_of(keywords, data_dir, {}),
                [](EditSource& source) { return mirror(source.clip, source.calibration()); });
}

// Checks arguments that are not options.
void check_finite(double number, const char* what) {
  if (std::isfinite(number) && std::abs(number) <= 1e6) return;
  raise(usage_failure(std::string(what) + ": expected a number from -1000000 to 1000000").value());
}

ClipHandle turned(const ClipHandle& clip, double degrees, const nb::dict& keywords,
                  const nb::object& data_dir) {
  check_finite(degrees, "degrees");
  return edited(clip, call_of(keywords, data_dir, {}), [&](EditSource& source) {
    return turn_clip(std::move(source.clip), source.calibration(),
                     degrees / 180.0 * std::numbers::pi);
  });
}

ClipHandle moved(const ClipHandle& clip, double x, double y, const nb::dict& keywords,
                 const nb::object& data_dir) {
  check_finite(x, "x");
  check_finite(y, "y");
  return edited(clip, call_of(keywords, data_dir, {.unit = true}), [&](EditSource& source) {
    return move_clip(std::move(source.clip), source.calibration(), {x, y});
  });
}

ClipHandle grounded(const ClipHandle& clip, const nb::dict& keywords, const nb::object& data_dir) {
  Call call = call_of(keywords, data_dir, {.no_lead_in = true}, ground_table);
  const std::optional<double>& floor = call.settings.floor;
  call.needs.unit = floor.has_value();
  return edited(clip, call, [&](EditSource& source) -> Result<Clip> {
    double height = floor.value_or(0.0);
    if (!floor) {
      RETARGET_TRY_ASSIGN(height, floor_height(source.clip, source.calibration()));
    }
    return put_on_floor(std::move(source.clip), source.calibration(), height);
  });
}

ClipHandle looped(const ClipHandle& clip, const nb::dict& keywords, const nb::object& data_dir) {
  const Call call = call_of(keywords, data_dir, {.no_lead_in = true}, loop_table);
  return edited(clip, call, [&](EditSource& source) {
    return make_loop(source.clip, source.calibration(), call.settings.loop_options());
  });
}

// Appends the next clip to the ones joined so far.
Result<void> join(EditSource& first, const ClipHandle& next, const Call& call,
                  const std::string& before, Edited& all) {
  RETARGET_TRY_ASSIGN(const ConcatenateOptions how, call.settings.concatenate_options());
  EditOptions options = call.options;
  // A bone map refers to the first clip's joints.
  options.human.map.clear();
  RETARGET_TRY_ASSIGN(const EditSource source,
                      edit_source(*next, options, call.data_dir, call.needs));
  RETARGET_TRY_ASSIGN(const Edited like, like_first(source.subject(), {all.clip, first.human.map,
                                                                       first.calibration()}));
  RETARGET_TRY_ASSIGN(Edited both, concatenate(all.clip, like.clip, first.calibration(), how,
                                               before, next->name()));
  if (both.misfit && !call.settings.force) return failure(placed(*both.misfit, next->name()));
  all.clip = std::move(both.clip);
  all.doubts.insert(all.doubts.end(), both.doubts.begin(), both.doubts.end());
  return {};
}

ClipHandle joined(const std::vector<ClipHandle>& clips, const nb::dict& keywords,
                  const nb::object& data_dir) {
  const Call call = call_of(keywords, data_dir, {.no_lead_in = true}, concatenate_table);
  if (clips.size() < 2) raise(usage_failure("clips: expected two or more").value());
  return edited(clips.front(), call, [&](EditSource& first) -> Result<Edited> {
    Edited all{std::move(first.clip)};
    for (std::size_t i = 1; i < clips.size(); ++i) {
      RETARGET_TRY(
          join(first, clips[i], call, i == 1 ? clips.front()->name() : "the preceding clips", all));
    }
    return all;
  });
}

ClipHandle along_path(const ClipHandle& clip, const nb::dict& keywords,
                      const nb::object& data_dir) {
  const Call call = call_of(keywords, data_dir, {.unit = true, .no_lead_in = true}, path_table);
  const PathChange& path = call.settings.path;
  const FollowPathOptions& how = call.settings.follow_path;
  value_of(path.check());
  return edited(clip, call, [&](EditSource& source) -> Result<FollowedPath> {
    const Calibration& calibration = source.calibration();
    RETARGET_TRY_ASSIGN(const auto own, fit_path(source.clip, calibration, how.fit));
    RETARGET_TRY_ASSIGN(const auto other, change_path(own.path, path));
    return follow_path(source.clip, calibration, other, how);
  });
}

}  // namespace

void bind_edit(nb::module_& module) {
  module.def("edit_trim", &trim_clip, "clip"_a, "options"_a);
  module.def("edit_resample", &resample, "clip"_a, "options"_a);
  module.def("edit_rest", &rest, "clip"_a, "like"_a);
  module.def("edit_transfer", &transferred, "clip"_a, "like"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_lafan1", &lafan1, "clip"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_mirror", &mirrored_clip, "clip"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_turn", &turned, "clip"_a, "degrees"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_move", &moved, "clip"_a, "x"_a, "y"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_ground", &grounded, "clip"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_loop", &looped, "clip"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_concatenate", &joined, "clips"_a, "options"_a, "data_dir"_a.none());
  module.def("edit_follow_path", &along_path, "clip"_a, "options"_a, "data_dir"_a.none());
}

}  // namespace retarget::python
