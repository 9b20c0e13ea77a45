#include "formats/scene/scene_skeleton.h"

#include <fmt/format.h>
#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/scene/skeleton_shape.h"
#include "retarget/text.h"

namespace retarget {
namespace {

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
// @param bones  mark_bones(scene)
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

}  // namespace

std::vector<bool> mark_bones(const SceneGraph& scene) {
  Marks marks(scene.nodes.size());
  for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = scene.nodes[i].is_bone;
  close_gaps(scene, marks);
  if (mark_dummy_hips(scene, marks)) close_gaps(scene, marks);
  return marks;
}

Result<SceneSkeleton> choose_skeleton(const SceneGraph& scene, const std::vector<bool>& bones,
                                      int take, const std::string& root,
                                      const std::string& file_name) {
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
           static_cast<double>(each.moving) >= kRivalShare * static_cast<double>(best->moving) &&
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

Result<SceneSkeleton> choose_skeleton(const SceneGraph& scene, int take, const std::string& root,
                                      const std::string& file_name) {
  return choose_skeleton(scene, mark_bones(scene), take, root, file_name);
}

std::string other_actors_text(const SceneGraph& scene, const SceneSkeleton& chosen, int take) {
  // This take comes first, because an actor may move in several.
  std::vector<int> takes(scene.takes.size());
  std::iota(takes.begin(), takes.end(), 0);
  std::stable_partition(takes.begin(), takes.end(), [take](int at) { return at == take; });
  std::set<int> known = {chosen.joints.front()};
  std::vector<std::string> actors;
  bool in_other_takes = false;
  const Marks bones = mark_bones(scene);
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

}  // namespace retarget
