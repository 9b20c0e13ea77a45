#include "app/plan/motion_contacts.h"

#include <algorithm>
#include <cstddef>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/human.h"
#include "retarget/motion.h"

namespace retarget {

std::optional<FootContacts> contacts_of(const Motion& motion) {
  if (!motion.fit) return std::nullopt;
  FootContacts contacts;
  const int frames = motion.clip.frame_count();
  contacts.planted.assign(kContactNames.size() * static_cast<std::size_t>(frames), 0);
  for (std::size_t end = 0; end < kContactNames.size(); ++end) {
    for (const ContactPhase& phase : motion.contacts[end]) {
      for (int frame = phase.begin; frame < std::min(phase.end, frames); ++frame) {
        contacts.planted[kContactNames.size() * static_cast<std::size_t>(frame) + end] = 1;
      }
    }
  }
  return contacts;
}

Result<OutputFile> write_contacts(const std::string& path,
                                  const std::optional<FootContacts>& contacts,
                                  const FrameRate& rate) {
  if (!contacts) {
    return usage_failure("the motion has no contacts for " OPTION("contacts"),
                         "the fit determines contacts, " OPTION("method") " gmr does not; NPZ, "
                         "pkl-pbhc, protomotions and csv-sonic files can contain them");
  }
  TRY_ASSIGN(OutputFile file, OutputFile::create(path));
  TRY(file.write(format_contacts_csv(*contacts, rate)));
  return file;
}

}  // namespace retarget
