#include "retarget/gallery.h"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <filesystem>
#include <new>
#include <set>
#include <system_error>

#include "batch/batch_report.h"
#include "batch/find_inputs.h"
#include "batch/gallery_batch.h"
#include "batch/process_pool.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/machine.h"
#include "retarget/measure_files.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// First character of a worker's answer if there is no motion.
constexpr char kNoMotion = '-';

// A clip of the gallery with its sources.
struct GalleryTask {
  const ManifestEntry* entry = nullptr;
  std::size_t clip = 0;
  PageLinks links;
};

class GalleryMaker {
 public:
  /// @param robot  the name of the request's robot; empty: none.
  GalleryMaker(const GalleryRequest& request, BatchFolder batch, std::string robot,
               Observer& observer)
      : request_(request),
        batch_(std::move(batch)),
        robot_(std::move(robot)),
        folder_(request.output),
        observer_(observer) {}

  Result<void> make() {
    RETARGET_TRY(plan());
    RETARGET_TRY(make_folders());
    const auto interrupts = observer_.hold_interrupts();
    RETARGET_TRY(make_pages());
    if (observer_.is_stopped()) {
      Failure stopped = interrupted_failure();
      stopped.value().message = "interrupted; the index was not written";
      return stopped;
    }
    fs::path folder = fs::path(batch_.folder).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    RETARGET_TRY(write_file((folder_ / "index.html").generic_string(),
                            gallery_page(folder.filename().generic_string(), clips_)));
    // Remove old pages last, when nothing links to them any more.
    std::set<std::string> kept;
    for (const GalleryClip& clip : clips_) {
      for (const std::string& file : {clip.page, clip.picture}) {
        kept.insert(fs::path(file).filename().generic_string());
      }
    }
    remove_stale_pages(folder_ / kGalleryPages, kept);
    return {};
  }

  // Reports the result and missing files, one sentence each.
  void report() const {
    if (!missing_.empty()) {
      observer_.warn({{0, 0,
                       (missing_.size() == 1 ? "a motion of the manifest is missing: "
                                             : count_text(missing_.size(), "motion") +
                                                   " of the manifest are missing: ") +
                           list_names(missing_, 3)}},
                     batch_.folder);
    }
    if (!sources_.empty()) {
      observer_.warn(
          {{0, 0,
            count_text(sources_.size(), "clip") + (sources_.size() == 1 ? " is" : " are") +
                " shown without the source, which no longer exists: " + list_names(sources_, 3)}},
          batch_.folder);
    }
    if (unshown_ > 0) {
      observer_.warn(
          {{0, 0,
            count_text(unshown_, "motion") + " cannot be shown; the index gives the reasons"}},
          batch_.folder);
    }
    if (batch_.unreadable > 0) {
      observer_.warn(
          {{0, 0,
            count_text(batch_.unreadable, "line") + " of the manifest cannot be read and " +
                (batch_.unreadable == 1 ? "is" : "are") + " skipped"}},
          batch_.folder);
    }
    observer_.line("wrote", (folder_ / "index.html").generic_string() + ": " +
                                count_text(clips_.size(), "clip") + ", " +
                                count_text(tasks_.size(), "page"));
  }

