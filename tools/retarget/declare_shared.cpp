#include "declare_shared.h"

#include <charconv>
#include <string>
#include <utility>

#include "base/suggest.h"
#include "console.h"

namespace retarget::cli {

CLI::Validator silent(CLI::Validator validator) {
  return validator.description("");
}

CLI::Validator number_from(double least, double most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && value >= least && value <= most) return {};
    return "expected a number from " + number_text(least, 3) + " to " + number_text(most, 0) +
           ", found \"" + text + "\"";
  };
  return CLI::Validator(check, "");
}

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.add_flag("-q,--quiet", options.quiet, "Print errors only")->group(kGeneral);
  app.add_option("--data-dir", options.data_dir,
                 "Folder that holds robots/ and configs/\n"
                 "(default: $RETARGET_DATA_DIR, else found beside the program)")
      ->type_name("DIR")
      ->group(kGeneral);
}

void add_source_options(CLI::App& app, SourceOptions& options) {
  app.add_flag("--lenient", options.lenient,
               "Keep the complete frames of a damaged file, say what was\ndropped")
      ->group(kInput);
  app.add_option("--root", options.root, "Which tree to read, when a file holds several ROOTs")
      ->type_name("NAME")
      ->group(kInput);
  app.add_option("--source-fps", options.source_fps,
                 "Frames per second of the source, whatever its header says")
      ->type_name("N")
      ->check(number_from(kSlowestRate, kFastestRate))
      ->group(kInput);
  add_memory_option(app, options);
}

void add_memory_option(CLI::App& app, SourceOptions& options) {
  app.add_option("--memory", options.memory_gb,
                 "Take no motion that would need more memory than this, GB\n(default: three "
                 "quarters of what there is)")
      ->type_name("GB")
      ->check(number_from(0.001, 1e6))
      ->group(kInput);
}

void add_lead_in_option(CLI::App& app, RunOptions& run) {
  app.add_option("--lead-in", run.lead_in,
                 "Frames in front that the motion jumps away from (a T-pose,\na frame of zeros), "
                 "where no --start or --frames is\ngiven: auto drops them but for --method gmr")
      ->type_name("auto|drop|keep")
      ->check(silent(CLI::IsMember({"auto", "drop", "keep"})))
      ->capture_default_str()
      ->group(kInput);
}

void add_human_options(CLI::App& app, HumanOptions& options) {
  app.add_option("--map", options.map,
                 "Which joint is which bone: a mapping file in place of\nrecognition")
      ->type_name("FILE")
      ->group(kHuman);
  app.add_option("--write-map", options.write_map, "Write the mapping that was used, to be edited")
      ->type_name("FILE")
      ->group(kHuman);
  app.add_flag("--partial", options.partial, "Accept a body without arms or without legs")
      ->group(kHuman);
  app.add_option(
         "--rest", options.rest,
         "The pose that is a T-pose, or is brought to one: the zero\npose, the first frame, "
         "the best frame, or none (learned\nfrom the movement)")
      ->type_name("auto|zero|first|best|learned")
      ->check(silent(CLI::IsMember({"auto", "zero", "first", "best", "learned"})))
      ->capture_default_str()
      ->group(kHuman);
  app.add_option("--tpose-frame", options.tpose_frame, "Frame of the source that is the T-pose")
      ->type_name("N")
      ->check(silent(CLI::NonNegativeNumber))
      ->group(kHuman);
  app.add_option("--tpose-file", options.tpose_file,
                 "BVH of the same skeleton whose first frame is the T-pose")
      ->type_name("FILE")
      ->group(kHuman);
  app.add_option("--unit", options.unit, "Unit of length: m, dm, cm, mm, inch, cmu, or metres")
      ->type_name("UNIT")
      ->group(kHuman);
  app.add_option("--up", options.up, "Up axis of the source: y, z, -y, ...")
      ->type_name("AXIS")
      ->group(kHuman);
  app.add_option("--forward", options.forward, "Where the source's rest pose faces")
      ->type_name("AXIS")
      ->group(kHuman);
  app.add_option("--height", options.height,
                 "Height of the body, metres; settles a unit that is\nunknown (default: estimated; "
                 "1.75 for LAFAN1)")
      ->type_name("M")
      ->check(number_from(0.1, 10.0))
      ->group(kHuman);
}

void add_motion_options(CLI::App& app, RunOptions& run) {
  SourceOptions& options = run.source;
  app.add_option("--bvh", options.file, "Motion to retarget; - reads standard input")
      ->type_name("FILE")
      ->group(kInput);
  app.add_option("--smpl", run.smpl_file, "SMPL or SMPL-X motion to retarget, NPZ as in AMASS")
      ->type_name("FILE")
      ->group(kInput);
  app.add_option("--smpl-model", options.smpl_model,
                 "Your SMPL-X or SMPL+H body model (NPZ) for bone lengths\n(default: a generic "
                 "body of the same height)")
      ->type_name("FILE")
      ->group(kInput);
}

}  // namespace retarget::cli
