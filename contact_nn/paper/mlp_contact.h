// The paper's network as a contact model: what its module does inside an integrator.
//
// The network says where two cubes touch and in which direction B is pushed, but not how hard. So where the boxes overlap
// (by the separating axes) B is pushed along the regressed direction at the regressed point by a spring, k times the depth.
#pragma once

#include "contact_nn/contact.h"
#include "contact_nn/mlp.h"
#include "contact_nn/paper/patterns.h"

namespace quayside::contact_nn::paper {

// Which depth the spring has.
//   exact  minus the largest separation over the 15 axes
//   own    how far the cubes overlap along the regressed direction
enum class Depth { exact, own };

class MlpContact {
 public:
  // `stiffness` k [N/m]. The network's interface is that of patterns.h.
  MlpContact(Network network, Encoding encoding, Depth depth, double stiffness);

  // Elastic, frictionless force between the paper's cubes. There is no potential: `potential_energy` stays zero.
  ContactForce operator()(const Pose& X_AB) const;

 private:
  Network network_;
  Encoding encoding_;
  Depth depth_;
  double stiffness_;
};

}  // namespace quayside::contact_nn::paper
