#include "formats/robot_motion/scene_tracks.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "formats/robot_motion/sample_times.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "retarget/spline.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Seconds before and after a contact.
constexpr double kBlendTime = 0.15;

std::vector<Pose> sampled(const SceneClip& scene, std::size_t body, const TrackingMotion& motion) {
  const SampleTimes times(scene.rate, motion.rate);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < motion.frames; ++i) {
    const auto [frame, share] = times.at(static_cast<WideFrames>(i));
    const Pose& a = scene.pose(std::min(frame, scene.frame_count - 1), body);
    const Pose& b = scene.pose(std::min(frame + 1, scene.frame_count - 1), body);
    Pose pose;
    pose.translation = a.translation * (1.0 - share) + b.translation * share;
    pose.rotation = interpolate_linear(a.rotation.normalized(), b.rotation.normalized(), share);
    if (i > 0) align_sign(poses.back().rotation.coeffs(), pose.rotation.coeffs());
    poses.push_back(pose);
  }
  return poses;
}

void add_sample(const std::vector<Pose>& poses, std::size_t i, double frame_time,
                TrackedObjects& objects) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, poses.size() - 1);
  const std::size_t middle = std::clamp<std::size_t>(i, 1, poses.size() - 2);
  const Quaterniond& q = poses[i].rotation;
  append_vector(objects.pos, poses[i].translation);
  objects.quat.insert(objects.quat.end(), {q.w(), q.x(), q.y(), q.z()});
  append_vector(objects.lin_vel, (poses[after].translation - poses[before].translation) /
                                     (static_cast<double>(after - before) * frame_time));
  const Quaterniond turn = poses[middle + 1].rotation * poses[middle - 1].rotation.conjugate();
  append_vector(objects.ang_vel, log_so3(turn) / (2.0 * frame_time));
}

// Contacts of the same part, or of the same body, with one surface.
struct Column {
  const SurfaceTouch* first;
  std::vector<const SurfaceTouch*> touches;
};

// Groups contacts by surface and `of`, in the order in which they appear.
std::vector<Column> columns_of(const ContactLabels& labels, std::string SurfaceTouch::*of) {
  std::vector<Column> columns;
  for (const SurfaceTouch& touch : labels.touches) {
    const auto found = std::ranges::find_if(columns, [&](const Column& column) {
      return column.first->*of == touch.*of && column.first->surface == touch.surface;
    });
    Column& column = found != columns.end() ? *found : columns.emplace_back(Column{&touch, {}});
    column.touches.push_back(&touch);
  }
  return columns;
}

bool touches_in(const Column& column, int frame) {
  return std::ranges::any_of(column.touches, [&](const SurfaceTouch* touch) {
    return touch->begin <= frame && frame < touch->end;
  });
}

// @param time  time in frames.
double label_at(const Column& column, double time, double frame_time) {
  double label = 0.0;
  for (const SurfaceTouch* touch : column.touches) {
    const double away = std::max({0.0, touch->begin - time, time - (touch->end - 1)});
    label = std::max(label, 1.0 - away * frame_time / kBlendTime);
  }
  return label;
}

// holosoma's configurations of robot and objects.
void add_qpos(const TrackingMotion& motion, NpzWriter& npz) {
  const std::size_t joints = motion.joint_names.size(), bodies = motion.body_names.size();
  const std::size_t objects = motion.objects->names.size();
  std::vector<double> qpos;
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    append_row(qpos, motion.body_pos, 3 * frame * bodies, 3);
    append_row(qpos, motion.body_quat, 4 * frame * bodies, 4);
    append_row(qpos, motion.joint_pos, frame * joints, joints);
    for (std::size_t object = 0; object < objects; ++object) {
      append_row(qpos, motion.objects->pos, 3 * (frame * objects + object), 3);
      append_row(qpos, motion.objects->quat, 4 * (frame * objects + object), 4);
    }
  }
  npz.add("qpos", float32_array(qpos, {motion.frames, 7 + joints + 7 * objects}));
}

}  // namespace

void append_row(std::vector<double>& to, const std::vector<double>& from, std::size_t begin,
                std::size_t width) {
  const auto first = from.begin() + static_cast<std::ptrdiff_t>(begin);
  to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(width));
}

