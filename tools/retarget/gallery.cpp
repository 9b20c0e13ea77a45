// `retarget view FOLDER`: pages of a batch, and one that lists them.

#include "gallery.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <set>
#include <system_error>

#include "base/file.h"
#include "base/machine.h"
#include "base/number_text.h"
#include "base/suggest.h"
#include "base/try.h"
#include "batch/clip_memory.h"
#include "batch/process_pool.h"
#include "batch/summary.h"
#include "gallery_batch.h"
#include "gallery_files.h"
#include "interrupt.h"
#include "measure_files.h"
#include "plan/memory.h"
#include "shared_arguments.h"
#include "view/gallery.h"
#include "view/strip.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// how answers of workers begin
constexpr char kNoMotion = '-';

// a clip of the gallery and what it is made from
struct GalleryTask {
  const ManifestEntry* entry = nullptr;
  std::size_t clip = 0;
  PageLinks links;
};

class GalleryMaker {
 public:
  /// @param robot  name of the one that the arguments name; empty: none is named.
  GalleryMaker(const ViewArguments& arguments, BatchFolder batch, std::string robot,
               Console& console)
      : arguments_(arguments),
        batch_(std::move(batch)),
        robot_(std::move(robot)),
        folder_(arguments.run.run.output),
        console_(console) {}

  Result<void> make() {
    TRY(plan());
    TRY(make_folders());
    const auto interrupts = console_.hold_interrupts();
    TRY(make_pages());
    if (console_.is_stopped()) {
      Failure stopped = interrupted_failure();
      stopped.value().message = "interrupted; the index was not written";
      return stopped;
    }
    fs::path folder = fs::path(batch_.folder).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    TRY(write_file((folder_ / "index.html").string(),
                   gallery_page(folder.filename().string(), clips_)));
    // only now does nothing lead to them any more
    std::set<std::string> kept;
    for (const GalleryClip& clip : clips_) {
      for (const std::string& file : {clip.page, clip.picture}) {
        kept.insert(fs::path(file).filename().string());
      }
    }
    remove_stale_pages(folder_ / kGalleryPages, kept);
    return {};
  }

  // what became of it, and what is missing, in one sentence each
  void tell() const {
    if (!missing_.empty()) {
      console_.warn({{0, 0,
                      (missing_.size() == 1 ? "a motion of the manifest is missing: "
                                            : count_text(missing_.size(), "motion") +
                                                  " of the manifest are missing: ") +
                          list_names(missing_, 3)}},
                    batch_.folder);
    }
    if (!sources_.empty()) {
      console_.warn(
          {{0, 0,
            count_text(sources_.size(), "clip") + (sources_.size() == 1 ? " is" : " are") +
                " shown without the source, which is no longer there: " + list_names(sources_, 3)}},
          batch_.folder);
    }
    if (unshown_ > 0) {
      console_.warn(
          {{0, 0, count_text(unshown_, "motion") + " cannot be shown: the index says why"}},
          batch_.folder);
    }
    if (batch_.unreadable > 0) {
      console_.warn(
          {{0, 0,
            count_text(batch_.unreadable, "line") + " of the manifest cannot be read and " +
                (batch_.unreadable == 1 ? "is" : "are") + " left out"}},
          batch_.folder);
    }
    console_.line("wrote", (folder_ / "index.html").string() + ": " +
                               count_text(clips_.size(), "clip") + ", " +
                               count_text(tasks_.size(), "page"));
  }

