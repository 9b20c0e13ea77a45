#include "app/run/outputs.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <new>
#include <system_error>
#include <utility>

#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kChunkFrames = 64;

bool is_csv(MotionFormat format) {
  return format == MotionFormat::kCsv || format == MotionFormat::kCsvSoma;
}

WriteMotionOptions with_surroundings(WriteMotionOptions write, const OutputMotion& motion) {
  write.human = motion.human;
  write.contacts = motion.contacts;
  write.scene = motion.scene;
  write.labels = motion.labels;
  return write;
}

}  // namespace

Result<std::unique_ptr<CsvSink>> CsvSink::open(const std::string& path,
                                               std::shared_ptr<const Robot> robot,
                                               const Options& options) {
  std::optional<OutputFile> file;
  if (!path.empty()) {
    TRY_ASSIGN(file, OutputFile::create(path));
  }
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  return std::unique_ptr<CsvSink>(
      new CsvSink(std::move(file), std::move(hasher), std::move(robot), options));
}

CsvSink::CsvSink(std::optional<OutputFile> file, ContentHasher hasher,
                 std::shared_ptr<const Robot> robot, const Options& options)
    : file_(std::move(file)),
      robot_(std::move(robot)),
      options_(options),
      formatter_(*robot_, options.csv),
      text_(formatter_.header()),
      hasher_(std::move(hasher)) {
  const std::size_t room = kChunkFrames * robot_->zero_configuration().size();
  filling_.reserve(room);
  waiting_.reserve(room);
  writing_.reserve(room);
  try {
    writer_ = std::thread([this] { write_chunks(); });
  } catch (const std::system_error&) {
    // Without a thread, write in the caller's thread.
  }
}

CsvSink::~CsvSink() {
  if (!writer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_all();
  writer_.join();
}

void CsvSink::add(std::span<const double> qpos) {
  filling_.insert(filling_.end(), qpos.begin(), qpos.end());
  if (filling_.size() == kChunkFrames * qpos.size()) hand_over();
}

void CsvSink::hand_over() {
  if (!writer_.joinable()) {
    write_frames(filling_);
    filling_.clear();
    return;
  }
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_.empty(); });
    std::swap(waiting_, filling_);
  }
  changed_.notify_all();
}

void CsvSink::write_chunks() {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return done_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      std::swap(writing_, waiting_);
    }
    changed_.notify_all();
    write_frames(writing_);
    writing_.clear();
  }
}

void CsvSink::write_frames(std::vector<double>& frames) {
  if (!written_) return;
  const std::size_t width = robot_->zero_configuration().size();
  try {
    for (std::size_t begin = 0; begin < frames.size(); begin += width) {
      const auto qpos = std::span<double>(frames).subspan(begin, width);
      if (options_.normalize_start) {
        if (!normalizer_) normalizer_.emplace(qpos);
        normalizer_->apply(qpos);
      }
      formatter_.append_line(qpos, text_, frames_++);
    }
  } catch (const std::bad_alloc&) {
    written_ = run_failure("", "not enough memory for a line of the output");
    return;
  }
  if (!file_ || !file_->is_direct()) write_text();
}

void CsvSink::write_text() {
  hasher_.update(text_);
  if (file_) written_ = file_->write(text_);
  text_.clear();
}

Result<std::string> CsvSink::flush() {
  if (!filling_.empty()) hand_over();
  if (writer_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_all();
    writer_.join();
  }
  // Also writes the header of a clip without frames.
  if (written_) write_text();
  if (!written_) return failure(written_.error());
  return hasher_.finish();
}

Result<void> CsvSink::commit() {
  return file_ ? file_->commit() : Result<void>();
}

