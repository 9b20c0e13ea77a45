#include "batch/duplicates.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>
#include <tuple>
#include <utility>

#include "retarget/load.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::size_t kMeans = kSignatureNumbers;
constexpr std::size_t kDimensions = kMeans + 1;  // The last dimension is the duration.
constexpr float kSignatureScale = 127.0F;

// Summary of a clip: the means of its numbers and its duration.
using Summary = std::array<float, kDimensions>;

Summary summary_of(const MotionSignature& signature) {
  Summary summary{};
  for (std::size_t i = 0; i < signature.samples.size(); ++i) {
    summary[i % kSignatureNumbers] += signature.samples[i];
  }
  for (std::size_t i = 0; i < kMeans; ++i) {
    summary[i] /= kSignatureScale * static_cast<float>(std::max<std::size_t>(1, signature.count()));
  }
  summary[kMeans] = static_cast<float>(signature.seconds);
  return summary;
}

// Maximum difference of the summaries of one movement. Trimming changes short clips more.
struct Reach {
  float means = 0.0F, seconds = 0.0F;

  explicit Reach(double length)
      : means(static_cast<float>(0.05 + 0.25 / std::max(1.0, length))),
        seconds(static_cast<float>(signature_tolerance(length))) {}
  [[nodiscard]] float along(std::size_t dimension) const {
    return dimension == kMeans ? seconds : means;
  }
};

// A k-d tree that splits points along their widest dimension.
class SummaryTree {
 public:
  explicit SummaryTree(const std::vector<Summary>& points)
      : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (!order_.empty()) build(0, order_.size());
  }

  // Visits the points within reach in every dimension.
  template <typename Visit>
  void find(const Summary& center, const Reach& reach, const Visit& visit) const {
    if (!nodes_.empty()) find(0, center, reach, visit);
  }

 private:
  static constexpr std::size_t kLeaf = 12;
  struct Node {
    std::size_t begin = 0, end = 0;  // Range in order_.
    std::size_t dimension = 0;
    float split = 0.0F;
    std::size_t left = 0, right = 0;  // Child nodes; 0: a leaf.
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t index = nodes_.size();
    nodes_.push_back({begin, end, widest(begin, end), 0.0F, 0, 0});
    if (end - begin <= kLeaf) return index;
    const std::size_t dimension = nodes_[index].dimension, middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t place) {
      return order_.begin() + static_cast<std::ptrdiff_t>(place);
    };
    std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
      return std::pair(points_[a][dimension], a) < std::pair(points_[b][dimension], b);
    });
    nodes_[index].split = points_[order_[middle]][dimension];
    const std::size_t left = build(begin, middle), right = build(middle, end);
    nodes_[index].left = left;
    nodes_[index].right = right;
    return index;
  }

  [[nodiscard]] std::size_t widest(std::size_t begin, std::size_t end) const {
    Summary low = points_[order_[begin]], high = low;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t d = 0; d < kDimensions; ++d) {
        low[d] = std::min(low[d], points_[order_[i]][d]);
        high[d] = std::max(high[d], points_[order_[i]][d]);
      }
    }
    // Weight of the duration: one second counts as much as 0.2 in a mean.
    constexpr float kPerSecond = 0.2F;
    std::size_t best = 0;
    float best_width = -1.0F;
    for (std::size_t d = 0; d < kDimensions; ++d) {
      const float width = (high[d] - low[d]) * (d == kMeans ? kPerSecond : 1.0F);
      if (width > best_width) std::tie(best, best_width) = std::pair(d, width);
    }
    return best;
  }

  template <typename Visit>
  void find(std::size_t index, const Summary& center, const Reach& reach,
            const Visit& visit) const {
    const Node& node = nodes_[index];
    if (node.left == 0) {
      for (std::size_t i = node.begin; i < node.end; ++i) {
        const Summary& point = points_[order_[i]];
        bool near = true;
        for (std::size_t d = kDimensions; near && d-- > 0;) {
          near = std::abs(point[d] - center[d]) <= reach.along(d);
        }
        if (near) visit(order_[i]);
      }
      return;
    }
    const float apart = center[node.dimension] - node.split, width = reach.along(node.dimension);
    if (apart <= width) find(node.left, center, reach, visit);
    if (apart >= -width) find(node.right, center, reach, visit);
  }

  const std::vector<Summary>& points_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

