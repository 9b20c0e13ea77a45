#include "formats/scene/scene_skeleton.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/scene/skeleton_shape.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Fraction of the movement from which another skeleton or take competes with the first.
constexpr double kRival = 0.5;

using Marks = std::vector<bool>;

// Marks the nodes between marked nodes.
void close_gaps(const SceneGraph& scene, Marks& marks) {
  // The nearest marked ancestor of each node, or the node itself.
  std::vector<int> above(scene.nodes.size(), -1);
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const int parent = scene.nodes[i].parent;
    above[i] = marks[i] ? static_cast<int>(i) : parent < 0 ? -1 : above[as_size(parent)];
    if (!marks[i] || parent < 0 || above[as_size(parent)] < 0) continue;
    for (int node = parent; !marks[as_size(node)]; node = scene.nodes[as_size(node)].parent) {
      marks[as_size(node)] = true;
    }
  }
}

Marks bones_of(const SceneGraph& scene) {
  Marks marks(scene.nodes.size());
  for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = scene.nodes[i].is_bone;
  close_gaps(scene, marks);
  if (mark_dummy_hips(scene, marks)) close_gaps(scene, marks);
  return marks;
}

// Nodes with keys and their descendants other than objects: hands and feet often have no keys.
Marks moving_nodes(const SceneGraph& scene, int take) {
  Marks marks(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const SceneNode& node = scene.nodes[i];
    const bool has_keys = take >= 0 && scene.takes[as_size(take)].has_keys[i];
    marks[i] = node.is_bone || has_keys ||
               (!node.is_object && node.parent >= 0 && marks[as_size(node.parent)]);
  }
  close_gaps(scene, marks);
  return marks;
}

struct Candidate {
  SceneSkeleton skeleton;
  std::size_t moving = 0;
};

