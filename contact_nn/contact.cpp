#include "contact_nn/contact.h"

#include <stdexcept>

#include "contact_nn/exact_module.h"

namespace quayside::contact_nn {

std::unique_ptr<ContactModule> make_contact_module(const ContactSettings& settings) {
  switch (settings.model) {
    case Model::exact: return make_exact_module(settings);
    case Model::committee: break;
  }
  throw std::runtime_error("contact.model committee is not available: use exact");
}

}  // namespace quayside::contact_nn
