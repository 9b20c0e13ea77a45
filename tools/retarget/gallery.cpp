// `retarget view FOLDER`: pages of a batch, and one that lists them.

#include "gallery.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "base/file.h"
#include "base/machine.h"
#include "base/number_text.h"
#include "base/suggest.h"
#include "base/try.h"
#include "batch/process_pool.h"
#include "batch/summary.h"
#include "gallery_batch.h"
#include "interrupt.h"
#include "measure_files.h"
#include "provenance/hash.h"
#include "shared_arguments.h"
#include "view/gallery.h"
#include "view/strip.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPages = "clips";
// how answers of workers begin
constexpr char kNoMotion = '-', kNoPage = '!';

// a name of an address, the same whenever the clip's and the robot's are
Result<std::string> address_name(const ManifestEntry& entry) {
  constexpr std::size_t kLongest = 60;
  std::string name = entry.relative + "-" + entry.robot;
  TRY_ASSIGN(const std::string hash, hash_bytes(entry.relative + '\0' + entry.robot));
  for (char& letter : name) {
    const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                       (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
    if (!plain) letter = '_';
  }
  return name.substr(0, kLongest) + "-" + hash.substr(std::string_view("sha256:").size(), 8);
}

// a clip of the gallery and what it is made from
struct GalleryTask {
  const ManifestEntry* entry = nullptr;
  std::size_t clip = 0;
  PageLinks links;
};

class GalleryMaker {
 public:
  GalleryMaker(const ViewArguments& arguments, BatchFolder batch, Console& console)
      : arguments_(arguments),
        batch_(std::move(batch)),
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
    return write_file((folder_ / "index.html").string(),
                      gallery_page(folder.filename().string(), clips_));
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
    if (!is_file(entry.input.file)) sources_.push_back(entry.input.file);
    TRY_ASSIGN(const std::string name, address_name(entry));
    clip.page = fmt::format("{}/{}.html", kPages, name);
    clip.picture = fmt::format("{}/{}.png", kPages, name);
    tasks_.push_back({&entry, clips_.size(), {}});
    return {};
  }

  // of a page beside another one
  [[nodiscard]] std::string page_name(const GalleryTask& task) const {
    return fs::path(clips_[task.clip].page).filename().string();
  }

  Result<void> make_folders() {
    std::error_code error;
    fs::create_directories(folder_ / kPages, error);
    if (error)
      return run_failure((folder_ / kPages).string(), "cannot make the folder: " + error.message());
    return {};
  }

  // page and picture of a clip; what is missing on the page, or nothing
  Result<std::string> make_page(const GalleryTask& task) const {
    Console silent(true);
    const GalleryClip& clip = clips_[task.clip];
    ViewArguments arguments = arguments_of(batch_, *task.entry, arguments_);
    std::string lacks;
    auto measures = load_measures(arguments, silent);
    if (!measures && !arguments.run.run.motion.empty()) {
      // a source that has changed must not keep its motion from being seen
      lacks = "without its source: " + describe(measures.error(), option_as_flag);
      arguments.run.run.motion.clear();
      arguments.run.run.options.part = {};
      measures = load_measures(arguments, silent);
    }
    if (!measures) return failure(measures.error());
    TRY_ASSIGN(const MeasuredMotion motion,
               measure_file(arguments.motions.front(), *measures, silent));
    const PageMotion shown{arguments.labels.front(), &motion.clip, motion.human, &motion.report,
                           &measures->limits};
    TRY_ASSIGN(const std::string page,
               view_page({&shown, 1}, {clip.name, arguments_.meshes, task.links}));
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

  // what the index says of it; where there is no motion to be played, kNoMotion comes first
  std::string done_page(const GalleryTask& task) const {
    const auto made = make_page(task);
    if (made) return *made;
    const GalleryClip& clip = clips_[task.clip];
    const std::string message = describe(made.error(), option_as_flag);
    const auto noted = write_file((folder_ / clip.page).string(),
                                  gallery_note_page(clip.name, message, task.links));
    return (noted ? kNoMotion : kNoPage) + message;
  }

  void take_answer(const GalleryTask& task, const TaskEnd& end) {
    GalleryClip& clip = clips_[task.clip];
    std::string answer =
        end.answered ? end.answer : kNoPage + std::string("its page could not be made");
    const bool no_page = answer.starts_with(kNoPage), no_motion = answer.starts_with(kNoMotion);
    if (no_page || no_motion) {
      answer.erase(0, 1);
      clip.picture.clear();
      ++unshown_;
    }
    if (no_page) clip.page.clear();
    clip.message = std::move(answer);
  }

  Result<void> make_pages() {
    ProcessPoolOptions pool;
    pool.workers = std::max(1, std::min<int>(usable_cores(), static_cast<int>(tasks_.size())));
    pool.end_process = [](int code) { ::_exit(code); };
    pool.begin_worker = leave_interrupts_to_parent;
    pool.keep_going = [this] { return !console_.is_stopped(); };
    const std::vector<std::uint64_t> memory(tasks_.size(), 0);
    std::size_t done = 0;
    auto ran = run_in_processes(
        memory, pool, [this](std::size_t i) { return done_page(tasks_[i]); },
        [&](std::size_t i, const TaskEnd& end) {
          take_answer(tasks_[i], end);
          console_.status(fmt::format("page {} of {}", ++done, tasks_.size()));
        });
    console_.end_progress();
    return ran;
  }

  const ViewArguments& arguments_;
  const BatchFolder batch_;
  const fs::path folder_;
  Console& console_;
  std::vector<GalleryClip> clips_;              // the worst first
  std::vector<GalleryTask> tasks_;              // in the same order
  std::vector<std::string> missing_, sources_;  // files that are no longer there
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
  if (!arguments.run.run.motion.empty() || !arguments.png.empty() || !arguments.labels.empty()) {
    return usage_failure(
        "--bvh, --smpl, --png and --label are for motions, not for a folder of them");
  }
  if (fs::equivalent(output, arguments.motions.front(), ignored)) {
    return usage_failure("the gallery would be put among the batch's own files",
                         "name another folder, such as " + (fs::path(output) / "gallery").string());
  }
  fs::path folder = fs::path(output).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return check_output_folder(folder.string());
}

}  // namespace

Result<void> write_gallery(const ViewArguments& arguments, Console& console) {
  TRY(check_gallery(arguments));
  TRY_ASSIGN(BatchFolder batch, read_batch_folder(arguments.motions.front()));
  const RobotChoice& robot = arguments.run.run.robot;
  if (!robot.name.empty() || !robot.model.empty()) {
    TRY(load_robot(robot, arguments.run.common, console, Soles::kAsTheyAre));
  }
  GalleryMaker maker(arguments, std::move(batch), console);
  TRY(maker.make());
  maker.tell();
  return {};
}

}  // namespace retarget::cli
