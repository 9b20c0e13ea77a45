#include "run/outputs.h"

#include <utility>

#include "base/suggest.h"
#include "base/try.h"
#include "plan/human_in_world.h"
#include "provenance/hash.h"

namespace retarget {
namespace {

bool is_csv(MotionFormat format) {
  return format == MotionFormat::kCsv || format == MotionFormat::kCsvSoma;
}

}  // namespace

Result<std::unique_ptr<MotionOutputs>> MotionOutputs::open(
    const std::string& output, const SaveOptions& options,
    const std::shared_ptr<const Robot>& robot, const FrameRate& rate, bool in_memory) {
  std::unique_ptr<MotionOutputs> outputs(new MotionOutputs());
  outputs->options_ = options;
  outputs->in_memory_ = in_memory;
  TRY_ASSIGN(outputs->items_, plan_outputs(output, options));
  outputs->write_options_ = write_options(output, options);
  for (const OutputItem& item : outputs->items_) {
    outputs->sinks_.push_back(nullptr);
    if (!is_csv(item.format)) {
      // fails now rather than after the work
      outputs->others_.emplace_back();
      if (in_memory) continue;
      TRY_ASSIGN(outputs->others_.back(), OutputFile::create(item.path));
      continue;
    }
    const RobotCsvOptions& csv = outputs->write_options_.csv;
    const CsvSink::Options sink_options{
        item.format == MotionFormat::kCsvSoma ? soma_csv_options(rate, csv.precision) : csv,
        options.normalize_start};
    outputs->others_.emplace_back();
    TRY_ASSIGN(outputs->sinks_.back(),
               CsvSink::open(in_memory ? std::string() : item.path, robot, sink_options));
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
  if (options_.normalize_start) normalize_start(moved, write_options_);
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (sinks_[i]) continue;
    auto bytes = format_robot_motion(moved, items_[i].format, write_options_);
    if (!bytes) {
      if (bytes.error().location.file.empty()) bytes.error().location.file = items_[i].path;
      return failure(bytes.error());
    }
    TRY_ASSIGN(auto hash, hash_bytes(*bytes));
    written_[i] = {items_[i], std::move(hash)};
    if (in_memory_) continue;
    TRY(others_[i]->write(*bytes));
  }
  return {};
}

Result<std::vector<WrittenFile>> MotionOutputs::finish(const RobotClip& motion,
                                                       std::optional<HumanInWorld> human,
                                                       const SidecarText& sidecar) {
  write_options_.human = std::move(human);
  written_.resize(items_.size());
  TRY(write_others(motion));
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (!sinks_[i]) continue;
    TRY_ASSIGN(auto hash, sinks_[i]->flush());
    written_[i] = {items_[i], std::move(hash)};
  }
  if (sidecar && !in_memory_) {
    for (const WrittenFile& written : written_) {
      TRY_ASSIGN(const auto text, sidecar(written));
      TRY_ASSIGN(auto file, OutputFile::create(written.item.path + ".json"));
      TRY(file.write(text));
      sidecars_.push_back(std::move(file));
    }
  }
  if (in_memory_) return written_;
  for (const auto& sink : sinks_) {
    if (!sink) continue;
    TRY(sink->commit());
  }
  for (auto& file : others_) {
    if (!file) continue;
    TRY(file->commit());
  }
  for (OutputFile& file : sidecars_) {
    TRY(file.commit());
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

}  // namespace retarget