 private:
  Result<void> plan() {
    for (const ManifestEntry* entry : worst_first(batch_.entries)) {
      // there is another page of the same
      if (entry->is_left_out()) continue;
      GalleryClip clip;
      clip.name = entry->relative;
      clip.robot = entry->robot;
      clip.frames = entry->frames;
      clip.fps = entry->fps;
      clip.failed = !entry->done;
      if (entry->error) {
        clip.message =
            describe({entry->error->kind, entry->error->location, entry->error->message, {}, {}},
                     option_as_flag);
      }
      if (entry->quality) {
        clip.measured = true;
        clip.figures = entry->quality->figures;
        clip.missed = entry->quality->missed;
      }
      if (entry->done) TRY(add_page(*entry, clip));
      clips_.push_back(std::move(clip));
    }
    // the order of the index is that of the pages
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      PageLinks& links = tasks_[i].links;
      links.index = "../index.html";
      if (i > 0) links.previous = page_name(tasks_[i - 1]);
      if (i + 1 < tasks_.size()) links.next = page_name(tasks_[i + 1]);
    }
    return {};
  }

  Result<void> add_page(const ManifestEntry& entry, GalleryClip& clip) {
    const std::string motion = motion_of(batch_, entry);
    if (motion.empty() || !is_file(motion)) {
      const std::string file = entry.outputs.empty() ? entry.relative : entry.outputs.front().file;
      clip.message = motion.empty() ? "no format that can be read back was written"
                                    : "the motion is missing: " + file;
      if (!motion.empty()) missing_.push_back(file);
      return {};
    }
    if (!source_is_there(batch_, entry)) sources_.push_back(entry.input.file);
    TRY_ASSIGN(const std::string name, gallery_name(entry));
    clip.page = fmt::format("{}/{}.html", kGalleryPages, name);
    clip.picture = fmt::format("{}/{}.png", kGalleryPages, name);
    tasks_.push_back({&entry, clips_.size(), {}});
    return {};
  }

  // of a page beside another one
  [[nodiscard]] std::string page_name(const GalleryTask& task) const {
    return fs::path(clips_[task.clip].page).filename().string();
  }

  Result<void> make_folders() {
    std::error_code error;
    fs::create_directories(folder_ / kGalleryPages, error);
    if (error)
      return run_failure((folder_ / kGalleryPages).string(),
                         "cannot make the folder: " + error.message());
    return {};
  }

  // page and picture of a clip; what is missing on the page, or nothing
  Result<std::string> make_page(std::size_t i) const {
    const GalleryTask& task = tasks_[i];
    Console silent(true);
    const GalleryClip& clip = clips_[task.clip];
    if (find_motion(batch_, *task.entry).path.empty()) {
      return input_failure(motion_of(batch_, *task.entry),
                           "the motion has changed since the batch wrote it");
    }
    ShownEntry shown_entry = arguments_of(batch_, *task.entry, arguments_, robot_);
    ViewArguments& arguments = shown_entry.arguments;
    Run& run = arguments.run.run;
    run.options.source.memory_gb = memory_gb_[i];
    std::string lacks = shown_entry.lacks;
    auto measures = load_measures(arguments, silent);
    if (!measures && !run.motion.empty()) {
      // a source that cannot be read must not keep its motion from being seen
      lacks = describe(measures.error(), option_as_flag);
      forget_source(run);
      measures = load_measures(arguments, silent);
    }
    if (!measures) return failure(measures.error());
    if (!lacks.empty()) lacks = "without its source: " + lacks;
    TRY_ASSIGN(const MeasuredMotion motion,
               measure_file(arguments.motions.front(), *measures, silent));
    RobotMeshes meshes;
    // where nobody asks for them pages stay small: there are many
    if (!arguments_.meshes.empty()) {
      TRY_ASSIGN(meshes, load_robot_meshes(*measures->robot, measures->model, arguments_.meshes));
    }
    const PageMotion shown{arguments.labels.front(), &motion.clip, motion.human, &motion.report,
                           &measures->limits,        {},           &meshes};
    TRY_ASSIGN(
        const std::string page,
        view_page({&shown, 1}, {lacks.empty() ? clip.name : clip.name + ", " + lacks, task.links}));
    StripPictureOptions picture;
    picture.poses = 5;
    picture.width = kThumbnailWidth;
    picture.max_row_height = kThumbnailHeight;
    picture.times = false;
    TRY(write_file((folder_ / clip.picture).string(),
                   draw_strip_picture(motion.clip, nullptr, picture)));
    TRY(write_file((folder_ / clip.page).string(), page));
    return lacks;
  }

  Result<void> write_note(const GalleryTask& task, const std::string& message) const {
    const GalleryClip& clip = clips_[task.clip];
    return write_file((folder_ / clip.page).string(),
                      gallery_note_page(clip.name, message, task.links));
  }

  // what the index says of it; where there is no motion to be played, kNoMotion comes first
  std::string done_page(std::size_t i) const {
    try {
      const auto made = make_page(i);
      return made ? *made : kNoMotion + describe(made.error(), option_as_flag);
    } catch (const std::bad_alloc&) {
      return kNoMotion + std::string("there is not enough memory for its page");
    }
  }

  // every clip has its page, so that the ways from one to the next lead on
  Result<void> take_answer(const GalleryTask& task, const TaskEnd& end) {
    GalleryClip& clip = clips_[task.clip];
    std::string answer =
        end.answered ? end.answer : kNoMotion + std::string("its page could not be made");
    if (end.answered) ++answered_;
    if (answer.starts_with(kNoMotion)) {
      answer.erase(0, 1);
      clip.picture.clear();
      ++unshown_;
      TRY(write_note(task, answer));
    }
    clip.message = std::move(answer);
    return {};
  }

  // as the batch does, with the motion in the place of what is written
  void plan_memory(ProcessPoolOptions& pool, std::vector<std::uint64_t>& memory) {
    pool.memory = memory_bound(0.0);
    const std::uint64_t even = pool.memory / static_cast<std::uint64_t>(pool.workers);
    for (const GalleryTask& task : tasks_) {
      const std::string motion = motion_of(batch_, *task.entry);
      std::error_code ignored;
      const std::uintmax_t bytes = fs::file_size(motion, ignored);
      const std::uint64_t needed = memory_of_clip(task.entry->relative, task.entry->input.bytes) +
                                   (ignored ? 0 : memory_of_clip(motion, bytes));
      memory.push_back(std::max(needed, even));
      // one that needs more than there is runs alone
      memory_gb_.push_back(static_cast<double>(std::min(memory.back(), pool.memory)) / 1e9);
    }
    if (pool.memory == 0) return;
    pool.max_memory = std::max(pool.memory, *std::ranges::max_element(memory)) + kMemoryOfProcess;
  }

  Result<void> make_pages() {
    if (tasks_.empty()) return {};
    ProcessPoolOptions pool;
    pool.workers = std::max(1, std::min<int>(usable_cores(), static_cast<int>(tasks_.size())));
    pool.end_process = [](int code) { ::_exit(code); };
    pool.begin_worker = leave_interrupts_to_parent;
    Result<void> taken;
    pool.keep_going = [&] { return taken && !console_.is_stopped(); };
    std::vector<std::uint64_t> memory;
    plan_memory(pool, memory);
    std::size_t done = 0;
    auto ran = run_in_processes(
        memory, pool, [this](std::size_t i) { return done_page(i); },
        [&](std::size_t i, const TaskEnd& end) {
          auto noted = take_answer(tasks_[i], end);
          if (!noted && taken) taken = std::move(noted);
          console_.status(fmt::format("page {} of {}", ++done, tasks_.size()));
        });
    console_.end_progress();
    TRY(std::move(ran));
    TRY(std::move(taken));
    if (answered_ == 0 && !console_.is_stopped()) {
      return run_failure(folder_.string(),
                         "no page could be made: every process that began one was ended",
                         "perhaps memory ran out");
    }
    return {};
  }

  const ViewArguments& arguments_;
  const BatchFolder batch_;
  const std::string robot_;
  const fs::path folder_;
  Console& console_;
  std::vector<GalleryClip> clips_;              // the worst first
  std::vector<GalleryTask> tasks_;              // in the same order
  std::vector<std::string> missing_, sources_;  // files that are no longer there
  std::vector<double> memory_gb_;               // that each page may take
  std::size_t answered_ = 0;                    // pages whose processes came to their end
  int unshown_ = 0;
};