float square_distance(const Summary& a, const Summary& b) {
  float sum = 0.0F;
  for (std::size_t d = 0; d < kMeans; ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

class DuplicateFinder {
 public:
  DuplicateFinder(const std::vector<const MotionSignature*>& clips, double limit, bool chains)
      : clips_(clips),
        limit_(limit),
        chains_(chains),
        summaries_(summaries(clips)),
        tree_(summaries_) {}

  std::vector<std::optional<DuplicateOf>> run(const std::function<bool()>& keep_going) {
    result_.resize(clips_.size());
    for (std::size_t i = 0; i < clips_.size(); ++i) {
      if (keep_going && !keep_going()) break;
      if (clips_[i] == nullptr || clips_[i]->samples.empty()) continue;
      std::optional<DuplicateOf> best = nearest(i, *clips_[i], false);
      const auto image = nearest(i, mirrored(*clips_[i]), true);
      // A symmetric movement matches its own mirror image equally well; prefer the unmirrored
      // match.
      if (image && (!best || image->distance < best->distance)) best = image;
      result_[i] = best;
    }
    return std::move(result_);
  }

 private:
  static std::vector<Summary> summaries(const std::vector<const MotionSignature*>& clips) {
    std::vector<Summary> result;
    result.reserve(clips.size());
    for (const MotionSignature* clip : clips) {
      result.push_back(clip == nullptr ? Summary{} : summary_of(*clip));
    }
    return result;
  }

  // Finds the nearest earlier clip; without chains, only among clips that are kept. Compares only
  // the candidates with similar summaries.
  std::optional<DuplicateOf> nearest(std::size_t index, const MotionSignature& clip,
                                     bool is_image) {
    const Summary summary = summary_of(clip);
    // Many clips may be similar, so keep the nearest ones in a heap with the farthest on top.
    constexpr std::size_t kCompared = 32;
    near_.clear();
    tree_.find(summary, Reach(clip.seconds), [&](std::size_t other) {
      if (other >= index || (result_[other] && !chains_) || clips_[other] == nullptr ||
          clips_[other]->samples.empty()) {
        return;
      }
      const std::pair candidate(square_distance(summaries_[other], summary), other);
      if (near_.size() == kCompared) {
        if (candidate >= near_.front()) return;
        std::ranges::pop_heap(near_);
        near_.pop_back();
      }
      near_.push_back(candidate);
      std::ranges::push_heap(near_);
    });
    std::ranges::sort_heap(near_);
    std::optional<DuplicateOf> best;
    for (const auto& [apart, other] : near_) {
      const double distance = signature_distance(*clips_[other], clip, limit_);
      if (distance > limit_ || (best && distance >= best->distance)) continue;
      best = DuplicateOf{other, is_image, distance};
    }
    return best;
  }

  const std::vector<const MotionSignature*>& clips_;
  const double limit_;
  const bool chains_;
  const std::vector<Summary> summaries_;
  const SummaryTree tree_;
  std::vector<std::optional<DuplicateOf>> result_;
  std::vector<std::pair<float, std::size_t>> near_;  // Squared distance and index.
};

}  // namespace

std::vector<std::optional<DuplicateOf>> find_duplicates(
    const std::vector<const MotionSignature*>& clips, const std::function<bool()>& keep_going,
    double limit, bool chains) {
  return DuplicateFinder(clips, limit, chains).run(keep_going);
}

std::map<std::string, RepeatedClip> repeated_clips(
    const std::vector<std::pair<std::string, std::string>>& clips,
    const std::function<bool()>& keep_going) {
  std::map<std::string, MotionSignature> signatures;
  for (const auto& [name, bytes] : clips) {
    if (!bytes.empty()) signatures.emplace(name, signature_from_bytes(bytes));
  }
  std::vector<const std::string*> names;
  std::vector<const MotionSignature*> pointers;
  for (const auto& [name, signature] : signatures) {
    names.push_back(&name);
    pointers.push_back(&signature);
  }
  const auto found = find_duplicates(pointers, keep_going);
  std::map<std::string, RepeatedClip> repeated;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!found[i]) continue;
    repeated[*names[i]] = {*names[found[i]->index], found[i]->mirrored, found[i]->distance};
  }
  return repeated;
}

