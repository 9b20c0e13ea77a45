#include "outputs.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/suggest.h"
#include "provenance/hash.h"
#include "robot/normalize_start.h"
#include "written_files.h"

namespace retarget::cli {

namespace fs = std::filesystem;

namespace {

bool is_csv(MotionFormat format) {
  return format == MotionFormat::kCsv || format == MotionFormat::kCsvSoma;
}

constexpr std::string_view kEndings[] = {".csv", ".npz", ".pkl"};

// other names that files of the same kinds have
constexpr std::pair<std::string_view, std::string_view> kOtherEndings[] = {
    {".pickle", ".pkl"}, {".joblib", ".pkl"}, {".tsv", ".csv"}, {".txt", ".csv"}};

// endings of what is no robot's motion
constexpr std::string_view kForeignEndings[] = {".bvh",  ".json", ".jsonl", ".npy", ".xml",
                                                ".urdf", ".html", ".fbx",   ".pt",  ".zip",
                                                ".gz",   ".xlsx", ".hdf5",  ".h5"};

// of a file's name, in lower case; empty: none
std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  for (char& letter : ending) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return ending;
}

// `.csv`, `.npz` or `.pkl` by a name; empty: it does not say
std::string_view kind_of(const std::string& path) {
  const std::string ending = ending_of(path);
  for (const std::string_view known : kEndings) {
    if (ending == known) return known;
  }
  for (const auto& [other, known] : kOtherEndings) {
    if (ending == other) return known;
  }
  return {};
}

// the formats of files with this ending
std::string formats_ending_in(std::string_view ending) {
  std::vector<std::string> names;
  for (const std::string& name : format_names()) {
    const auto format = format_from_name(name);
    if (format && format_ending(*format) == ending) names.push_back(name);
  }
  return list_names(names);
}

Result<MotionFormat> only_format(const OutputOptions& options) {
  if (!options.formats.empty()) return format_from_name(options.formats.front());
  const std::string_view kind = kind_of(options.output);
  if (kind.empty() || kind == format_ending(MotionFormat::kCsv)) return MotionFormat::kCsv;
  return usage_failure(
      "the output \"" + options.output + "\" may be of several formats, and --format is not given",
      "add --format with one of: " + formats_ending_in(kind));
}

Result<void> check_ending(const OutputItem& item) {
  const std::string_view kind = kind_of(item.path);
  const std::string ending = ending_of(item.path);
  const bool foreign = std::ranges::find(kForeignEndings, ending) != std::end(kForeignEndings);
  if (!foreign && (kind.empty() || kind == format_ending(item.format))) return {};
  return usage_failure("the output \"" + item.path + "\" ends in " +
                           fs::path(item.path).extension().string() + ", and --format " +
                           std::string(format_name(item.format)) + " makes a " +
                           std::string(format_ending(item.format)) + " file",
                       "give a name that says what it is");
}

}  // namespace

Result<std::vector<OutputItem>> plan_outputs(const OutputOptions& options) {
  if (options.output.empty()) {
    return usage_failure("no output is given", "add -o FILE, or -o - for standard output");
  }
  if (options.formats.size() <= 1) {
    const auto format = only_format(options);
    if (!format) return failure(format.error());
    OutputItem item{*format, options.output};
    if (auto ending = check_ending(item); !ending) return failure(ending.error());
    return std::vector<OutputItem>{std::move(item)};
  }
  if (options.output == "-") {
    return usage_failure("several formats cannot go to standard output", "give a name with -o");
  }
  std::string base = options.output;
  const std::string given = ending_of(base);
  if (std::ranges::find(kEndings, given) != std::end(kEndings)) {
    base.erase(base.size() - given.size());
  }
  std::vector<OutputItem> items;
  for (const std::string& name : options.formats) {
    const auto format = format_from_name(name);
    if (!format) return failure(format.error());
    for (const OutputItem& other : items) {
      if (other.format == *format) return usage_failure("--format names " + name + " twice");
    }
    items.push_back({*format, base + std::string(format_long_ending(*format))});
  }
  return items;
}

Result<void> check_outputs(const OutputOptions& options, const std::vector<std::string>& inputs,
                           const std::vector<std::string>& other_outputs) {
  WrittenFiles written(inputs);
  // before what its name says: whoever names an input has mistaken something else
  if (options.output != "-" && options.formats.size() <= 1) {
    if (auto spared = written.check_spared(options.output); !spared) return spared;
  }
  const auto items = plan_outputs(options);
  if (!items) return failure(items.error());
  for (const std::string& other : other_outputs) {
    if (auto sound = written.take(other); !sound) return sound;
  }
  for (const OutputItem& item : *items) {
    if (auto sound = written.take(item.path); !sound) return sound;
    if (!options.sidecar) continue;
    if (item.path == "-") {
      return usage_failure("--sidecar needs a file to stand beside", "give a name with -o");
    }
    if (auto sound = written.take(item.path + ".json"); !sound) return sound;
  }
  if (auto sound = write_options(options); !sound) return failure(sound.error());
  return {};
}

