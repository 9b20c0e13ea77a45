#include "robot/anatomy/finger_names.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "retarget/text.h"

namespace retarget {
namespace {

struct FingerWords {
  Finger finger;
  std::vector<std::string_view> words;
};

// Parts of names between separators, as of LEAP's (`if_bs`) and Shadow's hands (`FFJ3`).
struct FingerLetters {
  Finger finger;
  std::string_view alone, before_j;
};
constexpr std::array kFingerLetters = {
    FingerLetters{Finger::kThumb, "th", "thj"}, FingerLetters{Finger::kIndex, "if", "ffj"},
    FingerLetters{Finger::kMiddle, "mf", "mfj"}, FingerLetters{Finger::kRing, "rf", "rfj"},
    FingerLetters{Finger::kLittle, "lf", "lfj"}};

std::optional<Finger> finger_of_letters(const std::string& lower) {
  for (std::size_t begin = 0; begin <= lower.size();) {
    const std::size_t end = std::min(lower.find_first_of("_-. ", begin), lower.size());
    const std::string_view part = std::string_view(lower).substr(begin, end - begin);
    for (const FingerLetters& letters : kFingerLetters) {
      if (part == letters.alone || part.starts_with(letters.before_j)) return letters.finger;
    }
    begin = end + 1;
  }
  return std::nullopt;
}

const std::vector<FingerWords>& finger_words() {
  static const std::vector<FingerWords> kWords = {{Finger::kThumb, {"thumb"}},
                                                  {Finger::kIndex, {"index", "forefinger"}},
                                                  {Finger::kMiddle, {"middle", "mid_", "_mid"}},
                                                  {Finger::kRing, {"ring"}},
                                                  {Finger::kLittle, {"pinky", "pinkie", "little"}}};
  return kWords;
}

// Rejects "ring" inside "spring" and "string".
bool has_finger_word(const std::string& name, std::string_view word) {
  const std::size_t at = name.find(word);
  if (at == std::string::npos) return false;
  return word != "ring" || at == 0 || (name[at - 1] != 'p' && name[at - 1] != 't');
}

}  // namespace

std::optional<Finger> finger_of_name(const std::string& name) {
  const std::string lower = lower_case(name);
  for (const auto& [finger, words] : finger_words()) {
    for (const std::string_view word : words) {
      if (has_finger_word(lower, word)) return finger;
    }
  }
  return finger_of_letters(lower);
}

}  // namespace retarget
