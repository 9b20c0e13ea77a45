#include "batch/batch_worker.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "batch/certify_clip.h"
#include "batch/data_set.h"
#include "batch/duplicates.h"
#include "batch/input_variants.h"
#include "retarget/certificate.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxWarnings = 20, kMaxNotes = 20;

// First character of an answer; the manifest line follows.
constexpr char kFinished = 'f', kUnchanged = 'u';

// Collects the messages of a clip's run, and the signature of its motion, for its manifest line.
class ClipNotes : public Observer {
 public:
  // Without `wants_signature`, planned() does nothing.
  ClipNotes(const Observer& batch, bool wants_signature)
      : batch_(batch), wants_signature_(wants_signature), deadline_(task_deadline()) {}

  void line(std::string_view label, std::string_view text) override {
    if (label == "taken as") taken_as = text;
    // A line without a label continues the one before.
    if (!label.empty()) is_note_ = label == "cleaned" || label == "fit";
    if (is_note_) notes.emplace_back(text);
  }
  void warn(const std::vector<Warning>& told, std::string_view file) override {
    // Manifests are read by command-line users, so spell options as flags.
    for (const Warning& each : told) warnings.push_back(describe(each, file, option_as_flag));
  }
  [[nodiscard]] bool is_stopped() const override {
    return batch_.is_stopped() || (deadline_ && std::chrono::steady_clock::now() >= *deadline_);
  }
  void planned(const Plan& plan) override {
    if (wants_signature_) signature = signature_of(plan);
  }

  std::string taken_as;
  std::string signature;
  std::vector<std::string> warnings;
  std::vector<std::string> notes;  ///< Corrections of the source, and notes of the fit.

 private:
  bool is_note_ = false;  // Whether the last line with a label was a note.
  const Observer& batch_;
  const bool wants_signature_;
  const std::optional<std::chrono::steady_clock::time_point> deadline_;
};

// Spells options as flags, since manifests and summaries are read by command-line users.
Error spelled(Error error) {
  error.message = spell_options(error.message, option_as_flag);
  for (std::string& detail : error.details) detail = spell_options(detail, option_as_flag);
  error.hint = spell_options(error.hint, option_as_flag);
  return error;
}

// Replaces the texts beyond the first `most` by their number.
std::vector<std::string> first_of(std::vector<std::string> texts, std::size_t most,
                                  const std::string& kind) {
  const std::size_t more = texts.size() - std::min(texts.size(), most);
  texts.resize(texts.size() - more);
  if (more > 0) texts.push_back("and " + std::to_string(more) + " more " + kind);
  return texts;
}

}  // namespace

ManifestEntry BatchWorker::entry_of(const BatchTask& task) const {
  ManifestEntry entry;
  entry.relative = task.input->relative;
  entry.robot = task.robot->name;
  entry.options_hash = task.robot->fingerprint.hash;
  entry.input.file = task.input->path;
  entry.input.bytes = task.input->bytes;
  entry.variant = task.input->variant;
  entry.signature = task.input->signature;
  return entry;
}

Result<void> BatchWorker::run(const BatchTask& task, double memory_gb, const std::string& output,
                              ManifestEntry& entry) const {
  Run one = run_of_clip(*task.robot, *task.input, memory_gb);
  one.output = output;
  if (request_.contacts) {
    one.options.save.contacts =
        context_.output_folder + "/" + task.robot->folder + contacts_output(task.input->relative);
  }
  RunRequest request = task.robot->request;
  request.threads = threads_;
  request.mirror = task.input->variant.is_mirrored();
  request.partial = true;
  // Every manifest line has a signature, so that lists can be split later without reading the clips
  // again. Mirror images and variations share those of their originals.
  ClipNotes notes(context_.observer, entry.signature.empty() && !task.input->variant.is_derived());
  const auto outcome = run_to_files(one, request, task.robot->setup, notes);
  if (!notes.signature.empty()) entry.signature = std::move(notes.signature);
  entry.taken_as = std::move(notes.taken_as);
  entry.warnings = first_of(std::move(notes.warnings), kMaxWarnings, "warnings");
  entry.notes = first_of(std::move(notes.notes), kMaxNotes, "notes");
  if (!outcome) return failure(outcome.error());
  entry.frames = outcome->frames;
  entry.fps = outcome->fps;
  entry.config = recorded_name(outcome->config, task.robot->setup.loaded.data_folder);
  if (outcome->quality) entry.quality = clip_quality(*outcome->quality);
  std::vector<std::string> files;
  for (const WrittenFile& motion : outcome->motions) {
    if (!format_is_folder(motion.item.format)) {
      files.push_back(motion.item.path);
      continue;
    }
    for (const fs::path& file : files_in_folder(motion.item.path))
      files.push_back(file.generic_string());
  }
  files.insert(files.end(), outcome->others.begin(), outcome->others.end());
  if (request_.certify) RETARGET_TRY(certify(task, one, *outcome, entry, files));
  const auto below_output = [&](const std::string& file) {
    return file.substr(context_.output_folder.size() + 1);
  };
  for (const std::string& file : files) {
    RETARGET_TRY_ASSIGN(auto record, record_file(file, below_output(file), FileUse::kOutput));
    entry.outputs.push_back(std::move(record));
  }
  for (const Error& error : outcome->left_out) {
    entry.not_written.push_back({below_output(error.location.file), error.message});
  }
  if (!entry.not_written.empty()) remove_outputs(task, entry.not_written);
  return {};
}

