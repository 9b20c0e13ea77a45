#include "run_setup.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "base/data_folder.h"
#include "base/suggest.h"
#include "memory_need.h"
#include "motion/clip_range.h"
#include "motion/lead_in.h"
#include "motion/resample.h"
#include "pipeline/limb_lengths.h"
#include "read_source.h"
#include "rig/bare_robot.h"
#include "robot/find_robot.h"
#include "robot/load_robot.h"
#include "robot/variant.h"
#include "robot_mapping.h"

namespace retarget::cli {

namespace fs = std::filesystem;

namespace {

// frames that are none of the motion, unless the user says where it begins
int frames_to_leave_out(const Clip& clip, const RunOptions& options, Console& console) {
  // the published method takes every frame
  const bool keep =
      options.lead_in == "keep" || (options.lead_in == "auto" && options.method == "gmr");
  if (keep || !options.frames.empty() || options.start_s >= 0.0) return 0;
  const int count = count_lead_in_frames(clip);
  // an end among them is meant
  const bool ends_there = options.end_s >= 0.0 && options.end_s * clip.rate().fps() < count;
  if (count == 0 || ends_there) return 0;
  console.line("lead-in", count_text(count, "frame") +
                              " in front left out, from which the motion jumps away; "
                              "--lead-in keep takes " +
                              (count == 1 ? "it" : "them"));
  return count;
}

// the part of the clip that the user asked for
Result<Clip> choose_frames(Clip clip, const RunOptions& options, int lead_in) {
  const bool has_range = !options.frames.empty() || options.start_s >= 0.0 || options.end_s >= 0.0;
  if (!has_range) return lead_in == 0 ? std::move(clip) : cut(clip, lead_in, clip.frame_count());
  const auto given = [](double seconds) {
    return seconds < 0.0 ? std::nullopt : std::optional<double>(seconds);
  };
  const auto range = options.frames.empty()
                         ? frame_range_from_seconds(given(options.start_s), given(options.end_s),
                                                    clip.rate(), clip.frame_count())
                         : frame_range_from_text(options.frames, clip.frame_count());
  if (!range) return failure(range.error());
  return cut(clip, std::max(range->begin, lead_in), range->end);
}

// the clip, cut and at the output rate
Result<Clip> prepare_clip(Clip clip, const RunOptions& options, int lead_in,
                          std::uint64_t file_bytes) {
  const auto rate = output_rate(options.fps);
  if (!rate) return failure(rate.error());
  auto chosen = choose_frames(std::move(clip), options, lead_in);
  if (!chosen) return chosen;
  const std::int64_t frames =
      resampled_frame_count(chosen->frame_count(), chosen->rate(), rate->value_or(chosen->rate()));
  const MotionNeed need{frames, rate->value_or(chosen->rate()), file_bytes,
                        source_name(options.source)};
  if (auto fits = check_need(need, options); !fits) return failure(fits.error());
  if (!*rate) return chosen;
  ResampleOptions resample_options;
  resample_options.interpolation =
      options.interpolation == "linear" ? Interpolation::kLinear : Interpolation::kCubic;
  resample_options.antialias = !options.no_antialias;
  auto resampled = resample(std::move(*chosen), **rate, resample_options);
  if (!resampled) resampled.error().location.file = source_name(options.source);
  return resampled;
}

// a motion so far away that no reader of robot motions takes it, and its numbers tell no steps apart
Result<void> check_place(const Clip& clip, double metres_per_unit, const RunOptions& options) {
  const double most = options.centimetres ? 5e3 : 5e5;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto places = clip.translations(frame);
    const auto far = std::ranges::find_if(places, [&](const Eigen::Vector3d& place) {
      return !(place.cwiseAbs().maxCoeff() * metres_per_unit <= most);
    });
    if (far == places.end()) continue;
    return input_failure(source_name(options.source),
                         "in frame " + std::to_string(frame) + " the body is more than " +
                             number_text(most / 1000.0, 0) + " km away from the origin",
                         "bring the motion to the origin first; or --unit says what its numbers "
                         "are");
  }
  return {};
}

// a motion whose feet nobody knows floats or sinks, so soles are looked for in the model
std::shared_ptr<const Robot> with_soles(const std::shared_ptr<const Robot>& robot,
                                        const std::string& model, const RunOptions& options,
                                        Console& console) {
  const bool may_have_one = !options.robot_xml.empty() && options.robot_profile.empty();
  const std::string remedy = std::string("a profile tells them (docs/robots.md)") +
                             (may_have_one ? ": --robot-profile FILE" : ", this robot's does not");
  auto completed = complete_bare_robot(*robot, model);
  if (!completed) {
    console.warn(
        {{0, 0,
          std::string("the robot's soles are not known, so its feet may float or sink; ") + remedy +
              "; they were looked for in the model: " + completed.error().message}},
        model);
    return robot;
  }
  console.line("soles", completed->note + "; " + remedy);
  std::vector<Warning> warnings;
  if (completed->guessed) {
    warnings.push_back({0, 0,
                        "nothing in the model tells where the soles are: they are guessed from the "
                        "legs' lengths, and feet may float or sink by centimetres"});
  }
  if (completed->shapeless > 0) {
    warnings.push_back({0, 0,
                        "the model has neither a sphere, capsule or box nor a mesh for " +
                            count_text(completed->shapeless, "part") +
                            " of its body, and nothing keeps these out of each other and the "
                            "floor; retarget robots add makes shapes for them"});
  }
  console.warn(warnings, model);
  return std::move(completed->robot);
}

}  // namespace

