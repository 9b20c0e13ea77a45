// `retarget edit`: reads BVH, writes BVH or a GLB for viewing.

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "edit_arguments.h"
#include "retarget/bvh.h"
#include "retarget/clip.h"
#include "retarget/clip_range.h"
#include "retarget/edit.h"
#include "retarget/file.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// A clip to edit and the human in it.
struct EditSource {
  Clip clip;
  HumanInClip human;

  [[nodiscard]] const Calibration& calibration() const { return human.calibration; }
  [[nodiscard]] Subject subject() const { return {clip, human.map, calibration()}; }
};

// Adds the file to an error of the motion itself.
Error placed(Error error, const std::string& file) {
  const bool of_motion = error.kind == ErrorKind::kInput || error.kind == ErrorKind::kRun;
  if (of_motion && error.location.file.empty()) error.location.file = file;
  return error;
}

std::string shown_name(const std::string& file) {
  return file == "-" ? "standard input" : file;
}

// Returns all files that an edit reads.
std::vector<std::string> files_of(const EditArguments& options) {
  Run run;
  run.motion = options.file;
  run.options.source = options.source;
  run.options.human = options.human;
  std::vector<std::string> files = files_read(run, options.common);
  files.insert(files.end(), {options.like, options.path.to});
  files.insert(files.end(), options.files.begin(), options.files.end());
  return files;
}

class EditRun {
 public:
  EditRun(const EditArguments& options, Console& console)
      : options_(options), console_(console), file_(shown_name(options.file)) {}

  // Returns nothing if the output is already written.
  Result<std::optional<Clip>> run() {
    switch (options_.edit) {
      case Edit::kRest:
        return to_rest();
      case Edit::kConcat:
        return concat();
      case Edit::kPath:
        return path();
      case Edit::kResample:
      case Edit::kTrim:
        return edit_time();
      default:
        return edit_body();
    }
  }

 private:
  // Prints an edit's notes and warnings; a poor seam is an error unless it is forced.
  template <typename SomeEdited>
  Result<Clip> told(Result<SomeEdited> edited, const std::string& file) {
    if (!edited) return failure(placed(edited.error(), file));
    for (const auto& [label, text] : edited->notes) console_.line(label, text);
    if (edited->misfit && !options_.force) return failure(placed(*edited->misfit, file));
    console_.warn(edited->doubts, file);
    return std::move(edited->clip);
  }

  // Prints warnings about the file.
  Result<Clip> read_clip(const std::string& file) {
    RETARGET_TRY_ASSIGN(Clip clip, load_clip(file, options_.source, {options_.common.data_dir}));
    console_.warn(clip.origin().warnings, clip.name());
    return clip;
  }

  // Cuts a clip to the requested part.
  Result<Clip> trim_clip(Clip clip) {
    console_.warn(range_doubts(options_.part, clip.rate(), clip.frame_count()), clip.name());
    return trim(std::move(clip), options_.part);
  }

  Result<EditSource> read_human(Clip clip, const HumanOptions& how, const std::string& write_map) {
    RETARGET_TRY_ASSIGN(const std::string data_folder, data_folder_of(options_.common));
    RETARGET_TRY_ASSIGN(auto human, find_human(clip, how, data_folder));
    RETARGET_TRY(save_bone_map(write_map, human.map, clip.skeleton()));
    console_.lines(human.lines());
    console_.warn(human.doubts(), clip.name());
    return EditSource{std::move(clip), std::move(human)};
  }

  // Recognises the human in the whole clip, then cuts it to the requested part.
  Result<EditSource> read(const std::string& file, HumanOptions how, const std::string& write_map) {
    const Edit edit = options_.edit;
    // Edits with lengths in metres need a unit; all others work in the file's own.
    how.unit_optional =
        edit != Edit::kMove && edit != Edit::kPath && !(edit == Edit::kGround && options_.floor);
    RETARGET_TRY_ASSIGN(Clip clip, read_clip(file));
    RETARGET_TRY_ASSIGN(auto source, read_human(std::move(clip), how, write_map));
    const PartOptions& part = options_.part;
    RETARGET_TRY_ASSIGN(source.clip, trim_clip(std::move(source.clip)));
    // Edits that analyse the whole motion must not treat a leading T-pose as part of it.
    const bool looks_at_motion = edit == Edit::kPath || edit == Edit::kLoop ||
                                 edit == Edit::kConcat || edit == Edit::kGround;
    if (part.start_s >= 0.0 || !part.frames.empty() || !looks_at_motion) return source;
    // Joined clips have no --start option.
    const bool can_start = edit != Edit::kConcat;
    RETARGET_TRY_ASSIGN(
        source.clip, told(Result<Edited>(cut_lead_in(std::move(source.clip), can_start)), file_));
    return source;
  }