// Adds the certificate to the files of a clip. A motion that cannot be certified, such as that of
// two frames, still counts as done; gates on metrics of certificates do not select it.
Result<void> BatchWorker::certify(const BatchTask& task, const Run& run, const RunOutcome& outcome,
                                  ManifestEntry& entry, std::vector<std::string>& files) const {
  std::vector<OutputItem> items;
  for (const WrittenFile& motion : outcome.motions) items.push_back(motion.item);
  const OutputItem* const item = certified_item(items);
  if (item == nullptr || !entry.quality) return {};
  auto file = certify_clip(run, task.input->variant.is_mirrored(), request_.gates, item->path,
                           request_.data_folder, context_.observer, *entry.quality);
  if (file) {
    files.push_back(*std::move(file));
  } else if (file.error().kind == ErrorKind::kInterrupted) {
    return failure(std::move(file).error());
  } else {
    entry.warnings.push_back("no certificate: " + full_message(spelled(std::move(file).error())));
  }
  const std::optional<Gates>& gates = task.robot->request.gates;
  if (gates) judge_quality(*gates, *entry.quality);
  return {};
}

// Removes outputs of earlier runs for a clip whose file is no longer valid, unless they were
// changed since.
void BatchWorker::remove_outputs(const BatchTask& task,
                                 const std::vector<MissingFile>& only) const {
  const auto is_meant = [&](const std::string& file) {
    return only.empty() || std::ranges::any_of(only, [&](const MissingFile& each) {
             // The motion itself, its sidecar or certificate, or a file in its folder.
             return file == each.file || file == each.file + ".json" ||
                    file == certificate_file(each.file) || file.starts_with(each.file + "/");
           });
  };
  std::error_code ignored;
  for (const std::string& file :
       context_.finished.outputs_of(task.input->relative, task.robot->name, true)) {
    if (!is_meant(file)) continue;
    const fs::path path = context_.output_folder + "/" + file;
    fs::remove(path, ignored);
    // Remove the folder of a motion that was a folder, once it is empty.
    if (path.parent_path().filename() == fs::path(task.input->relative).stem()) {
      fs::remove(path.parent_path(), ignored);
    }
  }
}

Result<void> BatchWorker::solve(const BatchTask& task, double memory_gb,
                                ManifestEntry& entry) const {
  RETARGET_TRY_ASSIGN(entry.input,
                      record_file(task.input->path, task.input->path, FileUse::kInput));
  const std::string output = context_.output_folder + "/" + task.robot->folder +
                             batch_output(task.robot->run.options.save, task.input->relative);
  std::error_code error;
  fs::create_directories(fs::path(output).parent_path(), error);
  if (error) {
    return run_failure(
        fs::path(output).parent_path().generic_string(),
        "cannot create the folder: " + std::generic_category().message(error.value()));
  }
  auto done = run(task, memory_gb, output, entry);
  if (!done) {
    if (done.error().location.file.empty()) done.error().location.file = task.input->path;
    // Keep the outputs after other errors: a wrong option or a full disk does not invalidate them.
    if (done.error().kind == ErrorKind::kInput) remove_outputs(task);
  }
  return done;
}

