// Many pairs at once: eight pairs side by side in the lanes of vectors, for yards and broad phases, where most pairs
// are apart.
//
// No heap, no locks; the caller owns the buffers. Answers are those of single queries up to the rounding of sums (1e-15
// of the boxes' size), so where two axes tie to within it either may be named. Points and forces are made pair by pair:
// a batch of whole queries took as long as the single ones.
#pragma once

#include <cstddef>

#include "contact_nn/contact.h"
#include "contact_nn/dataset.h"
#include "contact_nn/separating_axes.h"

namespace quayside::contact_nn {

struct GapAndAxis {
  double gap;  // largest separation over the 15 axes [m]
  int axis;    // numbered as in separating_axes.h
};

// `pairs` and `answers` hold `count` items each; any count will do, multiples of 8 are best.
void separations(const BoxPair* pairs, std::size_t count, GapAndAxis* answers);

// Who is within `margin` [m] of each other? Writes the indices of these pairs in rising order and returns how many
// there are; `found` has room for `count`. Eight pairs that are all apart along some face cost no more than the test of
// the faces.
std::size_t find_touching(const BoxPair* pairs, std::size_t count, double margin, std::size_t* found);

}  // namespace quayside::contact_nn
