// The exact model: closed form over everything, for both laws.
#pragma once

#include "contact_nn/contact.h"

namespace quayside::contact_nn {

// Throws std::invalid_argument for values out of range. Does not look at `model` and `network`.
std::unique_ptr<ContactModule> make_exact_module(const ContactSettings& settings);

}  // namespace quayside::contact_nn
