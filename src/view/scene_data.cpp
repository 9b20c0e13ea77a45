#include "view/scene_data.h"

#include <zlib.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "retarget/bytes.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using Words = std::vector<std::uint32_t>;

// Maps signed to unsigned values such that values near 0 stay small (zigzag encoding).
std::uint32_t folded(std::uint32_t value) {
  return (value << 1U) ^ ((value & 0x80000000U) != 0 ? 0xFFFFFFFFU : 0U);
}

Words differences(const Words& values) {
  Words result(values.size());
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    result[i] = values[i] - before;
    before = values[i];
  }
  return result;
}

std::size_t bits_of(const Words& values) {
  std::size_t bits = 0;
  for (const std::uint32_t value : values) bits += std::bit_width(folded(value));
  return bits;
}

struct PackedChannel {
  Words values;
  char order = 0;  // Number of times that differences were taken.
};

PackedChannel packed(Words values) {
  PackedChannel best{std::move(values), 0};
  std::size_t fewest = bits_of(best.values);
  Words next = best.values;
  for (char order = 1; order <= 2; ++order) {
    next = differences(next);
    const std::size_t bits = bits_of(next);
    if (bits >= fewest) continue;
    fewest = bits;
    best = {next, order};
  }
  return best;
}

}  // namespace

Result<std::string> packed_text(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string deflated(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(deflated.data()), &size,
                             reinterpret_cast<const Bytef*>(bytes.data()),
                             static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  if (code != Z_OK) return run_failure("", "zlib cannot compress the page data: out of memory");
  deflated.resize(size);
  return base64_text(deflated);
}

Result<int> TrackPacker::add(int channels, double step, std::span<const double> values) {
  constexpr double kMaxSteps = 1e9;
  const auto wide = static_cast<std::size_t>(channels);
  const std::size_t frames = channels > 0 ? values.size() / wide : 0;
  std::string orders;
  std::array<std::string, 4> planes;
  for (std::size_t channel = 0; channel < wide; ++channel) {
    Words rounded(frames);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const double steps = std::nearbyint(values[frame * wide + channel] / step);
      // Negated comparison: NaN fails too.
      if (!(std::abs(steps) <= kMaxSteps)) {
        return input_failure(
            "", "frame " + std::to_string(frame) + " has a position too far away to display");
      }
      rounded[frame] = static_cast<std::uint32_t>(static_cast<std::int32_t>(steps));
    }
    const PackedChannel each = packed(std::move(rounded));
    orders += each.order;
    for (const std::uint32_t value : each.values) {
      const std::uint32_t word = folded(value);
      for (std::size_t i = 0; i < planes.size(); ++i) {
        planes[i] += static_cast<char>((word >> (8U * i)) & 0xFFU);
      }
    }
  }
  bytes_ += orders;
  for (const std::string& plane : planes) bytes_ += plane;
  tracks_.push_back({channels, static_cast<int>(frames), step});
  return static_cast<int>(tracks_.size()) - 1;
}

namespace {

using Json = nlohmann::ordered_json;

// This many triangles take about ten megabytes of a page.
constexpr std::size_t kMaxPageTriangles = 300'000;
constexpr std::size_t kMaxSceneShapes = 20'000;
constexpr std::size_t kMaxScenePoses = 1'000'000;

// The poses of a world: those of static bodies as numbers, those of moving bodies as tracks.
Result<Json> world_json(const SceneClip& world, TrackPacker& packer) {
  const std::vector<SceneBody>& bodies = world.scene->bodies;
  Json poses = Json::array();
  std::vector<std::size_t> moving;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    if (bodies[body].moves && world.frame_count > 0) {
      moving.push_back(body);
      poses.push_back(nullptr);
    } else {
      poses.push_back(
          page_pose(world.frame_count > 0 ? world.pose(0, body) : bodies[body].world_from_body));
    }
  }
  Json json = {{"frames", world.frame_count}, {"poses", std::move(poses)}};
  if (moving.empty()) return json;
  std::vector<double> positions, rotations;
  for (int frame = 0; frame < world.frame_count; ++frame) {
    for (const std::size_t body : moving) {
      const Pose& pose = world.pose(frame, body);
      positions.insert(positions.end(), pose.translation.begin(), pose.translation.end());
      const Eigen::Quaterniond& q = pose.rotation;
      rotations.insert(rotations.end(), {q.w(), q.x(), q.y(), q.z()});
    }
  }
  const auto count = static_cast<int>(moving.size());
  RETARGET_TRY_ASSIGN(json["position"], packer.add(3 * count, kPageRootStep, positions));
  RETARGET_TRY_ASSIGN(json["rotation"], packer.add(4 * count, kPageQuaternionStep, rotations));
  return json;
}

}  // namespace

