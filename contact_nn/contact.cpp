#include "contact_nn/contact.h"

#include <stdexcept>

#include "contact_nn/committee.h"
#include "contact_nn/exact_module.h"
#include "contact_nn/learned_potential.h"

namespace quayside::contact_nn {

std::unique_ptr<ContactModule> make_contact_module(const ContactSettings& settings) {
  if (settings.law == Law::learned) return make_learned_module(settings);
  if (settings.law == Law::pads) return make_exact_module(settings);
  switch (settings.model) {
    case Model::exact: return make_exact_module(settings);
    case Model::committee: return make_committee_module(settings);
  }
  throw std::invalid_argument("contact.model is not one of the known models");
}

}  // namespace quayside::contact_nn
