#include "formats/scene/scene_takes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/scene/skeleton_shape.h"
#include "retarget/text.h"

namespace retarget {

std::vector<bool> nodes_of_chain(const SceneGraph& scene, const SceneSkeleton& skeleton) {
  std::vector<bool> marks(scene.nodes.size(), false);
  for (const int joint : skeleton.joints) marks[as_size(joint)] = true;
  for (int node = skeleton.joints.front(); node >= 0; node = scene.nodes[as_size(node)].parent) {
    marks[as_size(node)] = true;
  }
  return marks;
}

void set_extent(const SceneGraph& scene, const std::vector<bool>& chain,
                SceneMotionChoice& choice) {
  const SceneTake& take = scene.takes[as_size(choice.take)];
  std::vector<double> times = scene.motion->key_times(choice.take, chain);
  std::erase_if(times, [](double time) { return !std::isfinite(time); });
  if (times.empty()) return;
  const auto [first, last] = std::ranges::minmax(times);
  choice.begin = first;
  choice.end = last;
  const double begin = std::max(first, take.begin), end = std::min(last, take.end);
  if (begin < end) {
    choice.begin = begin;
    choice.end = end;
  }
}

namespace {

bool any_of_both(const std::vector<bool>& a, const std::vector<bool>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] && b[i]) return true;
  }
  return false;
}

// A take with the skeleton that is read with it.
struct TakeUse {
  Result<SceneMotionChoice> choice;
  bool has_keys = false, is_body = false;
  double share = 0.0;  // See moving_share.

  [[nodiscard]] bool moves() const { return has_keys && (!choice || choice->moves); }
  [[nodiscard]] double length() const { return choice ? choice->end - choice->begin : 0.0; }
};

// The facts that all takes of a scene share.
struct SceneBodies {
  std::vector<bool> bones;              // mark_bones()
  std::vector<Eigen::Vector3d> places;  // node_rests()
};

TakeUse use_of(const SceneGraph& scene, const SceneBodies& bodies, int take,
               const std::string& root, const std::string& file_name) {
  const SceneTake& its = scene.takes[as_size(take)];
  if (std::ranges::find(its.has_keys, true) == its.has_keys.end()) {
    SceneMotionChoice none;
    none.take = take;
    return {std::move(none)};
  }
  const auto skeleton = choose_skeleton(scene, bodies.bones, take, root, file_name);
  if (!skeleton) {
    // The choice between several skeletons is ambiguous; report it only if this take is used.
    return {failure(skeleton.error()),
            skeleton.error().kind != ErrorKind::kUsage &&
                std::ranges::find(its.moves, true) != its.moves.end(),
            true};
  }
  const std::vector<bool> chain = nodes_of_chain(scene, *skeleton);
  SceneMotionChoice choice;
  choice.take = take;
  choice.skeleton = *skeleton;
  choice.moves = any_of_both(chain, its.moves);
  set_extent(scene, chain, choice);
  return {std::move(choice), any_of_both(chain, its.has_keys),
          skeleton->joints.size() >= kMinBodyJoints,
          moving_share(bodies.places, *skeleton, its.moves)};
}

// Whether a take lasts longer, by more than rounding.
bool is_longer(const TakeUse& a, const TakeUse& b) {
  return a.length() > b.length() + 1e-6;
}

// Order of preference: moving over still, bodies over props, movement of the body over movement of
// a small part such as the face, long over short.
// @param most  the largest share of all takes
bool is_better(const TakeUse& a, const TakeUse& b, double most) {
  if (a.moves() != b.moves()) return a.moves();
  if (a.is_body != b.is_body) return a.is_body;
  const bool whole = a.share >= kRivalShare * most;
  if (whole != (b.share >= kRivalShare * most)) return whole;
  return is_longer(a, b);
}

// The take to read without a request; the number of takes if none has keys.
std::size_t best_take(const std::vector<TakeUse>& uses) {
  double most = 0.0;
  for (const TakeUse& use : uses) most = std::max(most, use.share);
  std::size_t best = uses.size();
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (!uses[i].has_keys) continue;
    if (best == uses.size() || is_better(uses[i], uses[best], most)) best = i;
  }
  return best;
}

std::string take_names(const SceneGraph& scene, const std::vector<TakeUse>* uses) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.takes.size(); ++i) {
    if (uses == nullptr || (*uses)[i].moves()) names.push_back(printable(scene.takes[i].name));
  }
  return names.empty() ? "none" : list_names(names, 8);
}

Result<int> find_take(const SceneGraph& scene, const std::string& wanted,
                      const std::string& file_name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.takes.size(); ++i) {
    if (scene.takes[i].name == wanted) return static_cast<int>(i);
    names.push_back(printable(scene.takes[i].name));
  }
  const auto number = parse_number<std::size_t>(wanted);
  if (number && *number >= 1 && *number <= scene.takes.size()) {
    return static_cast<int>(*number) - 1;
  }
  return usage_failure("expected a take \"" + printable(wanted) +
                       "\" (" OPTION("take") "), found " + take_names(scene, nullptr) + " in " +
                       file_name + did_you_mean(printable(wanted), names));
}

}  // namespace

Result<SceneMotionChoice> choose_motion(const SceneGraph& scene, const std::string& wanted_take,
                                        const std::string& root, bool skeleton_only,
                                        const std::string& file_name) {
  int wanted = -1;
  if (!wanted_take.empty()) {
    TRY_ASSIGN(wanted, find_take(scene, wanted_take, file_name));
  }
  const SceneBodies bodies = {mark_bones(scene), node_rests(scene)};
  std::vector<TakeUse> uses;
  for (std::size_t i = 0; i < scene.takes.size(); ++i) {
    uses.push_back(use_of(scene, bodies, static_cast<int>(i), root, file_name));
  }
  if (wanted >= 0) {
    TakeUse& use = uses[as_size(wanted)];
    if (use.has_keys || !use.choice) return std::move(use.choice);
    if (skeleton_only) {
      TRY_ASSIGN(use.choice->skeleton, choose_skeleton(scene, wanted, root, file_name));
      return std::move(use.choice);
    }
    return usage_failure("expected a take with keys of the skeleton (" OPTION("take") "); \"" +
                         printable(scene.takes[as_size(wanted)].name) +
                         "\" has none. Takes that have: " + take_names(scene, &uses));
  }
  if (const std::size_t best = best_take(uses); best < uses.size()) {
    TakeUse& use = uses[best];
    for (std::size_t i = 0; use.choice && i < uses.size(); ++i) {
      if (uses[i].moves() && uses[i].is_body && is_longer(uses[i], use)) {
        use.choice->longer.push_back(printable(scene.takes[i].name));
      }
    }
    return std::move(use.choice);
  }
  for (TakeUse& use : uses) {
    if (!use.choice && use.choice.error().kind == ErrorKind::kUsage) return std::move(use.choice);
  }
  SceneMotionChoice still;
  if (!skeleton_only) return still;
  TRY_ASSIGN(still.skeleton, choose_skeleton(scene, -1, root, file_name));
  return still;
}

}  // namespace retarget