Result<std::optional<FrameRate>> output_rate(const std::string& text) {
  if (text == "source") return std::optional<FrameRate>();
  double fps = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), fps);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  // wider than any motion, narrower than any slip
  if (!whole || !(fps >= 0.001 && fps <= 1e6)) {
    return usage_failure("--fps must be a number from 0.001 to 1000000 or `source`, found \"" +
                         text + "\"");
  }
  return frame_rate_from_fps(fps);
}

Result<void> choose_motion_file(RunOptions& options) {
  if (options.smpl_file.empty()) return {};
  if (!options.source.file.empty()) {
    return usage_failure("--bvh and --smpl both name a motion", "give one of them");
  }
  options.source.file = options.smpl_file;
  options.source.smpl = true;
  return {};
}

Result<Source> load_source(const RunOptions& options, const fs::path& data_folder,
                           Console& console) {
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  const Clip& clip = motion->clip;
  console.line("read", source_name(options.source) + ": " +
                           count_text(clip.skeleton().joint_count(), "joint") + ", " +
                           count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) +
                           " fps, " + number_text(clip.duration(), 2) + " s");
  if (clip.frame_count() == 0) {
    return input_failure(source_name(options.source), "the clip has no frames to retarget",
                         "retarget inspect shows its skeleton");
  }
  // rest pose, unit and axes are looked for in the whole clip, whatever part is taken
  auto human =
      find_human(*motion, options.source, options.human, data_folder / "configs" / "skeletons");
  if (!human) return failure(human.error());
  console.line("taken as", human->calibration.mapping.description);
  for (const std::string& note : human->map.notes) console.line("", note);
  console.warn(human->calibration.mapping.doubts, source_name(options.source));
  const int lead_in = frames_to_leave_out(clip, options, console);
  auto prepared = prepare_clip(std::move(motion->clip), options, lead_in, motion->bytes);
  if (!prepared) return failure(prepared.error());
  const double metres_per_unit = human->calibration.mapping.metres_per_unit;
  if (auto place = check_place(*prepared, metres_per_unit, options); !place) {
    return failure(place.error());
  }
  return Source{std::move(*prepared), lead_in, std::move(*human)};
}

Result<fs::path> data_folder_of(const CommonOptions& options) {
  const auto& chosen = options.data_dir;
  return find_data_folder(chosen.empty() ? std::nullopt : std::optional<std::string>(chosen));
}

Result<void> resolve_robot(std::string& robot, const fs::path& data_folder) {
  if (robot.empty()) return {};
  auto found = find_robot(robot, data_folder / "robots");
  if (!found) return failure(found.error());
  robot = std::move(found->name);
  return {};
}

