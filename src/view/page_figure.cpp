#include "human/skeleton/side_colours.h"
#include "view/figure.h"
#include "view/page_data.h"

namespace retarget {

const char* side_name(Side side) {
  return side == Side::kLeft ? "left" : side == Side::kRight ? "right" : "middle";
}

nlohmann::ordered_json page_figure() {
  using Json = nlohmann::ordered_json;
  Json colours = Json::object(), chains = Json::array();
  for (const Side side : {Side::kLeft, Side::kRight, Side::kNone}) {
    colours[side_name(side)] = side_colour(side);
  }
  for (const auto& [side, bones] : human_chains()) {
    chains.push_back({{"side", side_name(side)}, {"bones", bones}});
  }
  return {{"colours", std::move(colours)}, {"chains", std::move(chains)}};
}

}  // namespace retarget