std::string scene_excess(const SceneClip& scene) {
  std::size_t triangles = 0, shapes = 0, moving = 0;
  for (const SceneBody& body : scene.scene->bodies) {
    shapes += body.shapes.size();
    if (body.moves) ++moving;
    for (const SceneShape& shape : body.shapes) {
      if (shape.mesh) triangles += shape.mesh->triangles.size();
    }
  }
  const std::size_t poses = moving * static_cast<std::size_t>(scene.frame_count);
  const auto text = [](std::size_t count, const char* noun, std::size_t most) {
    const char* of = std::string_view(noun) == "pose" ? " of moving bodies" : "";
    return count_text(count, noun) + of + ", at most " + std::to_string(most) + " fit on a page";
  };
  if (triangles > kMaxPageTriangles) return text(triangles, "triangle", kMaxPageTriangles);
  if (shapes > kMaxSceneShapes) return text(shapes, "shape", kMaxSceneShapes);
  if (poses > kMaxScenePoses) return text(poses, "pose", kMaxScenePoses);
  return {};
}

std::vector<SummaryLine> scene_lines(const SceneClip* scene) {
  if (scene == nullptr) return {};
  const std::string excess = scene_excess(*scene);
  if (excess.empty()) return {};
  return {{"scene", "omitted from the page: " + excess}};
}

Result<void> pack_mesh(const TriangleMesh& mesh, TrackPacker& packer, Json& json) {
  std::vector<double> vertices, corners;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    vertices.insert(vertices.end(), vertex.begin(), vertex.end());
  }
  for (const auto& triangle : mesh.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  RETARGET_TRY_ASSIGN(json["vertices"], packer.add(3, kPageMeshStep, vertices));
  RETARGET_TRY_ASSIGN(json["triangles"], packer.add(3, 1.0, corners));
  return {};
}

Result<Json> ScenePacker::shape_json(const SceneShape& shape, TrackPacker& packer) {
  Json json = {{"pose", page_pose(shape.body_from_shape)}};
  switch (shape.type) {
    case SceneShape::Type::kPlane:
      json["plane"] = true;
      break;
    case SceneShape::Type::kBox:
      json["box"] = {shape.half_size.x(), shape.half_size.y(), shape.half_size.z()};
      break;
    case SceneShape::Type::kSphere:
      json["sphere"] = shape.radius;
      break;
    case SceneShape::Type::kCapsule:
      json["capsule"] = {shape.radius, shape.half_length};
      break;
    case SceneShape::Type::kCylinder:
      json["cylinder"] = {shape.radius, shape.half_length};
      break;
    case SceneShape::Type::kMesh:
      Json& mesh = meshes_[shape.mesh.get()];
      if (mesh.is_null()) RETARGET_TRY(pack_mesh(*shape.mesh, packer, mesh));
      json["mesh"] = mesh;
      break;
  }
  return json;
}

Result<Json> ScenePacker::pack(const MotionScene& scene, TrackPacker& packer) {
  Json bodies = Json::array();
  for (const SceneBody& body : scene.robot.scene->bodies) {
    Json shapes = Json::array();
    for (const SceneShape& shape : body.shapes) {
      RETARGET_TRY_ASSIGN(Json json, shape_json(shape, packer));
      shapes.push_back(std::move(json));
    }
    bodies.push_back({{"name", body.name}, {"shapes", std::move(shapes)}});
  }
  Json json = {{"bodies", std::move(bodies)}, {"scale", scene.scale}};
  RETARGET_TRY_ASSIGN(json["robot"], world_json(scene.robot, packer));
  if (scene.human) {
    RETARGET_TRY_ASSIGN(json["human"], world_json(*scene.human, packer));
  }
  return json;
}

Json page_touches(const ContactLabels& labels, int frames) {
  std::vector<const SurfaceTouch*> sorted;
  for (const SurfaceTouch& touch : labels.touches) {
    if (touch.surface != kFloorName && touch.begin < frames) sorted.push_back(&touch);
  }
  std::ranges::stable_sort(sorted, {}, &SurfaceTouch::begin);
  Json json = Json::array();
  for (const SurfaceTouch& label : labels.touches) {
    const auto is_same = [&](const auto& row) {
      return row["part"] == label.part && row["surface"] == label.surface;
    };
    if (std::any_of(json.begin(), json.end(), is_same)) continue;
    Json phases = Json::array();
    for (const SurfaceTouch* touch : sorted) {
      if (touch->part != label.part || touch->surface != label.surface) continue;
      phases.push_back({touch->begin, std::min(touch->end, frames)});
    }
    if (phases.empty()) continue;
    json.push_back(
        {{"part", label.part}, {"surface", label.surface}, {"phases", std::move(phases)}});
  }
  return json;
}

}  // namespace retarget