Result<WriteMotionOptions> write_options(const OutputOptions& options) {
  WriteMotionOptions write;
  write.csv.precision = options.precision;
  write.csv.delimiter = options.delimiter == "comma"   ? ','
                        : options.delimiter == "space" ? ' '
                                                       : '\t';
  write.csv.header = options.header;
  write.csv.quaternion_order =
      options.quaternion == "wxyz" ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  write.csv.frame_column = options.frame_column;
  write.csv.degrees = options.degrees;
  write.csv.centimetres = options.centimetres;
  write.tracking.rate = {options.npz_fps, 1};
  if (options.npz_velocity == "link") write.tracking.velocity_of = BodyPoint::kLink;
  if (options.npz_velocity == "mass") write.tracking.velocity_of = BodyPoint::kMass;
  write.name = options.motion_name;
  if (write.name.empty()) {
    // walk.pbhc.pkl holds the motion `walk`
    const std::string file = fs::path(options.output).filename().string();
    write.name = file.substr(0, file.find('.'));
    if (options.output == "-") write.name.clear();
  }
  return write;
}

Result<std::unique_ptr<MotionOutputs>> MotionOutputs::open(const OutputOptions& options,
                                                           std::shared_ptr<const Robot> robot,
                                                           const FrameRate& rate, bool in_memory) {
  std::unique_ptr<MotionOutputs> outputs(new MotionOutputs());
  outputs->options_ = options;
  outputs->in_memory_ = in_memory;
  auto items = plan_outputs(options);
  if (!items) return failure(items.error());
  outputs->items_ = std::move(*items);
  auto write = write_options(options);
  if (!write) return failure(write.error());
  outputs->write_options_ = std::move(*write);
  for (const OutputItem& item : outputs->items_) {
    outputs->sinks_.push_back(nullptr);
    if (!is_csv(item.format)) {
      // fails now rather than after the work
      outputs->others_.emplace_back();
      if (in_memory) continue;
      auto file = OutputFile::create(item.path);
      if (!file) return failure(file.error());
      outputs->others_.back() = std::move(*file);
      continue;
    }
    const RobotCsvOptions& csv = outputs->write_options_.csv;
    const CsvSink::Options sink_options{
        item.format == MotionFormat::kCsvSoma ? soma_csv_options(rate, csv.precision) : csv,
        options.normalize_start};
    outputs->others_.emplace_back();
    auto sink = CsvSink::open(in_memory ? std::string() : item.path, robot, sink_options);
    if (!sink) return failure(sink.error());
    outputs->sinks_.back() = std::move(*sink);
  }
  return outputs;
}

void MotionOutputs::add(std::span<const double> qpos) {
  for (const auto& sink : sinks_) {
    if (sink) sink->add(qpos);
  }
}

Result<void> MotionOutputs::write_others(const RobotClip& motion) {
  RobotClip moved = motion;
  if (options_.normalize_start) normalize_start(moved);
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (sinks_[i]) continue;
    auto bytes = format_robot_motion(moved, items_[i].format, write_options_);
    if (!bytes) {
      if (bytes.error().location.file.empty()) bytes.error().location.file = items_[i].path;
      return failure(bytes.error());
    }
    auto hash = hash_bytes(*bytes);
    if (!hash) return failure(hash.error());
    written_[i] = {items_[i], std::move(*hash)};
    if (in_memory_) continue;
    if (auto done = others_[i]->write(*bytes); !done) return done;
  }
  return {};
}

Result<std::vector<WrittenFile>> MotionOutputs::finish(const RobotClip& motion,
                                                       const SidecarText& sidecar) {
  written_.resize(items_.size());
  if (auto written = write_others(motion); !written) return failure(written.error());
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (!sinks_[i]) continue;
    auto hash = sinks_[i]->flush();
    if (!hash) return failure(hash.error());
    written_[i] = {items_[i], std::move(*hash)};
  }
  if (sidecar && !in_memory_) {
    for (const WrittenFile& written : written_) {
      const auto text = sidecar(written);
      if (!text) return failure(text.error());
      auto file = OutputFile::create(written.item.path + ".json");
      if (!file) return failure(file.error());
      if (auto done = file->write(*text); !done) return failure(done.error());
      sidecars_.push_back(std::move(*file));
    }
  }
  if (in_memory_) return written_;
  for (const auto& sink : sinks_) {
    if (!sink) continue;
    if (auto done = sink->commit(); !done) return failure(done.error());
  }
  for (auto& file : others_) {
    if (!file) continue;
    if (auto done = file->commit(); !done) return failure(done.error());
  }
  for (OutputFile& file : sidecars_) {
    if (auto done = file.commit(); !done) return failure(done.error());
  }
  return written_;
}

std::string outputs_text(std::span<const WrittenFile> files) {
  std::vector<std::string> names;
  for (const WrittenFile& file : files) {
    names.push_back(file.item.path == "-" ? "standard output" : file.item.path);
  }
  return list_names(names);
}

}  // namespace retarget::cli
