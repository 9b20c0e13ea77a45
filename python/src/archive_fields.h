#pragma once

#include "archive.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion_io.h"
#include "retarget/report.h"
#include "retarget/scene.h"
#include "retarget/solved_scene.h"
#include "retarget/time_scale.h"
#include "retarget/triangle_mesh.h"

// Members of the library's structs, for archives. The functions are in the structs' namespace,
// where argument-dependent lookup finds them.

namespace retarget {

template <typename Archive>
void fields(Archive& archive, FrameRate& rate) {
  archive(rate.frames, rate.seconds);
}
template <typename Archive>
void fields(Archive& archive, Warning& warning) {
  archive(warning.line, warning.column, warning.message);
}
template <typename Archive>
void fields(Archive& archive, Joint& joint) {
  archive(joint.name, joint.parent, joint.offset, joint.end_sites, joint.channels);
}
template <typename Archive>
void fields(Archive& archive, ClipOrigin& origin) {
  archive(origin.name, origin.bytes, origin.body_height, origin.warnings, origin.metres_per_unit,
          origin.up, origin.takes, origin.choices, origin.unknown_rotations, origin.robot);
}
template <typename Archive>
void fields(Archive& archive, ContactPhase& phase) {
  archive(phase.begin, phase.end, phase.support);
}
template <typename Archive>
void fields(Archive& archive, FootContacts& contacts) {
  archive(contacts.planted);
}

template <typename Archive>
void fields(Archive& archive, SlowedStretch& stretch) {
  archive(stretch.begin, stretch.end, stretch.factor, stretch.cause);
}
template <typename Archive>
void fields(Archive& archive, TimeScale& scale) {
  archive(scale.knot_time, scale.pace, scale.stretches, scale.left, scale.longer);
}

template <typename Archive>
void fields(Archive& archive, FitTermReport& term) {
  archive(term.name, term.before, term.after, term.worst);
}
template <typename Archive>
void fields(Archive& archive, FitBoundReport& bound) {
  archive(bound.joint, bound.frames, bound.worst_frame, bound.largest);
}
template <typename Archive>
void fields(Archive& archive, FitStatus& status) {
  archive(status.begin, status.end, status.converged, status.steps, status.failed_blocks,
          status.predicted_decrease, status.cost_before, status.cost_after,
          status.distrusted_frames, status.dynamics_taken_back, status.failed,
          status.dynamics_failed);
}
template <typename Archive>
void fields(Archive& archive, SolverFailure& failure) {
  archive(failure.solver, failure.begin, failure.end);
}
template <typename Archive>
void fields(Archive& archive, FitReport& report) {
  archive(report.floor_height, report.floor_found, report.contact_phases, report.terms,
          report.bounded, report.status, report.windows, report.failures, report.notes);
}

template <typename Archive>
void fields(Archive& archive, TriangleMesh& mesh) {
  archive(mesh.vertices, mesh.triangles);
}
template <typename Archive>
void fields(Archive& archive, SceneShape& shape) {
  archive(shape.type, shape.body_from_shape, shape.half_size, shape.radius, shape.half_length,
          shape.mesh);
}
template <typename Archive>
void fields(Archive& archive, SceneBody& body) {
  archive(body.name, body.shapes, body.world_from_body, body.moves, body.mass);
}
template <typename Archive>
void fields(Archive& archive, Scene& scene) {
  archive(scene.name, scene.bodies);
}
template <typename Archive>
void fields(Archive& archive, SceneClip& clip) {
  archive(clip.scene, clip.rate, clip.frame_count, clip.world_from_body);
}
template <typename Archive>
void fields(Archive& archive, SceneContact& contact) {
  archive(contact.part, contact.body, contact.begin, contact.end, contact.slides);
}
/// Without SolvedScene::human, which the plan determines.
template <typename Archive>
void fields(Archive& archive, SolvedScene& scene) {
  archive(scene.clip, scene.scale, scene.contacts, scene.on_floor, scene.under_feet);
}

}  // namespace retarget