Result<std::unique_ptr<MotionOutputs>> MotionOutputs::open(
    const std::string& output, const SaveOptions& options,
    const std::shared_ptr<const Robot>& robot, const FrameRate& rate, Purpose purpose) {
  std::unique_ptr<MotionOutputs> outputs(new MotionOutputs());
  outputs->options_ = options;
  const bool in_memory = outputs->in_memory_ = purpose == Purpose::kHash;
  TRY_ASSIGN(outputs->items_, plan_outputs(output, options));
  outputs->write_options_ = write_options(output, options);
  TrackingOptions& tracking = outputs->write_options_.tracking;
  if (purpose == Purpose::kConversion) tracking = conversion_options(tracking, rate);
  TRY_ASSIGN(outputs->reference_, reference_path(output, options));
  for (const OutputItem& item : outputs->items_) {
    outputs->sinks_.push_back(nullptr);
    if (!is_csv(item.format)) {
      // Create the target now, so that an error occurs before the work.
      outputs->others_.emplace_back();
      if (in_memory) continue;
      TRY_ASSIGN(outputs->others_.back(), MotionTarget::create(item));
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

Result<void> MotionOutputs::write_others(std::span<const OutputMotion> motions,
                                         std::vector<Error>* left_out) {
  std::vector<RobotClip> moved;
  std::vector<WriteMotionOptions> writes;
  std::vector<FrameRate> rates;
  for (const OutputMotion& motion : motions) {
    rates.push_back(motion.clip->rate());
    moved.push_back(*motion.clip);
    writes.push_back(with_surroundings(write_options_, motion));
    if (options_.normalize_start) {
      // All files of a run share one world: that of the frames given to add().
      normalize_start(StartNormalizer(*motions.front().clip), moved.back(), writes.back());
    }
  }
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (sinks_[i]) continue;
    const std::size_t chosen = motion_of_format(items_[i].format, options_, rates);
    auto files = format_motion_files(moved[chosen], items_[i].format, writes[chosen]);
    if (!files) {
      if (files.error().location.file.empty()) files.error().location.file = items_[i].path;
      const bool may_lack = left_out != nullptr && files.error().kind == ErrorKind::kInput;
      if (!may_lack || left_out->size() + 1 == items_.size()) return failure(files.error());
      left_out->push_back(std::move(files.error()));
      others_[i].reset();
      continue;
    }
    TRY_ASSIGN(auto hash, hash_files(*files));
    const MotionFormat format = items_[i].format;
    written_[i] = {items_[i],
                   std::move(hash),
                   {},
                   format_frame_count(moved[chosen], format, write_options_.tracking),
                   rate_of_format(format, options_, rates[chosen])};
    if (in_memory_) continue;
    TRY(others_[i]->write(*files));
  }
  return {};
}

Result<std::vector<WrittenFile>> MotionOutputs::finish(std::span<const OutputMotion> motions,
                                                       const SidecarText& sidecar,
                                                       std::vector<Error>* left_out) {
  written_.resize(items_.size());
  TRY(write_others(motions, left_out));
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (!sinks_[i]) continue;
    TRY_ASSIGN(auto hash, sinks_[i]->flush());
    const RobotClip& clip = *motions.front().clip;
    written_[i] = {items_[i], std::move(hash), {}, clip.frame_count(), clip.rate()};
  }
  std::erase_if(written_, [](const WrittenFile& file) { return file.hash.empty(); });
  if (sidecar) {
    for (WrittenFile& written : written_) {
      TRY_ASSIGN(written.sidecar, sidecar(written));
    }
  }
  if (in_memory_) return written_;
  for (const WrittenFile& written : written_) {
    if (written.sidecar.empty()) continue;
    TRY_ASSIGN(auto file, OutputFile::create(written.item.path + ".json"));
    TRY(file.write(written.sidecar));
    sidecars_.push_back(std::move(file));
  }
  TRY(write_beside(motions.front()));
  TRY(commit());
  return written_;
}

Result<void> MotionOutputs::write_beside(const OutputMotion& motion) {
  if (options_.contacts.empty() && options_.scene_out.empty() && reference_.empty()) return {};
  RobotClip moved = *motion.clip;
  WriteMotionOptions write = with_surroundings(write_options_, motion);
  if (options_.normalize_start) normalize_start(StartNormalizer(moved), moved, write);
  TRY_ASSIGN(FilesBeside beside,
             write_files_beside(reference_, moved, write, options_, motion.limits));
  std::ranges::move(beside.files, std::back_inserter(sidecars_));
  lines_ = std::move(beside.lines);
  return {};
}

Result<void> MotionOutputs::commit() {
  for (const auto& sink : sinks_) {
    if (sink) TRY(sink->commit());
  }
  for (auto& target : others_) {
    if (target) TRY(target->commit());
  }
  for (OutputFile& file : sidecars_) TRY(file.commit());
  return {};
}

Result<std::string> hash_files(const std::vector<FormattedFile>& files) {
  if (files.size() == 1 && files.front().name.empty()) return hash_bytes(files.front().bytes);
  std::map<std::string, std::string> hashes;  // Sorted by name, as when a folder is read.
  for (const FormattedFile& file : files) {
    TRY_ASSIGN(hashes[file.name], hash_bytes(file.bytes));
  }
  std::string listed;
  for (const auto& [name, hash] : hashes) listed += name + " " + hash + "\n";
  return hash_bytes(listed);
}

std::size_t motion_of_format(MotionFormat format, const SaveOptions& options,
                             std::span<const FrameRate> rates) {
  const FrameRate wanted = rate_of_format(format, options, rates.front());
  for (std::size_t i = 0; i < rates.size(); ++i) {
    if (same_rate(rates[i], wanted)) return i;
  }
  return 0;
}

std::string frames_text(int frames, const FrameRate& rate) {
  return count_text(frames, "frame") + " at " + to_text(rate) + " fps";
}

std::string outputs_text(std::span<const WrittenFile> files, const RobotClip* motion) {
  std::vector<std::string> names;
  for (const WrittenFile& file : files) {
    names.push_back(file.item.path == "-" ? "standard output" : file.item.path);
    if (motion == nullptr) continue;
    if (file.frames == motion->frame_count() && same_rate(file.rate, motion->rate())) continue;
    names.back() += " (" + frames_text(file.frames, file.rate) + ")";
  }
  return list_names(names);
}

void warn_of_losses(const RobotClip& motion, std::span<const WrittenFile> files,
                    const SaveOptions& options, Observer& observer) {
  for (const WrittenFile& file : files) {
    const MotionFormat format = file.item.format;
    const FrameRate rate = rate_of_format(format, options, motion.rate());
    for (const std::string& loss : format_losses(motion, format, rate)) {
      observer.warn({{0, 0, loss}}, file.item.path);
    }
  }
}

Result<std::vector<WrittenFile>> write_motion(const RobotClip& clip,
                                              const std::optional<FootContacts>& contacts,
                                              const std::string& output, const SaveOptions& options,
                                              Observer& observer) {
  TRY_ASSIGN(const auto outputs,
             MotionOutputs::open(output, options, clip.shared_robot(), clip.rate(),
                                 MotionOutputs::Purpose::kConversion));
  for (int frame = 0; frame < clip.frame_count(); ++frame) outputs->add(clip.qpos(frame));
  const OutputMotion written{&clip, std::nullopt, contacts};
  TRY_ASSIGN(auto files, outputs->finish({&written, 1}));
  observer.lines(outputs->lines());
  warn_of_losses(clip, files, options, observer);
  std::string text = outputs_text(files) + ": " + frames_text(clip.frame_count(), clip.rate());
  for (const WrittenFile& file : files) {
    if (same_rate(file.rate, clip.rate())) continue;
    text += "; " + std::string(format_name(file.item.format)) + " resampled to " +
            frames_text(file.frames, file.rate);
  }
  observer.line("wrote", text);
  return files;
}

}  // namespace retarget
