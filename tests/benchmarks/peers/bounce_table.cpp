#include "tests/benchmarks/peers/bounce_table.h"

#include <cmath>

#include <fmt/format.h>

#include "contact_nn/bounces.h"

namespace quayside::peers {
namespace {

constexpr double kStiffness = 6e8;   // [N/m]
constexpr double kTolerance = 1e-9;  // error of a step [m]

// Asks a method about one pair.
Answer ask(Contender& contender, std::vector<Placed>& pair) {
  contender.load(pair);
  contender.query(0);
  return contender.answer();
}

bool gives_what_a_spring_needs(Contender& contender) {
  contact_nn::Pose above = contact_nn::Pose::Identity();
  above.translation().z() = 2 * contact_nn::kBounceBox.half.z() - 1e-3;
  std::vector<Placed> pair{{contact_nn::kBounceBox, contact_nn::kBounceBox, contact_nn::Pose::Identity(), above}};
  const Answer answer = ask(contender, pair);
  return std::isfinite(answer.depth) && answer.point_W.allFinite();
}

}  // namespace

std::string bounce_table(const Contenders& contenders, std::size_t bounces, std::uint64_t seed) {
  std::string out = fmt::format(
      "\n## Energy from nowhere: {} elastic bounces under one spring at the reported contact\n\n"
      "| method | bounces that gain more than 0.1 % | most gained | most lost | still touching after 3 s |\n"
      "| --- | --- | --- | --- | --- |\n", bounces);
  for (const auto& contender : contenders) {
    if (contender->kind == Kind::mesh || !gives_what_a_spring_needs(*contender)) continue;
    std::vector<Placed> pair{{contact_nn::kBounceBox, contact_nn::kBounceBox, contact_nn::Pose::Identity(),
                              contact_nn::Pose::Identity()}};
    const contact_nn::ElasticLaw law = [&](const contact_nn::Pose& X_AB) -> contact_nn::Wrench {
      pair[0].X_WB = Placement(X_AB);
      const Answer answer = ask(*contender, pair);
      if (!answer.touching || !(answer.depth > 0)) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
      const Eigen::Vector3d f = kStiffness * answer.depth * answer.n_W;
      return {f, answer.point_W.cross(f)};
    };
    contact_nn::BounceTrials trials;
    for (std::size_t i = 0; i < bounces; ++i)
      trials.add(contact_nn::bounce(contact_nn::random_bounce_start(seed * 1000003 + i), law, kTolerance));
    const double finished = static_cast<double>(std::max<std::uint64_t>(trials.touched - trials.unfinished, 1));
    out += fmt::format("| {} | {:.1f} % | {:+.2g} % | {:.2g} % | {} |\n", contender->name,
                       100 * static_cast<double>(trials.gained) / finished, 100 * trials.most_gained,
                       100 * trials.most_lost, trials.unfinished);
  }
  return out;
}

}  // namespace quayside::peers