Result<void> check_robot_choice(const RunOptions& options) {
  if (options.robot.empty() && options.robot_xml.empty()) {
    return usage_failure("no robot is given", "add --robot NAME or --robot-xml FILE");
  }
  if (!options.robot.empty() && !options.robot_xml.empty()) {
    return usage_failure("--robot and --robot-xml both name a robot", "give one of them");
  }
  if (!options.robot_profile.empty() && options.robot_xml.empty()) {
    return usage_failure("--robot-profile belongs to --robot-xml", "add --robot-xml FILE");
  }
  return {};
}

namespace {

Result<void> check_model_file(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return {};
  const fs::path model = fs::path(path) / "model.xml";
  return config_failure(
      path, "expected a robot's model, found a directory",
      fs::is_regular_file(model, ignored)
          ? "--robot " + path + " takes a robot's folder; its model is " + model.string()
          : "name the MJCF or URDF in it");
}

}  // namespace

Result<ChosenRobot> load_chosen_robot(const RunOptions& options, const fs::path& data_folder,
                                      Console& console, Soles soles) {
  std::string model = options.robot_xml, profile = options.robot_profile;
  if (auto file = check_model_file(model); !file) return failure(file.error());
  if (model.empty()) {
    const auto found = find_robot(options.robot, data_folder / "robots");
    if (!found) return failure(found.error());
    model = found->model.string();
    profile = found->profile.string();
  }
  auto robot = load_robot(model, profile);
  if (!robot) return failure(robot.error());
  if (soles == Soles::kNeeded && (*robot)->profile().soles.empty()) {
    robot = with_soles(*robot, model, options, console);
  }
  if (!options.dof.empty()) robot = robot_variant(*robot, options.dof);
  if (!robot) return failure(robot.error());
  for (const std::string& warning : (*robot)->warnings()) console.warn({{0, 0, warning}}, model);
  return ChosenRobot{std::move(*robot), model};
}

const ResolvedMapping& RobotMappings::for_source(const HumanSource& human) const {
  const std::string& dialect = human.calibration.mapping.dialect;
  const bool is_lafan1 = dialect == "lafan1" || dialect == "lafan1_resolved";
  return of_others && !is_lafan1 ? *of_others : of_lafan1;
}

Result<RobotMappings> load_mappings(const RunOptions& options, const ChosenRobot& robot,
                                    const fs::path& data_folder) {
  const auto files =
      find_mappings(options.ik_config, options.method, fs::path(robot.model).parent_path(),
                    data_folder, fs::path(robot.robot->name()).filename().string());
  if (!files) return failure(files.error());
  auto of_lafan1 = load_mapping(files->of_lafan1, *robot.robot);
  if (!of_lafan1) return failure(of_lafan1.error());
  RobotMappings mappings{std::move(*of_lafan1), std::nullopt};
  if (files->of_others.empty()) return mappings;
  auto of_others = load_mapping(files->of_others, *robot.robot);
  if (!of_others) return failure(of_others.error());
  mappings.of_others = std::move(*of_others);
  return mappings;
}

HeightScale choose_scale(const HumanSource& human, const Robot& robot,
                         const ResolvedMapping& tables, const RunOptions& options) {
  if (options.scale == "table") return HeightScale::kPublished;
  if (options.scale == "height") return HeightScale::kNormalised;
  if (options.scale == "limbs") return HeightScale::kLimbs;
  // the published method takes every body of LAFAN1 for one, and the tables that are made for it do
  const bool as_published =
      options.method == "gmr" || (!options.ik_config.empty() && options.ik_config != "derived");
  if (as_published && human.calibration.rest_pose == "lafan1") return HeightScale::kPublished;
  const bool measurable = std::ranges::all_of(kMeasuredBones, [&](Bone bone) {
    return human.calibration.mapping.bones[bone].position_joint >= 0;
  });
  if (options.human.height > 0.0 || !measurable) return HeightScale::kNormalised;
  const auto limbs = robot_limbs(robot, tables);
  // robots whose arms end at the elbow: a fit measures them as far as they go
  const bool by_limbs = limbs && (limbs->forearms || options.method != "gmr");
  return by_limbs ? HeightScale::kLimbs : HeightScale::kNormalised;
}

}  // namespace retarget::cli
