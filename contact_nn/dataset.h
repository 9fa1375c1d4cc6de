// Pairs of boxes in a shell of gaps around contact, as cranes meet them: what the gates learn from and are judged by.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "contact_nn/random.h"

namespace quayside::contact_nn {

enum class BoxKind { container_20ft, container_40ft, container_45ft, spreader, ground, trailer_deck };
inline constexpr int kBoxKinds = 6;

// Containers after ISO 668. The ground is a slab of 20 to 400 m, drawn anew each time.
Box sample_box(BoxKind kind, Random& random);

enum class PoseDomain {
  landing,  // B set down on A: any yaw, tilts to 3°; offsets from none to anywhere
  aligned,  // the same with axes exactly parallel, every second one without any offset or with edges flush
  resting,  // as aligned, half of them turned by any yaw, but for a disturbance in every direction, its size from
            // rounding to milliradians
  side,     // B pushed against A's side or end
  any,      // any orientation, any direction
};
const std::vector<PoseDomain>& all_pose_domains();
const char* name_of(PoseDomain domain);

struct BoxPair {
  Box a, b;
  Pose X_AB;
};

// A pair whose separation is drawn from [−deepest, farthest] [m]: half of the draws are spread evenly, half by orders
// of magnitude down to 10⁻⁹ m, since boxes rest at tenths of millimetres and land at tens. Offsets and tilts are drawn
// alike. Which box is A is drawn too.
// In the domain `any` the range is widened to a tenth of the smaller box if that is more.
struct GapRange {
  double deepest = 0.05;
  double farthest = 0;
};
BoxPair sample_pair(const Box& a, const Box& b, PoseDomain domain, const GapRange& gaps, Random& random);

// `count` pairs over all kinds that can meet (the ground and the deck lie below and do not meet one another), all
// domains in turn. The same seed gives the same pairs.
std::vector<BoxPair> sample_pairs(std::size_t count, const std::vector<PoseDomain>& domains, const GapRange& gaps,
                                  std::uint64_t seed);

}  // namespace quayside::contact_nn