std::vector<Candidate> candidates_of(const SceneGraph& scene, const Marks& marks, int take) {
  std::vector<std::vector<int>> children(scene.nodes.size());
  std::vector<int> roots;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!marks[i]) continue;
    const int parent = scene.nodes[i].parent;
    if (parent >= 0 && marks[as_size(parent)]) {
      children[as_size(parent)].push_back(static_cast<int>(i));
    } else {
      roots.push_back(static_cast<int>(i));
    }
  }
  std::vector<Candidate> candidates;
  for (const int root : roots) {
    Candidate candidate;
    std::vector<std::pair<int, int>> waiting = {{root, -1}};
    while (!waiting.empty()) {
      const auto [node, parent] = waiting.back();
      waiting.pop_back();
      const int place = static_cast<int>(candidate.skeleton.joints.size());
      candidate.skeleton.joints.push_back(node);
      candidate.skeleton.parents.push_back(parent);
      candidate.moving += take >= 0 && scene.takes[as_size(take)].moves[as_size(node)] ? 1 : 0;
      for (std::size_t i = children[as_size(node)].size(); i-- > 0;) {
        waiting.emplace_back(children[as_size(node)][i], place);
      }
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

bool is_body(const Candidate& candidate) {
  return candidate.skeleton.joints.size() >= kMinBodyJoints;
}

std::string root_name(const SceneGraph& scene, const Candidate& candidate) {
  return printable(scene.nodes[as_size(candidate.skeleton.joints.front())].name);
}

std::vector<std::string> root_names(const SceneGraph& scene,
                                    const std::vector<Candidate>& candidates) {
  std::vector<std::string> names;
  for (const Candidate& each : candidates) {
    if (is_body(each)) names.push_back(root_name(scene, each));
  }
  return names;
}

// Whether the root or a node above it has this name.
bool is_below(const SceneGraph& scene, const Candidate& candidate, const std::string& name) {
  for (int node = candidate.skeleton.joints.front(); node >= 0;
       node = scene.nodes[as_size(node)].parent) {
    if (scene.nodes[as_size(node)].name == name) return true;
  }
  return false;
}

std::vector<int> body_roots(const std::vector<Candidate>& candidates) {
  std::vector<int> roots;
  for (const Candidate& each : candidates) {
    if (is_body(each)) roots.push_back(each.skeleton.joints.front());
  }
  return roots;
}

// Skeletons of bones, or of moving nodes if the bones do not form a body.
// @param bones  bones_of(scene)
std::vector<Candidate> skeletons_of(const SceneGraph& scene, const Marks& bones, int take) {
  auto candidates = candidates_of(scene, bones, take);
  if (std::ranges::any_of(candidates, is_body)) return candidates;
  auto plain = candidates_of(scene, moving_nodes(scene, take), take);
  if (candidates.empty() || std::ranges::any_of(plain, is_body)) return plain;
  return candidates;
}

// The name of a root or of a node above it that distinguishes it from another root.
std::string name_unlike(const SceneGraph& scene, int root, int other) {
  std::set<std::string> taken;
  for (int node = other; node >= 0; node = scene.nodes[as_size(node)].parent) {
    taken.insert(scene.nodes[as_size(node)].name);
  }
  for (int node = root; node >= 0; node = scene.nodes[as_size(node)].parent) {
    if (!taken.contains(scene.nodes[as_size(node)].name)) return scene.nodes[as_size(node)].name;
  }
  return scene.nodes[as_size(root)].name;
}

// The root of a skeleton given by its number from 1; -1 if there is none.
int numbered_root(const std::string& text, const std::vector<int>& roots) {
  const auto number = parse_number<std::size_t>(text);
  return number && *number >= 1 && *number <= roots.size() ? roots[*number - 1] : -1;
}

// How to choose between skeletons: by names, or by their numbers if names do not distinguish them.
std::string choice_hint(const SceneGraph& scene, const std::vector<int>& rivals,
                        const std::vector<int>& roots) {
  std::vector<std::string> names, numbers;
  std::set<std::string> different;
  for (const int rival : rivals) {
    std::string name = scene.nodes[as_size(rival)].name;
    for (const int other : rivals) {
      if (other != rival && scene.nodes[as_size(other)].name == name) {
        name = name_unlike(scene, rival, other);
        break;
      }
    }
    names.push_back("\"" + printable(name) + "\"");
    different.insert(std::move(name));
    const auto number = std::ranges::find(roots, rival) - roots.begin() + 1;
    numbers.push_back(std::to_string(number));
  }
  if (different.size() == rivals.size()) {
    return "choose one of them with " OPTION("root") " NAME: " + list_names(names, 8);
  }
  return "their names are equal: choose one with " OPTION("root") " NUMBER: " +
         list_names(numbers, 8);
}

bool is_larger(const Candidate& a, const Candidate& b) {
  return a.moving != b.moving ? a.moving > b.moving
                              : a.skeleton.joints.size() > b.skeleton.joints.size();
}

// choose_skeleton() with the marks of bones_of(scene), which are the same in all takes.
Result<SceneSkeleton> choose_among(const SceneGraph& scene, const Marks& bones, int take,
                                   const std::string& root, const std::string& file_name) {
  auto candidates = skeletons_of(scene, bones, take);
  if (candidates.empty()) {
    return input_failure(file_name,
                         fmt::format("the {} file has no skeleton: none of its {} is a joint",
                                     scene.format, count_text(scene.nodes.size(), "node")),
                         "export the armature with its animation");
  }
  const std::vector<std::string> names = root_names(scene, candidates);
  const std::vector<int> roots = body_roots(candidates);
  if (!root.empty()) {
    const int numbered = numbered_root(root, roots);
    const bool is_name = std::ranges::any_of(
        candidates, [&](const Candidate& each) { return is_below(scene, each, root); });
    std::erase_if(candidates, [&](const Candidate& each) {
      return is_name ? !is_below(scene, each, root) : each.skeleton.joints.front() != numbered;
    });
    if (candidates.empty()) {
      return usage_failure("expected a skeleton \"" + root + "\" (" OPTION("root") "), found " +
                           (names.empty() ? "no skeleton of human size" : list_names(names, 8)));
    }
  }
  const auto best = std::ranges::min_element(candidates, is_larger);
  const auto rivals = std::ranges::count_if(candidates, [&](const Candidate& each) {
    return is_body(each) &&
           static_cast<double>(each.moving) >= kRival * static_cast<double>(best->moving) &&
           (best->moving > 0 || each.skeleton.joints.size() == best->skeleton.joints.size());
  });
  if (rivals > 1) {
    return input_failure(file_name,
                         fmt::format("the {} file has {} possible skeletons: {}", scene.format,
                                     rivals, list_names(root_names(scene, candidates), 8)),
                         choice_hint(scene, body_roots(candidates), roots));
  }
  SceneSkeleton chosen = std::move(best->skeleton);
  for (std::size_t i = 0; i < roots.size(); ++i) {
    if (roots[i] != chosen.joints.front()) chosen.others.push_back(names[i]);
  }
  return chosen;
}

}  // namespace

Result<SceneSkeleton> choose_skeleton(const SceneGraph& scene, int take, const std::string& root,
                                      const std::string& file_name) {
  return choose_among(scene, bones_of(scene), take, root, file_name);
}

std::string other_actors_text(const SceneGraph& scene, const SceneSkeleton& chosen, int take) {
  // This take comes first, because an actor may move in several.
  std::vector<int> takes(scene.takes.size());
  std::iota(takes.begin(), takes.end(), 0);
  std::stable_partition(takes.begin(), takes.end(), [take](int at) { return at == take; });
  std::set<int> known = {chosen.joints.front()};
  std::vector<std::string> actors;
  bool in_other_takes = false;
  const Marks bones = bones_of(scene);
  for (const int at : takes) {
    for (const Candidate& each : skeletons_of(scene, bones, at)) {
      const int root = each.skeleton.joints.front();
      if (!is_body(each) || each.moving == 0 || !known.insert(root).second) continue;
      std::string actor = "\"" + printable(name_unlike(scene, root, chosen.joints.front())) + "\"";
      if (at != take) {
        in_other_takes = true;
        actor += " (take \"" + printable(scene.takes[as_size(at)].name) + "\")";
      }
      actors.push_back(std::move(actor));
    }
  }
  if (actors.empty()) return {};
  return fmt::format("{}: {}; {} reads another skeleton",
                     actors.size() == 1 ? "another skeleton moves" : "other skeletons move",
                     list_names(actors, 8),
                     in_other_takes ? OPTION("root") " NAME with " OPTION("take") " NAME"
                                    : OPTION("root") " NAME");
}

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

bool any_of_both(const Marks& a, const Marks& b) {
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
  Marks bones;                          // bones_of
  std::vector<Eigen::Vector3d> places;  // node_rests
};

TakeUse use_of(const SceneGraph& scene, const SceneBodies& bodies, int take,
               const std::string& root, const std::string& file_name) {
  const SceneTake& its = scene.takes[as_size(take)];
  if (std::ranges::find(its.has_keys, true) == its.has_keys.end()) {
    SceneMotionChoice none;
    none.take = take;
    return {std::move(none)};
  }
  const auto skeleton = choose_among(scene, bodies.bones, take, root, file_name);
  if (!skeleton) {
    // The choice between several skeletons is ambiguous; report it only if this take is used.
    return {failure(skeleton.error()),
            skeleton.error().kind != ErrorKind::kUsage &&
                std::ranges::find(its.moves, true) != its.moves.end(),
            true};
  }
  const Marks chain = nodes_of_chain(scene, *skeleton);
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
  const bool whole = a.share >= kRival * most;
  if (whole != (b.share >= kRival * most)) return whole;
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
  const SceneBodies bodies = {bones_of(scene), node_rests(scene)};
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
