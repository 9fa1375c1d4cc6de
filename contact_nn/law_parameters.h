// The numbers that every force law needs, made from the settings once.
#pragma once

#include "contact_nn/contact.h"

namespace quayside::contact_nn {

struct LawParameters {
  double stiffness;         // flat contact over the reference area [N/m]
  double damping;           // c of F = F_elastic (1 + c s) [s/m]
  double friction;          // Coulomb coefficient; 0 where friction is not the module's
  double transition_speed;  // of the regularised friction [m/s]
  bool pressure_radius = false;  // whether `ContactForce::pressure_radius2` is asked for
};

// Throws std::invalid_argument, naming the setting and its range.
LawParameters law_parameters(const ContactSettings& settings);

}  // namespace quayside::contact_nn