namespace {

// Signature of a clip as a run would read it; empty if it cannot be read.
std::string signature_in(const BatchRobot& robot, const BatchInput& clip, double memory_gb) {
  try {
    const Run run = run_of_clip(robot, clip, memory_gb);
    const DataFolder data_folder{robot.setup.loaded.data_folder};
    const auto source = recorded_source(run.motion, run.options.source, data_folder);
    if (!source) return {};
    auto loaded = load_clip(run.motion, *source, data_folder);
    if (!loaded) return {};
    const auto plan = make_plan(std::move(*loaded), robot.setup, run.options);
    if (!plan) return {};
    return signature_of(*plan);
  } catch (const std::exception&) {
    // For example, out of memory; the run itself reports it.
    return {};
  }
}

// Clips without mirror images and variations, in the order in which the first duplicate is kept.
std::vector<BatchInput*> originals(std::vector<BatchInput>& inputs) {
  std::vector<BatchInput*> clips;
  for (BatchInput& input : inputs) {
    if (!input.variant.is_derived()) clips.push_back(&input);
  }
  std::ranges::sort(clips, {}, &BatchInput::relative);
  return clips;
}

}  // namespace

std::string signature_of(const Plan& plan) {
  return signature_bytes(
      motion_signature(*plan.clip, plan.human.calibration, plan.part.begin, plan.part.end));
}

Result<void> find_signatures(std::vector<BatchInput>& inputs, const BatchRobot& robot,
                             const BatchRequest& request, const FinishedClips& finished,
                             Observer& observer) {
  const auto interrupts = observer.hold_interrupts();
  std::vector<BatchInput*> unknown;
  for (BatchInput* clip : originals(inputs)) {
    clip->signature =
        finished.signature_of(clip->relative, robot.fingerprint.hash, clip->path, clip->variant);
    if (clip->signature.empty()) unknown.push_back(clip);
  }
  ClipPool pool = clip_pool({unknown.begin(), unknown.end()}, request);
  std::size_t done = 0;
  pool.options.keep_going = [&] { return !observer.is_stopped(); };
  const auto work = [&](std::size_t task) {
    return signature_in(robot, *unknown[task], pool.memory_gb(task));
  };
  const auto ended = [&](std::size_t task, const TaskEnd& end) {
    if (end.answered) unknown[task]->signature = end.answer;
    observer.status(
        fmt::format("searching for duplicate motions: {} of {}", ++done, unknown.size()));
  };
  if (!unknown.empty()) RETARGET_TRY(run_in_processes(pool.memory, pool.options, work, ended));
  observer.end_progress();
  if (observer.is_stopped()) return interrupted_failure();
  return {};
}

Result<std::map<std::string, RepeatedClip>> repeated_inputs(const std::vector<BatchInput>& inputs,
                                                            Observer& observer) {
  const auto interrupts = observer.hold_interrupts();
  std::vector<std::pair<std::string, std::string>> clips;
  for (const BatchInput& input : inputs) {
    if (!input.variant.is_derived()) clips.emplace_back(input.relative, input.signature);
  }
  auto repeated = repeated_clips(clips, [&] { return !observer.is_stopped(); });
  if (observer.is_stopped()) return interrupted_failure();
  // A mirror image or variation shares the result of its original.
  for (const BatchInput& input : inputs) {
    const auto of = repeated.find(input.variant.original());
    if (input.variant.is_derived() && of != repeated.end()) repeated[input.relative] = of->second;
  }
  return repeated;
}

}  // namespace retarget