// The entry of a clip whose outputs are still up to date.
std::optional<ManifestEntry> BatchWorker::done_already(const BatchTask& task) const {
  if (task.candidate == nullptr) return std::nullopt;
  if (!context_.finished.still_holds(*task.candidate, task.input->path)) return std::nullopt;
  // Record the new timestamps, so that the next run need not read the files.
  ManifestEntry entry = *task.candidate;
  if (!task.input->signature.empty()) entry.signature = task.input->signature;
  const auto input = record_file(task.input->path, task.input->path, FileUse::kInput);
  if (!input || input->hash != entry.input.hash) return std::nullopt;
  entry.input = *input;
  for (FileRecord& output : entry.outputs) {
    const auto now =
        record_file(context_.output_folder + "/" + output.file, output.file, FileUse::kOutput);
    if (!now || now->hash != output.hash) return std::nullopt;
    output = *now;
  }
  return entry;
}

// The entry of a clip whose process ended without an answer.
ManifestEntry BatchWorker::entry_of_ended(const BatchTask& task, const TaskEnd& end) const {
  ManifestEntry entry = entry_of(task);
  Error& error = entry.error.emplace();
  error.location.file = task.input->path;
  if (end.timed_out) {
    error.message = "the clip took longer than " + number_text(request_.clip_timeout_s, 3) +
                    " s and was terminated";
    error.hint = RETARGET_OPTION("clip-timeout") " allows more time";
  } else if (end.was_killed) {
    error.message = "the clip's process was killed externally; memory may have run out";
    error.hint = "fewer " RETARGET_OPTION("jobs") " leave more memory for each clip";
  } else {
    error.message = "the clip's process crashed" +
                    (end.signal == 0 ? std::string()
                                     : " with signal " + std::to_string(end.signal) + " (" +
                                           end.signal_name + ")");
    error.hint = "this is a bug in retarget; the other clips are not affected";
  }
  error = spelled(std::move(error));
  entry.exit_code = exit_code_of(error.kind);
  entry.finished = finished_now(context_.finished, entry);
  return entry;
}

void BatchWorker::take(const BatchTask& task, const TaskEnd& end) {
  // No answer means that the clip was interrupted.
  if (end.answered && end.answer.empty()) return;
  if (!end.answered && context_.observer.is_stopped()) return;
  std::optional<ManifestEntry> entry;
  if (end.answered) entry = parse_manifest_line(std::string_view(end.answer).substr(1));
  if (!entry) entry = entry_of_ended(task, end);
  // A clip that is not in the manifest would be solved again, so stop the batch.
  if (auto appended = context_.manifest.append(*entry); !appended) {
    if (!fatal_) fatal_ = std::move(appended.error());
    return;
  }
  if (end.answered && end.answer.front() == kUnchanged) {
    context_.progress.skipped(task.input->bytes);
  } else {
    context_.progress.finished(*entry);
  }
}

std::string BatchWorker::work(const BatchTask& task, double memory_gb) const {
  const auto start = std::chrono::steady_clock::now();
  ManifestEntry entry = entry_of(task);
  Result<void> done;
  try {
    if (const auto unchanged = done_already(task)) return kUnchanged + manifest_line(*unchanged);
    done = solve(task, memory_gb, entry);
  } catch (const std::bad_alloc&) {
    done = run_failure(task.input->path, "not enough memory for this clip",
                       "fewer " RETARGET_OPTION("jobs") " leave more memory for each clip");
  } catch (const std::exception& error) {
    done = run_failure(task.input->path, error.what());
  }
  if (!done && done.error().kind == ErrorKind::kInterrupted) return {};
  entry.done = done.has_value();
  if (!done) {
    entry.exit_code = exit_code_of(done.error().kind);
    entry.error = spelled(std::move(done.error()));
  }
  entry.finished = finished_now(context_.finished, entry);
  entry.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return kFinished + manifest_line(entry);
}

bool BatchWorker::keep_going() {
  context_.progress.show();
  return !fatal_ && !context_.observer.is_stopped();
}

Result<void> BatchWorker::result() {
  if (fatal_) return failure(*fatal_);
  if (context_.observer.is_stopped()) return interrupted_failure();
  return {};
}

}  // namespace retarget
