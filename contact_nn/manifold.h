// The geometry query: from the axis of largest separation to the points of contact.
#pragma once

#include "contact_nn/contact.h"
#include "contact_nn/separating_axes.h"

namespace quayside::contact_nn {

// The manifold on the axis of largest separation. Two faces nearly flat on each other touch in the corners of their
// overlap even where that axis is that of an edge pair: with a tilt of any size, half of all flat contacts have such an
// axis, and a single point would let the boxes rock. As the tilt grows the other points lift off by themselves. Its
// class is `apart`, and it has no points, when the gap exceeds `margin` or when the features nearest to each other
// along the normal do not face each other (boxes that are apart and pass each other diagonally).
Manifold contact_manifold(const Box& a, const Box& b, const Pose& X_AB, double margin);

// The same on a given axis, for a caller who has found the axis of largest separation in another way.
Manifold contact_manifold(const Box& a, const Box& b, const Pose& X_AB, double margin, const AxisSeparation& axis);

}  // namespace quayside::contact_nn
