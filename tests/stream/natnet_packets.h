#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "retarget/pose.h"
#include "support/npz_builder.h"

// Messages of NatNet 3.0 to 4.2 with all sections of Motive, built byte by byte.

namespace retarget::natnet_test {

inline std::string float_bytes(double value) {
  return little_endian_bytes(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
}

inline std::string vector(const Eigen::Vector3d& value) {
  return float_bytes(value.x()) + float_bytes(value.y()) + float_bytes(value.z());
}

inline std::string text(const std::string& value) {
  return value + '\0';
}

inline std::string natnet_message(int type, const std::string& payload) {
  return little_endian_bytes(static_cast<std::uint64_t>(type), 2) +
         little_endian_bytes(payload.size(), 2) + payload;
}

struct Version {
  int major, minor;
  [[nodiscard]] bool is_from(int other_major, int other_minor) const {
    return major > other_major || (major == other_major && minor >= other_minor);
  }
};

inline constexpr Version kVersions[] = {{3, 0}, {3, 1}, {4, 0}, {4, 1}, {4, 2}};

inline std::string server_info(Version version) {
  std::string payload = text("Motive");
  payload.resize(256);
  return natnet_message(1, payload + std::string("\3\1\0\0", 4) +
                               little_endian_bytes(static_cast<std::uint64_t>(version.major), 1) +
                               little_endian_bytes(static_cast<std::uint64_t>(version.minor), 1) +
                               little_endian_bytes(0, 2) + std::string(15, '\0'));
}

struct DescribedBone {
  std::string name;
  int id, parent;
  Eigen::Vector3d offset;
};

// A child before its parent, as Motive sends toes.
inline const std::vector<DescribedBone> kBones = {{"Anna_Hip", 1, 0, {0, 0, 0}},
                                                  {"Anna_LToe", 4, 3, {0, -0.07, 0.14}},
                                                  {"Anna_LThigh", 2, 1, {0.09, -0.03, 0}},
                                                  {"Anna_LShin", 3, 2, {0, -0.42, 0.01}},
                                                  {"Anna_Ab", 5, 1, {0, 0.09, -0.01}}};

inline std::string bone_description(Version version, const DescribedBone& bone) {
  std::string bytes =
      text(bone.name) + little_endian_bytes(static_cast<std::uint64_t>(bone.id), 4) +
      little_endian_bytes(static_cast<std::uint64_t>(bone.parent), 4) + vector(bone.offset);
  if (version.is_from(4, 2))
    bytes += float_bytes(0) + float_bytes(0) + float_bytes(0) + float_bytes(1);
  // Two markers.
  bytes += little_endian_bytes(2, 4) + vector({1, 2, 3}) + vector({4, 5, 6}) +
           little_endian_bytes(7, 4) + little_endian_bytes(8, 4);
  if (version.is_from(4, 0)) bytes += text("WaistL") + text("WaistR");
  return bytes;
}

inline std::string described(Version version, int type, const std::string& item) {
  return little_endian_bytes(static_cast<std::uint64_t>(type), 4) +
         (version.is_from(4, 1) ? little_endian_bytes(item.size(), 4) : "") + item;
}

inline std::string skeleton_description(Version version, int id,
                                        const std::vector<DescribedBone>& bones) {
  std::string item = text("Anna") + little_endian_bytes(static_cast<std::uint64_t>(id), 4) +
                     little_endian_bytes(bones.size(), 4);
  for (const DescribedBone& bone : bones) item += bone_description(version, bone);
  return described(version, 2, item);
}

inline std::string models(Version version, const std::vector<DescribedBone>& bones = kBones) {
  std::string sets = described(
      version, 0,
      text("all") + little_endian_bytes(2, 4) + text("Anna_WaistL") + text("Anna_WaistR"));
  sets += described(version, 1, bone_description(version, {"Box", 9, -1, {0, 0, 0}}));
  sets += described(version, 3,
                    little_endian_bytes(1, 4) + text("FP-1") + std::string(163 * 4, '\1') +
                        little_endian_bytes(2, 4) + text("Fx") + text("Fy"));
  sets += described(version, 4,
                    little_endian_bytes(1, 4) + text("NIDAQ") + text("0815") +
                        little_endian_bytes(0, 8) + little_endian_bytes(1, 4) + text("ai0"));
  sets += described(version, 5, text("Prime 13") + std::string(28, '\2'));
  sets += skeleton_description(version, 3, bones);
  sets += skeleton_description(version, 6, bones);
  return natnet_message(5, little_endian_bytes(7, 4) + sets);
}

inline std::string body(int id, const Pose& pose, bool is_tracked = true) {
  return little_endian_bytes(static_cast<std::uint64_t>(id), 4) + vector(pose.translation) +
         vector(pose.rotation.vec()) + float_bytes(pose.rotation.w()) + float_bytes(0.0004) +
         little_endian_bytes(is_tracked ? 1 : 0, 2);
}

inline std::string section(Version version, int count, const std::string& items) {
  return little_endian_bytes(static_cast<std::uint64_t>(count), 4) +
         (version.is_from(4, 1) ? little_endian_bytes(items.size(), 4) : "") + items;
}

inline std::string channels(int id) {
  return little_endian_bytes(static_cast<std::uint64_t>(id), 4) + little_endian_bytes(2, 4) +
         little_endian_bytes(1, 4) + float_bytes(1) + little_endian_bytes(3, 4) + float_bytes(1) +
         float_bytes(2) + float_bytes(3);
}

// The poses of the bones in the order of kBones.
inline std::string frame(Version version, const std::vector<Pose>& poses, double time,
                         bool models_changed = false, bool is_tracked = true) {
  std::string skeletons;
  for (const int id : {3, 6}) {
    skeletons += little_endian_bytes(static_cast<std::uint64_t>(id), 4) +
                 little_endian_bytes(poses.size(), 4);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      Pose pose = poses[i];
      // The second one is elsewhere.
      if (id == 6) pose.translation.x() += 5.0;
      skeletons += body(id << 16 | kBones[i].id, pose, is_tracked);
    }
  }
  std::string bytes = little_endian_bytes(77, 4);
  bytes += section(version, 1, text("all") + little_endian_bytes(1, 4) + vector({1, 1, 1}));
  bytes += section(version, 2, vector({1, 2, 3}) + vector({3, 2, 1}));
  bytes += section(version, 1, body(9, Pose{}));
  bytes += section(version, 2, skeletons);
  if (version.is_from(4, 1)) {
    bytes += section(version, 1, little_endian_bytes(1, 4) + little_endian_bytes(0, 8));
  }
  bytes += section(version, 1, std::string(26, '\5'));
  bytes += section(version, 1, channels(1));
  bytes += section(version, 2, channels(1) + channels(2));
  bytes += little_endian_bytes(0, 8) + little_endian_bytes(std::bit_cast<std::uint64_t>(time), 8) +
           std::string(24, '\6');
  if (version.is_from(4, 1)) bytes += little_endian_bytes(0, 8);
  return natnet_message(
      7, bytes + little_endian_bytes(models_changed ? 2 : 0, 2) + little_endian_bytes(0, 4));
}

}  // namespace retarget::natnet_test
