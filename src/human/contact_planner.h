#pragma once

#include <memory>

#include "human/contact_plan.h"
#include "human/source_feet.h"

namespace retarget {

/// find_contacts() again and again, as of a clip that grows: the same plans. Keeps its memory, so that
/// nothing is allocated for clips that are no longer than one before, or than was reserved.
class ContactPlanner {
 public:
  ContactPlanner();
  ~ContactPlanner();
  ContactPlanner(ContactPlanner&&) noexcept;
  ContactPlanner& operator=(ContactPlanner&&) noexcept;

  /// Valid until the next call.
  [[nodiscard]] const ContactPlan& plan(const SourceFeet& source,
                                        const ContactOptions& options = {});
  void reserve(int frames);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