Result<void> check_gallery(const ViewArguments& arguments) {
  const std::string& output = arguments.run.run.output;
  if (arguments.motions.size() > 1) {
    return usage_failure("a gallery is of one folder",
                         "motions are played side by side by their files");
  }
  std::error_code ignored;
  if (output == "-" || (fs::exists(output, ignored) && !fs::is_directory(output, ignored)) ||
      (!fs::exists(output, ignored) && !fs::path(output).extension().empty() &&
       output.back() != '/')) {
    return usage_failure("a gallery is a folder, and the output is \"" + output + "\"",
                         "name a folder, such as gallery/");
  }
  if (!arguments.run.run.motion.empty() || !arguments.run.request.png.empty() ||
      !arguments.labels.empty()) {
    return usage_failure(
        "--bvh, --smpl, --png and --label are for motions, not for a folder of them");
  }
  fs::path folder = fs::path(output).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return check_output_folder(folder.string());
}

// the name of the robot that the call names, which the batch must have motions of; empty: none is named
Result<std::string> given_robot(const ViewArguments& arguments, const BatchFolder& batch,
                                Console& console) {
  const RobotChoice& choice = arguments.run.run.robot;
  if (choice.name.empty() && choice.model.empty()) return std::string();
  TRY_ASSIGN(const LoadedRobot loaded,
             load_robot(choice, arguments.run.common, console, Soles::kAsTheyAre));
  // as a batch names its robots
  std::string name = fs::path(loaded.robot->name()).filename().string();
  std::set<std::string> robots;
  for (const ManifestEntry& entry : batch.entries) robots.insert(entry.robot);
  if (robots.contains(name)) return name;
  return usage_failure(
      "the batch has no motions of the robot \"" + name + "\"",
      "it has those of " + list_names(std::vector<std::string>(robots.begin(), robots.end()), 5));
}

}  // namespace

Result<void> write_gallery(const ViewArguments& arguments, Console& console) {
  TRY(check_gallery(arguments));
  TRY_ASSIGN(BatchFolder batch, read_batch_folder(arguments.motions.front()));
  TRY(check_gallery_folder(arguments.run.run.output, batch));
  TRY_ASSIGN(std::string robot, given_robot(arguments, batch, console));
  GalleryMaker maker(arguments, std::move(batch), std::move(robot), console);
  TRY(maker.make());
  maker.tell();
  return {};
}

}  // namespace retarget::cli
