// The network files that are part of the library, put there when it is built (embed_networks.cmake).
#pragma once

#include <string_view>

namespace quayside::contact_nn {

std::string_view embedded_gate_potential();
std::string_view embedded_gate_points();
std::string_view embedded_potential_landing();

}  // namespace quayside::contact_nn
