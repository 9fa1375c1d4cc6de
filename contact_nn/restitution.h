// Restitution of the damping law F = F_elastic (1 + c s), s the approach speed.
#pragma once

namespace quayside::contact_nn {

// The damping c [s/m] with which a body that arrives at `speed` [m/s] leaves at `restitution` times it. A linear or
// Hunt-Crossley contact loses the same share whatever the mass and the exponent of the spring (Hunt and Crossley,
// 1975): with x = c · speed, x (1 + e) = ln[(1 + x)/(1 − x e)]. `restitution` in (0, 1]; 1 gives 0.
double damping_for(double restitution, double speed);

// The inverse: rebound over approach speed of a contact with damping c [s/m] at approach speed `speed` [m/s].
double restitution_of(double damping, double speed);

}  // namespace quayside::contact_nn