  Result<Clip> to_rest() {
    RETARGET_TRY_ASSIGN(const Clip motion, read_clip(options_.file));
    RETARGET_TRY_ASSIGN(const Clip like, load_skeleton(options_.like));
    return told(change_rest(motion, like.shared_skeleton(), file_, options_.like), file_);
  }

  Result<Clip> to_other(const EditSource& source) {
    HumanOptions how;
    how.unit_optional = true;
    RETARGET_TRY_ASSIGN(Clip like, load_skeleton(options_.like));
    console_.warn(like.origin().warnings, like.name());
    RETARGET_TRY_ASSIGN(const auto target, read_human(std::move(like), how, {}));
    return told(Result<Transferred>(transfer(source.subject(), target.subject())), options_.like);
  }

  Result<Clip> edit_time() {
    const bool resample = options_.edit == Edit::kResample;
    if (resample && options_.fps.empty() && !options_.timing.speed) {
      return usage_failure("edit resample needs --fps or --speed");
    }
    const PartOptions& part = options_.part;
    if (!resample && part.start_s < 0.0 && part.end_s < 0.0 && part.frames.empty()) {
      return usage_failure("edit trim needs --start, --end or --frames");
    }
    RETARGET_TRY_ASSIGN(const TimingOptions timing, options_.timing_options());
    RETARGET_TRY_ASSIGN(Clip motion, read_clip(options_.file));
    RETARGET_TRY_ASSIGN(auto clip, trim_clip(std::move(motion)));
    if (!resample) return clip;
    console_.line("source", summary(clip));
    return change_timing(std::move(clip), timing);
  }

  Result<Clip> edit_body() {
    RETARGET_TRY_ASSIGN(auto source, read(options_.file, options_.human, options_.write_map));
    const Calibration& calibration = source.calibration();
    switch (options_.edit) {
      case Edit::kTransfer:
        return to_other(source);
      case Edit::kLafan1:
        return lafan1_clip(source.clip, calibration);
      case Edit::kMirror:
        return mirror(source.clip, calibration);
      case Edit::kTurn:
        return turn_clip(std::move(source.clip), calibration,
                         options_.degrees / 180.0 * std::numbers::pi);
      case Edit::kLoop:
        return told(make_loop(source.clip, calibration, options_.loop_options()), file_);
      case Edit::kMove: {
        RETARGET_TRY_ASSIGN(const auto way, way_from_text(options_.shift));
        return move_clip(std::move(source.clip), calibration, way);
      }
      default: {
        RETARGET_TRY_ASSIGN(const double floor, options_.floor
                                                    ? Result<double>(*options_.floor)
                                                    : floor_height(source.clip, calibration));
        console_.line("floor", "was at " + number_text(floor, 4) + " m");
        return put_on_floor(std::move(source.clip), calibration, floor);
      }
    }
  }

  Result<EditSource> read_one(std::size_t index) {
    HumanOptions human = options_.human;
    // A bone map refers to the first clip's joints.
    if (index > 0) human.map.clear();
    console_.line("motion", options_.files[index]);
    return read(options_.files[index], human, index > 0 ? std::string() : options_.write_map);
  }

