// The learned potential: a network for d = (I/A_f)^(1/p), of which U = ½ K d² is the contact potential of
// potential_law.h. Force and torque are the gradient of U, in reverse through the network and its inputs, so the force
// is conservative whatever the weights are, and zero when the boxes are apart (learned_potential_view.h).
//
// Outside the network's domain it would be wrong by orders of magnitude. There the exact law answers. In between U is
// blended, w U_network + (1 − w) U_exact, w a smooth function of the pose, and its gradient taken with ∇w: forces stay
// conservative and continuous. In the seam both are evaluated.
//
// Damping and friction act on the resultant, for which alone the network stands, at its centre of pressure c: where the
// line of action meets A's face (or the lower box', whichever is A). With the elastic force N n and the approach speed
// s = −n·v_c the normal force is N (1 + D s)₊. Rocking is damped by the torque −D N (r_x² ω_x, r_y² ω_y), friction and
// torsion are those of one piece of the exact law, with r² = r_x² + r_y². r_x and r_y, the radii of the pressure, are those
// of a wedge as wide as the overlap or as the depth over the tilt: r_x² = L_x²/12 / (1 + (tilt L_x/s)²). Each only takes
// energy. In the seam what they add to the elastic wrench is blended with what the exact law adds.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>

#include "contact_nn/contact.h"
#include "contact_nn/learned_potential_view.h"
#include "contact_nn/mlp.h"
#include "contact_nn/onnx_file.h"

namespace quayside::contact_nn {

namespace learned {

inline constexpr const char* kInterface = "quayside potential/1";  // of the network file
inline constexpr int kHidden = 48;                                 // units in each of two layers

// Where a network may answer alone, and the wider bounds at which its weight has fallen to zero. Boxes lie on one another
// along z, axes x along one another.
struct Domain {
  double tilt = 2 * M_PI / 180, outer_tilt = 2.5 * M_PI / 180;  // of the z axes [rad]
  double yaw = 5 * M_PI / 180, outer_yaw = 6.25 * M_PI / 180;   // of the x axes, about z [rad]
  double depth = 0.033, outer_depth = 0.042;                    // s [m]; a penetration of 30 mm has at most this s
  double overlap = 0.5, outer_overlap = 0.3;                    // least, sideways [m]
  // The same for boxes that lie across one another, the yaw counted between A's x and B's y axis; 0: not in the domain.
  double crossed_yaw = 0, outer_crossed_yaw = 0;                // [rad]

  // Beyond the yaw of this sine boxes count as crossed.
  double cross_from() const { return outer_crossed_yaw > 0 ? std::sin(outer_yaw) : Canonical::kNeverCrossed; }
};

// Domains that networks are made for. A network file names its own at the beginning of its key `domain`.
//   landing  as above
//   crane    tilt to 4° (5°); yaw to 10° (12.5°), and to 40° (50°) from square across one another
inline constexpr const char *kLanding = "landing", *kCrane = "crane";
Domain domain_named(const std::string& name);      // throws std::invalid_argument for another name
Domain domain_of(const NetworkFile& file);         // throws std::runtime_error when the file does not say

// Sizes of boxes that the network was trained on: containers and spreaders of any length, or ground.
bool known_size(const Box& a, const Box& b);

// The weight of the network and its gradient, for a canonical pose with s and its gradient known.
double domain_weight(const View<double>& view, bool crossed, const Domain& domain, const PoseGradient<double>& log_s,
                     PoseGradient<double>& gradient);

// Two hidden layers of tanh, value and gradient. `Scalar`: float in use, double to test the gradient against differences.
template <class Scalar>
class PotentialNetwork {
 public:
  static constexpr int kBatch = 16;
  using Lane = Eigen::Array<Scalar, kBatch, 1>;

  // Throws std::runtime_error for a network of other sizes.
  explicit PotentialNetwork(const Network& network);

  Scalar operator()(const Scalar* input, Scalar* gradient) const;
  void operator()(const Lane* input, Lane& value, Lane* gradient) const;  // 16 at once

 private:
  template <int Inputs, int Outputs>
  using Linear = detail::DenseLayer<Scalar, Inputs, Outputs, Activation::identity>;
  using Vector = Eigen::Array<Scalar, kHidden, 1>;

  Linear<kInputs, kHidden> in_;
  Linear<kHidden, kHidden> middle_, middle_back_;
  Linear<kHidden, kInputs> in_back_;
  alignas(detail::vector_bytes) std::array<Scalar, kHidden> out_;
  Scalar out_bias_;
  // The same again for batches: what multiplies one lane after another, in that order.
  std::array<Scalar, kHidden * kInputs> w1_, w1_back_;
  std::array<Scalar, kHidden * kHidden> w2_, w2_back_;
  std::array<Scalar, kHidden> b1_, b2_;
};

}  // namespace learned

struct LearnedPair {
  Box a, b;
  Pose X_AB;
  RelativeVelocity V_AB;
};

// The law `learned`. Answers like every module, and for many pairs at once.
class LearnedModule : public ContactModule {
 public:
  // Sixteen pairs at a time share one evaluation of the network. The same forces as one by one, to rounding.
  virtual void forces(const LearnedPair* pairs, std::size_t count, ContactForce* forces,
                      ContactCounters& counters) const = 0;
};

// Throws as `make_contact_module` does. Outside the network's domain `settings.model` answers with the law `potential`;
// `settings.network` replaces the network that ships. `fallbacks` counts pairs for which the exact law was needed.
std::unique_ptr<LearnedModule> make_learned_module(const ContactSettings& settings);

// The same with all arithmetic in double precision: for tests of the gradient.
std::unique_ptr<LearnedModule> make_learned_module_in_double(const ContactSettings& settings);

NetworkFile shipped_potential();

}  // namespace quayside::contact_nn