 private:
  Result<void> plan() {
    for (const ManifestEntry* entry : worst_first(batch_.entries)) {
      // The clip repeats another one, which has its own page.
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
                     request_.spelling);
      }
      if (entry->quality) {
        clip.measured = true;
        clip.figures = entry->quality->figures;
        clip.missed = entry->quality->missed;
      }
      if (entry->done) RETARGET_TRY(add_page(*entry, clip));
      clips_.push_back(std::move(clip));
    }
    // Pages have the order in which the index opens.
    std::ranges::stable_sort(
        tasks_, {}, [this](const GalleryTask& task) { return opening_rank(clips_[task.clip]); });
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
      clip.message =
          motion.empty() ? "no readable format was written" : "the motion is missing: " + file;
      if (!motion.empty()) missing_.push_back(file);
      return {};
    }
    if (!source_is_there(batch_, entry)) sources_.push_back(entry.input.file);
    RETARGET_TRY_ASSIGN(const std::string name, gallery_name(entry));
    clip.page = fmt::format("{}/{}.html", kGalleryPages, name);
    clip.picture = fmt::format("{}/{}.png", kGalleryPages, name);
    tasks_.push_back({&entry, clips_.size(), {}});
    return {};
  }

  // Returns the file name of a page, relative to its neighbours.
  [[nodiscard]] std::string page_name(const GalleryTask& task) const {
    return fs::path(clips_[task.clip].page).filename().generic_string();
  }

  Result<void> make_folders() {
    std::error_code error;
    fs::create_directories(folder_ / kGalleryPages, error);
    if (error) {
      return run_failure((folder_ / kGalleryPages).generic_string(),
                         "cannot create the folder: " + error.message());
    }
    return {};
  }

  // Makes the page and thumbnail of a clip; returns a description of missing contents, if any.
  Result<std::string> make_page(std::size_t i) const {
    const GalleryTask& task = tasks_[i];
    Observer silent;
    const GalleryClip& clip = clips_[task.clip];
    if (find_motion(batch_, *task.entry).path.empty()) {
      return input_failure(motion_of(batch_, *task.entry),
                           "the motion has changed since the batch wrote it");
    }
    ShownEntry shown_entry = show_entry(batch_, *task.entry, request_, robot_);
    Run& run = shown_entry.request.run;
    run.options.source.memory_gb = memory_gb_[i];
    std::string lacks = shown_entry.lacks;
    auto measures = load_measures(shown_entry.request, silent);
    if (!measures && !run.motion.empty()) {
      // Show the motion even if its source cannot be read.
      lacks = describe(measures.error(), request_.spelling);
      forget_source(run);
      measures = load_measures(shown_entry.request, silent);
    }
    if (!measures) return failure(measures.error());
    if (!lacks.empty()) lacks = "without its source: " + lacks;
    RETARGET_TRY_ASSIGN(const MeasuredMotion motion,
                        measure_file(shown_entry.request.motions.front(), *measures, silent));
    RobotMeshes meshes;
    // Without the option, pages have no meshes: there are many pages, so each must be small.
    if (!request_.meshes.empty()) {
      RETARGET_TRY_ASSIGN(meshes,
                          load_robot_meshes(*measures->robot, measures->model, request_.meshes));
    }
    RETARGET_TRY_ASSIGN(const auto scene, measured_scene(motion, *measures));
    const PageMotion shown{shown_entry.label, &motion.clip, motion.human, &motion.report,
                           &measures->limits, {},           &meshes,      scene.get()};
    RETARGET_TRY_ASSIGN(
        const std::string page,
        view_page({&shown, 1}, {lacks.empty() ? clip.name : clip.name + ", " + lacks, task.links}));
    StripPictureOptions picture;
    picture.poses = 5;
    picture.width = kThumbnailWidth;
    picture.max_row_height = kThumbnailHeight;
    picture.times = false;
    RETARGET_TRY(write_file((folder_ / clip.picture).generic_string(),
                            draw_strip_picture(motion.clip, nullptr, picture)));
    RETARGET_TRY(write_file((folder_ / clip.page).generic_string(), page));
    for (const std::string& note : meshes.notes) lacks += (lacks.empty() ? "" : "; ") + note;
    return lacks;
  }

  Result<void> write_note(const GalleryTask& task, const std::string& message) const {
    const GalleryClip& clip = clips_[task.clip];
    return write_file((folder_ / clip.page).generic_string(),
                      gallery_note_page(clip.name, message, task.links));
  }

  // Text for the index; it begins with kNoMotion if there is no playable motion.
  std::string done_page(std::size_t i) const {
    try {
      const auto made = make_page(i);
      return made ? *made : kNoMotion + describe(made.error(), request_.spelling);
    } catch (const std::bad_alloc&) {
      return kNoMotion + std::string("not enough memory for its page");
    }
  }

  // Every clip gets a page, so that the links between pages are unbroken.
  Result<void> take_answer(const GalleryTask& task, const TaskEnd& end) {
    GalleryClip& clip = clips_[task.clip];
    std::string answer =
        end.answered ? end.answer : kNoMotion + std::string("its page could not be created");
    if (end.answered) ++answered_;
    if (answer.starts_with(kNoMotion)) {
      answer.erase(0, 1);
      clip.picture.clear();
      ++unshown_;
      RETARGET_TRY(write_note(task, answer));
    }
    clip.message = std::move(answer);
    return {};
  }

  // Plans memory as the batch does, with the motion in place of the output.
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
      // A page that needs more than the available memory runs alone.
      memory_gb_.push_back(static_cast<double>(std::min(memory.back(), pool.memory)) / 1e9);
    }
    if (pool.memory == 0) return;
    pool.max_memory = std::max(pool.memory, *std::ranges::max_element(memory)) + kMemoryOfProcess;
  }

  Result<void> make_pages() {
    if (tasks_.empty()) return {};
    ProcessPoolOptions pool;
    pool.workers = std::max(1, std::min<int>(usable_cores(), static_cast<int>(tasks_.size())));
    pool.end_process = ::_exit;
    pool.begin_worker = request_.begin_worker;
    Result<void> taken;
    pool.keep_going = [&] { return taken && !observer_.is_stopped(); };
    std::vector<std::uint64_t> memory;
    plan_memory(pool, memory);
    std::size_t done = 0;
    auto ran = run_in_processes(
        memory, pool, [this](std::size_t i) { return done_page(i); },
        [&](std::size_t i, const TaskEnd& end) {
          auto noted = take_answer(tasks_[i], end);
          if (!noted && taken) taken = std::move(noted);
          observer_.status(fmt::format("page {} of {}", ++done, tasks_.size()));
        });
    observer_.end_progress();
    RETARGET_TRY(std::move(ran));
    RETARGET_TRY(std::move(taken));
    if (answered_ == 0 && !observer_.is_stopped()) {
      return run_failure(folder_.generic_string(),
                         "no page could be created: all worker processes ended early",
                         "memory may have run out");
    }
    return {};
  }

  const GalleryRequest& request_;
  const BatchFolder batch_;
  const std::string robot_;
  const fs::path folder_;
  Observer& observer_;
  std::vector<GalleryClip> clips_;              // Worst first.
  std::vector<GalleryTask> tasks_;              // By opening_rank.
  std::vector<std::string> missing_, sources_;  // Files that no longer exist.
  std::vector<double> memory_gb_;               // Memory limit of each page.
  std::size_t answered_ = 0;                    // Pages whose processes finished.
  int unshown_ = 0;
};

