// What contact points do to energy: the same elastic bounces for every method, under the same spring.
#pragma once

#include <string>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {

// As Markdown. The law is one spring of 6e8 N/m at the reported point, along the reported normal, as long as the reported
// depth; methods that give no depth, and meshes, are left out. Two 40 ft boxes, thrown from
// anywhere as `rebound` of contact_nn/free_box.h does it.
std::string bounce_table(const Contenders& contenders, std::size_t bounces, std::uint64_t seed);

}  // namespace quayside::peers