  Result<Clip> concat() {
    RETARGET_TRY_ASSIGN(const ConcatenateOptions how, options_.concatenate_options());
    const std::vector<std::string>& files = options_.files;
    if (files.size() < 2) return usage_failure("edit concat requires at least two files");
    if (std::ranges::count(files, "-") > 1) {
      return usage_failure("standard input provides only one clip, but `-` is given twice");
    }
    RETARGET_TRY_ASSIGN(auto first, read_one(0));
    for (std::size_t i = 1; i < files.size(); ++i) {
      RETARGET_TRY_ASSIGN(const auto source, read_one(i));
      RETARGET_TRY_ASSIGN(const auto next,
                          told(like_first(source.subject(), first.subject()), files[i]));
      const std::string before = i == 1 ? files[0] : "the preceding clips";
      auto joined = concatenate(first.clip, next, first.calibration(), how, before, files[i]);
      if (joined && i == 1 && !options_.matrix.empty()) {
        RETARGET_TRY(write_file(options_.matrix, format_pgm(joined->map)));
      }
      RETARGET_TRY_ASSIGN(first.clip, told(std::move(joined), files[i]));
    }
    console_.line("result", count_text(first.clip.frame_count(), "frame"));
    return first.clip;
  }

  [[nodiscard]] Result<void> check_path() const {
    const bool follows = options_.path.any(), writes = !options_.output.empty();
    if (!writes && options_.fit.empty() && options_.svg.empty()) {
      return usage_failure("edit path needs --fit, --svg or -o",
                           "--fit and --svg write the motion's own path; -o follows another path");
    }
    if (writes && !follows) {
      return usage_failure("edit path -o needs a path to follow", "give --to, --scale or --rotate");
    }
    if (!writes && follows && options_.svg.empty()) {
      return usage_failure("edit path needs -o for the motion on its new path");
    }
    return options_.path.check();
  }

  Result<std::optional<Clip>> path() {
    RETARGET_TRY(check_path());
    RETARGET_TRY_ASSIGN(const auto source, read(options_.file, options_.human, options_.write_map));
    RETARGET_TRY_ASSIGN(const auto own,
                        fit_path(source.clip, source.calibration(), options_.follow_path.fit));
    console_.line("path", own.summary());
    if (!options_.fit.empty()) RETARGET_TRY(write_file(options_.fit, format_path(own.path)));
    std::vector<PathDrawing> drawings = {{&source.clip, &own.path}};
    std::optional<GroundPath> path;
    std::optional<Clip> clip;
    if (options_.path.any()) {
      RETARGET_TRY_ASSIGN(path, change_path(own.path, options_.path));
      RETARGET_TRY_ASSIGN(
          clip,
          told(follow_path(source.clip, source.calibration(), *path, options_.follow_path), file_));
      drawings.push_back({&*clip, &*path});
    }
    if (!options_.svg.empty())
      RETARGET_TRY(write_file(options_.svg, draw_paths(source.calibration(), drawings)));
    if (options_.output.empty()) return std::nullopt;
    return clip;
  }

  const EditArguments& options_;
  Console& console_;
  const std::string file_;
};

// Returns the options to recognise the human in an edited clip: those given, unless the skeleton
// has changed.
HumanOptions human_options(const EditArguments& options) {
  const bool same = options.edit != Edit::kTransfer && options.edit != Edit::kLafan1;
  return same ? options.human : HumanOptions();
}

Result<void> check_endings(const EditArguments& options) {
  RETARGET_TRY(check_output_ending(options.output, {".bvh", ".glb"}, "a BVH file or a GLB"));
  RETARGET_TRY(check_output_ending(options.matrix, {".pgm"}, "a picture in the format PGM"));
  RETARGET_TRY(check_output_ending(options.fit, {".json"}, "a path in JSON"));
  return check_output_ending(options.svg, {".svg"}, "a picture in the format SVG");
}

}  // namespace

Result<void> edit(const EditArguments& options, Console& console) {
  RETARGET_TRY(
      check_written({options.output, options.matrix, options.fit, options.svg, options.write_map},
                    files_of(options)));
  RETARGET_TRY(check_endings(options));
  const auto clip = EditRun(options, console).run();
  if (!clip) return failure(placed(clip.error(), shown_name(options.file)));
  if (!*clip) return {};
  if (options.edit >= Edit::kResample && options.edit <= Edit::kLoop) {
    console.line("result", summary(**clip));
  }
  RETARGET_TRY(is_glb_name(options.output)
                   ? write_human_glb(options.output, **clip, human_options(options),
                                     DataFolder{options.common.data_dir}, console)
                   : save_bvh(options.output, **clip));
  console.line("wrote", options.output == "-" ? "standard output" : options.output);
  return {};
}

}  // namespace retarget::cli