// Returns the name of the request's robot, which must occur in the batch; empty if it has none.
Result<std::string> given_robot(const GalleryRequest& request, const BatchFolder& batch,
                                Observer& observer) {
  const RobotChoice& choice = request.robot;
  if (choice.name.empty() && choice.model.empty()) return std::string();
  RETARGET_TRY_ASSIGN(const LoadedRobot loaded,
                      load_robot(choice, request.data_folder, observer, Soles::kAsTheyAre));
  // Batches name robots this way.
  std::string name = fs::path(loaded.robot->name()).filename().generic_string();
  std::set<std::string> robots;
  for (const ManifestEntry& entry : batch.entries) robots.insert(entry.robot);
  if (robots.contains(name)) return name;
  return usage_failure("the batch has no motions for the robot \"" + name + "\"",
                       "it has motions for " +
                           list_names(std::vector<std::string>(robots.begin(), robots.end()), 5));
}

}  // namespace

Result<void> write_gallery(const GalleryRequest& request, Observer& observer) {
  RETARGET_TRY_ASSIGN(BatchFolder batch, read_batch_folder(request.batch));
  RETARGET_TRY(check_gallery_folder(request.output, batch));
  RETARGET_TRY_ASSIGN(std::string robot, given_robot(request, batch, observer));
  GalleryMaker maker(request, std::move(batch), std::move(robot), observer);
  RETARGET_TRY(maker.make());
  maker.report();
  return {};
}

}  // namespace retarget