void add_scene_arrays(const TrackingMotion& motion, NpzWriter& npz) {
  const std::size_t frames = motion.frames;
  if (motion.objects) {
    const TrackedObjects& objects = *motion.objects;
    const std::size_t count = objects.names.size();
    npz.add("object_names", text_array(objects.names));
    npz.add("object_pos_w", float32_array(objects.pos, {frames, count, 3}));
    npz.add("object_quat_w", float32_array(objects.quat, {frames, count, 4}));
    npz.add("object_lin_vel_w", float32_array(objects.lin_vel, {frames, count, 3}));
    npz.add("object_ang_vel_w", float32_array(objects.ang_vel, {frames, count, 3}));
    if (motion.format == MotionFormat::kNpzHolosoma) add_qpos(motion, npz);
  }
  if (motion.touches) {
    const TrackedContacts& touches = *motion.touches;
    npz.add("contact_labels", float32_array(touches.labels, {frames, touches.links.size()}));
    npz.add("contact_links", text_array(touches.links));
    npz.add("contact_surfaces", text_array(touches.surfaces));
  }
}

std::optional<TrackedObjects> tracked_objects(const SceneClip& scene,
                                              const TrackingMotion& motion) {
  TrackedObjects objects;
  std::vector<std::vector<Pose>> paths;
  for (std::size_t body = 0; body < scene.scene->bodies.size(); ++body) {
    if (!scene.scene->bodies[body].moves) continue;
    objects.names.push_back(scene.scene->bodies[body].name);
    paths.push_back(sampled(scene, body, motion));
  }
  if (paths.empty()) return std::nullopt;
  for (std::size_t i = 0; i < motion.frames; ++i) {
    for (const auto& path : paths) add_sample(path, i, motion.rate.frame_time(), objects);
  }
  return objects;
}

TrackedContacts tracked_contacts(const ContactLabels& labels, const FrameRate& clip,
                                 const TrackingMotion& motion) {
  TrackedContacts contacts;
  const std::vector<Column> columns = columns_of(labels, &SurfaceTouch::link);
  for (const Column& column : columns) {
    contacts.links.push_back(column.first->link);
    contacts.surfaces.push_back(column.first->surface);
  }
  const SampleTimes times(clip, motion.rate);
  for (std::size_t i = 0; i < motion.frames; ++i) {
    const auto [frame, share] = times.at(static_cast<WideFrames>(i));
    for (const Column& column : columns) {
      contacts.labels.push_back(label_at(column, frame + share, clip.frame_time()));
    }
  }
  return contacts;
}

std::string format_contacts_csv(const FootContacts& contacts, const FrameRate& rate,
                                const ContactLabels* labels) {
  const std::vector<Column> all =
      labels != nullptr ? columns_of(*labels, &SurfaceTouch::part) : std::vector<Column>();
  std::vector<Column> columns;
  // With the floor: the contacts of the feet, which have their own columns.
  std::array<const Column*, kContactNames.size()> on_floor{};
  for (const Column& column : all) {
    const auto end = std::ranges::find(kContactNames, column.first->part);
    if (end != kContactNames.end() && column.first->surface == kFloorName) {
      on_floor[static_cast<std::size_t>(end - kContactNames.begin())] = &column;
    } else {
      columns.push_back(column);
    }
  }
  std::string text = "frame,time";
  for (const std::string_view name : kContactNames) text += fmt::format(",{}", name);
  for (const Column& column : columns) {
    text += ',' + csv_field(column.first->part + ':' + column.first->surface);
  }
  text += '\n';
  for (int frame = 0; frame < contacts.frame_count(); ++frame) {
    text += fmt::format("{},{:.6f}", frame, rate.time_of(frame));
    for (std::size_t end = 0; end < kContactNames.size(); ++end) {
      bool planted =
          contacts.planted[kContactNames.size() * static_cast<std::size_t>(frame) + end] != 0;
      if (labels != nullptr)
        planted = on_floor[end] != nullptr && touches_in(*on_floor[end], frame);
      text += planted ? ",1" : ",0";
    }
    for (const Column& column : columns) text += touches_in(column, frame) ? ",1" : ",0";
    text += '\n';
  }
  return text;
}

}  // namespace retarget
