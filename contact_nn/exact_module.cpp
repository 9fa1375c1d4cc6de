#include "contact_nn/exact_module.h"

#include "contact_nn/law_parameters.h"
#include "contact_nn/manifold.h"
#include "contact_nn/pads_law.h"
#include "contact_nn/points_law.h"
#include "contact_nn/potential_law.h"

namespace quayside::contact_nn {
namespace {

class ExactModule final : public ContactModule {
 public:
  explicit ExactModule(const ContactSettings& settings) : law_(settings.law), parameters_(law_parameters(settings)) {}

  Manifold query(const Box& a, const Box& b, const Pose& X_AB, ContactCounters& counters,
                 double margin) const override {
    ++counters.queries;
    return contact_manifold(a, b, X_AB, margin);
  }

  ContactForce force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                     ContactCounters& counters) const override {
    ++counters.queries;
    if (law_ == Law::potential) return potential_force(a, b, X_AB, V_AB, parameters_);
    const Manifold manifold = contact_manifold(a, b, X_AB, 0);
    return law_ == Law::pads ? pads_force(manifold, X_AB, V_AB, parameters_) : points_force(manifold, X_AB, V_AB, parameters_);
  }

 private:
  Law law_;
  LawParameters parameters_;
};

}  // namespace

std::unique_ptr<ContactModule> make_exact_module(const ContactSettings& settings) {
  return std::make_unique<ExactModule>(settings);
}

}  // namespace quayside::contact_nn
